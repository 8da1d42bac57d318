// A loaded model behind the torch-free interface.
#include "engine/neural/model.h"

#include <algorithm>
#include <thread>

#include "engine/neural/attention_source.h"
#include "engine/neural/images.h"
#include "engine/neural/sds_guidance.h"
#include "engine/neural/torch_errors.h"

namespace gse::neural {
namespace {

class Model final : public TextToImage {
public:
    explicit Model(ModelBundle bundle) : bundle_(std::make_shared<const ModelBundle>(std::move(bundle))) {}

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

    Image sample(const SampleRequest& request) override { return run(nullptr, request); }
    Image img2img(const Image& image, const SampleRequest& request) override { return run(&image, request); }

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

    std::shared_ptr<const ModelBundle> bundle_;
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
