// Multi-view editing by a diffusion model: a noised render goes to the prompt in a few DDIM steps (Song et
// al. 2021, eq. 12). Its noise lies on the scene's surface.
#pragma once

#include <map>
#include <memory>

#include "engine/base/memory_cache.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/neural/api/sds_parameters.h"
#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/layers/buffer_cache.h"

namespace gse::neural {

/// Timesteps of an img2img run of `steps` steps from `strength` of a schedule of `total` steps: strength (S -
/// i) / S, i = 0..S-1. Rounded to the schedule, descending, none twice.
std::vector<std::int64_t> redraw_timesteps(double strength, int steps, std::int64_t total);

/// Timesteps of a run for a kind of model; distilled ones know some levels only. LCM and TCD take levels of
/// their table up to the strength. Turbo models take trailing levels, at least the quarters they were trained
/// on. Never empty; at most `steps`.
std::vector<std::int64_t> redraw_levels(BundleKind kind, const NoiseSchedule& schedule, double strength,
                                        int steps);

class DiffusionViewEditor final : public edit::MultiViewEditor {
public:
    /// `shapes`: the same model with what it learned for drawing new things; null = it has learned nothing of
    /// that kind. `supports_appearance_editing`: that draws known things in another look, too.
    DiffusionViewEditor(std::shared_ptr<const ModelBundle> bundle, std::string prompt,
                        SdsParameters parameters, std::shared_ptr<const ModelBundle> shapes = nullptr,
                        bool supports_appearance_editing = false);
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override;
    bool supports_appearance_editing() const override { return restyles_; }

private:
    struct Batch;
    /// Tells whether the network for new objects draws this round.
    bool shown_scene(const edit::EditViewsRequest& input) const {
        return shapes_ != nullptr && (input.anew || restyles_);
    }
    /// Tells whether new objects in pictures of this size get more detail than the model's size holds.
    bool upscales(Codec codec, const Image& picture) const {
        return codec == Codec::Full && !bundle_->upscaler.is_empty() && picture.width == picture.height &&
               picture.height > bundle_->image_size();
    }
    edit::EditedViews redraw(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                             const JobControl& job);
    Batch prepare(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input);
    void denoise(Batch& batch, const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                 const JobControl& job) const;
    edit::EditedViews finish(const Batch& batch, const std::vector<edit::EditView>& views,
                             const edit::EditViewsRequest& input) const;
    torch::Tensor contexts(const std::vector<edit::EditView>& views, const std::string& prompt, bool exact);
    /// Noise [K,C,h,w] on the scene's surface.
    torch::Tensor noise(const std::vector<edit::EditView>& views, std::uint64_t seed) const;
    /// Guided output of the UNet for latents [K,C,h,w], in pieces that fit into memory.
    torch::Tensor output(const UNet& unet, const torch::Tensor& x, std::int64_t timestep,
                         const Conditioning& conditioning) const;
    /// Guided output of the network for new objects; in each of `groups` the views see each other. `outline`,
    /// where not null, receives outlines.
    torch::Tensor output_together(const torch::Tensor& x, std::int64_t timestep,
                                  const Conditioning& conditioning,
                                  const std::vector<std::vector<std::int64_t>>& groups,
                                  torch::Tensor* outline) const;

    BufferHolder buffers_;  // goes last
    std::shared_ptr<const ModelBundle> bundle_, shapes_;
    std::string prompt_;
    SdsParameters parameters_;
    const bool restyles_;
    const bool apart_;  // views are shared out among threads, not operations
    std::map<std::pair<bool, std::string>, torch::Tensor> encoded_;  // [1,T,D], one per sentence and network
    MemoryCache<torch::Tensor> originals_{MostLatents};  // of the unedited views: the same in every round
};

}  // namespace gse::neural
