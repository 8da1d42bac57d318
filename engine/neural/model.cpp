// A loaded model behind the torch-free interface.
#include "engine/neural/model.h"

#include <algorithm>
#include <mutex>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/neural/clip/clip_score.h"
#include "engine/neural/diffusion/scene_views.h"
#include "engine/neural/guidance/attention_source.h"
#include "engine/neural/guidance/dreambooth.h"
#include "engine/neural/guidance/multi_view_editor.h"
#include "engine/neural/guidance/sds_guidance.h"
#include "engine/neural/layers/buffer_cache.h"
#include "engine/neural/layers/devices.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/parallel_for_batches.h"
#include "engine/neural/layers/torch_errors.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {
namespace {

/// A LoRA that makes the model another kind.
struct Distilled {
    LoraWeights weights;
    double strength = 1;
    LoraMark mark = LoraMark::None;
};
using DistilledLoras = std::vector<Distilled>;

std::shared_ptr<const ModelBundle> distilled(std::shared_ptr<const ModelBundle> bundle,
                                             const DistilledLoras& loras) {
    for (const auto& lora : loras) {
        auto merged = with_lora(*bundle, lora.weights, lora.strength);
        if (merged.kind == BundleKind::Plain)
            merged.kind = lora.mark == LoraMark::Tcd ? BundleKind::Tcd : BundleKind::Lcm;
        bundle = std::make_shared<const ModelBundle>(std::move(merged));
    }
    return bundle;
}

/// A distilled model's answer at a noise level is not the score: the weights without what was distilled are
/// probed, pull and learn.
class Model final : public TextToImage {
public:
    using Bundle = std::shared_ptr<const ModelBundle>;
    Model(ModelBundle bundle, DistilledLoras fast)
        : loaded_(std::make_shared<const ModelBundle>(std::move(bundle))), slow_(loaded_),
          fast_(std::move(fast)), bundle_(distilled(slow_, fast_)) {}
    Model(Bundle loaded, Bundle tuned, std::optional<LoraWeights> lora, DistilledLoras fast)
        : loaded_(std::move(loaded)), slow_(std::move(tuned)), fast_(std::move(fast)),
          bundle_(distilled(slow_, fast_)), lora_(std::move(lora)) {}

    using TextToImage::attention;
    using TextToImage::tune;
    std::unique_ptr<edit::AttentionSource> attention(const AttentionParameters& parameters) const override {
        return std::make_unique<BundleAttentionSource>(slow_, parameters);
    }
    std::unique_ptr<edit::Guidance> guidance(const std::string& prompt,
                                             const SdsParameters& parameters) const override {
        return std::make_unique<SdsGuidance>(slow_, prompt, parameters);
    }
    std::unique_ptr<edit::MultiViewEditor> views(const std::string& prompt,
                                                 const SdsParameters& parameters) const override {
        return std::make_unique<DiffusionViewEditor>(bundle_, prompt, parameters, with_shapes(),
                                                     parameters.restyle && supports_appearance_editing());
    }
    bool supports_scene_conditioning() const override {
        const auto& facts = loaded_->facts;
        if (!facts.shape_unet.empty()) return shape_unet_shows_scene(loaded_->path / facts.shape_unet);
        return !facts.shape_lora.empty() && !facts.shape_cameras.empty() &&
               shows_scene(SafetensorsFile(loaded_->path / facts.shape_cameras));
    }
    /// A tuned model draws by itself: the network beside it was not tuned.
    bool supports_appearance_editing() const override {
        return bundle_ == loaded_ && loaded_->facts.shape_restyles && !loaded_->facts.shape_unet.empty() &&
               supports_scene_conditioning();
    }
    std::vector<std::string> known_words() const override { return bundle_->facts.vocabulary; }
    std::vector<std::string> generated_vocabulary() const override {
        return supports_appearance_editing() && !loaded_->facts.vocabulary.empty()
                   ? loaded_->facts.drawn_vocabulary
                   : std::vector<std::string>{};
    }
    int image_size() const override { return static_cast<int>(bundle_->image_size()); }
    std::string name() const override { return bundle_->facts.name; }
    BundleKind kind() const override { return bundle_->kind; }
    std::vector<std::string> notes() const override { return bundle_->notes; }

