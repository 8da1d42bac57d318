// Clicks to prompts, and a cache of embeddings.
#include "engine/neural/sam/sam_segmenter.h"

#include <algorithm>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/memory_cache.h"
#include "engine/neural/layers/devices.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/torch_errors.h"
#include "engine/neural/sam/sam_model.h"

namespace gse::neural {
namespace {

class SamSegmenter final : public edit::Segmenter {
public:
    SamSegmenter(SamModel model, const torch::Device& device)
        : model_(std::move(model)), device_(device), pictures_(MostPictures) {}

    Mask segment(const Image& image, const std::vector<edit::PointPrompt>& points,
                 const std::optional<edit::BoxPrompt>& box, const Image&) override {
        GSE_CHECK_EQ(image.channels, 3);
        Mask mask(image.width, image.height);
        if (points.empty() && !box) return mask;
        return guard_torch("cutting out a mask", [&] {
            const torch::NoGradGuard no_grad;
            const auto found =
                model_->masks(embedding(image), model_->encode(prompts(image, points, box)), false);
            const auto inside = (model_->enlarge(found.logits, image.height, image.width) > 0)
                                    .to(torch::kUInt8)
                                    .cpu()
                                    .contiguous();
            std::copy_n(inside.data_ptr<std::uint8_t>(), mask.data.size(), mask.data.begin());
            return std::move(mask);
        });
    }
    bool trusted() const override { return true; }
    std::string name() const override { return model_->shape().name; }

private:
    /// Places in pixels of the encoder's picture. Here pixels have their centres at .5, in prompts at 0.
    SamPrompts prompts(const Image& image, const std::vector<edit::PointPrompt>& points,
                       const std::optional<edit::BoxPrompt>& box) const {
        const SamScale scale = model_->scale(image.height, image.width);
        SamPrompts prompts;
        if (points.empty()) {
            prompts.boxes = torch::tensor({box->x0, box->y0, box->x1, box->y1}, torch::kFloat32)
                                .mul_(torch::tensor({scale.x, scale.y, scale.x, scale.y}, torch::kFloat32))
                                .sub_(0.5)
                                .view({1, 4})
                                .to(device_);
            return prompts;
        }
        std::vector<float> places;
        std::vector<std::int64_t> labels;
        for (const auto& point : points) {
            places.push_back(static_cast<float>(point.x * scale.x - 0.5));
            places.push_back(static_cast<float>(point.y * scale.y - 0.5));
            labels.push_back(point.positive ? 1 : 0);
        }
        prompts.points = torch::tensor(places).view({1, -1, 2}).to(device_);
        prompts.labels = torch::tensor(labels, torch::kInt64).view({1, -1}).to(device_);
        return prompts;
    }

    torch::Tensor embedding(const Image& image) {
        return pictures_.get(key_of(image),
                             [&] { return model_->embed(model_->pixels(to_tensor(image, device_))); });
    }

    SamModel model_;
    torch::Device device_;
    static constexpr std::size_t MostPictures = 64;  // 4 MB each with SAM's weights
    MemoryCache<torch::Tensor> pictures_;
};

}  // namespace

std::unique_ptr<edit::Segmenter> load_sam_segmenter(const std::filesystem::path& path,
                                                    const std::string& device) {
    const auto where = parse_device(device);
    return guard_torch("loading the segmenter",
                       [&] { return std::make_unique<SamSegmenter>(load_sam(path, where), where); });
}

}  // namespace gse::neural
