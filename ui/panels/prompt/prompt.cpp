// Prompt: what in the scene, the sentence after the edit, how hard, and what it will cost.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/language/synonyms.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/scene/strength.h"
#include "ui/commands/guarded.h"
#include "ui/keys/keyboard.h"
#include "ui/panels/panels.h"
#include "ui/panels/prompt/parts.h"
#include "ui/state/sentence.h"
#include "ui/state/state.h"
#include "ui/state/status.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

constexpr double LeastStrength = 0;
constexpr double TypingPause = 0.5;  // seconds without a letter, after which words are judged
constexpr std::array<const char*, 4> Modes{"auto", "modify", "replace", "add"};
constexpr std::array<const char*, 4> ModeHelp{
    "As the sentence says: what describes the source modifies it, what stands in its place replaces it.",
    "Change what is there: colours and material of the source.",
    "Put something else in the source's place: a cat for the bear.",
    "Put something new there, such as a hat on the bear."};

/// Offer to have the image server look for what the model has no word for. Nothing goes there before the
/// click. What it found may be wrong: the offer stays beside the label.
void draw_server_search(Context& context) {
    if (context.model.server_search.empty()) return;
    const bool again = context.model.labelled_by_hand;
    dim_text(context.model.server_search);
    if (button(context,
               {.name = "prompt.source.by_server",
                .text = again ? "Let the server find it again" : "Let the server find it",
                .why_off = why_not_work(context),
                .tooltip = again ? "What it changes takes the label's place; undo brings that back. Another "
                                   "sentence or seed gives other pictures"
                                 : "What it changes becomes a label, which you can look at and correct"}))
        run_server_search(context);
}

/// Advice for a source that the model does not know.
void draw_unknown_source(Context& context) {
    const auto& prompt = context.state.prompt;
    const std::string word = language::unknown_word(context.model.known_words, context.request.source);
    const std::string synonym = language::known_synonym(word, context.model.known_words);
    if (context.model.labelled_by_hand) {
        dim_text(fmt::format("The model cannot find \"{}\": the label says where it is.", word));
        draw_server_search(context);
        return;
    }
    if (!synonym.empty()) wrapped_text(fmt::format("\"{}\" is another word for \"{}\".", word, synonym));
    else
        coloured_text(palette::Warning,
                      language::vocabulary_contains(context.model.generated_vocabulary, word) &&
                              !context.model.generated_vocabulary.empty()
                          ? fmt::format("I can draw \"{}\" but not find it: click on it in the view.", word)
                          : fmt::format("I do not know \"{}\": click on it in the view.", word));
    for (std::size_t i = 0; i < prompt.source_suggestions.size(); ++i) {
        const auto& suggestion = prompt.source_suggestions[i];
        const std::string text = fmt::format("Use \"{}\"", suggestion);
        if (i > 0) flow(button_width(text));
        if (button(context, {.name = i == 0 ? "prompt.source.suggestion"
                                            : fmt::format("prompt.source.suggestion.{}", i),
                             .text = text})) {
            context.request.source = suggestion;
            context.request_changed = true;
        }
    }
    constexpr const char* by_hand = "Click on it";
    if (!prompt.source_suggestions.empty()) flow(button_width(by_hand));
    if (button(context, {.name = "prompt.source.by_hand",
                         .text = by_hand,
                         .why_off = context.scene_open() ? "" : "Open a scene first",
                         .tooltip = "Gives you Cut out: click on the thing that may change, or drag a box "
                                    "around it. It becomes a label of that name"}))
        label_by_hand(context, context.request.source);
    if (prompt.source_suggestions.empty()) dim_text(fmt::format("Or use {}.", prompt.source_help));
    draw_server_search(context);
}

void draw_source(Context& context) {
    auto& prompt = context.state.prompt;
    dim_text("What in the scene is it about?");
    tooltip("A thing by its name, of one word or several. Empty: the target itself is looked for.");
    if (text_input(context, "prompt.source", context.request.source, "for example: bear")) {
        context.request_changed = true;
        prompt.typed_at = ImGui::GetTime();
    }
}

