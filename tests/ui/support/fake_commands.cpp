// Commands as the fake application takes them: a line of text each, and the changes that later frames need.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "engine/scene/viewpoints.h"
#include "tests/ui/support/fake_application.h"

namespace gse::test {
namespace {

namespace command = ui::command;

/// "set_label_threshold" of the type SetLabelThreshold.
template <class C> std::string name_of() {
    std::string_view text = __PRETTY_FUNCTION__;  // "... [with C = gse::ui::command::Name; ...]"
    text.remove_prefix(text.find("command::") + 9);
    std::string name;
    for (const char letter : text.substr(0, text.find_first_of(";]"))) {
        const bool capital = letter >= 'A' && letter <= 'Z';
        if (capital && !name.empty()) name += '_';
        name += capital ? static_cast<char>(letter - 'A' + 'a') : letter;
    }
    return name;
}

const char* end_of(bool drag_ends) { return drag_ends ? " end" : ""; }

template <class... F> struct Overloaded : F... { using F::operator()...; };
template <class... F> Overloaded(F...) -> Overloaded<F...>;

/// The fields of a command that tests look at, behind its name; nothing of those that are not listed.
template <class C> std::string fields_of(const C& wanted) {
    const auto text = [](const auto& value) { return fmt::format(" {}", value); };
    const auto two = [](const auto& a, const auto& b) { return fmt::format(" {} {}", a, b); };
    const Overloaded of_files_and_edits{
        [](const auto&) { return std::string(); },
        [&](const command::Open& one) { return text(one.path.string()); },
        [&](const command::SaveProject& one) { return text(one.path.string()); },
        [&](const command::LeaveEdit& one) { return text(one.keep ? "keep" : "discard"); },
        [&](const command::Recover& one) { return text(one.project); },
        [&](const command::DiscardRecovery& one) { return text(one.project); },
        [&](const command::PostponeRecovery& one) { return text(one.project); },
        [&](const command::SetUpAxis& one) { return text(one.up); },
        [&](const command::Edit& one) {
            return one.left_out.empty() ? std::string()
                                        : fmt::format(" without {}", fmt::join(one.left_out, "; "));
        },
        [&](const command::Pause& one) { return text(one.paused ? "on" : "off"); },
        [&](const command::OrderTarget& one) {
            constexpr std::array<const char*, 3> names{"accept", "drop", "redo"};
            return two(one.order.round, one.order.view) +
                   text(names[static_cast<std::size_t>(one.order.choice)]);
        },
        [&](const command::ShowResult& one) { return text(one.index); },
        [&](const command::ShowSnapshot& one) { return text(one.index); },
        [&](const command::TakeSnapshot& one) { return text(one.iteration); },
        [&](const command::BranchFromSnapshot& one) { return text(one.iteration); },
        [&](const command::SetAttentionThreshold& one) {
            return fmt::format(" {:.3f}{}", one.value, end_of(one.drag_ends));
        },
        [&](const command::LeaveOutView& one) { return two(one.view, one.out ? "out" : "back"); },
        [&](const command::Locate& one) { return std::string(one.by_server ? " by server" : ""); },
        [&](const command::SetScope& one) { return text(one.by_label ? "label" : "search"); },
        [&](const command::RepeatEdit& one) { return text(one.id); }};
    const Overloaded of_labels{
        of_files_and_edits,
        [&](const command::SetLabelThreshold& one) {
            return fmt::format(" {:.3f}{}", one.value, end_of(one.drag_ends));
        },
        [&](const command::SetActiveLabel& one) { return text(one.index); },
        [&](const command::AddLabel& one) { return text(one.name); },
        [&](const command::RenameLabel& one) { return two(one.index, one.name); },
        [&](const command::DeleteLabel& one) { return text(one.index); },
        [&](const command::Select& one) {
            return two(one.region.polygon.size(), one.region.circles.size()) +
                   text(static_cast<int>(one.operation)) + end_of(one.stroke_ends);
        },
        [&](const command::CutOut& one) { return text(one.box.polygon.size()); },
        [&](const command::ExchangeVariation& one) { return two(one.id, one.index); },
        [&](const command::GrowLabel& one) { return text(one.steps); },
        [&](const command::AdjustColours& one) { return text(adjustment_text(one.adjustment)); },
        [&](const command::HealStroke& one) { return text(one.region.circles.size()); },
        [&](const command::PutIn& one) { return text(one.path.string()); },
        [&](const command::UsePlacing& one) { return text(one.on ? "on" : "off"); },
        [&](const command::PlaceThing& one) {
            return fmt::format(" {:.2f} {:.2f} {:.2f} turn {:.0f} size {:.2f}{}", one.settings.move_right,
                               one.settings.move_up, one.settings.move_forward, one.settings.turn,
                               one.settings.resize, end_of(one.drag_ends));
        },
        [&](const command::PickRows& one) {
            return text(localize::choice_text(one.choice)) + (one.choice.within_label ? " within" : "");
        },
        [&](const command::UsePicked& one) { return text(static_cast<int>(one.use)); },
        [&](const command::GoTo& one) { return text(one.position); },
        [&](const command::SetEditEnabled& one) { return two(one.id, one.enabled ? "on" : "off"); },
        [&](const command::SetEditStrength& one) {
            return two(one.id, std::to_string(one.strength)) + end_of(one.drag_ends);
        },
        [&](const command::DeleteEdit& one) { return text(one.id); },
        [&](const command::MoveEdit& one) { return two(one.id, one.places); }};
    const Overloaded of_the_rest{
        of_labels,
        [&](const command::SetComparison& one) { return text(static_cast<int>(one.comparison)); },
        [&](const command::CompareWith& one) { return text(one.position); },
        [&](const command::LookThrough& one) { return text(one.view); },
        [&](const command::DeleteView& one) { return text(one.view); },
        [&](const command::RenameView& one) { return two(one.view, one.name); },
        [&](const command::DrawView& one) { return text(one.view); },
        [&](const command::PickColour& one) { return two(one.x, one.y); },
        [&](const command::SetViewportSize& one) { return two(one.width, one.height); },
        [&](const command::OpenModel& one) { return text(one.path.string()); },
        [&](const command::ChooseModel& one) { return text(one.path); },
        [&](const command::AddLora& one) { return text(one.text); },
        [&](const command::SetLoraStrength& one) { return two(one.index, std::to_string(one.strength)); },
        [&](const command::RemoveLora& one) { return text(one.index); },
        [&](const command::ChooseSegmenter& one) {
            return two(one.role == ui::SegmenterRole::Clicks ? "clicks" : "words", one.path);
        },
        [&](const command::SetServer& one) {
            const auto& choice = one.choice;
            return two(choice.url, choice.model) + two(choice.family, choice.agreement) +
                   fmt::format(" {} {} {} {}", choice.side, choice.steps, choice.guidance, choice.strength) +
                   fmt::format(" [{}] [{}] [{}]", fmt::join(choice.lora, ", "),
                               fmt::join(choice.option, ", "), fmt::join(choice.target_picture, ", ")) +
                   two(choice.workflow, choice.ca) + (choice.paid_nodes ? " paid" : "");
        },
        [&](const command::KeepServerPassword& one) { return two(one.name, one.password.size()); },
        [&](const command::UseServer& one) { return text(one.on ? "on" : "off"); },
        [&](const command::SetCacheMb& one) { return text(one.most); },
        [&](const command::DeleteCameraKey& one) { return text(one.index); },
        [&](const command::ExportCameraPath& one) { return std::string(one.as_film ? " film" : ""); },
        [&](const command::Answer& one) { return text(one.index); },
        [&](const command::DismissToast& one) { return text(one.index); },
        [&](const command::PressToast& one) { return text(one.index); },
        [&](const command::SetUiScale& one) { return fmt::format(" {:.2f}", one.scale); },
        [&](const command::SetKeymap& one) { return text(one.text); }};
    return of_the_rest(wanted);
}

}  // namespace

void FakeApplication::run(const ui::Command& command) {
    std::visit(
        [this](const auto& group) {
            std::visit(
                [this](const auto& one) {
                    calls.push_back(name_of<std::decay_t<decltype(one)>>() + fields_of(one));
                    take(one);
                },
                group);
        },
        command);
}

void FakeApplication::take(const command::SaveProject& one) {
    if (one.then) one.then();
}

void FakeApplication::take(const command::LeaveEdit& one) {
    model_.edit_running = model_.job.running = model_.result_waiting = false;
    if (one.then) one.then();
}

void FakeApplication::take(const command::LeaveOutView& one) {
    model_.attention[one.view].failed = one.out;
    model_.attention[one.view].step = one.out ? edit::ViewStep::LeftOut : edit::ViewStep::Found;
}

void FakeApplication::take(const command::SetAttentionThreshold& one) {
    model_.attention_threshold = one.value;
}

void FakeApplication::take(const command::SetLabelThreshold& one) {
    auto state = document_->state();
    auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    label.threshold = one.value;
    label = with_bits(label);
    document_->apply("Threshold", state, "threshold");
}

void FakeApplication::take(const command::DeleteLabel& one) {
    auto state = document_->state();
    state.labels.erase(state.labels.begin() + one.index);
    state.active_label = state.labels.empty() ? -1 : 0;
    document_->apply("Delete label", state);
}

void FakeApplication::take(const command::Select& one) {
    regions.push_back(one.region);
    operations.push_back(one.operation);
}

void FakeApplication::take(const command::AdjustColours& one) {
    model_.adjusting = !(one.adjustment == ColourAdjustment{});
}

void FakeApplication::take(const command::UsePlacing& one) {
    model_.placed.reset();
    if (one.on) model_.placed = ui::PlacedThing{{}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}, 1, 0.7};
}

