// Stand-in for a model of an open vocabulary: attention by colours and heights, views redrawn by a rule.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/neural/api/api.h"

namespace open_model {

using namespace gse;

/// Record of all that the model was asked.
struct AskedOfModel {
    std::vector<std::string> words;      // looked for
    std::vector<std::string> prompts;    // told for views
    std::size_t masked = 0, pixels = 0;  // of the views that were redrawn
};

/// "bear" is what is red. Any other word is the same amount everywhere in the upper part of the picture.
class ColourMaps final : public edit::AttentionSource {
public:
    explicit ColourMaps(AskedOfModel& asked) : asked_(asked) {}
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        std::vector<Image> maps;
        for (const auto& word : query.words) {
            asked_.words.push_back(word);
            Image map(query.image.width, query.image.height, 1);
            for (int y = 0; y < map.height; ++y)
                for (int x = 0; x < map.width; ++x) {
                    const float red = query.image.at(x, y, 0) - query.image.at(x, y, 1);
                    const bool upper = y < map.height / 2;
                    map.at(x, y, 0) = word == "bear" ? (red > 0.1f ? 1.0f : 0.0f) : upper ? 1.0f : 0.0f;
                }
            maps.push_back(std::move(map));
        }
        return maps;
    }
    int image_size() const override { return 64; }

private:
    AskedOfModel& asked_;
};

/// Draws every picture in half of its light.
class Dimmed final : public edit::MultiViewEditor {
public:
    explicit Dimmed(AskedOfModel& asked) : asked_(asked) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest&,
                           const JobControl&) override {
        edit::EditedViews edited;
        for (const auto& view : views) {
            asked_.masked += view.mask.count();
            asked_.pixels += view.mask.data.size();
            edited.images.push_back(view.original);
            for (auto& value : edited.images.back().data) value *= 0.5f;
        }
        return edited;
    }

private:
    AskedOfModel& asked_;
};

class OpenModel final : public neural::TextToImage {
public:
    explicit OpenModel(neural::BundleKind kind = neural::BundleKind::Plain) : kind_(kind) {}
    mutable AskedOfModel asked;

    std::unique_ptr<edit::AttentionSource> attention(const neural::AttentionParameters&) const override {
        return std::make_unique<ColourMaps>(asked);
    }
    std::unique_ptr<edit::Guidance> guidance(const std::string&,
                                             const neural::SdsParameters&) const override {
        throw Error(ErrorCode::Model, "it has no gradient");
    }
    std::unique_ptr<edit::MultiViewEditor> views(const std::string& prompt,
                                                 const neural::SdsParameters&) const override {
        asked.prompts.push_back(prompt);
        return std::make_unique<Dimmed>(asked);
    }
    std::vector<std::string> known_words() const override { return {}; }
    int image_size() const override { return 64; }
    std::string name() const override { return "open"; }
    neural::BundleKind kind() const override { return kind_; }
    Image sample(const neural::SampleRequest&) const override { return Image(64, 64, 3); }
    Image img2img(const Image& image, const neural::SampleRequest&) const override { return image; }
    neural::TunedModel tune(const neural::DreamBoothParameters&, std::span<const Image>, const std::string&,
                            const std::string&, const JobControl&, AnswerCache*) const override {
        throw Error(ErrorCode::Model, "it learns nothing");
    }
    bool save_tuning(const std::filesystem::path&, std::uint64_t) const override { return false; }
    std::shared_ptr<neural::TextToImage> load_tuning(const std::filesystem::path&) const override {
        throw Error(ErrorCode::Model, "it learns nothing");
    }
    void save_lora(const std::filesystem::path&) const override {}
    std::shared_ptr<neural::TextToImage> load_lora(const std::filesystem::path&, double) const override {
        throw Error(ErrorCode::Model, "it learns nothing");
    }

private:
    neural::BundleKind kind_;
};

}  // namespace open_model