/// True while a field of words is being typed into: half a word is not judged.
bool typing(const Context& context) { return ImGui::GetTime() - context.state.prompt.typed_at < TypingPause; }

void draw_sentence(Context& context) {
    auto& prompt = context.state.prompt;
    dim_text("The scene after the edit");
    tooltip("One sentence. Shift + Enter or Ctrl + Enter starts the edit.");
    const std::string before = context.request.prompt;
    if (text_input(context, "prompt.sentence", context.request.prompt,
                   "for example: a bear wearing a red hat")) {
        context.request_changed = true;
        prompt.typed_at = ImGui::GetTime();
        // What was clicked, or taken from an edit, belongs to its sentence.
        if (language::words_of(before) != language::words_of(context.request.prompt)) {
            context.request.target.clear();
            forget_scope(context.request);
        }
    }
}

/// Words of the sentence as chips: the target is clicked, a word that is not known is exchanged.
void draw_chips(Context& context) {
    const auto& prompt = context.state.prompt;
    if (prompt.chips.empty()) return;
    const ChipClick click = chips(context, "prompt.chip", prompt.chips, !typing(context));
    if (click.chosen >= 0) {
        const auto& chip = prompt.chips[static_cast<std::size_t>(click.chosen)];
        const auto index = static_cast<std::size_t>(click.chosen);
        auto& target = context.request.target;
        if (click.extends) target = target_to(context.request.prompt, target, index);
        else target = chip.target && !chip.guessed ? std::string() : chip.text;
        context.request_changed = true;
    }
    if (click.replaced >= 0) {
        const auto index = static_cast<std::size_t>(click.replaced);
        const auto& chip = prompt.chips[index];
        if (chip.target && !chip.guessed) {
            const std::size_t first = language::position_of(context.request.prompt, context.request.target);
            context.request.target = with_word(context.request.target, index - first, chip.suggestion);
        }
        context.request.prompt = with_word(context.request.prompt, index, chip.suggestion);
        context.request_changed = true;
    }
}

/// Way to a thing of the sentence that nothing in the scene is called yet.
void draw_missing(Context& context) {
    const std::string& missing = context.state.prompt.missing;
    if (missing.empty()) return;
    coloured_text(palette::Warning, fmt::format("I do not know where \"{}\" is.", missing));
    if (button(context,
               {.name = "prompt.missing.by_hand",
                .text = fmt::format("Click on \"{}\"", missing),
                .why_off = context.scene_open() ? "" : "Open a scene first",
                .tooltip = "Gives you Cut out: click on the thing, or drag a box around it. It becomes "
                           "a label of that name, and the sentence goes on"}))
        label_by_hand(context, missing);
}

/// Remarks about both fields, below them: no field moves under the cursor, and Tab leads from field to field.
void draw_remarks(Context& context) {
    const auto& prompt = context.state.prompt;
    if (typing(context)) return;
    if (!prompt.source_known) draw_unknown_source(context);
    if (prompt.chips.empty()) return;
    if (!prompt.cut_at.empty())
        coloured_text(palette::Warning,
                      fmt::format("The model reads {} words of a sentence: from \"{}\" on nothing counts.",
                                  context.model.words_read, prompt.cut_at));
    draw_missing(context);
    if (prompt.refused) return;  // words alone would not help
    // The source's own remark says more.
    const bool unknown = std::any_of(prompt.chips.begin(), prompt.chips.end(),
                                     [](const Chip& chip) { return !chip.known && !chip.source; });
    if (unknown) coloured_text(palette::Warning, "Words the model does not know have no effect.");
    const bool chosen =
        std::any_of(prompt.chips.begin(), prompt.chips.end(), [](const Chip& chip) { return chip.target; });
    if (!chosen && prompt.steps.empty())
        dim_text("Click the word that is new: it is the target of the edit.");
}

/// Instruction for a model that edits pictures.
void draw_instruction(Context& context) {
    if (!context.model.edits_by_instruction) return;
    dim_text("What is to be done");
    tooltip(
        "The model in use (InstructPix2Pix) is told an order. Empty: what the field shows, made of the words "
        "above.");
    const std::string usual = context.request.prompt.empty() ? "for example: make the bear golden"
                                                             : edit::instruction_of(context.request);
    context.request_changed |= text_input(context, "prompt.instruction", context.request.instruction, usual);
}