void FakeApplication::take(const command::PlaceThing& one) {
    model_.placing = !(one.settings == edit::RearrangeSettings{});
}

void FakeApplication::take(const command::PickRows& one) {
    const auto& choice = one.choice;
    const auto values =
        localize::row_values(document_->state().current, choice.property, choice.colour, nullptr);
    const auto rows = localize::chosen_rows(choice, values, {});
    model_.picked = {true, false, static_cast<std::size_t>(std::count(rows.begin(), rows.end(), 1)),
                     std::make_shared<const std::vector<float>>(values)};
}

void FakeApplication::take(const command::DropPicked&) { model_.picked = {}; }

void FakeApplication::take(const command::PickColour& one) {
    const auto& picture = viewport_picture_;
    model_.seen_colour.number += 1;
    if (picture == nullptr || one.x >= picture->width || one.y >= picture->height) return;
    for (int c = 0; c < 3; ++c)
        model_.seen_colour.colour[static_cast<std::size_t>(c)] = picture->at(one.x, one.y, c);
}

void FakeApplication::take(const command::DrawView& one) {
    model_.view_pictures.resize(document_->state().views.size());
    if (one.view >= model_.view_pictures.size() || model_.attention.empty()) return;
    model_.view_pictures[one.view] = model_.attention[one.view % model_.attention.size()].render;
}

