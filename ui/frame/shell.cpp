// The whole window: menu, tools, viewport and panels.
#include "ui/frame/shell.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/base/file.h"
#include "ui/commands/guarded.h"
#include "ui/frame/menu.h"
#include "ui/keys/keyboard.h"
#include "ui/panels/panels.h"
#include "ui/state/own_pictures.h"
#include "ui/state/sentence.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/splitter.h"
#include "ui/widgets/tooltips.h"

namespace gse::ui {
namespace {

constexpr float ToolBarEm = 2.65f;
constexpr float SplitterEm = 0.35f;
constexpr float LeastViewportEm = 14;

constexpr ImGuiWindowFlags HostFlags =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_MenuBar | ImGuiWindowFlags_NoScrollWithMouse;

/// A surface of its own with padding, at a place of the window.
bool begin_surface(const char* name, ImVec2 low, ImVec2 size, ImU32 colour) {
    ImGui::SetCursorScreenPos(low);
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colour);
    const bool shown =
        ImGui::BeginChild(name, {std::max(1.0f, size.x), std::max(1.0f, size.y)}, false,
                          ImGuiWindowFlags_AlwaysUseWindowPadding | ImGuiWindowFlags_NoScrollbar |
                              ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NavFlattened);
    ImGui::PopStyleColor();
    return shown;
}

/// Facts about the sentence, made anew only when words or the model changed.
void update_sentence(Context& context) {
    auto& prompt = context.state.prompt;
    const auto& request = context.request;
    const auto& model = context.model;
    const bool server_finds = !model.server_search.empty();
    std::string key = fmt::format(
        "{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", request.source, request.prompt, request.target,
        request.mode, request.method, model.known_words.size(), model.labelled_by_hand, model.words_read,
        model.read_target, model.generated_vocabulary.size(), model.server.on, server_finds);
    for (const auto& word : model.said_words) key += "\n" + word;
    for (const auto& thing : model.made_things) key += "\n" + thing;
    if (key == prompt.key) return;
    prompt.key = std::move(key);
    SentenceFacts facts = facts_of(request, {model.known_words, model.said_words, model.labelled_by_hand,
                                             model.words_read, model.read_target, model.made_things,
                                             model.generated_vocabulary, model.server.on, server_finds});
    prompt.chips = std::move(facts.chips);
    prompt.problem = std::move(facts.problem);
    prompt.locate_problem = std::move(facts.locate_problem);
    prompt.source_suggestions = std::move(facts.source_suggestions);
    prompt.source_help = std::move(facts.source_help);
    prompt.source_known = facts.source_known;
    prompt.guessed_target = std::move(facts.guessed_target);
    prompt.told = std::move(facts.told);
    prompt.steps = std::move(facts.steps);
    prompt.refused = facts.refused;
    prompt.missing = std::move(facts.missing);
    std::erase_if(prompt.left_out, [&](const auto& out) {
        return std::none_of(prompt.steps.begin(), prompt.steps.end(),
                            [&](const auto& step) { return step.notation == out; });
    });
    prompt.cut_at = std::move(facts.cut_at);
}

/// Brings a panel to the front that the artist has to answer, with the room that its pictures need.
void ask_with(UiState& state, PanelId panel) {
    show_panel(state, panel);
    auto& layout = state.layout;
    if (layout.place(panel).area != Area::Bottom || layout.bottom_share >= Layout::AskingShare) return;
    layout.share_before_asking = layout.bottom_share;
    layout.bottom_share = Layout::AskingShare;
}

/// Gives the room back that a panel took to ask.
void take_back_room(Context& context) {
    auto& layout = context.state.layout;
    const bool asks = context.model.search.problem != edit::SearchProblem::None || context.model.targets_wait;
    if (layout.share_before_asking <= 0 || asks) return;
    layout.bottom_share = std::exchange(layout.share_before_asking, 0.0f);
}

/// A search that came to nothing shows why.
void show_failed_search(Context& context) {
    const auto& search = context.model.search;
    auto& shown = context.state.attention.problem_shown;
    if (search.problem == edit::SearchProblem::None || search.number == shown) return;
    shown = search.number;
    ask_with(context.state, PanelId::Attention);
}

/// An edit that waits for the artist's look at the redrawn views shows them.
void show_waiting_targets(Context& context) {
    auto& shown = context.state.targets.waited_for;
    const int round = context.model.targets_wait && !context.model.target_rounds.empty()
                          ? context.model.target_rounds.back().round
                          : -1;
    if (round >= 0 && round != shown) ask_with(context.state, PanelId::Targets);
    shown = round;
}

/// The accent below the tab in front.
void underline_tab(Context& context) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const float width = std::max(2.0f, std::round(context.em * 0.14f));
    ImGui::GetWindowDrawList()->AddRectFilled({low.x, high.y - width}, high, palette::Accent);
}