void draw_mode(Context& context) {
    int mode = static_cast<int>(std::find(Modes.begin(), Modes.end(), context.request.mode) - Modes.begin());
    row_label(context, "Mode", ModeHelp.front());
    if (segmented(context, "prompt.mode", Modes, mode)) {
        context.request.mode = Modes[static_cast<std::size_t>(mode)];
        context.request_changed = true;
    }
    if (mode >= 0 && mode < static_cast<int>(ModeHelp.size()))
        tooltip(ModeHelp[static_cast<std::size_t>(mode)]);
}

void draw_method(Context& context) {
    const auto& help = edit::methods_explained();
    const auto names = edit::method_names();
    int method =
        static_cast<int>(std::find(names.begin(), names.end(), context.request.method) - names.begin());
    row_label(context, "Method", help);
    if (segmented(context, "prompt.method", names, method)) {
        context.request.method = names[static_cast<std::size_t>(method)];
        context.request_changed = true;
    }
    tooltip(help);
}

/// "draft: half of the views ... About 5 s.", a line per quality.
std::string quality_help(const Estimate& estimate) {
    constexpr std::array<const char*, edit::Qualities.size()> what{
        "half of the views, three quarters of their steps: to see where it goes", "what the settings say",
        "twice the views, half again as many steps"};
    std::string help;
    for (std::size_t i = 0; i < what.size(); ++i) {
        help += fmt::format("{}{}: {}.", i == 0 ? "" : "\n", edit::Qualities[i], what[i]);
        const double seconds = estimate.quality_seconds[i];
        if (seconds >= 0) help += fmt::format(" About {}.", duration_text(seconds));
    }
    return help;
}

void draw_quality(Context& context) {
    if (!edit::method_of(context.request).draws_views()) return;
    const auto& names = edit::Qualities;
    const std::string help = quality_help(context.model.estimate);
    int quality =
        static_cast<int>(std::find(names.begin(), names.end(), context.request.quality) - names.begin());
    row_label(context, "Quality", help);
    if (segmented(context, "prompt.quality", names, quality)) {
        context.request.quality = names[static_cast<std::size_t>(quality)];
        context.request_changed = true;
    }
    tooltip(help);
}

/// The steps that the method will run: of the loop, or of the fits to redrawn views.
void draw_iterations(Context& context) {
    auto& request = context.request;
    const auto mode = edit::planned_mode(as_planned(context));
    const auto& method = edit::method_of(context.request);
    const std::string help = method.steps_help(request, mode);
    row_label(context, "Iterations", help);
    const int least = 1;
    int steps = method.steps(request, mode);
    const float speed = method.draws_views() ? 1.0f : 5.0f;
    if (ImGui::DragInt("##prompt.iterations", &steps, speed, least, 100000, "%d",
                       ImGuiSliderFlags_AlwaysClamp)) {
        method.set_steps(request, mode, steps);
        context.request_changed = true;
    }
    note(context, "prompt.iterations");
    tooltip(help);
}

void draw_strength(Context& context) {
    row_label(context, "Strength",
              "How much of the edit is kept. 1: what the model made of it. Less: between before and after. "
              "More: colours go "
              "beyond it. Of an applied edit it can be changed under History.");
    const double before = context.request.strength;
    context.request_changed |=
        ImGui::SliderScalar("##prompt.strength", ImGuiDataType_Double, &context.request.strength,
                            &LeastStrength, &MostStrength, "%.2f");
    if (!std::isfinite(context.request.strength)) context.request.strength = before;  // "1e999" was typed
    context.request.strength = std::clamp(context.request.strength, LeastStrength, MostStrength);
    note(context, "prompt.strength");
    draw_iterations(context);
}