void FakeApplication::take(const command::AddView&) {
    auto state = document_->state();
    state.views.push_back({fmt::format("view {}", state.views.size() + 1), model_.camera, false});
    document_->apply("Add view", state);
}

void FakeApplication::take(const command::SetCamera& one) { model_.camera = one.camera; }

void FakeApplication::take(const command::SetViewSettings& one) { model_.view = one.settings; }

void FakeApplication::take(const command::SetViewportSize& one) {
    model_.viewport_width = one.width;
    model_.viewport_height = one.height;
}

void FakeApplication::take(const command::SetComparison& one) { model_.comparison = one.comparison; }

void FakeApplication::take(const command::LookThrough& one) {
    const int width = std::max(model_.viewport_width, 1), height = std::max(model_.viewport_height, 1);
    // As the application does.
    model_.camera = fitted(document_->state().views[one.view].camera, width, height);
}

void FakeApplication::take(const command::SetRequest& one) { model_.request = one.request; }

void FakeApplication::take(const command::SetModelSettings& one) { model_.model_settings = one.settings; }

void FakeApplication::take(const command::SetExports& one) { model_.exports = one.settings; }

void FakeApplication::take(const command::SetUiScale& one) { model_.ui_scale = one.scale; }

void FakeApplication::take(const command::SetKeymap& one) { model_.keymap = one.text; }

}  // namespace gse::test
