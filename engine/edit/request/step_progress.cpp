// Steps of a plan while they are made: what was made, or left out, changes how the later ones are told.
#include "engine/edit/request/step_progress.h"

#include <algorithm>
#include <utility>

namespace gse::edit {

StepProgress::StepProgress(std::vector<PlannedStep> steps, language::plan::SceneWords scene,
                           language::plan::ModelAbility model)
    : steps_(std::move(steps)), scene_(std::move(scene)), model_(std::move(model)) {}

void StepProgress::take(std::size_t i) { scene_ = language::plan::after(step(i).step, std::move(scene_)); }

void StepProgress::leave_out(std::size_t i) {
    language::plan::Plan rest;
    for (std::size_t later = i + 1; later < size(); ++later) rest.steps.push_back(step(later).step);
    auto described = planned_steps(rest, scene_, model_);
    std::move(described.begin(), described.end(), steps_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
}

}  // namespace gse::edit
