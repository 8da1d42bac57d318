// Labels, edit stack, undo: every change is one named step of the document.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/application.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/run/views.h"
#include "engine/pipeline/select/cut_out.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/stack_edits.h"
#include "engine/scene/strength.h"
#include "ui/widgets/controls.h"

namespace gse::app {
namespace {

ScreenArea screen_area(const ui::ScreenRegion& region) {
    return {region.polygon, region.circles, region.radius_px};
}

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

bool Application::require_scene() {
    if (!document_.empty()) return true;
    toast("Open a scene first.");
    return false;
}

void Application::change_label(const std::string& name, const std::function<NamedLabel(NamedLabel)>& change,
                               const std::string& merge_key) {
    if (!require_scene()) return;
    if (work_.running() && !edit_running()) {
        toast("The label can be changed when the job is done.");
        return;
    }
    DocumentState state = document_.state();
    if (state.active_label < 0 || state.active_label >= static_cast<int>(state.labels.size())) {
        state.labels.push_back(empty_label("selection", state.current.size()));
        state.active_label = static_cast<int>(state.labels.size()) - 1;
    }
    auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    label = change(std::move(label));
    if (edit_running()) {  // the loop takes it over before its next step
        const std::lock_guard lock(live_->mutex);
        if (live_->adds) toast(AddsElsewhere);
        else live_->label = *label.bits;
    }
    document_.apply(name, std::move(state), merge_key);
    choose_label_by_hand();
}

void Application::set_label_threshold(float value, bool drag_ends) {
    change_label(
        fmt::format("Threshold {:.2f}", value),
        [&](NamedLabel label) {
            if (label.attention_threshold >= 0)
                model_.request.tau =
                    std::stod(fmt::format("{:.4f}", value));  // a repeated search gives this label
            return with_threshold(std::move(label), value);
        },
        fmt::format("threshold{}", stroke_));
    if (drag_ends) ++stroke_;
}

void Application::set_active_label(int index) {
    if (!require_scene()) return;
    DocumentState state = document_.state();
    if (index < -1 || index >= static_cast<int>(state.labels.size()) || index == state.active_label) return;
    state.active_label = index;
    document_.apply("Choose label", std::move(state), "choose-label");
    choose_label_by_hand();
}

void Application::add_label(const std::string& name) {
    if (!require_scene()) return;
    DocumentState state = document_.state();
    state.labels.push_back(empty_label(name.empty() ? fmt::format("label {}", state.labels.size() + 1) : name,
                                       state.current.size()));
    state.active_label = static_cast<int>(state.labels.size()) - 1;
    document_.apply("New label", std::move(state));
    choose_label_by_hand();
}

void Application::rename_label(int index, const std::string& name) {
    if (!require_scene()) return;
    DocumentState state = document_.state();
    if (index < 0 || index >= static_cast<int>(state.labels.size()) || name.empty()) return;
    auto& called = state.labels[static_cast<std::size_t>(index)].name;
    if (reach_choice_ && reach_choice_->label == called) reach_choice_->label = name;
    called = name;
    document_.apply("Rename label", std::move(state), fmt::format("rename{}", index));
}

void Application::delete_label(int index) {
    if (!require_scene()) return;
    DocumentState state = document_.state();
    if (index < 0 || index >= static_cast<int>(state.labels.size())) return;
    const std::string name = state.labels[static_cast<std::size_t>(index)].name;
    state.labels.erase(state.labels.begin() + index);
    if (state.active_label >= index) --state.active_label;
    if (state.active_label < 0 && !state.labels.empty()) state.active_label = 0;
    document_.apply(fmt::format("Delete label \"{}\"", name), std::move(state));
    toast_step(fmt::format("The label \"{}\" is deleted; its splats stay.", name));
}

void Application::select(const ui::ScreenRegion& region, ui::SetOperation operation, bool stroke_ends) {
    if (!require_scene()) return;
    PickOptions options;
    const auto depth = model_.viewport_depth;  // stays alive for the call
    if (model_.view.front_only && depth) options.depth = depth.get();
    const auto rows =
        rows_in_area(seen(document_.state().current), model_.camera, screen_area(region), options);
    const auto count = std::count(rows.begin(), rows.end(), std::uint8_t{1});
    const char* names[] = {"Add to label", "Remove from label", "Intersect label", "Select"};
    if (count > 0 || operation == ui::SetOperation::Replace || operation == ui::SetOperation::Intersect)
        change_label(
            names[static_cast<int>(operation)],
            [&](NamedLabel label) {
                return marked(std::move(label), rows, operation, model_.camera, document_.state().info.up);
            },
            fmt::format("stroke{}", stroke_));
    if (stroke_ends) ++stroke_;
}

void Application::cut_out(const ui::ScreenRegion& box, ui::SetOperation operation) {
    if (!require_scene()) return;
    if (work_.running()) return toast("Things can be cut out when the job is done.");
    CutOutRequest request{model_.camera,
                          screen_area(box),
                          {},
                          document_.state().info.up,
                          edit::names_ground(current_recipe().request.source)};
    request.settings.background = parse_colour(model_.view.background);
    request.settings.antialiased = document_.state().info.antialiased;
    auto rows = std::make_shared<std::vector<std::uint8_t>>();
    auto job = current_recipe().job;
    job.text_segmenter.clear();  // no word is looked for
    work_.start({"Cut out",
                 [=, set = seen(document_.state().current), cache = cache_](const JobControl& control) {
                     control.report("cutting out what is in the box", 0, 0);
                     *rows =
                         pipeline::cut_out(set, request, open_segmenters(job, cache).clicks.get(), control);
                 },
                 [this, rows, operation, camera = request.camera, up = request.up](const Error* error) {
                     if (error != nullptr)
                         return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
                     if (rows->size() != document_.state().current.size()) return;  // another scene meanwhile
                     change_label("Cut out", [&](NamedLabel label) {
                         return marked(std::move(label), *rows, operation, camera, up);
                     });
                 }});
}

void Application::grow_label(int steps) {
    change_label(steps > 0 ? "Grow label" : "Shrink label",
                 [&](NamedLabel label) { return grow(std::move(label), document_.state().current, steps); });
}

void Application::invert_label() {
    change_label("Invert label", [](NamedLabel label) { return invert(std::move(label)); });
}

void Application::clear_label() {
    const auto before = document_.revision();
    change_label("Clear label", [](NamedLabel label) { return clear(std::move(label)); });
    if (document_.revision() != before) toast_step("The label is cleared.");
}

void Application::change_stack(const std::string& name,
                               const std::function<void(std::vector<EditNode>&)>& change,
                               const std::string& merge_key) {
    if (!require_scene()) return;
    if (work_.running() || pending_) {
        toast(pending_ ? "Apply or discard the edit first."
                       : "The edit stack can be changed when the job is done.");
        return;
    }
    auto stack = document_.state().stack;
    change(stack);
    document_.apply(name, with_stack(document_.state(), std::move(stack)), merge_key);
}

void Application::delete_rows(const std::vector<std::uint8_t>& rows) {
    const EditNode node = removal_of(document_.state(), rows, next_edit_id_++);
    if (node.delta->removed.empty()) return toast("There is nothing to delete.");
    if (node.delta->removed.size() == rows.size())
        return toast("That is every splat; an empty scene cannot be kept.");
    const auto before = document_.revision();
    change_stack(node.name, [&](std::vector<EditNode>& stack) { stack.push_back(node); });
    if (document_.revision() != before)
        toast_step(fmt::format("{} splats are deleted.", ui::count_text(node.delta->removed.size())));
}

void Application::delete_labelled_splats() {
    const NamedLabel* label = require_scene() ? active_label() : nullptr;
    if (label != nullptr && label->bits) delete_rows(*label->bits);
}

void Application::adjust_colours(const ColourAdjustment& adjustment) {
    if (!require_scene() || work_.running() || pending_) return;
    if (adjustment == ColourAdjustment{}) return adjusted_ ? undo() : void();
    if (!adjusted_) adjusted_ = AdjustedColours{document_.state(), 0, next_edit_id_++};
    const NamedLabel* label = active_label();
    const bool some = label != nullptr && count_labelled(*label) > 0;
    auto state =
        with_adjustment(adjusted_->before,
                        some ? *label->bits : std::vector<std::uint8_t>(document_.state().current.size(), 1),
                        adjustment, adjusted_->id);
    const std::string name = state.stack.back().name;
    document_.apply(name, std::move(state), fmt::format("colours{}", adjusted_->id));
    adjusted_->revision = document_.revision();
}

void Application::undo() {
    if (document_.can_undo()) travel([&] { document_.undo(); });
}

void Application::redo() {
    if (document_.can_redo()) travel([&] { document_.redo(); });
}

void Application::go_to(std::size_t position) {
    if (!document_.empty()) travel([&] { document_.go_to(position); });
}

void Application::set_edit_enabled(std::uint64_t id, bool enabled) {
    change_stack(enabled ? "Switch edit on" : "Switch edit off", [&](std::vector<EditNode>& stack) {
        for (auto& node : stack)
            if (node.id == id) node.enabled = enabled;
    });
}

void Application::set_edit_strength(std::uint64_t id, double strength, bool drag_ends) {
    if (!std::isfinite(strength)) return;
    change_stack(
        fmt::format("Strength {:.2f}", strength),
        [&](std::vector<EditNode>& stack) {
            for (auto& node : stack)
                if (node.id == id) node.strength = std::clamp(strength, 0.0, MostStrength);
        },
        fmt::format("strength{}.{}", id, stroke_));
    if (drag_ends) ++stroke_;
}

void Application::delete_edit(std::uint64_t id) {
    change_stack("Delete edit", [&](std::vector<EditNode>& stack) {
        std::erase_if(stack, [&](const EditNode& node) { return node.id == id; });
    });
}

void Application::move_edit(std::uint64_t id, int places) {
    change_stack("Move edit", [&](std::vector<EditNode>& stack) {
        const auto found =
            std::find_if(stack.begin(), stack.end(), [&](const EditNode& node) { return node.id == id; });
        if (found == stack.end()) return;
        const auto from = found - stack.begin();
        const auto to =
            std::clamp<std::ptrdiff_t>(from + places, 0, static_cast<std::ptrdiff_t>(stack.size()) - 1);
        EditNode node = std::move(*found);
        stack.erase(found);
        stack.insert(stack.begin() + to, std::move(node));
    });
}

void Application::repeat_edit(std::uint64_t id) {
    if (document_.empty()) return;
    for (const auto& node : document_.state().stack) {
        if (node.id != id || node.recipe.empty()) continue;
        const auto json = try_parse_json<nlohmann::ordered_json>(node.recipe);
        if (!json.is_object() || !json.contains("request")) return;
        try {
            edit::EditRequest request;
            fields_from_json(request, json["request"]);
            request.seed = Random::stream(request.seed, 77).next() % 1000000;
            set_request(request);
            toast("The settings are in the prompt, with a new seed.");
        } catch (const Error& error) { report_error(error); }
        return;
    }
}

}  // namespace gse::app
