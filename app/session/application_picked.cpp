// Splats chosen by a property: measured beside the frames, shown at once, labelled or deleted when the artist
// says so.
#include <fmt/format.h>

#include <algorithm>

#include "app/session/application.h"
#include "engine/scene/label_ops.h"

namespace gse::app {

void Application::pick_rows(const localize::RowChoice& choice) {
    if (!require_scene()) return;
    if (!picking_) picking_.emplace();
    picking_->choose(choice);
}

void Application::drop_picked() {
    picking_.reset();
    model_.picked = {};
    ++content_;
}

/// The rows that are meant now; every frame, for what they are chosen from changes under them.
void Application::refresh_picked() {
    if (!picking_) return;
    const auto& set = document_.state().current;
    auto& picked = model_.picked;
    picked.shown = true;
    picked.working = picking_->wants_values(set);
    if (picked.working) {
        auto values = std::make_shared<std::vector<float>>();
        const auto choice = picking_->wanted();
        counter_.start({"Measure",
                        [=](const JobControl&) {
                            *values = localize::row_values(set, choice.property, choice.colour, nullptr);
                        },
                        [=, this](const Error*) {  // where it is busy, once more with the next frame
                            if (picking_ && values->size() == set.size()) picking_->take(set, choice, values);
                        }});
        return;
    }
    const NamedLabel* label = active_label();
    const auto hidden =
        hidden_.empty() ? std::vector<std::uint8_t>() : hidden_.rows(*document_.state().row_ids);
    if (!picking_->update(label != nullptr ? label->bits : nullptr, hidden)) return;
    const auto& rows = *picking_->rows();
    picked.values = picking_->values();
    picked.count = static_cast<std::size_t>(std::count(rows.begin(), rows.end(), std::uint8_t{1}));
    ++content_;
}

void Application::use_picked(ui::PickedUse use) {
    const auto rows = picking_ ? picking_->rows() : nullptr;
    if (!rows || rows->size() != document_.state().current.size()) return;
    if (use == ui::PickedUse::Delete) return delete_rows(*rows);
    const std::string name = localize::choice_text(picking_->chosen());
    if (use != ui::PickedUse::NewLabel) {
        const bool removes = use == ui::PickedUse::Remove;
        return change_label(fmt::format("{}: {}", removes ? "Remove from label" : "Add to label", name),
                            [&](NamedLabel label) {
                                return combine(std::move(label), *rows,
                                               removes ? LabelOperation::Remove : LabelOperation::Add);
                            });
    }
    DocumentState state = document_.state();
    state.labels.push_back(combine(empty_label(name, rows->size()), *rows, LabelOperation::Add));
    state.active_label = static_cast<int>(state.labels.size()) - 1;
    document_.apply(fmt::format("Label: {}", name), std::move(state));
    choose_label_by_hand();
}

}  // namespace gse::app