void draw_seed(Context& context) {
    auto& prompt = context.state.prompt;
    row_label(context, "Seed", "The same seed, sentence and settings give the same edit.");
    const float buttons = context.em * 1.75f * 2 + ImGui::GetStyle().ItemSpacing.x * 2;
    ImGui::SetNextItemWidth(std::max(context.em * 3, ImGui::GetContentRegionAvail().x - buttons));
    context.request_changed |= ImGui::InputScalar("##prompt.seed", ImGuiDataType_U64, &context.request.seed);
    note(context, "prompt.seed");
    takes_letters(context);
    ImGui::SameLine();
    if (icon_button(context, {.name = "prompt.seed.lock",
                              .icon = prompt.seed_locked ? Icon::Lock : Icon::Unlock,
                              .tooltip = prompt.seed_locked ? "Locked: every edit uses this seed"
                                                            : "Open: every edit gets another seed",
                              .active = prompt.seed_locked}))
        prompt.seed_locked = !prompt.seed_locked;
    ImGui::SameLine();
    if (icon_button(context, {.name = "prompt.seed.dice", .icon = Icon::Dice, .tooltip = "Another seed"}))
        roll_seed(context);
}

/// Work of the model before the loop. More of it is under "All settings".
void draw_model_settings(Context& context) {
    context.model_settings_changed |=
        checkbox(context, "prompt.learn", "Learn the scene first", context.model_settings.learn_scene,
                 "DreamBooth: the model looks at renders of this scene before it edits. Takes about a "
                 "minute; helps with scenes "
                 "that look like nothing it knows.");
}

/// Seconds of the edit; of several steps, those that are ticked. Negative = not known yet.
double planned_seconds(const Context& context) {
    const auto& prompt = context.state.prompt;
    const auto& estimate = context.model.estimate;
    if (prompt.steps.size() < 2 || estimate.step_seconds.size() != prompt.steps.size())
        return estimate.seconds;
    double sum = 0;
    bool any = false;
    for (std::size_t i = 0; i < prompt.steps.size(); ++i) {
        if (!prompt.steps[i].problem.empty() || is_left_out(context, prompt.steps[i])) continue;
        if (estimate.step_seconds[i] < 0) return -1;
        sum += estimate.step_seconds[i];
        any = true;
    }
    return any ? sum : -1;
}

/// Part of the image server in words; empty = it draws nothing.
std::string server_estimate_text(const Estimate& estimate) {
    if (estimate.server_pictures <= 0) return {};
    const auto pictures =
        fmt::format("{} picture{}", estimate.server_pictures, estimate.server_pictures == 1 ? "" : "s");
    if (estimate.server_seconds < 0)
        return fmt::format("Image server: {}, their time is known once it has drawn one", pictures);
    return fmt::format("Image server: about {} for {}", duration_text(estimate.server_seconds), pictures);
}

std::string estimate_text(const Context& context) {
    const auto& estimate = context.model.estimate;
    const double seconds = planned_seconds(context);
    if (seconds < 0 && estimate.memory_mb < 0 && estimate.server_pictures <= 0) return {};
    std::string text = seconds >= 0 ? fmt::format("Estimate: about {}", duration_text(seconds))
                                    : "Time: measured with the first search";
    if (estimate.server_pictures > 0) text = server_estimate_text(estimate);
    const auto& [draft, normal, fine] = estimate.quality_seconds;
    if (seconds >= 0 && context.state.prompt.left_out.empty() && draft >= 0 && fine > draft)
        text += fmt::format(" (draft {}, normal {}, fine {})", duration_text(draft), duration_text(normal),
                            duration_text(fine));
    if (estimate.memory_mb < 0) return text;
    text += ", " + bytes_text(estimate.memory_mb * 1e6);
    if (estimate.memory_free_mb >= 0)
        text += fmt::format(" of {} free", bytes_text(estimate.memory_free_mb * 1e6));
    return text;
}

std::string memory_warning(const Estimate& estimate) {
    const bool tight =
        estimate.memory_mb > 0 && estimate.memory_free_mb > 0 && estimate.memory_mb > estimate.memory_free_mb;
    return tight ? "That is more memory than is free: fewer views or a smaller image size help." : "";
}

/// Obstacles, shown without hovering too.
std::string obstacle_text(const Context& context) {
    if (!context.scene_open() || context.model.job.running || typing(context)) return {};
    const std::string why = why_not_edit(context);
    return why.empty() || why.ends_with('.') ? why : fmt::format("{}.", why);
}

