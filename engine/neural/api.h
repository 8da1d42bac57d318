// The networks as a plug-in: the program loads libgse_neural.so (and with it torch) only when an edit begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/edit/interfaces.h"
#include "engine/edit/text_image_score.h"
#include "engine/neural/attention_parameters.h"
#include "engine/neural/dreambooth_parameters.h"
#include "engine/neural/sds_parameters.h"
#include "engine/neural/starter_trainer.h"

namespace gse::neural {

/// How a sample is drawn from the model.
struct SampleRequest {
    std::string prompt;
    std::string negative_prompt;
    int steps = 30;
    double guidance_scale = 5;
    double strength = 1.0;      // img2img only: share of the steps that are run
    std::uint64_t seed = 0;
};

/// A loaded text-to-image model (tokenizer, text encoder, UNet, VAE, scheduler).
class TextToImage {
public:
    virtual ~TextToImage() = default;
    virtual std::unique_ptr<edit::AttentionSource> attention(const AttentionParameters& parameters) = 0;
    std::unique_ptr<edit::AttentionSource> attention() { return attention(AttentionParameters{}); }
    virtual std::unique_ptr<edit::Guidance> guidance(const std::string& prompt, const SdsParameters& parameters) = 0;
    /// Words the model was trained on; empty = an open vocabulary.
    virtual std::vector<std::string> known_words() const = 0;
    /// Side of the square images the model works at.
    virtual int image_size() const = 0;
    virtual std::string name() const = 0;
    virtual Image sample(const SampleRequest& request) = 0;
    virtual Image img2img(const Image& image, const SampleRequest& request) = 0;
    /// The bundle's text-image encoder; null when it has none.
    virtual std::unique_ptr<edit::TextImageScore> text_image_score() { return nullptr; }

    /// DreamBooth: learns what the pictures show under `instance_prompt`, while pictures of `class_prompt`, drawn from the
    /// untouched model first, keep what it knows. Always begins at the loaded weights. What attention(), guidance(),
    /// sample() and img2img() give from then on is of the tuned weights; objects they gave before keep theirs. Throws Error
    /// (Cancelled) on a stop request; then, as after any Error, the model is as it was before the call.
    virtual TuneReport tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                            const std::string& instance_prompt, const std::string& class_prompt,
                            const JobControl& job) = 0;
    /// Back to the loaded weights.
    virtual void untune() = 0;
    virtual bool tuned() const = 0;
    /// Number of the tuning in use, another one for each; 0 = the loaded weights.
    virtual std::uint64_t tuning() const = 0;
    /// The tuning as a file (kohya's names). Throws Error (InvalidArgument) unless the model is tuned with a rank.
    virtual void save_lora(const std::filesystem::path& path) const = 0;
    /// Tunes the loaded weights by a file. Throws Error (NotFound, Malformed, Model).
    virtual void load_lora(const std::filesystem::path& path, double strength) = 0;
    void load_lora(const std::filesystem::path& path) { load_lora(path, 1.0); }
};

/// Everything the program asks of engine/neural.
class Api {
public:
    virtual ~Api() = default;
    /// Loads a diffusers folder or a single-file checkpoint. Throws Error (Model, NotFound).
    virtual std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const std::string& device) = 0;
    virtual void train_starter(const StarterTrainParameters& parameters, const StarterSource& source,
                               const std::filesystem::path& work, const std::filesystem::path& output,
                               const JobControl& job) = 0;
    /// Threads inside one network operation; 0 = one per core.
    virtual void set_threads(int count) = 0;
};

}  // namespace gse::neural

/// The plug-in's one symbol; the object lives as long as the process.
extern "C" gse::neural::Api* gse_neural_api();
