// A loaded model behind the torch-free interface.
#include "engine/neural/model.h"

#include <algorithm>
#include <thread>

#include "engine/base/error.h"
#include "engine/neural/attention_source.h"
#include "engine/neural/clip_score.h"
#include "engine/neural/dreambooth.h"
#include "engine/neural/images.h"
#include "engine/neural/sds_guidance.h"
#include "engine/neural/torch_errors.h"

namespace gse::neural {
namespace {

class Model final : public TextToImage {
public:
    explicit Model(ModelBundle bundle)
        : loaded_(std::make_shared<const ModelBundle>(std::move(bundle))), bundle_(loaded_) {}

    using TextToImage::attention;
    std::unique_ptr<edit::AttentionSource> attention(const AttentionParameters& parameters) override {
        return std::make_unique<BundleAttentionSource>(bundle_, parameters);
    }
    std::unique_ptr<edit::Guidance> guidance(const std::string& prompt,
                                             const SdsParameters& parameters) override {
        return std::make_unique<SdsGuidance>(bundle_, prompt, parameters);
    }
    std::vector<std::string> known_words() const override { return bundle_->facts.vocabulary; }
    int image_size() const override { return static_cast<int>(bundle_->image_size()); }
    std::string name() const override { return bundle_->facts.name; }

    std::unique_ptr<edit::TextImageScore> text_image_score() override {
        const auto folder = loaded_->path / "clip";
        if (!has_clip(folder)) return nullptr;
        return load_clip_score(
            {folder, loaded_->path / "tokenizer", loaded_->facts.vocabulary, loaded_->device});
    }

    Image sample(const SampleRequest& request) override { return run(nullptr, request); }
    Image img2img(const Image& image, const SampleRequest& request) override { return run(&image, request); }

    TuneReport tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                    const std::string& instance_prompt, const std::string& class_prompt,
                    const JobControl& job) override {
        auto result = guard_torch("tuning the model", [&] {
            return run_dreambooth(*loaded_, parameters, {instance, instance_prompt, class_prompt}, job);
        });
        bundle_ = std::move(result.bundle);
        lora_ = std::move(result.lora);
        ++tunings_;
        return std::move(result.report);
    }
    void untune() override {
        bundle_ = loaded_;
        lora_.reset();
    }
    std::uint64_t tuning() const override { return tuned() ? tunings_ : 0; }
    bool tuned() const override { return bundle_ != loaded_; }
    void save_lora(const std::filesystem::path& path) const override {
        if (!lora_)
            throw Error(ErrorCode::InvalidArgument, "the model was not tuned as a LoRA", "tune it with a rank above 0", path);
        write_lora(path, *lora_);
    }
    using TextToImage::load_lora;
    void load_lora(const std::filesystem::path& path, double strength) override {
        auto weights = read_lora(path);
        bundle_ = guard_torch("merging a LoRA", [&] {
            return std::make_shared<const ModelBundle>(with_lora(*loaded_, weights, strength));
        });
        lora_ = std::move(weights);
        ++tunings_;
    }

private:
    Image run(const Image* image, const SampleRequest& request) const {
        return guard_torch("sampling", [&] {
            const torch::NoGradGuard no_grad;
            const auto side = bundle_->latent_size();
            const auto sampler = make_sampler(SamplerKind::Ddim, bundle_->schedule, request.steps);
            auto latents = seeded_noise({1, bundle_->unet->config().in_channels, side, side}, request.seed)
                               .to(bundle_->device);
            DenoiseJob job;
            job.sampler = sampler.get();
            job.guidance_scale = request.guidance_scale;
            job.context = bundle_->encode_prompts({request.negative_prompt, request.prompt});
            job.seed = request.seed;
            if (image != nullptr) {
                job.first =
                    std::min(first_step(sampler->step_count(), request.strength), sampler->step_count() - 1);
                const auto source = resize_square(to_tensor(*image, bundle_->device), bundle_->image_size());
                latents = sampler->start_from(image_to_latents(*bundle_, source), latents, job.first);
            }
            return to_image(latents_to_image(*bundle_, denoise(*bundle_, latents, job)));
        });
    }

    std::shared_ptr<const ModelBundle> loaded_, bundle_;  // as read; in use (the same unless tuned)
    std::optional<LoraWeights> lora_;                     // the change between them, when it is low-rank
    std::uint64_t tunings_ = 0;
};

}  // namespace

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void set_threads(int count) {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    torch::set_num_threads(count > 0 ? count : cores);
}

std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const std::string& device) {
    return std::make_unique<Model>(load_bundle(path, parse_device(device)));
}

}  // namespace gse::neural