void draw_estimate(Context& context) {
    const std::string text = estimate_text(context), warning = memory_warning(context.model.estimate);
    if (!text.empty()) {
        dim_text(text);
        note(context, "prompt.estimate");
        if (context.model.estimate.tflop >= 0)
            tooltip(fmt::format("Arithmetic of the networks: {}", tflop_text(context.model.estimate.tflop)));
    }
    if (!warning.empty()) coloured_text(palette::Bad, warning);
}

/// Which label the edit will change, or what it searches for; empty = that cannot be said yet.
std::string reach_text(const Context& context) {
    const auto& scope = context.model.scope;
    const auto planned = as_planned(context);
    const auto word = language::normalised_prompt(planned.source.empty() ? planned.target : planned.source);
    if (!context.scene_open() || word.empty() || context.model.job.running) return {};
    if (!scope.by_label && !context.state.prompt.source_known)
        return scope.label.empty() ? std::string() : fmt::format("No label is named \"{}\".", word);
    if (edit::planned_mode(planned) == edit::EditMode::Add)
        return fmt::format(
            "Adds \"{}\" where a search places it.{}", language::normalised_prompt(planned.target),
            scope.corrected ? " What was set by hand in the label does not count for that." : "");
    if (scope.by_label)
        return fmt::format(
            "May change: label \"{}\", {} splats{}.", scope.label, count_text(scope.splats),
            scope.shown.empty() ? std::string() : fmt::format("; label \"{}\" stays", scope.shown));
    return fmt::format("Will search for \"{}\" first.", word);
}

/// True where the model is told other words than those typed, and nothing else shows them.
bool read_otherwise(const Context& context) {
    const auto& told = context.state.prompt.told.prompt;
    const bool listed = context.state.prompt.steps.size() > 1;
    return !told.empty() && !listed && context.request.target.empty() &&
           language::normalised_prompt(told) != language::normalised_prompt(context.request.prompt);
}

/// reach_text() behind the sentence that the model is told, where that is not the typed one.
std::string plan_text(const Context& context) {
    const std::string reach = reach_text(context);
    if (reach.empty() || !read_otherwise(context)) return reach;
    return fmt::format("Read as \"{}\". {}", context.state.prompt.told.prompt, reach);
}

/// The other way; empty = there is none.
std::string other_reach(const Context& context) {
    const auto& scope = context.model.scope;
    if (reach_text(context).empty() || edit::planned_mode(as_planned(context)) == edit::EditMode::Add)
        return {};
    if (!scope.by_label)
        return scope.label.empty() ? std::string()
                                   : fmt::format("Use label \"{}\"", shortened(scope.label, context.em * 7));
    return context.state.prompt.source_known ? "Ignore label" : "";
}

/// Tells whether text and button have room beside each other.
bool reach_in_line(const std::string& text, const std::string& other) {
    return ImGui::CalcTextSize(text.c_str()).x + ImGui::GetStyle().ItemSpacing.x + button_width(other) <=
           ImGui::GetContentRegionAvail().x;
}