/// A double click on a tab of the bottom area gives it half of the height, another one takes it back.
void grow_by_double_click(Layout& layout) {
    constexpr float Large = 0.5f, HardlyMore = 0.05f;
    tooltip("Double click: half of the window's height, and back");
    if (!ImGui::IsItemHovered() || !ImGui::IsMouseDoubleClicked(0)) return;
    layout.share_before_asking = 0;
    const float usual = Layout::standard().bottom_share;
    layout.bottom_share = layout.bottom_share > usual + HardlyMore ? usual : Large;
}

struct Box {
    ImVec2 low, high;
    ImVec2 size() const { return {high.x - low.x, high.y - low.y}; }
};

/// Places of the areas in the space below the menu.
struct Plan {
    Box tools, viewport, bottom, right_top, right_bottom, job;
    Box split_right, split_bottom, split_column;
    bool right = false, bottom_used = false, column_split = false;
};

Plan plan_of(const Context& context, const Layout& layout, Box space) {
    const float em = context.em, split = std::round(em * SplitterEm);
    const float job = std::round(ImGui::GetFrameHeight() + em * 0.6f), tools = std::round(em * ToolBarEm);
    Plan plan;
    plan.job = {{space.low.x, space.high.y - job}, space.high};
    const Box middle{space.low, {space.high.x, plan.job.low.y - 1}};
    plan.tools = {middle.low, {middle.low.x + tools, middle.high.y}};
    const bool hidden = layout.panels_hidden;
    plan.right = !hidden && (layout.used(Area::RightTop) || layout.used(Area::RightBottom));
    plan.bottom_used = !hidden && layout.used(Area::Bottom);
    const float width = middle.high.x - plan.tools.high.x;
    const float most_right = std::max(width * 0.3f, std::min(width * 0.46f, width - em * LeastViewportEm));
    const float right = plan.right ? std::round(std::min(layout.right_em * em, most_right)) : 0;
    const float right_edge = middle.high.x - right;
    plan.split_right = {{right_edge - (plan.right ? split : 0), middle.low.y}, {right_edge, middle.high.y}};
    const float height = middle.high.y - middle.low.y;
    const float most_bottom = std::max(height * 0.25f, std::min(height * 0.6f, height - em * 10));
    const float bottom =
        plan.bottom_used
            ? std::round(std::clamp(layout.bottom_share * height, std::min(em * 6, most_bottom), most_bottom))
            : 0;
    const float bottom_edge = middle.high.y - bottom;
    plan.split_bottom = {{plan.tools.high.x, bottom_edge - (plan.bottom_used ? split : 0)},
                         {plan.split_right.low.x, bottom_edge}};
    plan.viewport = {{plan.tools.high.x, middle.low.y}, {plan.split_right.low.x, plan.split_bottom.low.y}};
    plan.bottom = {{plan.tools.high.x, bottom_edge}, {plan.split_right.low.x, middle.high.y}};
    plan.column_split = plan.right && layout.used(Area::RightTop) && layout.used(Area::RightBottom);
    const float share = plan.column_split ? layout.right_split : layout.used(Area::RightTop) ? 1.0f : 0.0f;
    const float cut = std::round(middle.low.y + height * share);
    plan.right_top = {{right_edge, middle.low.y},
                      {middle.high.x, plan.column_split ? cut - split * 0.5f : cut}};
    plan.split_column = {{right_edge, cut - split * 0.5f}, {middle.high.x, cut + split * 0.5f}};
    plan.right_bottom = {{right_edge, plan.column_split ? cut + split * 0.5f : cut}, middle.high};
    return plan;
}

void drag_splitters(Context& context, const Plan& plan) {
    auto& layout = context.state.layout;
    if (plan.right) {
        const float drag = splitter(context, "split.right", plan.split_right.low, plan.split_right.high);
        if (drag != 0)
            layout.right_em =
                std::clamp(plan.right_top.size().x / context.em - drag / context.em, 14.0f, 80.0f);
    }
    if (plan.bottom_used) {
        const float drag = splitter(context, "split.bottom", plan.split_bottom.low, plan.split_bottom.high);
        const float height = plan.tools.size().y;
        if (drag != 0) layout.share_before_asking = 0;  // the artist's own share
        if (drag != 0)
            layout.bottom_share =
                std::clamp((plan.bottom.size().y - drag) / std::max(1.0f, height), 0.08f, 0.9f);
    }
    if (plan.column_split) {
        const float drag = splitter(context, "split.column", plan.split_column.low, plan.split_column.high);
        const float height = plan.right_bottom.high.y - plan.right_top.low.y;
        if (drag != 0)
            layout.right_split = std::clamp(layout.right_split + drag / std::max(1.0f, height), 0.1f, 0.9f);
    }
}

}  // namespace

