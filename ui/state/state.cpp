// Forgetting of the window's state that belongs to one scene, in one place.
#include "ui/state/state.h"

#include <utility>

namespace gse::ui {

void forget_scene(UiState& state) {
    auto& viewport = state.viewport;
    viewport.tool = Tool::Orbit;
    viewport.operation = SetOperation::Add;
    viewport.stroke = viewport.flipped = viewport.wipe_dragged = false;
    viewport.path.clear();
    viewport.selected_view = -1;
    const bool points = state.attention.points;
    state.attention = {};
    state.attention.points = points;
    const int steps = state.labels.steps;
    state.labels = {};
    state.labels.steps = steps;
    const auto choices = state.pick.choices;
    state.pick = {};
    state.pick.choices = choices;
    state.by_hand = {};
    state.targets = {};
    state.history = {};
    state.question = {};  // a question about the last scene
}

}  // namespace gse::ui