float reach_height(const Context& context) {
    const std::string text = plan_text(context), other = other_reach(context);
    if (text.empty()) return 0;
    const float gap = ImGui::GetStyle().ItemSpacing.y,
                button_row = other.empty() ? 0 : ImGui::GetFrameHeight() + gap;
    if (!other.empty() && reach_in_line(text, other)) return button_row;
    return ImGui::CalcTextSize(text.c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y + gap +
           button_row;
}

void draw_reach(Context& context) {
    const std::string text = plan_text(context), other = other_reach(context);
    if (text.empty()) return;
    const bool in_line = !other.empty() && reach_in_line(text, other);
    if (in_line) ImGui::AlignTextToFramePadding();
    wrapped_text(text);
    note(context, "prompt.scope");
    if (read_otherwise(context)) note(context, "prompt.read_as");
    if (other.empty()) return;
    if (in_line) ImGui::SameLine();
    const bool by_label = context.model.scope.by_label;
    if (button(context,
               {.name = "prompt.scope.other",
                .text = other,
                .tooltip = by_label ? "The words say what may change: they are looked for in all views"
                                    : "What this label marks may change, whatever the words find"}))
        context.emit(command::SetScope{!by_label});
}

void draw_run(Context& context) {
    const std::string why_locate = why_not_locate(context), why_edit = why_not_edit(context);
    const float spacing = ImGui::GetStyle().ItemSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - spacing) * 0.5f;
    const bool stacked = width < button_width("Locate") || width < button_width("Cancel");
    if (button(context,
               {.name = "prompt.locate",
                .text = "Locate",
                .why_off = why_locate,
                .tooltip = with_key(context, "Find the source in the scene and label it", Shortcut::Locate),
                .width = stacked ? -1 : width}))
        run_locate(context);
    if (!stacked) ImGui::SameLine();
    if (context.model.job.running) {
        if (button(context, {.name = "prompt.cancel",
                             .text = "Cancel",
                             .tooltip = "Stop the job (Esc)",
                             .look = Look::Danger,
                             .width = stacked ? -1 : width}))
            cancel_job(context);
    } else if (button(context, {.name = "prompt.edit",
                                .text = "Edit",
                                .why_off = why_edit,
                                .tooltip = "Change the scene (Shift + Enter)",
                                .look = Look::Primary,
                                .width = stacked ? -1 : width})) {
        run_edit(context);
    }
}

void draw_words(Context& context) {
    draw_source(context);
    draw_sentence(context);
    draw_chips(context);
    draw_remarks(context);
    if (!typing(context)) draw_plan(context);
    draw_instruction(context);
    ImGui::Spacing();
    draw_mode(context);
    draw_method(context);
    draw_quality(context);
    draw_strength(context);
    draw_seed(context);
    draw_model_settings(context);
    draw_advanced(context);
}

/// Estimate, buttons, and why they are off: as high as they are, so that they end at the panel's edge.
float footer_height(Context& context) {
    const float width = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.y;
    float height = ImGui::GetFrameHeight() + gap;
    const auto add = [&](const std::string& text) {
        if (!text.empty()) height += ImGui::CalcTextSize(text.c_str(), nullptr, false, width).y + gap;
    };
    add(estimate_text(context));
    add(memory_warning(context.model.estimate));
    add(obstacle_text(context));
    return height + reach_height(context) + context.em * 0.2f;
}

}  // namespace

void draw_prompt_panel(Context& context) {
    // The buttons stay in sight, whatever is scrolled above them.
    const float height = std::max(context.em * 4, ImGui::GetContentRegionAvail().y - footer_height(context));
    if (ImGui::BeginChild("words", {0, height}, false, ImGuiWindowFlags_NavFlattened)) draw_words(context);
    ImGui::EndChild();
    draw_estimate(context);
    draw_reach(context);
    if (const std::string obstacle = obstacle_text(context); !obstacle.empty()) dim_text(obstacle);
    draw_run(context);
}

void draw_result_notice(Context& context, const char* prefix) {
    if (!context.model.result_waiting) return;
    const auto& verdict = context.model.verdict;
    begin_notice(context, fmt::format("{}.result", prefix),
                 verdict.warns ? palette::Warning : palette::Accent);
    wrapped_text(fmt::format("{} Look at it: V wipes between before and after, hold ` to flip.",
                             result_sentence(verdict)));
    for (std::size_t i = 0; i < verdict.changes.size(); ++i)
        dim_text(fmt::format("{} {}", i + 1, verdict.changes[i]));
    for (const auto& change : verdict.kept_out)
        coloured_text(palette::Warning, fmt::format("Kept out: {}", change));
    if (verdict.warns) coloured_text(palette::Warning, verdict.text);
    if (button(context, {.name = fmt::format("{}.apply", prefix),
                         .text = verdict.warns ? "Apply anyway" : "Apply",
                         .tooltip = "Keep it as an entry of the edit stack",
                         .look = verdict.warns ? Look::Normal : Look::Primary}))
        context.emit(command::ApplyResult{});
    flow(button_width("Discard"));
    if (button(context, {.name = fmt::format("{}.discard", prefix),
                         .text = "Discard",
                         .tooltip = "Leave the scene as it was"}))
        context.emit(command::DiscardResult{});
    end_notice();
}

}  // namespace gse::ui
