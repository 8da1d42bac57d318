// Score distillation as the edit's guidance (GSEditPro eq. 3; DreamFusion, Poole et al. 2022).
#pragma once

#include <map>
#include <memory>

#include "engine/edit/interfaces.h"
#include "engine/neural/pipelines.h"
#include "engine/neural/sds_parameters.h"

namespace gse::neural {

/// Noise level of one iteration: uniform over the steps between t_min and the annealed t_max.
std::int64_t draw_timestep(const SdsParameters& parameters, double progress, std::int64_t steps,
                           Random& random);

class SdsGuidance final : public edit::Guidance {
public:
    SdsGuidance(std::shared_ptr<const ModelBundle> bundle, std::string prompt, SdsParameters parameters);
    edit::GuidanceOutput evaluate(const edit::GuidanceInput& input) override;

private:
    const torch::Tensor& context_for(const std::string& prompt);

    std::shared_ptr<const ModelBundle> bundle_;
    std::string prompt_;
    SdsParameters parameters_;
    std::map<std::string, torch::Tensor> contexts_;  // [2,T,D] negative, positive; one per view word
};

}  // namespace gse::neural
