// Model whose answers are cached on the disk; it is loaded only for those that are not.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/disk_cache.h"
#include "engine/neural/api/api.h"
#include "engine/pipeline/models/recipe_model.h"

namespace gse::pipeline {

/// Takes attention maps, views drawn to find a place (EditViewsRequest::keep), text-image vectors and tunings
/// from a cache. The networks give the rest. Answers from the cache are the networks' bit by bit;
/// network_use().cached counts them.
class CachedModel final : public neural::TextToImage, public std::enable_shared_from_this<CachedModel> {
public:
    using Loader = std::function<std::shared_ptr<neural::TextToImage>()>;

    /// `identity`: of the model (model_identity()); `loader` gives it, on the thread that needs it first.
    CachedModel(std::shared_ptr<DiskCache> cache, std::string identity, Loader loader);

    using TextToImage::attention;
    using TextToImage::load_lora;
    using TextToImage::tune;
    std::unique_ptr<edit::AttentionSource> attention(
        const neural::AttentionParameters& parameters) const override;
    std::unique_ptr<edit::Guidance> guidance(const std::string& prompt,
                                             const neural::SdsParameters& parameters) const override;
    std::unique_ptr<edit::MultiViewEditor> views(const std::string& prompt,
                                                 const neural::SdsParameters& parameters) const override;
    bool supports_scene_conditioning() const override { return facts().supports_scene_conditioning; }
    bool supports_appearance_editing() const override { return facts().supports_appearance_editing; }
    std::vector<std::string> known_words() const override { return facts().words; }
    std::vector<std::string> generated_vocabulary() const override { return facts().generated_vocabulary; }
    int image_size() const override { return facts().image_size; }
    std::string name() const override { return facts().name; }
    neural::BundleKind kind() const override { return facts().kind; }
    std::vector<std::string> notes() const override { return facts().notes; }
    Image sample(const neural::SampleRequest& request) const override { return real().sample(request); }
    Image img2img(const Image& image, const neural::SampleRequest& request) const override {
        return real().img2img(image, request);
    }
    std::unique_ptr<edit::ImageTextEncoder> image_text_encoder() const override;
    neural::TunedModel tune(const neural::DreamBoothParameters& parameters, std::span<const Image> instance,
                            const std::string& instance_prompt, const std::string& class_prompt,
                            const JobControl& job, AnswerCache* cache) const override;
    bool save_tuning(const std::filesystem::path& path, std::uint64_t most_bytes) const override;
    std::shared_ptr<TextToImage> load_tuning(const std::filesystem::path& path) const override {
        return real().load_tuning(path);
    }
    void save_lora(const std::filesystem::path& path) const override { real().save_lora(path); }
    std::shared_ptr<TextToImage> load_lora(const std::filesystem::path& path, double strength) const override;

    /// Tells whether it was loaded once: it can say what it is without being loaded.
    bool known() const;
    /// The networks; loads them. Throws Error.
    const TextToImage& real() const;
    std::optional<ModelLoad> load() const;
    DiskCache& cache() const { return *cache_; }
    /// Question to this model, as bytes: its kind, the model, its threads, `text`.
    std::string question(std::string_view kind, std::string_view text) const;

private:
    /// Facts of a model that was loaded once, which need no loading.
    struct Facts {
        std::vector<std::string> words, generated_vocabulary;
        int image_size = 0;
        std::string name;
        neural::BundleKind kind = neural::BundleKind::Plain;
        bool scores = false;  // it has a text-image encoder
        bool supports_scene_conditioning = false, supports_appearance_editing = false;
        double threshold = 0.5;  // of its attention
        int attention_size = 0;
        std::vector<std::string> notes;
    };
    const Facts& facts() const;
    std::optional<Facts> kept_facts() const;
    std::shared_ptr<CachedModel> tuned_model(const std::string& question, Loader loader) const;
    friend class CachedAttentionSource;
    friend class CachedEditor;

    const std::shared_ptr<DiskCache> cache_;
    const std::string identity_;
    std::string loaded_identity_;  // of a tuned model: what it was before, which another tuning begins at
    mutable std::mutex mutex_;
    mutable Loader loader_;  // until it has been called
    mutable std::shared_ptr<TextToImage> real_;
    mutable std::optional<ModelLoad> load_;
    mutable std::optional<Facts> facts_;
};

}  // namespace gse::pipeline
