// Conditions, reasons and actions that menus, keys and buttons share.
#include "ui/commands/guarded.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/scene/framing.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/viewpoints.h"
#include "ui/state/sentence.h"
#include "ui/state/state.h"

namespace gse::ui {
namespace {

/// Bounds of what is labelled; nothing where nothing is.
std::optional<Bounds> labelled_bounds(const Context& context) {
    const NamedLabel* label = context.active_label();
    if (label == nullptr || label->bits == nullptr || context.model.labelled == 0) return std::nullopt;
    return framing_bounds(context.document().current, *label->bits);
}

constexpr double AskAfterSeconds = 30;           // of work, before a cancel is asked about
constexpr std::uint64_t LargestSeed = 1u << 31;  // still easy to read and to type
constexpr float SmallestScale = 0.6f, LargestScale = 4.0f;

/// Sends the request first, with text that was typed in this very frame.
void send_request(Context& context) {
    if (context.request_changed) context.emit(command::SetRequest{context.request});
    context.request_changed = false;
}

/// A running or finished edit that is not applied: keep it for later, wait, or let it go.
void ask_about_edit(Context& context, const std::string& what, const std::function<void()>& act) {
    auto& commands = context.commands;
    auto& question = context.state.question;
    const auto& model = context.model;
    const bool running = model.edit_running;
    question.title = running ? "An edit is running" : "An edit is not applied";
    question.text = running ? fmt::format("{} \"{}\" is at step {} of {}.", what, model.job.title,
                                          model.job.step, model.job.total)
                            : fmt::format("{} A finished edit waits to be applied or discarded.", what);
    if (running && model.job.total <= 0)
        question.text = fmt::format("{} \"{}\" still works.", what, model.job.title);
    question.text += " What is kept is offered when the scene is opened again or the program starts.";
    question.answers = {{!running                  ? "Keep it for later"
                         : model.snapshots.empty() ? "Stop and keep the settings"
                                                   : "Stop and keep the snapshot",
                         false,
                         [&commands, act] {
                             commands.push(command::LeaveEdit{true, act});
                         }},
                        {running ? "Wait" : "Stay", false, {}},
                        // Other unsaved work is asked about next.
                        {"Discard it", true, [&commands, state = &context.state, what, act] {
                             commands.push(command::LeaveEdit{false, [state, what, act] {
                                                                  state->asked.leave = {what, act};
                                                              }});
                         }}};
    question.pending = true;
}

}  // namespace

void with_unsaved_work(Context& context, const std::string& what, std::function<void()> act) {
    if (!context.model.unsaved) return act();
    if (context.model.edit_running || context.model.result_waiting) return ask_about_edit(context, what, act);
    auto& commands = context.commands;
    auto& question = context.state.question;
    question.title = "Unsaved changes";
    question.text = fmt::format("{} The changes since the last save would be lost.", what);
    question.answers.clear();
    if (context.model.project_path.empty()) {
        question.answers.push_back({"Save as...", false, [state = &context.state, act] {
                                        state->asked.save_as = true;
                                        state->asked.after_save = act;
                                    }});
    } else {
        question.answers.push_back({"Save, then go on", false, [&commands, act] {
                                        commands.push(command::SaveProject{{}, act});
                                    }});
    }
    question.answers.push_back({"Go on without saving", true, act});
    question.answers.push_back({"Stay", false, {}});
    question.pending = true;
}

const std::vector<std::string>& scene_extensions() {
    static const std::vector<std::string> Endings = [] {
        std::vector<std::string> endings = readable_extensions();
        const std::vector<std::string> wrappers = wrapper_extensions();
        endings.insert(endings.end(), wrappers.begin(), wrappers.end());
        for (const char* other : {".json", ".gsep", ".png"}) endings.emplace_back(other);
        return endings;
    }();
    return Endings;
}

const std::vector<std::string>& film_extensions() {
    static const std::vector<std::string> Endings{".mp4", ".webm"};
    return Endings;
}

std::string keys_of(const Context& context, Shortcut command) {
    return chord_text(context.state.keymap.of(command));
}

std::string with_key(const Context& context, std::string text, Shortcut command) {
    const std::string keys = keys_of(context, command);
    return keys.empty() ? text : fmt::format("{} ({})", text, keys);
}

std::string why_not_work(const Context& context) {
    if (!context.scene_open()) return "Open a scene first";
    if (!context.model.cannot_edit.empty()) return context.model.cannot_edit;
    if (context.model.job.running) return fmt::format("\"{}\" is still running", context.model.job.title);
    if (context.model.result_waiting) return "Apply or discard the finished edit first";
    return {};
}

std::string why_not_locate(const Context& context) {
    const std::string why = why_not_work(context);
    return why.empty() ? context.state.prompt.locate_problem : why;
}

std::string why_not_edit(const Context& context) {
    const std::string why = why_not_work(context);
    if (!why.empty()) return why;
    const auto& prompt = context.state.prompt;
    if (!prompt.problem.empty() || prompt.steps.size() < 2) return prompt.problem;
    const bool any = std::any_of(prompt.steps.begin(), prompt.steps.end(), [&](const auto& step) {
        return step.problem.empty() && !is_left_out(context, step);
    });
    return any ? "" : "Tick a change that can be made";
}

bool is_left_out(const Context& context, const StepFacts& step) {
    const auto& out = context.state.prompt.left_out;
    return std::find(out.begin(), out.end(), step.notation) != out.end();
}

std::string why_not_label(const Context& context) {
    if (!context.scene_open()) return "Open a scene first";
    if (context.active_label() == nullptr) return "There is no label yet: press Locate, or add one";
    return {};
}

std::string why_not_hide(Context& context) {
    const std::string why = why_not_label(context);
    return why.empty() && label_count(context) == 0 ? "Nothing is labelled" : why;
}

void hide_label(Context& context) {
    if (why_not_hide(context).empty()) context.emit(command::HideLabel{});
}

void isolate_label(Context& context) {
    if (why_not_hide(context).empty()) context.emit(command::IsolateLabel{});
}

std::string why_not_vote(const Context& context) {
    if (context.model.attention_arriving) return "The search is still looking";
    return context.model.voting ? std::string() : why_not_work(context);
}

void toggle_vote(Context& context, int index) {
    const auto& views = context.model.attention;
    if (index < 0 || index >= static_cast<int>(views.size()) || !why_not_vote(context).empty()) return;
    const auto view = static_cast<std::size_t>(index);
    context.emit(command::LeaveOutView{view, views[view].step != edit::ViewStep::LeftOut});
}

std::string why_not_save(const Context& context) {
    return context.scene_open() ? std::string() : std::string("Nothing is open");
}

edit::EditRequest as_planned(const Context& context) {
    auto request = context.request;
    const auto& prompt = context.state.prompt;
    if (request.target.empty() && !prompt.told.prompt.empty()) {
        static_cast<edit::EditWords&>(request) = prompt.told;
        return request;
    }
    if (request.target.empty()) request.target = prompt.guessed_target;
    return request;
}

std::string why_not_export(const Context& context, const std::string& path) {
    if (!context.scene_open()) return "Open a scene first";
    if (path.empty()) return "Type where it should be written";
    if (context.model.file_job.running)
        return fmt::format("\"{}\" is still running", context.model.file_job.title);
    return {};
}

void export_picture(Context& context) {
    const auto& viewport = context.state.viewport;
    const float width = viewport.high.x - viewport.low.x;
    const float pixels = static_cast<float>(context.model.camera.width) / std::max(1.0f, width);
    context.emit(command::ExportPicture{width > 1 && pixels > 0 ? context.em * pixels : context.em});
}

std::string views_text(const Context& context) {
    const auto there = static_cast<int>(context.document().views.size()), used = context.request.views;
    if (there < static_cast<int>(LeastViewpoints))
        return fmt::format("{} automatic view{}", used, used == 1 ? "" : "s");
    if (there > used) return fmt::format("{} of {} views", used, there);
    return fmt::format("{} view{}", there, there == 1 ? "" : "s");
}

void roll_seed(Context& context) {
    context.request.seed =
        Random(context.request.seed ^ static_cast<std::uint64_t>(ImGui::GetTime() * 1e6)).below(LargestSeed);
    context.request_changed = true;
}

namespace {

void search(Context& context, const command::Locate& order) {
    context.request.excluded_views.clear();  // views of the search before
    context.request_changed = true;
    send_request(context);
    context.emit(order);
    show_panel(context.state, PanelId::Attention);
}

}  // namespace

void run_locate(Context& context) {
    if (why_not_locate(context).empty()) search(context, {!context.state.prompt.problem.empty()});
}

void run_server_search(Context& context) {
    if (why_not_work(context).empty()) search(context, {.by_server = true});
}

namespace {

/// Asks whether what the scene has already is changed, or one more is added.
void ask_second(Context& context, const std::string& thing) {
    auto& commands = context.commands;
    auto& question = context.state.question;
    const edit::EditRequest change = as_change(context.request, thing);
    question.title = fmt::format("\"{}\" is there already", thing);
    question.text = fmt::format(
        "\"{}\" adds one more. To change the one that is there, the edit has to be about the {} alone.",
        context.request.prompt, thing);
    question.answers = {{fmt::format("Change the {}", thing), false,
                         [&commands, state = &context.state, change] {
                             commands.push(command::SetRequest{change});
                             if (!change.target.empty()) commands.push(command::Edit{});
                             show_panel(*state, change.target.empty() ? PanelId::Prompt : PanelId::Progress);
                             if (change.target.empty())
                                 state->keyboard.asked = "prompt.sentence";  // nothing is said of it yet
                         }},
                        {"Add another", false,
                         [&commands, state = &context.state] {
                             commands.push(command::Edit{});
                             show_panel(*state, PanelId::Progress);
                         }},
                        {"Cancel", false, {}}};
    question.pending = true;
}

/// Steps that are not made: left out by the artist, or beyond the model.
std::vector<std::string> steps_not_made(const Context& context) {
    std::vector<std::string> out;
    for (const auto& step : context.state.prompt.steps)
        if (!step.problem.empty() || is_left_out(context, step)) out.push_back(step.notation);
    return out;
}

/// Asks whether the other steps are made where some cannot be. False = there is nothing to ask.
bool ask_partly(Context& context) {
    const auto& prompt = context.state.prompt;
    std::string undone;
    for (const auto& step : prompt.steps)
        if (!step.problem.empty() && !is_left_out(context, step))
            undone += fmt::format("{}{}: {}.", undone.empty() ? "" : "\n", step.text, step.problem);
    if (prompt.steps.size() < 2 || undone.empty()) return false;
    auto& question = context.state.question;
    question.title = "Some changes cannot be made";
    question.text = undone;
    question.answers = {
        {"Make the others", false,
         [&commands = context.commands, state = &context.state, out = steps_not_made(context)] {
             commands.push(command::Edit{out});
             show_panel(*state, PanelId::Progress);
         }},
        {"Cancel", false, {}}};
    question.pending = true;
    return true;
}

}  // namespace

void run_edit(Context& context) {
    if (asks_for_click(context)) return label_by_hand(context, context.request.source);
    if (!why_not_edit(context).empty()) return;
    const auto& present = context.model.scope.present;
    if (!context.state.prompt.seed_locked) roll_seed(context);
    send_request(context);
    if (context.state.prompt.steps.size() < 2 && !present.empty()) return ask_second(context, present);
    if (ask_partly(context)) return;
    context.emit(command::Edit{steps_not_made(context)});
    show_panel(context.state, PanelId::Progress);
}

void cancel_job(Context& context) {
    const auto& job = context.model.job;
    auto& commands = context.commands;
    if (!job.running) {
        if (context.model.file_job.running) commands.push(command::CancelFileJob{});
        return;
    }
    if (job.seconds < AskAfterSeconds) return commands.push(command::Cancel{});
    auto& question = context.state.question;
    question.title = "Cancel the job?";
    question.text = fmt::format("\"{}\" has worked for {:.0f} s. Its snapshots stay until the next run.",
                                job.title, job.seconds);
    question.answers = {{"Cancel the job", true, [&commands] { commands.push(command::Cancel{}); }},
                        {"Let it work", false, {}}};
    question.pending = true;
}

void open_path(Context& context, const std::string& path) {
    if (names_model(path_of(path))) {
        context.commands.push(command::OpenModel{path_of(path)});
        return show_panel(context.state, PanelId::Models);
    }
    auto& commands = context.commands;
    if (has_extension(path, std::vector<std::string>{".png"}))
        return commands.push(command::Open{path_of(path)});  // a prompt, no scene
    if (context.scene_open() && only_cameras(path_of(path)))
        return commands.push(command::Open{path_of(path)});  // for this scene
    with_unsaved_work(context, "Another scene is to be opened.",
                      [&commands, path] { commands.push(command::Open{path_of(path)}); });
}

std::string why_not_put_in(const Context& context) { return why_not_work(context); }

bool can_be_put_in(const Context& context, const std::vector<std::string>& paths) {
    if (!why_not_put_in(context).empty() || paths.size() != 1) return false;
    const auto& path = paths.front();
    return !has_extension(path, std::vector<std::string>{".png", ".gsep"}) && !only_cameras(path_of(path)) &&
           !names_model(path_of(path));
}

namespace {

/// Its handles show where it stands.
void put_in(Context& context, const std::string& path) {
    context.commands.push(command::PutIn{path_of(path)});
    if (context.state.viewport.tool != Tool::Place) set_tool(context, Tool::Place);
}

}  // namespace

void ask_put_in_or_open(Context& context, const std::string& path) {
    auto& question = context.state.question;
    question.title = "Put it in, or open it?";
    question.text = fmt::format("{} can be put into the open scene, or take its place.",
                                utf8_of(path_of(path).filename()));
    question.answers = {{"Put it in", false, [state = &context.state, path] { state->asked.put_in = path; }},
                        {"Open it", false, [state = &context.state, path] { state->asked.open = {path}; }},
                        {"Cancel", false, {}}};
    question.pending = true;
}

void ask_put_in(Context& context) {
    auto* state = &context.state;
    context.state.files.ask(
        {.title = "Put a scene into the open one",
         .confirm = "Put it in",
         .extensions = scene_extensions(),
         .saves = false,
         .folder_allowed = true,
         .start = context.model.recent.empty() ? std::string() : context.model.recent.front(),
         .answer = [state](const std::filesystem::path& path) { state->asked.put_in = utf8_of(path); }});
}

void put_in_what_is_asked(Context& context) {
    const std::string path = std::exchange(context.state.asked.put_in, {});
    if (!path.empty()) put_in(context, path);
}

void open_sample(Context& context) {
    auto& commands = context.commands;
    with_unsaved_work(context, "The sample is to be opened.",
                      [&commands] { commands.push(command::OpenSample{}); });
}

void open_one_of(Context& context, const std::vector<std::string>& paths) {
    if (paths.size() == 1) return open_path(context, paths.front());
    auto& question = context.state.question;
    question.title = "Which one is to be opened?";
    question.text = fmt::format("{} files came in; one scene is open at a time.", paths.size());
    question.answers.clear();
    for (const auto& path : paths)
        question.answers.push_back({utf8_of(path_of(path).filename()),
                                    false,
                                    [state = &context.state, path] { state->asked.open = {path}; },
                                    {},
                                    true});
    question.answers.push_back({"Cancel", false, {}});
    question.pending = true;
}

void ask_open(Context& context) {
    auto* state = &context.state;
    context.state.files.ask(
        {.title = "Open a scene, a folder or a project",
         .confirm = "Open",
         .extensions = scene_extensions(),
         .saves = false,
         .folder_allowed = true,
         .start = context.model.recent.empty() ? std::string() : context.model.recent.front(),
         .answer = [state](const std::filesystem::path& path) { state->asked.open = {utf8_of(path)}; }});
}

void ask_lost_scene(Context& context) {
    auto& commands = context.commands;
    const auto& lost = context.model.lost;
    const auto folder = path_of(lost.project).parent_path();
    const auto find = [&commands](const std::filesystem::path& path) {
        commands.push(command::FindScene{path});
    };
    auto* state = &context.state;
    context.state.files.ask(
        {.title = fmt::format("Where is {} now?", utf8_of(path_of(lost.scene).filename())),
         .confirm = "This is it",
         .extensions = scene_extensions(),
         .saves = false,
         .folder_allowed = true,
         .start = utf8_of(folder),
         .answer = [state, find](const std::filesystem::path& path) {
             state->asked.leave = {"Another project is to be opened.", [find, path] { find(path); }};
         }});
}

void recover(Context& context, const std::string& file) {
    auto& commands = context.commands;
    with_unsaved_work(context, "The work of another session is to be opened.",
                      [&commands, file] { commands.push(command::Recover{file}); });
}

void discard_recovery(Context& context, const RecoveryView& found) {
    auto& commands = context.commands;
    auto& question = context.state.question;
    question.title = "Discard the unsaved work?";
    question.text = fmt::format("{}, {}. It cannot be brought back.", found.name, found.facts);
    question.answers = {
        {"Discard", true, [&commands, file = found.file] { commands.push(command::DiscardRecovery{file}); }},
        {"Keep", false, {}}};
    question.pending = true;
}

void save_as(Context& context, std::function<void()> then) {
    if (!context.scene_open()) return;
    auto& commands = context.commands;
    std::filesystem::path start = path_of(context.model.project_path);
    if (start.empty() && !context.model.scene_path.empty()) start = path_of(context.model.suggested_project);
    if (start.empty()) start = home_folder() / "scene.gsep";
    context.state.files.ask({.title = "Save the project",
                             .confirm = "Save",
                             .extensions = {".gsep"},
                             .saves = true,
                             .folder_allowed = false,
                             .start = utf8_of(start),
                             .answer = [&commands, then](const std::filesystem::path& path) {
                                 commands.push(command::SaveProject{path, then});
                             }});
}

void save(Context& context) {
    if (!context.scene_open()) return;
    if (context.model.project_path.empty()) return save_as(context);
    context.emit(command::SaveProject{});
}

void quit(Context& context) {
    auto& commands = context.commands;
    const auto& files = context.model.file_job;
    if (!files.running)
        return with_unsaved_work(context, "The window is to be closed.",
                                 [&commands] { commands.push(command::Quit{}); });
    auto& question = context.state.question;
    question.title = "A file is not done";
    question.text = fmt::format("\"{}\" is still at work.", files.title);
    question.answers = {{"Wait", false, {}}, {"Stop it", true, [&commands, state = &context.state] {
                                                  commands.push(command::CancelFileJob{});
                                                  state->asked.leave = {
                                                      "The window is to be closed.",
                                                      [&commands] { commands.push(command::Quit{}); }};
                                              }}};
    question.pending = true;
}

void add_label(Context& context) {
    if (!context.scene_open()) return;
    const auto& labels = context.document().labels;
    const std::string name = free_label_name(labels, "label");
    context.emit(command::AddLabel{name});
    context.state.labels.renamed = static_cast<int>(labels.size());
    context.state.labels.name = name;
    context.state.labels.focus_name = true;
    show_panel(context.state, PanelId::Labels);
}

bool asks_for_click(const Context& context) {
    return context.scene_open() && why_not_work(context).empty() && !context.request.source.empty() &&
           !context.state.prompt.source_known && !context.model.labelled_by_hand;
}

void label_by_hand(Context& context, const std::string& name) {
    if (!context.scene_open()) return;
    const auto& labels = context.document().labels;
    const auto found = std::find_if(labels.begin(), labels.end(),
                                    [&](const NamedLabel& label) { return label.name == name; });
    if (found == labels.end()) context.emit(command::AddLabel{name});
    else context.emit(command::SetActiveLabel{static_cast<int>(found - labels.begin())});
    show_labelled(context);
    // A click or a box is the quickest way to a thing; the other tools correct it.
    context.state.viewport.tool = Tool::CutOut;
    context.state.viewport.stroke = false;
    show_panel(context.state, PanelId::Prompt);  // the sentence goes on when the thing is labelled
}

void set_tool(Context& context, Tool tool) {
    auto& viewport = context.state.viewport;
    viewport.tool = viewport.tool == tool ? Tool::Orbit : tool;
    viewport.stroke = false;
    if (viewport.tool != Tool::Orbit && viewport.tool != Tool::Heal) show_labelled(context);
}

void show_labelled(Context& context) {
    if (context.view.tint_labels) return;
    context.view.tint_labels = true;
    context.view_changed = true;
}

void toggle_wipe(Context& context) {
    context.emit(command::SetComparison{context.model.comparison == Comparison::Wipe ? Comparison::None
                                                                                     : Comparison::Wipe});
}

void frame_selection(Context& context) {
    if (!context.scene_open()) return;
    context.state.viewport.camera.frame(labelled_bounds(context).value_or(context.model.framing));
}

void go_home(Context& context) {
    if (!context.scene_open()) return;
    auto& viewport = context.state.viewport;
    viewport.labelled_home = labelled_bounds(context);
    viewport.camera.set_home(context.model.orbit, viewport.labelled_home.value_or(context.model.home));
    viewport.camera.set_fov(context.view.fov_degrees * 3.14159265358979323846 / 180);
    viewport.camera.home();
}

void step_view(Context& context, int step) {
    if (!context.scene_open() || context.document().views.empty()) return;
    const int count = static_cast<int>(context.document().views.size());
    int& selected = context.state.viewport.selected_view;
    selected = selected < 0 ? (step > 0 ? 0 : count - 1) : ((selected + step) % count + count) % count;
    context.emit(command::LookThrough{static_cast<std::size_t>(selected)});
}

void scale_ui(Context& context, float factor) {
    const float wanted = factor == 0 ? 1.0f : context.model.ui_scale * factor;
    context.emit(command::SetUiScale{std::clamp(std::round(wanted * 20) / 20, SmallestScale, LargestScale)});
}

std::size_t label_count(Context& context) {
    auto& labels = context.state.labels;
    const NamedLabel* label = context.active_label();
    if (label == nullptr || label->bits == nullptr) return 0;
    if (labels.counted != label->bits) {
        labels.counted = label->bits;
        labels.count = static_cast<std::size_t>(
            std::count_if(label->bits->begin(), label->bits->end(), [](auto bit) { return bit != 0; }));
    }
    return labels.count;
}

void show_panel(UiState& state, PanelId panel) {
    state.layout.show(panel);
    state.front_changed[static_cast<std::size_t>(state.layout.place(panel).area)] = true;
}

}  // namespace gse::ui
