// Labels, splats chosen by a property, the edit stack and its undo steps: every change is one named step.
#include "app/session/label_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/session/state/located_label.h"
#include "app/session/state/screen_area.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/edit/search/thing_parts.h"
#include "engine/language/grammar.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/run/views.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/pipeline/select/cut_out.h"
#include "engine/pipeline/select/point_out.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/stack_edits.h"
#include "engine/scene/strength.h"
#include "ui/widgets/controls.h"

namespace gse::app {
namespace {

namespace command = ui::command;

// Splats: of more, a label is decided when its threshold is let go.
constexpr std::size_t MostDecidedWhileDragging = 200000;

LabelOperation operation_of(ui::SetOperation operation) {
    switch (operation) {
        case ui::SetOperation::Add: return LabelOperation::Add;
        case ui::SetOperation::Remove: return LabelOperation::Remove;
        case ui::SetOperation::Intersect: return LabelOperation::Intersect;
        case ui::SetOperation::Replace: return LabelOperation::Replace;
    }
    return LabelOperation::Add;
}

/// With rows that were picked in a view: where they begin the label, it was made from there.
NamedLabel marked(NamedLabel label, const std::vector<std::uint8_t>& rows, ui::SetOperation operation,
                  const Camera& camera, const Vec3& up) {
    if (operation == ui::SetOperation::Replace || count_labelled(label) == 0)
        label.looked_from = fmt::format("{:.0f}", looked_from(camera, up));
    return combine(std::move(label), rows, operation_of(operation));
}

}  // namespace

// Labels

void LabelController::change_label(const std::string& name,
                                   const std::function<NamedLabel(NamedLabel)>& change,
                                   const std::string& merge_key, const std::string& new_name) {
    if (!workspace_.require_scene()) return;
    if (workspace_.jobs->works() && !edits_.runs())
        return workspace_.notices.toast("The label can be changed when the job is done.");
    DocumentState next = state();
    if (next.active_label < 0 || next.active_label >= static_cast<int>(next.labels.size())) {
        next.labels.push_back(empty_label(free_label_name(next.labels, new_name), next.current.size()));
        next.active_label = static_cast<int>(next.labels.size()) - 1;
    }
    auto& label = next.labels[static_cast<std::size_t>(next.active_label)];
    label = change(std::move(label));
    if (edits_.runs()) edits_.correct_label(*label.bits);
    workspace_.document.apply(name, std::move(next), merge_key);
    search_.choose_label_by_hand();
}

/// The new label is the active one.
void LabelController::add_label(NamedLabel label, const std::string& step) {
    DocumentState next = state();
    next.labels.push_back(std::move(label));
    next.active_label = static_cast<int>(next.labels.size()) - 1;
    workspace_.document.apply(step, std::move(next));
    search_.choose_label_by_hand();
}

template <> void LabelController::on(const command::SetLabelThreshold& one) {
    change_label(
        fmt::format("Threshold {:.2f}", one.value),
        [&](NamedLabel label) {
            const double threshold = std::stod(fmt::format("{:.4f}", one.value));
            if (label.attention_threshold >= 0) search_.sentence().settings().label_threshold = threshold;
            const auto& set = state().current;
            return one.drag_ends || set.size() <= MostDecidedWhileDragging
                       ? at_threshold(std::move(label), set, threshold)
                       : with_threshold(std::move(label), static_cast<float>(threshold));
        },
        fmt::format("threshold{}", workspace_.stroke));
    if (one.drag_ends) ++workspace_.stroke;
}

template <> void LabelController::on(const command::SetActiveLabel& one) {
    if (!workspace_.require_scene()) return;
    DocumentState next = state();
    if (one.index < -1 || one.index >= static_cast<int>(next.labels.size()) || one.index == next.active_label)
        return;
    next.active_label = one.index;
    workspace_.document.apply("Choose label", std::move(next), "choose-label");
    search_.choose_label_by_hand();
}

template <> void LabelController::on(const command::AddLabel& one) {
    if (!workspace_.require_scene()) return;
    const auto name = one.name.empty() ? fmt::format("label {}", state().labels.size() + 1) : one.name;
    add_label(empty_label(name, state().current.size()), "New label");
}

template <> void LabelController::on(const command::RenameLabel& one) {
    if (!workspace_.require_scene()) return;
    DocumentState next = state();
    if (one.index < 0 || one.index >= static_cast<int>(next.labels.size()) || one.name.empty()) return;
    auto& called = next.labels[static_cast<std::size_t>(one.index)].name;
    search_.rename_label(called, one.name);
    called = one.name;
    workspace_.document.apply("Rename label", std::move(next), fmt::format("rename{}", one.index));
}

template <> void LabelController::on(const command::DeleteLabel& one) {
    if (!workspace_.require_scene()) return;
    DocumentState next = state();
    if (one.index < 0 || one.index >= static_cast<int>(next.labels.size())) return;
    const std::string name = next.labels[static_cast<std::size_t>(one.index)].name;
    next.labels.erase(next.labels.begin() + one.index);
    if (next.active_label >= one.index) --next.active_label;
    if (next.active_label < 0 && !next.labels.empty()) next.active_label = 0;
    workspace_.document.apply(fmt::format("Delete label \"{}\"", name), std::move(next));
    workspace_.toast_step(fmt::format("The label \"{}\" is deleted; its splats stay.", name));
}

template <> void LabelController::on(const command::Select& one) {
    if (!workspace_.require_scene()) return;
    PickOptions options;
    const auto depth = view_.depth();  // stays alive for the call
    if (view_.settings().front_only && depth) options.depth = depth.get();
    const Camera camera = view_.shown_camera();
    const auto rows = rows_in_area(view_.seen_document(), camera, screen_area(one.region), options);
    const bool any = std::find(rows.begin(), rows.end(), std::uint8_t{1}) != rows.end();
    const char* names[] = {"Add to label", "Remove from label", "Intersect label", "Select"};
    if (any || one.operation == ui::SetOperation::Replace || one.operation == ui::SetOperation::Intersect)
        change_label(
            names[static_cast<int>(one.operation)],
            [&](NamedLabel label) {
                return marked(std::move(label), rows, one.operation, camera, state().info.up);
            },
            fmt::format("stroke{}", workspace_.stroke));
    if (one.stroke_ends) ++workspace_.stroke;
}

namespace {

/// Rows of the thing under a click or in a box, and a sentence about them.
struct CutOutRows {
    std::vector<std::uint8_t> rows;
    std::string said;
};

CutOutRows clicked(const GaussianSet& set, const CutOutRequest& request, const JobControl& control) {
    const auto& at = request.area.polygon.front();
    const pipeline::ClickRequest click{request.camera,
                                       static_cast<double>(at[0]),
                                       static_cast<double>(at[1]),
                                       request.settings,
                                       request.up,
                                       request.ground,
                                       request.nature,
                                       request.part};
    auto thing = pipeline::thing_at(set, click, control);
    const bool any = std::find(thing.rows.begin(), thing.rows.end(), std::uint8_t{1}) != thing.rows.end();
    if (!any) return {{}, "There is nothing under the click."};
    const auto doubt = pipeline::part_doubt(thing, click);
    if (!doubt.empty()) return {std::move(thing.rows), fmt::format("Check the label: {}.", doubt)};
    const auto parted = pipeline::parted_text(thing);
    return {std::move(thing.rows),
            parted.empty() ? "The thing is labelled. For a part of it alone, drag a box around that."
                           : fmt::format("The thing is labelled, {}.", parted)};
}

CutOutRows boxed(const GaussianSet& set, const CutOutRequest& request, edit::Segmenter* segmenter,
                 const JobControl& control) {
    auto thing = pipeline::cut_out(set, request, segmenter, control);
    auto said = pipeline::cut_text(thing);
    if (!said.empty()) said = fmt::format("Check the label: {}.", said);
    return {std::move(thing.rows), std::move(said)};
}

}  // namespace

template <> void LabelController::on(const command::CutOut& one) {
    if (!workspace_.require_scene()) return;
    if (workspace_.jobs->occupied())
        return workspace_.notices.toast("Things can be cut out when the job is done.");
    const auto recipe = search_.recipe();
    CutOutRequest request{view_.shown_camera(),
                          screen_area(one.box),
                          {},
                          state().info.up,
                          language::names_ground(recipe.request.source),
                          edit::nature_of(recipe.request.source),
                          edit::is_about_part(recipe.request)};
    request.settings.background = parse_colour(view_.settings().background);
    request.settings.antialiased = state().info.antialiased;
    auto found = std::make_shared<CutOutRows>();
    auto job = recipe.job;
    job.text_segmenter.clear();  // no word is looked for
    workspace_.jobs->start_work(
        JobKind::CutOut,
        {"Cut out",
         [=, set = view_.seen_document(), cache = models_.cache()](const JobControl& control) {
             if (request.area.polygon.size() == 1) {
                 control.report("labelling the thing under the click", 0, 0);
                 *found = clicked(set, request, control);
                 return;
             }
             control.report("cutting out what is in the box", 0, 0);
             *found = boxed(set, request, open_segmenters(job, cache).clicks.get(), control);
         },
         [this, found, operation = one.operation, camera = request.camera,
          up = request.up](const Error* error) {
             if (error != nullptr) return workspace_.report_end(*error);
             take_cut_out(found->rows, operation, camera, up);
             if (!found->said.empty()) workspace_.toast_step(found->said);
         }});
}

void LabelController::take_cut_out(const std::vector<std::uint8_t>& rows, ui::SetOperation operation,
                                   const Camera& camera, const Vec3& up) {
    if (rows.size() != state().current.size()) return;  // another scene meanwhile
    change_label(
        "Cut out", [&](NamedLabel label) { return marked(std::move(label), rows, operation, camera, up); },
        {}, "cut out");
}

template <> void LabelController::on(const command::GrowLabel& one) {
    change_label(one.steps > 0 ? "Grow label" : "Shrink label",
                 [&](NamedLabel label) { return grow(std::move(label), state().current, one.steps); });
}

template <> void LabelController::on(const command::InvertLabel&) {
    change_label("Invert label", [](NamedLabel label) { return invert(std::move(label)); });
}

template <> void LabelController::on(const command::ClearLabel&) {
    const auto before = workspace_.document.revision();
    change_label("Clear label", [](NamedLabel label) { return clear(std::move(label)); });
    if (workspace_.document.revision() != before) workspace_.toast_step("The label is cleared.");
}

// Splats chosen by a property

void LabelController::drop_picked() {
    picking_.reset();
    picked_ = {};
    ++workspace_.content;
}

void LabelController::take_document() {
    drop_picked();
    adjusted_.reset();
    hidden_seen_ = view_.hidden().number();
}

void LabelController::dress(Stage& stage) const {
    stage.picking = picking_.has_value();
    if (picking_) stage.picked = picking_->rows();
}

template <> void LabelController::on(const command::PickRows& one) {
    if (!workspace_.require_scene()) return;
    if (!picking_) picking_.emplace();
    picking_->choose(one.choice);
}

template <> void LabelController::on(const command::DropPicked&) { drop_picked(); }

void LabelController::measure_picked() {
    auto values = std::make_shared<std::vector<float>>();
    const auto choice = picking_->wanted();
    workspace_.jobs->counter.start(
        {"Measure",
         [=, set = state().current](const JobControl&) {
             *values = localize::row_values(set, choice.property, choice.colour, nullptr);
         },
         [=, this, set = state().current](const Error*) {  // where it is busy, once more with the next frame
             if (picking_ && values->size() == set.size()) picking_->take(set, choice, values);
         }});
}

/// The rows that are meant now; every frame, for what they are chosen from changes under them.
void LabelController::refresh() {
    if (adjusted_ && adjusted_->revision != workspace_.document.revision()) adjusted_.reset();
    const bool hidden_changed =
        std::exchange(hidden_seen_, view_.hidden().number()) != view_.hidden().number();
    if (!picking_) return;
    if (hidden_changed) picking_->forget_rows();
    picked_.shown = true;
    picked_.working = picking_->wants_values(state().current);
    if (picked_.working) return measure_picked();
    const NamedLabel* label = workspace_.active_label();
    const auto hidden = view_.hidden().any() ? view_.hidden().of_document() : std::vector<std::uint8_t>();
    if (!picking_->update(label != nullptr ? label->bits : nullptr, hidden)) return;
    const auto& rows = *picking_->rows();
    picked_.values = picking_->values();
    picked_.count = static_cast<std::size_t>(std::count(rows.begin(), rows.end(), std::uint8_t{1}));
    ++workspace_.content;
}

template <> void LabelController::on(const command::UsePicked& one) {
    const auto rows = picking_ ? picking_->rows() : nullptr;
    if (!rows || rows->size() != state().current.size()) return;
    if (one.use == ui::PickedUse::Delete) return delete_rows(*rows);
    const std::string name = localize::choice_text(picking_->chosen());
    if (one.use == ui::PickedUse::NewLabel)
        return add_label(combine(empty_label(name, rows->size()), *rows, LabelOperation::Add),
                         fmt::format("Label: {}", name));
    const bool removes = one.use == ui::PickedUse::Remove;
    change_label(
        fmt::format("{}: {}", removes ? "Remove from label" : "Add to label", name), [&](NamedLabel label) {
            return combine(std::move(label), *rows, removes ? LabelOperation::Remove : LabelOperation::Add);
        });
}

// Undo

template <> void LabelController::on(const command::Undo&) {
    if (workspace_.document.can_undo()) search_.travel([this] { workspace_.document.undo(); });
}

template <> void LabelController::on(const command::Redo&) {
    if (workspace_.document.can_redo()) search_.travel([this] { workspace_.document.redo(); });
}

template <> void LabelController::on(const command::GoTo& one) {
    if (!workspace_.document.empty()) search_.travel([&] { workspace_.document.go_to(one.position); });
}

// The edit stack

/// False, and said, while the stack cannot be changed.
bool LabelController::stack_is_free() {
    if (!workspace_.require_scene()) return false;
    if (!workspace_.results && !workspace_.jobs->works()) return true;
    workspace_.notices.toast(workspace_.results ? "Apply or discard the edit first."
                                                : "The edit stack can be changed when the job is done.");
    return false;
}

void LabelController::change_stack(const std::string& name,
                                   const std::function<void(std::vector<EditNode>&)>& change,
                                   const std::string& merge_key) {
    if (!stack_is_free()) return;
    auto stack = state().stack;
    change(stack);
    workspace_.document.apply(name, with_stack(state(), std::move(stack)), merge_key);
}

void LabelController::delete_rows(const std::vector<std::uint8_t>& rows) {
    const EditNode node = removal_of(state(), rows, workspace_.next_edit_id++);
    if (node.delta->removed.empty()) return workspace_.notices.toast("There is nothing to delete.");
    if (node.delta->removed.size() == rows.size())
        return workspace_.notices.toast("That is every splat; an empty scene cannot be kept.");
    const auto before = workspace_.document.revision();
    change_stack(node.name, [&](std::vector<EditNode>& stack) { stack.push_back(node); });
    if (workspace_.document.revision() != before)
        workspace_.toast_step(
            fmt::format("{} splats are deleted.", ui::count_text(node.delta->removed.size())));
}

template <> void LabelController::on(const command::DeleteLabelledSplats&) {
    const NamedLabel* label = workspace_.require_scene() ? workspace_.active_label() : nullptr;
    if (label != nullptr && label->bits) delete_rows(*label->bits);
}

template <> void LabelController::on(const command::AdjustColours& one) {
    if (!workspace_.require_scene() || workspace_.jobs->works() || workspace_.results) return;
    if (one.adjustment == ColourAdjustment{}) return adjusted_ ? on(command::Undo{}) : void();
    if (!adjusted_) adjusted_ = AdjustedColours{state(), 0, workspace_.next_edit_id++};
    const NamedLabel* label = workspace_.active_label();
    const bool some = label != nullptr && count_labelled(*label) > 0;
    auto next = with_adjustment(adjusted_->before,
                                some ? *label->bits : std::vector<std::uint8_t>(state().current.size(), 1),
                                one.adjustment, adjusted_->id);
    const std::string name = next.stack.back().name;
    workspace_.document.apply(name, std::move(next), fmt::format("colours{}", adjusted_->id));
    adjusted_->revision = workspace_.document.revision();
}

template <> void LabelController::on(const command::SetEditEnabled& one) {
    change_stack(one.enabled ? "Switch edit on" : "Switch edit off", [&](std::vector<EditNode>& stack) {
        for (auto& node : stack)
            if (node.id == one.id) node.enabled = one.enabled;
    });
    const auto built = one.enabled ? std::vector<std::string>() : edits_built_on(state().stack, one.id);
    if (built.empty()) return;
    std::string names;
    for (const auto& name : built) names += (names.empty() ? "\"" : "\", \"") + name;
    workspace_.notices.toast(fmt::format(
        "Built on what is switched off now: {}\". Some of that is not seen until it is on again.", names));
}

template <> void LabelController::on(const command::SetEditStrength& one) {
    if (!std::isfinite(one.strength)) return;
    change_stack(
        fmt::format("Strength {:.2f}", one.strength),
        [&](std::vector<EditNode>& stack) {
            for (auto& node : stack)
                if (node.id == one.id) node.strength = std::clamp(one.strength, 0.0, MostStrength);
        },
        fmt::format("strength{}.{}", one.id, workspace_.stroke));
    if (one.drag_ends) ++workspace_.stroke;
}

template <> void LabelController::on(const command::ExchangeVariation& one) {
    const EditVariations* kept = workspace_.variations.of(one.id);
    if (kept == nullptr || one.index >= kept->nodes.size() || !stack_is_free()) return;
    if (kept->applied(state().stack) == one.index) return;
    const EditNode& node = kept->nodes[one.index];
    workspace_.document.apply(
        fmt::format("Variation {} of {}: {}", one.index + 1, kept->nodes.size(), node.name),
        with_variation(state(), node));
}

template <> void LabelController::on(const command::DeleteEdit& one) {
    change_stack("Delete edit", [&](std::vector<EditNode>& stack) {
        std::erase_if(stack, [&](const EditNode& node) { return node.id == one.id; });
    });
}

template <> void LabelController::on(const command::MoveEdit& one) {
    change_stack("Move edit", [&](std::vector<EditNode>& stack) {
        const auto found =
            std::find_if(stack.begin(), stack.end(), [&](const EditNode& node) { return node.id == one.id; });
        if (found == stack.end()) return;
        const auto from = found - stack.begin();
        const auto to =
            std::clamp<std::ptrdiff_t>(from + one.places, 0, static_cast<std::ptrdiff_t>(stack.size()) - 1);
        EditNode node = std::move(*found);
        stack.erase(found);
        stack.insert(stack.begin() + to, std::move(node));
    });
}

void LabelController::show(ui::LabelPart& model) const {
    model.picked = picked_;
    model.adjusting = adjusted_.has_value();
    model.labelled = workspace_.labelled;
}

void LabelController::run(const ui::LabelCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
