// A noun and a picture to a mask.
#include "engine/neural/clip/text_segmenter.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/memory_cache.h"
#include "engine/neural/api/tokenizer.h"
#include "engine/neural/api/tokenizer_json.h"
#include "engine/neural/clip/clipseg_model.h"
#include "engine/neural/layers/devices.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/torch_errors.h"
#include "engine/neural/weights/tensor_file.h"

namespace gse::neural {
namespace {

constexpr std::int64_t PictureSize = 352;  // side of the pictures CLIPSeg was trained with
constexpr double LeastOfLargest = 0.5;     // probability that counts as inside, of the largest; by judgement
std::filesystem::path existing_part(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        throw Error(
            ErrorCode::NotFound, "the text segmenter is incomplete",
            "a CLIPSeg folder has config.json, merges.txt or tokenizer.json, and model.safetensors or "
            "pytorch_model.bin",
            path);
    return path;
}

std::filesystem::path weights_in(const std::filesystem::path& folder) {
    const auto pickled = folder / "pytorch_model.bin";
    return std::filesystem::exists(pickled) && !std::filesystem::exists(folder / "model.safetensors")
               ? pickled
               : existing_part(folder / "model.safetensors");
}

/// ImageNet's unless preprocessor_config.json says otherwise.
ClipPreprocessing preprocessing(const ClipSegConfig& config, const std::filesystem::path& folder) {
    if (std::filesystem::exists(folder / "preprocessor_config.json"))
        return ClipPreprocessing::read(config.clip, folder);
    ClipPreprocessing result;
    result.mean = {0.485, 0.456, 0.406};
    result.deviation = {0.229, 0.224, 0.225};
    return result;
}

class ClipSegSegmenter final : public edit::TextSegmenter {
public:
    ClipSegSegmenter(const std::filesystem::path& folder, const torch::Device& device)
        : config_(ClipSegConfig::from_json(read_json_file(existing_part(folder / "config.json")),
                                           folder / "config.json")),
          preprocessing_(preprocessing(config_, folder)),
          tokenizer_(has_tokenizer(folder) ? folder : existing_part(folder / "merges.txt").parent_path()),
          device_(device), pictures_(MostPictures) {
        if (tokenizer_.vocabulary_size() > config_.clip.text.vocab_size)
            throw Error(ErrorCode::Model,
                        fmt::format("the tokenizer has {} tokens but the text segmenter only {}",
                                    tokenizer_.vocabulary_size(), config_.clip.text.vocab_size),
                        {}, folder);
        model_ = loaded_network<ClipSegModel>(config_, *open_tensor_file(weights_in(folder)), clipseg_plan());
        for (auto& parameter : model_->parameters()) parameter.set_requires_grad(false);
        model_->to(device);
        model_->eval();
        const auto patch = config_.clip.vision.patch_size;
        preprocessing_.size = std::max<std::int64_t>(1, PictureSize / patch) * patch;
    }

    std::pair<Mask, double> segment(const Image& image, const std::string& noun) override {
        GSE_CHECK_EQ(image.channels, 3);
        return guard_torch("looking for a word", [&] {
            const torch::NoGradGuard no_grad;
            const auto shown =
                pictures_.get(key_of(image), [&] { return model_->activations(pixels(image)); });
            const auto length = std::min(tokenizer_.max_length(), config_.clip.text.max_position_embeddings);
            const auto ids =
                torch::tensor(tokenizer_.encode(noun, length).ids, torch::kInt64).unsqueeze(0).to(device_);
            auto probable =
                torch::sigmoid(model_->logits(shown, model_->clip->text->forward(ids).text_embeds))
                    .unsqueeze(1);
            probable = torch::upsample_bilinear2d(probable, {image.height, image.width}, false);
            const double largest = probable.max().item<double>();
            const auto inside = (probable >= LeastOfLargest * largest).to(torch::kUInt8).cpu().contiguous();
            Mask mask(image.width, image.height);
            std::copy_n(inside.data_ptr<std::uint8_t>(), mask.data.size(), mask.data.begin());
            return std::pair(std::move(mask), largest);
        });
    }

private:
    /// Squeezed to a square, as in the reference.
    torch::Tensor pixels(const Image& image) const {
        const auto size = preprocessing_.size;
        const auto picture = to_tensor(image, device_).clamp(0.0, 1.0);
        return preprocessing_.pixels(at::_upsample_bilinear2d_aa(picture, {size, size}, false));
    }

    ClipSegConfig config_;
    ClipPreprocessing preprocessing_;
    Tokenizer tokenizer_;
    ClipSegModel model_{nullptr};
    torch::Device device_;
    static constexpr std::size_t MostPictures = 32;  // 4.5 MB each
    MemoryCache<std::vector<torch::Tensor>> pictures_;
};

}  // namespace

std::unique_ptr<edit::TextSegmenter> load_text_segmenter(const std::filesystem::path& folder,
                                                         const std::string& device) {
    const auto where = parse_device(device);
    if (!std::filesystem::is_directory(folder))
        throw Error(ErrorCode::NotFound, "the text segmenter is a folder, and there is none",
                    "a CLIPSeg folder has config.json, merges.txt or tokenizer.json, and weights", folder);
    return guard_torch("loading the text segmenter",
                       [&] { return std::make_unique<ClipSegSegmenter>(folder, where); });
}

}  // namespace gse::neural