    std::unique_ptr<edit::ImageTextEncoder> image_text_encoder() const override {
        const auto folder = loaded_->path / "clip";
        if (!has_clip(folder)) return nullptr;
        const auto& facts = loaded_->facts;
        const auto viewpoint =
            facts.viewpoint.empty() ? std::filesystem::path() : loaded_->path / facts.viewpoint;
        return load_clip_score(
            {folder, loaded_->path / "tokenizer", facts.vocabulary, loaded_->device, viewpoint});
    }

    Image sample(const SampleRequest& request) const override { return run(nullptr, request); }
    Image img2img(const Image& image, const SampleRequest& request) const override {
        return run(&image, request);
    }

    TunedModel tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                    const std::string& instance_prompt, const std::string& class_prompt,
                    const JobControl& job, AnswerCache* cache) const override {
        auto result = guard_torch("tuning the model", [&] {
            return run_dreambooth(*loaded_, parameters, {instance, instance_prompt, class_prompt, cache},
                                  job);
        });
        return {std::make_shared<Model>(loaded_, std::move(result.bundle), std::move(result.lora), fast_),
                std::move(result.report)};
    }
    void save_lora(const std::filesystem::path& path) const override {
        if (!lora_)
            throw Error(ErrorCode::InvalidArgument, "the model was not tuned as a LoRA",
                        "tune it with a rank above 0", path);
        write_lora(path, *lora_);
    }
    bool save_tuning(const std::filesystem::path& path, std::uint64_t most_bytes) const override {
        if (slow_ == loaded_) return false;
        if (lora_) return write_lora(path, *lora_), std::filesystem::file_size(path) <= most_bytes;
        return guard_torch("saving the tuning", [&] {
            const auto weights = tuned_weights(*slow_);
            std::uint64_t bytes = 0;
            for (const auto& [name, weight] : weights) bytes += weight.nbytes();
            if (bytes > most_bytes) return false;
            write_safetensors(path, weights);
            return true;
        });
    }
    std::shared_ptr<TextToImage> load_tuning(const std::filesystem::path& path) const override {
        const bool whole = guard_torch("reading a tuning",
                                       [&] { return SafetensorsFile(path).contains("unet.conv_in.weight"); });
        if (!whole) return load_lora(path, 1.0);
        auto tuned = guard_torch("reading a tuning", [&] {
            return std::make_shared<const ModelBundle>(with_weights(*loaded_, SafetensorsFile(path)));
        });
        return std::make_shared<Model>(loaded_, std::move(tuned), std::nullopt, fast_);
    }
    using TextToImage::load_lora;
    std::shared_ptr<TextToImage> load_lora(const std::filesystem::path& path,
                                           double strength) const override {
        auto weights = read_lora(path);
        fit_lora(weights, *loaded_->unet, *loaded_->text_encoder);
        auto merged = guard_torch("merging a LoRA", [&] {
            auto bundle = with_lora(*loaded_, weights, strength);
            for (auto& note : weights.notes()) bundle.notes.push_back(std::move(note));
            return std::make_shared<const ModelBundle>(std::move(bundle));
        });
        return std::make_shared<Model>(loaded_, std::move(merged), std::move(weights), fast_);
    }

private:
    /// The weights in use with the network or the LoRA for new things that the model brings along; null where
    /// it brings none.
    Bundle with_shapes() const {
        const auto& facts = loaded_->facts;
        if (facts.shape_unet.empty() && facts.shape_lora.empty()) return nullptr;
        const std::lock_guard lock(shapes_mutex_);
        if (shapes_ == nullptr)
            shapes_ = guard_torch("reading what the model draws new things with", [&] {
                return std::make_shared<const ModelBundle>(facts.shape_unet.empty() ? with_shape_lora()
                                                                                    : with_shape_unet());
            });
        return shapes_;
    }
    ModelBundle with_shape_unet() const {
        auto bundle = *bundle_;
        const auto drawn = generated_vocabulary();
        bundle.facts.vocabulary.insert(bundle.facts.vocabulary.end(), drawn.begin(), drawn.end());
        bundle.unet = load_shape_unet(loaded_->path / loaded_->facts.shape_unet);
        bundle.unet->to(bundle.device);
        return bundle;
    }
    ModelBundle with_shape_lora() const {
        auto merged = with_lora(*bundle_, read_lora(loaded_->path / loaded_->facts.shape_lora), 1);
        if (const auto& cameras = loaded_->facts.shape_cameras; !cameras.empty())
            merged.unet = with_scene_inputs(merged.unet, SafetensorsFile(loaded_->path / cameras));
        return merged;
    }
    Image run(const Image* image, const SampleRequest& request) const {
        return guard_torch("sampling", [&] {
            const torch::NoGradGuard no_grad;
            const auto side = bundle_->latent_size();
            const double strength = image != nullptr ? request.strength : 1;
            const auto walk = image_to_image(sampler_of(bundle_->kind), bundle_->schedule, request.steps,
                                             {.strength = strength});
            auto latents =
                seeded_noise({1, bundle_->latent_channels(), side, side}, request.seed).to(bundle_->device);
            DenoiseJob job;
            job.sampler = walk.sampler.get();
            job.first = walk.first;
            job.guidance_scale = request.guidance_scale;
            job.image_guidance_scale = request.image_guidance_scale;
            job.context = bundle_->encode_prompts({request.negative_prompt, request.prompt});
            job.seed = request.seed;
            if (image != nullptr) {
                const auto source = resize_square(to_tensor(*image, bundle_->device), bundle_->image_size());
                job.picture = picture_latents(*bundle_, source);
                latents = walk.sampler->start_from(image_to_latents(*bundle_, source), latents, job.first);
            } else if (takes_picture(bundle_->unet->config())) {
                job.picture = torch::zeros_like(latents);
            }
            return to_image(latents_to_image(*bundle_, denoise(*bundle_, latents, job)));
        });
    }

