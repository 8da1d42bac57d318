// The networks as a plug-in: the program loads libgse_neural.so (and with it torch) only when an edit begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/answer_cache.h"
#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/edit/interfaces/image_text_encoder.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/neural/api/attention_parameters.h"
#include "engine/neural/api/bundle_kind.h"
#include "engine/neural/api/dreambooth_parameters.h"
#include "engine/neural/api/lora_spec.h"
#include "engine/neural/api/network_use.h"
#include "engine/neural/api/sds_parameters.h"

namespace gse::neural {

/// Settings of one sample.
struct SampleRequest {
    std::string prompt;
    std::string negative_prompt;
    int steps = 30;
    double guidance_scale = 5;
    double strength = 1.0;              // img2img only: share of the steps that are run
    double image_guidance_scale = 1.5;  // of models that edit pictures
    std::uint64_t seed = 0;
};

struct TunedModel;

/// A loaded text-to-image model (tokenizer, text encoder, UNet, VAE, scheduler). It never changes, so that
/// threads and jobs may share it.
class TextToImage {
public:
    virtual ~TextToImage() = default;
    virtual std::unique_ptr<edit::AttentionSource> attention(const AttentionParameters& parameters) const = 0;
    std::unique_ptr<edit::AttentionSource> attention() const { return attention(AttentionParameters{}); }
    virtual std::unique_ptr<edit::Guidance> guidance(const std::string& prompt,
                                                     const SdsParameters& parameters) const = 0;
    /// Redraws views of a scene under the prompt; scale, negative prompt, view words and what is taken off
    /// are as `parameters` say.
    virtual std::unique_ptr<edit::MultiViewEditor> views(const std::string& prompt,
                                                         const SdsParameters& parameters) const = 0;
    /// Tells whether views() shows the model the clean plate where it draws anew. Such a model knows where in
    /// a scene a new object goes.
    virtual bool supports_scene_conditioning() const { return false; }
    /// Tells whether views() changes the look of objects by a network that is shown them
    /// (edit::MultiViewEditor::supports_appearance_editing()).
    virtual bool supports_appearance_editing() const { return false; }
    /// Words the model was trained on; empty = an open vocabulary.
    virtual std::vector<std::string> known_words() const = 0;
    /// Words that only its views() are told besides: what they stand for can be drawn, but not looked for.
    virtual std::vector<std::string> generated_vocabulary() const { return {}; }
    /// Side of the square images the model works at.
    virtual int image_size() const = 0;
    virtual std::string name() const = 0;
    /// Kind of the model, which decides how views are redrawn.
    virtual BundleKind kind() const = 0;
    /// Sentences about parts of its files that are not used, and about what was taken for granted.
    virtual std::vector<std::string> notes() const { return {}; }
    virtual Image sample(const SampleRequest& request) const = 0;
    virtual Image img2img(const Image& image, const SampleRequest& request) const = 0;
    /// The bundle's text-image encoder; null when it has none.
    virtual std::unique_ptr<edit::ImageTextEncoder> image_text_encoder() const { return nullptr; }

    /// Tunes a model of its own by DreamBooth (Ruiz et al. 2023). It learns what the pictures show under
    /// `instance_prompt`; pictures of `class_prompt` keep what it knows. The tuning begins at the loaded
    /// weights, also where this model is a tuned one. Pictures of the class come from `cache` and go there;
    /// it is of the loaded weights and may be null. Throws Error (Cancelled) on a stop request.
    virtual TunedModel tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                            const std::string& instance_prompt, const std::string& class_prompt,
                            const JobControl& job, AnswerCache* cache) const = 0;
    TunedModel tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                    const std::string& instance_prompt, const std::string& class_prompt,
                    const JobControl& job) const;
    /// The tuning as a file that load_tuning() gives back bit by bit: low-rank factors, or all weights. False
    /// where there is none, or it would be larger. Throws Error (Unwritable).
    virtual bool save_tuning(const std::filesystem::path& path, std::uint64_t most_bytes) const = 0;
    /// The model that save_tuning() was asked of, from one with the same loaded weights. Throws Error.
    virtual std::shared_ptr<TextToImage> load_tuning(const std::filesystem::path& path) const = 0;
    /// The tuning as a file (kohya's names). Throws Error (InvalidArgument) unless this is a model tuned with
    /// a rank.
    virtual void save_lora(const std::filesystem::path& path) const = 0;
    /// A model of its own: the loaded weights, tuned by a file. Throws Error (NotFound, Malformed, Model).
    virtual std::shared_ptr<TextToImage> load_lora(const std::filesystem::path& path,
                                                   double strength) const = 0;
    std::shared_ptr<TextToImage> load_lora(const std::filesystem::path& path) const {
        return load_lora(path, 1.0);
    }
};

/// Result of tune().
struct TunedModel {
    std::shared_ptr<TextToImage> model;
    TuneReport report;
};

inline TunedModel TextToImage::tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                                    const std::string& instance_prompt, const std::string& class_prompt,
                                    const JobControl& job) const {
    return tune(parameters, instance, instance_prompt, class_prompt, job, nullptr);
}

/// Options of loading a model.
struct ModelOptions {
    std::string device = "cpu";
    /// Merged into the weights, in order; one that was distilled (lora_mark()) only into those that redraw
    /// views and sample. At strength 0 it is read and checked, and no more.
    std::vector<LoraSpec> loras = {};
    /// Folder of the tiny autoencoder; empty = as the model says, or "taesd" beside its weights; "none" =
    /// none.
    std::string taesd = {};
    /// fp32, bf16, or auto: bf16 for the UNet where it was measured to be faster (precision.h).
    std::string precision = "auto";
};

/// Everything the program asks of engine/neural.
class Api {
public:
    virtual ~Api() = default;
    /// Loads a diffusers folder or a single-file checkpoint. Throws Error (Model, NotFound); what is wrong
    /// with a LoRA is said before any weight is read.
    virtual std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path,
                                                    const ModelOptions& options) = 0;
    /// Cuts masks out of pictures: SAM or MobileSAM, from a file or a folder. May be used from several
    /// threads. Throws Error (NotFound, Malformed, Unsupported, Model).
    virtual std::unique_ptr<edit::Segmenter> load_segmenter(const std::filesystem::path& path,
                                                            const std::string& device) = 0;
    /// Loads CLIPSeg from a folder; it finds nouns in pictures. Threads and errors are as for
    /// load_segmenter().
    virtual std::unique_ptr<edit::TextSegmenter> load_text_segmenter(const std::filesystem::path& folder,
                                                                     const std::string& device) = 0;
    /// Threads inside one network operation; 0 = one per core.
    virtual void set_threads(int count) = 0;
    /// Counts what the calling thread has asked of the networks since it began.
    virtual NetworkUse use() const = 0;
};

}  // namespace gse::neural

/// The plug-in's one symbol; the object lives as long as the process.
extern "C" gse::neural::Api* gse_neural_api();
