// Loading of a CLIP folder, and its vectors of pictures and sentences.
#include "engine/neural/clip/clip_score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "engine/base/error.h"
#include "engine/language/vocabulary.h"
#include "engine/neural/api/tokenizer.h"
#include "engine/neural/api/tokenizer_json.h"
#include "engine/neural/clip/viewpoint_model.h"
#include "engine/neural/layers/images.h"
#include "engine/neural/layers/torch_errors.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {
namespace {

std::filesystem::path existing(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        throw Error(ErrorCode::NotFound, "the image-text encoder is incomplete",
                    "it has config.json and model.safetensors, as transformers writes a CLIPModel", path);
    return path;
}

std::vector<float> to_vector(const torch::Tensor& row) {
    const auto values = row.detach().to(torch::kCPU, torch::kFloat32).contiguous();
    return {values.data_ptr<float>(), values.data_ptr<float>() + values.numel()};
}

class ClipScore final : public edit::ImageTextEncoder {
public:
    explicit ClipScore(const ClipFolder& folder)
        : folder_(folder),
          config_(ClipConfig::from_json(read_json_file(existing(folder.path / "config.json")),
                                        folder.path / "config.json")),
          preprocessing_(ClipPreprocessing::read(config_, folder.path)),
          tokenizer_(has_tokenizer(folder.path) ? folder.path : folder.tokenizer) {
        if (folder_.known_words.empty() &&
            tokenizer_.vocabulary_size() > config_.text.vocab_size)  // else it is told nothing else
            throw Error(ErrorCode::Model,
                        fmt::format("the tokenizer has {} tokens but the image-text encoder only {}",
                                    tokenizer_.vocabulary_size(), config_.text.vocab_size),
                        {}, folder.path);
        model_ = loaded_network<ClipModel>(
            config_, SafetensorsFile(existing(folder.path / "model.safetensors")), clip_plan());
        for (auto& parameter : model_->parameters()) parameter.set_requires_grad(false);
        model_->to(folder.device);
        model_->eval();
        if (!folder.viewpoint.empty())
            viewpoint_ = std::make_unique<ViewpointReader>(folder.viewpoint, folder.device);
    }

    std::vector<float> image(const Image& image) override {
        return guard_torch("looking at a picture", [&] {
            const torch::NoGradGuard no_grad;
            const auto picture = to_tensor(image, folder_.device).slice(1, 0, 3).clamp(0.0, 1.0);
            return to_vector(model_->image_vectors(preprocessing_.pixels(picture)));
        });
    }

    std::vector<float> text(const std::string& sentence) override {
        return guard_torch("reading a sentence", [&] {
            const torch::NoGradGuard no_grad;
            const auto known = folder_.known_words.empty()
                                   ? sentence
                                   : language::filter_to_vocabulary(sentence, folder_.known_words);
            const auto length = std::min(tokenizer_.max_length(), config_.text.max_position_embeddings);
            const auto ids = torch::tensor(tokenizer_.encode(known, length).ids, torch::kInt64);
            return to_vector(model_->text_vectors(ids.unsqueeze(0).to(folder_.device)));
        });
    }

    std::vector<float> viewpoint(const Image& image) override {
        return viewpoint_ ? viewpoint_->shares(image) : std::vector<float>{};
    }

private:
    ClipFolder folder_;
    ClipConfig config_;
    ClipPreprocessing preprocessing_;
    Tokenizer tokenizer_;
    ClipModel model_{nullptr};
    std::unique_ptr<ViewpointReader> viewpoint_;
};

}  // namespace

bool has_clip(const std::filesystem::path& folder) {
    std::error_code ignored;
    return std::filesystem::exists(folder / "config.json", ignored);
}

std::unique_ptr<edit::ImageTextEncoder> load_clip_score(const ClipFolder& folder) {
    return guard_torch("loading the image-text encoder", [&] { return std::make_unique<ClipScore>(folder); });
}

}  // namespace gse::neural