Shell::Shell() : state_(std::make_unique<UiState>()) {}
Shell::~Shell() = default;

std::string Shell::focused() const {
    for (const auto& stop : state_->keyboard.stops)
        if (has_focus(stop)) return std::string(stop.name);
    return {};
}

bool Shell::animating() const { return state_->animating; }
bool Shell::takes_text() const { return ImGui::GetIO().WantTextInput; }
std::string Shell::layout() const { return state_->layout.to_json(); }
void Shell::set_layout(const std::string& json) {
    state_->layout = Layout::from_json(json);
    state_->front_changed = {true, true, true};
}
void Shell::reset_layout() {
    state_->layout = Layout::standard();
    state_->front_changed = {true, true, true};
}
void Shell::show(PanelId panel) { show_panel(*state_, panel); }
void Shell::request_quit() { state_->asked.quit = true; }
void Shell::request_open(const std::vector<std::filesystem::path>& paths) {
    state_->asked.open.clear();
    for (const auto& path : paths) state_->asked.open.push_back(utf8_of(path));
    state_->asked.dropped = true;
}

void Shell::write_widgets(const std::filesystem::path& path) const {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [name, rect] : widgets_)
        json[name] = {{"x", rect.x},
                      {"y", rect.y},
                      {"width", rect.width},
                      {"height", rect.height},
                      {"visible", rect.visible},
                      {"enabled", rect.enabled}};
    write_file(path, json.dump(1));
}

void Shell::follow_document(std::uint64_t opened) {
    const std::uint64_t before = std::exchange(state_->document, opened);
    if (before == opened) return;
    forget_scene(*state_);
    if (before != 0) ImGui::ClearActiveID();  // a field would put the last scene's words back
}

void Shell::answer_requests(Context& context) {
    if (std::exchange(state_->asked.save_as, false))
        save_as(context, std::exchange(state_->asked.after_save, {}));
    if (std::exchange(state_->asked.quit, false)) quit(context);
    if (const auto leave = std::exchange(state_->asked.leave, {}); leave.act)
        with_unsaved_work(context, leave.what, leave.act);
    put_in_what_is_asked(context);
    const bool dropped = std::exchange(state_->asked.dropped, false);
    if (const auto paths = std::exchange(state_->asked.open, {}); !paths.empty()) {
        if (dropped && is_own_picture(context, paths))
            context.emit(command::SetServer{
                with_own_picture(context.model.server.choice, context.state.targets.view, paths.front())});
        else if (dropped && can_be_put_in(context, paths)) ask_put_in_or_open(context, paths.front());
        else open_one_of(context, paths);
    }
    const auto& asked = context.model.question;
    if (asked.number == state_->asked.question_seen) return;
    state_->asked.question_seen = asked.number;
    auto& question = state_->question;
    question = {asked.title, asked.text, {}, true};
    for (std::size_t index = 0; index < asked.answers.size(); ++index) {
        const auto& answer = asked.answers[index];
        question.answers.push_back(
            {answer.text, answer.dangerous,
             [&commands = context.commands, index] { commands.push(command::Answer{index}); }, answer.detail,
             answer.listed});
    }
}

void Shell::draw_tab_menu(Context& context, PanelId panel) {
    if (!ImGui::BeginPopupContextItem()) return;
    auto& layout = state_->layout;
    for (std::size_t area = 0; area < AreaCount; ++area) {
        const bool here = layout.place(panel).area == static_cast<Area>(area);
        if (!ImGui::MenuItem(fmt::format("Move to the {}", AreaNames[area]).c_str(), nullptr, here, !here))
            continue;
        layout.move(panel, static_cast<Area>(area));
        state_->front_changed[area] = true;
    }
    if (ImGui::MenuItem("Close")) layout.close(panel);
    ImGui::EndPopup();
}

