// The networks as a plug-in: the program loads libgse_neural.so (and with it torch) only when an edit begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/edit/interfaces.h"
#include "engine/edit/text_image_score.h"
#include "engine/neural/attention_parameters.h"
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