    const Bundle loaded_, slow_;  // as read; in use where many steps are taken (the same unless tuned)
    const DistilledLoras fast_;
    const Bundle bundle_;                    // in use where few are: the same with what was distilled
    const std::optional<LoraWeights> lora_;  // the tuning, when it is low-rank
    mutable std::mutex shapes_mutex_;
    mutable Bundle shapes_;  // of with_shapes(), once they were asked for
};

}  // namespace

std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const ModelOptions& options) {
    keep_buffers();
    const auto device = parse_device(options.device);
    std::vector<LoraWeights> weights;
    for (const auto& lora : options.loras) {
        weights.push_back(guard_torch("reading a LoRA", [&] { return read_lora(lora.file); }));
        fit_lora(path, weights.back());
    }
    auto bundle = load_bundle(path, device, options.taesd, options.precision);
    DistilledLoras fast;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto& lora = options.loras[i];
        for (auto& note : weights[i].notes()) bundle.notes.push_back(std::move(note));
        if (lora.strength == 0) continue;  // none, and the model stays what it is
        const auto mark = lora_mark(lora.file);
        if (mark == LoraMark::None) {  // nobody else holds these weights yet
            merge_lora(*bundle.unet, weights[i].unet, lora.strength);
            merge_lora(*bundle.text_encoder, weights[i].text, lora.strength);
            bundle.facts.shape_restyles = false;  // the network beside it has none of that
        } else {
            fast.push_back({std::move(weights[i]), lora.strength, mark});
            log::info("the LoRA \"{}\" was distilled, as its name says: views are redrawn in few steps ({})",
                      lora.file.filename().string(), mark == LoraMark::Tcd ? "tcd" : "lcm");
        }
    }
    // Matrices of a small model are too small for OpenBLAS to share them out. Its second thread would spin on
    // the processor that the viewport needs.
    set_blas_threads(is_small(bundle.unet->config()) ? 1 : torch::get_num_threads());
    return std::make_unique<Model>(std::move(bundle), std::move(fast));
}

}  // namespace gse::neural
