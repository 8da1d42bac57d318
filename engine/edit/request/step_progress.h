// Steps of a plan while they are made: what was made, or left out, changes how the later ones are told.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/edit/request/sentence_plan.h"

namespace gse::edit {

class StepProgress {
public:
    StepProgress() = default;
    /// `scene` has the words before the first step.
    StepProgress(std::vector<PlannedStep> steps, language::plan::SceneWords scene,
                 language::plan::ModelAbility model);

    std::size_t size() const { return steps_.size(); }
    /// A step in the words of the scene as it is by now. Without words it cannot be done.
    const PlannedStep& step(std::size_t i) const { return steps_[i]; }
    /// Takes a step for made.
    void take(std::size_t i);
    /// Takes a step for not made: later steps are described anew.
    void leave_out(std::size_t i);

private:
    std::vector<PlannedStep> steps_;
    language::plan::SceneWords scene_;  // by now
    language::plan::ModelAbility model_;
};

}  // namespace gse::edit
