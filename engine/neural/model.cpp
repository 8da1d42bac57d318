// A loaded model behind the torch-free interface.
#include "engine/neural/model.h"

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <thread>

#include "engine/base/error.h"
#include "engine/neural/attention_source.h"
#include "engine/neural/clip_score.h"
#include "engine/neural/dreambooth.h"
#include "engine/neural/images.h"
#include "engine/neural/sds_guidance.h"
#include "engine/neural/torch_errors.h"
#include "engine/neural/view_guidance.h"

// OpenBLAS has this, other libraries behind torch do not.
extern "C" void openblas_set_num_threads(int count) __attribute__((weak));

namespace gse::neural {
namespace {

/// Channels of the widest level up to which matrices are too small for OpenBLAS to share them out. Its second thread would
/// wait for them in a loop all the same, on the processor that the viewport needs.
constexpr std::int64_t WidestSmallModel = 256;

class Model final : public TextToImage {
public:
    using Bundle = std::shared_ptr<const ModelBundle>;
    explicit Model(ModelBundle bundle) : loaded_(std::make_shared<const ModelBundle>(std::move(bundle))), bundle_(loaded_) {}
    Model(Bundle loaded, Bundle tuned, std::optional<LoraWeights> lora)
        : loaded_(std::move(loaded)), bundle_(std::move(tuned)), lora_(std::move(lora)) {}

    using TextToImage::attention;
    std::unique_ptr<edit::AttentionSource> attention(const AttentionParameters& parameters) const override {
        return std::make_unique<BundleAttentionSource>(bundle_, parameters);
    }
    std::unique_ptr<edit::Guidance> guidance(const std::string& prompt, const SdsParameters& parameters) const override {
        return std::make_unique<SdsGuidance>(bundle_, prompt, parameters);
    }
    std::unique_ptr<edit::ViewGuidance> views(const std::string& prompt, const SdsParameters& parameters) const override {
        return std::make_unique<DiffusionViews>(bundle_, prompt, parameters);
    }
    std::vector<std::string> known_words() const override { return bundle_->facts.vocabulary; }
    int image_size() const override { return static_cast<int>(bundle_->image_size()); }
    std::string name() const override { return bundle_->facts.name; }

    std::unique_ptr<edit::TextImageScore> text_image_score() const override {
        const auto folder = loaded_->path / "clip";
        if (!has_clip(folder)) return nullptr;
        return load_clip_score(
            {folder, loaded_->path / "tokenizer", loaded_->facts.vocabulary, loaded_->device});
    }

    Image sample(const SampleRequest& request) const override { return run(nullptr, request); }
    Image img2img(const Image& image, const SampleRequest& request) const override { return run(&image, request); }

    TunedModel tune(const DreamBoothParameters& parameters, std::span<const Image> instance,
                    const std::string& instance_prompt, const std::string& class_prompt,
                    const JobControl& job) const override {
        auto result = guard_torch("tuning the model", [&] {
            return run_dreambooth(*loaded_, parameters, {instance, instance_prompt, class_prompt}, job);
        });
        return {std::make_shared<Model>(loaded_, std::move(result.bundle), std::move(result.lora)), std::move(result.report)};
    }
    void save_lora(const std::filesystem::path& path) const override {
        if (!lora_)
            throw Error(ErrorCode::InvalidArgument, "the model was not tuned as a LoRA", "tune it with a rank above 0", path);
        write_lora(path, *lora_);
    }
    using TextToImage::load_lora;
    std::shared_ptr<TextToImage> load_lora(const std::filesystem::path& path, double strength) const override {
        auto weights = read_lora(path);
        auto merged = guard_torch("merging a LoRA", [&] {
            return std::make_shared<const ModelBundle>(with_lora(*loaded_, weights, strength));
        });
        return std::make_shared<Model>(loaded_, std::move(merged), std::move(weights));
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

    const Bundle loaded_, bundle_;           // as read; in use (the same unless tuned)
    const std::optional<LoraWeights> lora_;  // the change between them, when it is low-rank
};

}  // namespace

void set_blas_threads(int count) {
    if (openblas_set_num_threads != nullptr) openblas_set_num_threads(count);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::uint64_t refused_bytes(const std::string& text) {
    static const std::regex pattern("ried to allocate ([0-9.]+) ?([KMG]i)?[Bb]");
    std::smatch found;
    if (!std::regex_search(text, found, pattern)) return 0;
    const std::string unit = found[2];
    const double factor = unit == "Ki" ? 1024.0 : unit == "Mi" ? 1048576.0 : unit == "Gi" ? 1073741824.0 : 1.0;
    return static_cast<std::uint64_t>(std::strtod(found[1].str().c_str(), nullptr) * factor);
}

void set_threads(int count) {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    torch::set_num_threads(count > 0 ? count : cores);
}

std::unique_ptr<TextToImage> load_model(const std::filesystem::path& path, const std::string& device) {
    auto bundle = load_bundle(path, parse_device(device));
    const auto& widths = bundle.unet->config().block_out_channels;
    const bool small = *std::max_element(widths.begin(), widths.end()) <= WidestSmallModel;
    set_blas_threads(small ? 1 : torch::get_num_threads());
    return std::make_unique<Model>(std::move(bundle));
}

}  // namespace gse::neural