void Shell::draw_area(Context& context, Area area) {
    auto& layout = state_->layout;
    const auto index = static_cast<std::size_t>(area);
    if (!ImGui::BeginTabBar(AreaNames[index], ImGuiTabBarFlags_Reorderable |
                                                  ImGuiTabBarFlags_FittingPolicyScroll |
                                                  ImGuiTabBarFlags_NoTooltip))
        return;
    // Taken first: a panel drawn below may bring another one to the front. SetSelected takes effect in the
    // frame after, so the front is only read again then.
    const bool bring = std::exchange(state_->front_changed[index], false);
    for (std::size_t at = 0; at < PanelCount; ++at) {
        const auto panel = static_cast<PanelId>(at);
        if (!layout.place(panel).open || layout.place(panel).area != area) continue;
        const bool front = layout.front[index] == static_cast<int>(at);
        ImGui::PushStyleColor(ImGuiCol_Text, front ? palette::Text : palette::TextDim);
        const bool shown =
            ImGui::BeginTabItem(PanelTable[at].name, nullptr,
                                bring && front ? ImGuiTabItemFlags_SetSelected : ImGuiTabItemFlags_None);
        ImGui::PopStyleColor();
        if (shown) underline_tab(context);
        note(context, fmt::format("tab.{}", PanelTable[at].name));
        if (area == Area::Bottom) grow_by_double_click(layout);
        draw_tab_menu(context, panel);
        if (!shown) continue;
        if (!bring) layout.front[index] = static_cast<int>(at);
        if (ImGui::BeginChild(PanelTable[at].name, {0, 0}, false, ImGuiWindowFlags_NavFlattened))
            DrawPanel[at](context);
        ImGui::EndChild();
        note(context, fmt::format("panel.{}", PanelTable[at].name));
        ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
}

void Shell::draw_areas(Context& context) {
    const ImVec2 origin = ImGui::GetCursorScreenPos();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const Plan plan = plan_of(context, state_->layout, {{0, origin.y}, screen});
    const auto surface = [&](const char* name, const Box& box, ImU32 colour, auto draw) {
        if (begin_surface(name, box.low, box.size(), colour)) draw();
        ImGui::EndChild();
    };
    surface("tools", plan.tools, palette::Panel, [&] { draw_tool_bar(context); });
    follow_placing(context);
    surface("viewport", plan.viewport, palette::Panel, [&] { draw_viewport(context); });
    if (plan.bottom_used)
        surface("bottom", plan.bottom, palette::Panel, [&] { draw_area(context, Area::Bottom); });
    if (plan.right && state_->layout.used(Area::RightTop))
        surface("right top", plan.right_top, palette::Panel, [&] { draw_area(context, Area::RightTop); });
    if (plan.right && state_->layout.used(Area::RightBottom))
        surface("right bottom", plan.right_bottom, palette::Panel,
                [&] { draw_area(context, Area::RightBottom); });
    surface("job", plan.job, palette::Window, [&] { draw_job_bar(context); });
    drag_splitters(context, plan);
}

void Shell::draw_window(Context& context) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    ImGui::PushStyleColor(ImGuiCol_WindowBg, palette::Window);
    ImGui::Begin("GSEditPro", nullptr, HostFlags);
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(3);
    draw_menu_bar(context);
    draw_areas(context);
    ImGui::End();
    draw_bars(context);
    draw_dialogs(context);
}

std::vector<Command> Shell::draw(const ViewModel& model, Textures& textures) {
    const float em = ImGui::GetFontSize();
    if (em != styled_em_) apply_theme(ImGui::GetStyle(), em);
    styled_em_ = em;
    Context context{model,         commands_,           textures, *state_,    state_->keyboard,
                    widgets_,      current_fonts(),     em,       model.view, model.request,
                    model.exports, model.model_settings};
    state_->animating = false;
    follow_document(model.opened);
    set_foreign_glyphs(&glyphs_);
    if (model.keymap != state_->keys.read) {
        state_->keymap = Keymap::parse(model.keymap);
        state_->keys.read = model.keymap;
    }
    begin_keyboard(context);
    update_sentence(context);
    show_failed_search(context);
    show_waiting_targets(context);
    take_back_room(context);
    handle_keys(context);
    answer_requests(context);
    keep_controls(context);
    state_->keyboard.stops.clear();  // their names are those of the widgets
    widgets_.clear();
    state_->pick.seen = false;
    draw_window(context);
    if (model.picked.shown && !state_->pick.seen) context.emit(command::DropPicked{});
    end_keyboard(context);
    if (context.request_changed) context.emit(command::SetRequest{context.request});
    if (context.view_changed) context.emit(command::SetViewSettings{context.view});
    if (context.exports_changed) context.emit(command::SetExports{context.exports});
    if (context.model_settings_changed) context.emit(command::SetModelSettings{context.model_settings});
    state_->animating |= !commands_.empty() || awaits_tooltip();
    return commands_.take();
}

}  // namespace gse::ui
