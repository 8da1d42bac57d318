// Score distillation as the edit's guidance (DreamFusion, Poole et al. 2022). A share of the pull on the
// unedited picture is taken off (Delta Denoising Score, Hertz et al. 2023, eq. 3).
#pragma once

#include <map>
#include <memory>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/neural/api/sds_parameters.h"
#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/layers/buffer_cache.h"

namespace gse::neural {

/// Noise level of one iteration: uniform over the steps between t_min and the annealed t_max.
std::int64_t draw_timestep(const SdsParameters& parameters, double progress, std::int64_t steps,
                           Random& random);

class SdsGuidance final : public edit::Guidance {
public:
    SdsGuidance(std::shared_ptr<const ModelBundle> bundle, std::string prompt, SdsParameters parameters);
    edit::GuidanceOutput evaluate(const edit::GuidanceInput& input) override;

private:
    /// False without a sentence before the edit, or with the same one: the difference would be the pull
    /// itself. A model that sees the unedited view takes it into account by itself.
    bool takes_difference() const {
        return parameters_.delta > 0 && !parameters_.before_prompt.empty() &&
               parameters_.before_prompt != prompt_ && !takes_picture(bundle_->unet->config());
    }
    const torch::Tensor& context_for(const std::string& prompt, const std::string& view_words);
    /// Latents of the unedited view, posterior mean.
    const torch::Tensor& original_latents(const edit::GuidanceInput& input);
    /// Latent gradient of the unedited view with the same noise, under the sentence before the edit.
    torch::Tensor pull_on_original(const edit::GuidanceInput& input, const torch::Tensor& deviation,
                                   SdsStep step);

    BufferHolder buffers_;  // goes last
    std::shared_ptr<const ModelBundle> bundle_;
    std::string prompt_;
    SdsParameters parameters_;
    std::map<std::string, torch::Tensor> contexts_;   // [2,T,D] negative, positive; one per sentence
    std::map<std::size_t, torch::Tensor> originals_;  // latent means of the unedited views
};

}  // namespace gse::neural
