// Attention of words in an image: cross-attention averaged over layers, heads, noise levels and repeats.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "engine/base/memory_cache.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/neural/api/attention_parameters.h"
#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/layers/buffer_cache.h"

namespace gse::neural {

/// Sums captured maps at latent resolution, so that memory does not grow with the number of passes.
class AttentionAccumulator {
public:
    AttentionAccumulator(std::int64_t size, std::int64_t columns);
    /// Adds the mean over batch and heads of every map, bicubic to size x size, negative overshoot cut;
    /// clears `maps`.
    void take(std::vector<AttentionCapture::Map>& maps);
    /// Adds the mean over the batch of every affinity of the largest size there is; clears them.
    void take_affinities(std::vector<AttentionCapture::Map>& affinities);
    /// Mean over everything taken, [k,size,size].
    torch::Tensor mean() const;
    /// Mean spread `times` along the mean self-attention, S^times A at its size (DiffSegmenter; METHOD.md,
    /// Attention maps). The mean itself without self-attention.
    torch::Tensor refined(int times) const;
    std::int64_t count() const { return count_; }

private:
    torch::Tensor sum_;
    std::int64_t count_ = 0;
    torch::Tensor affinity_;  // sum, [s*s,s*s]
    std::int64_t affinities_ = 0, affinity_height_ = 0;
};

/// The maps of the query's words from a loaded model.
class BundleAttentionSource final : public edit::AttentionSource {
public:
    BundleAttentionSource(std::shared_ptr<const ModelBundle> bundle, AttentionParameters parameters);
    std::vector<Image> locate(const edit::AttentionQuery& query) override;
    void prepare(std::span<const edit::AttentionQuery> queries) override;
    std::size_t at_once() const override;
    double threshold() const override { return bundle_->facts.attention_threshold; }
    int image_size() const override { return static_cast<int>(bundle_->image_size()); }

private:
    std::vector<Image> maps_of(const edit::AttentionQuery& query);
    /// Latents of a picture, cached for other questions about it.
    torch::Tensor latents_of(const Image& picture);
    AttentionCapture make_capture() const;
    torch::Tensor checked(const AttentionAccumulator& sum) const;
    void probe(const edit::AttentionQuery& query, const torch::Tensor& latents, const torch::Tensor& context,
               AttentionCapture& capture, AttentionAccumulator& sum) const;
    void run_img2img(const edit::AttentionQuery& query, const torch::Tensor& latents,
                     const torch::Tensor& context, AttentionCapture& capture, AttentionAccumulator& sum);
    /// [1,T,D], encoded once per sentence.
    torch::Tensor context_of(const std::string& sentence);

    BufferHolder buffers_;  // goes last
    std::shared_ptr<const ModelBundle> bundle_;
    AttentionParameters parameters_;
    std::vector<double> levels_;  // of the parameters
    std::mutex mutex_;            // of the contexts
    std::map<std::string, torch::Tensor> contexts_;
    MemoryCache<torch::Tensor> latents_{MostLatents};
    std::unordered_map<ContentKey, std::vector<Image>> prepared_;  // by the question; until it is asked
};

/// "a bear" and "front view" to "a bear, front view".
std::string with_view_words(const std::string& prompt, const std::string& view_words);

}  // namespace gse::neural
