// Searches over two coloured balls: stand-ins for attention and segmenters, and the tools around them.
#pragma once

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/search/locate.h"
#include "tests/unit/edit/edit_scenes.h"

namespace locate_scenes {

using namespace gse;

constexpr int Side = 48;

inline double iou(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    double both = 0, either = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        both += a[i] != 0 && b[i] != 0 ? 1 : 0;
        either += a[i] != 0 || b[i] != 0 ? 1 : 0;
    }
    return either > 0 ? both / either : 0;
}

/// Attention from colours: "ball" is drawn to red pixels, "hat" to a spot above the red ball.
class ColourAttention : public edit::AttentionSource {
public:
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        if (query.words.size() > most_words)
            throw Error(ErrorCode::NotFound, "a word stands beyond what the model reads");
        queries.push_back({query.prompt, query.words.front(), query.absent, query.seed, query.words});
        Image map(query.image.width, query.image.height, 1);
        const bool blind = calls++ % 12 < blind_views;
        for (int y = 0; y < map.height && !blind; ++y)
            for (int x = 0; x < map.width; ++x) {
                const int source = query.absent ? y + hat_shift : y;  // absent things are drawn above the red
                if (source < map.height) map.at(x, y, 0) = redness(query.image, x, source);
            }
        std::vector<Image> maps{
            localize::resize_image(localize::resize_image(map, 16, 16), map.width, map.height)};
        for (std::size_t rival = 1; rival < query.words.size(); ++rival) {  // all other words: the lower half
            maps.emplace_back(map.width, map.height, 1);
            for (int y = map.height / 2; y < map.height; ++y)
                for (int x = 0; x < map.width; ++x) maps.back().at(x, y, 0) = 1;
        }
        return maps;
    }
    int image_size() const override { return Side; }

    struct Query {
        std::string prompt, word;
        bool absent;
        std::uint64_t seed;
        std::vector<std::string> words;
    };
    std::vector<Query> queries;
    std::size_t most_words = 9;
    int blind_views = 0;
    int hat_shift = 10;

private:
    static float redness(const Image& image, int x, int y) {
        return std::max(0.0f, image.at(x, y, 0) - image.at(x, y, 1));
    }
    int calls = 0;
};

/// One view has much attention beside the thing: at a low threshold its mask is at odds with the others'.
class DistractedAttention : public ColourAttention {
public:
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        auto maps = ColourAttention::locate(query);
        if (queries.size() % 12 == 1)
            for (int y = 0; y < maps[0].height; ++y)
                for (int x = 0; x < maps[0].width / 3; ++x)
                    maps[0].at(x, y, 0) = std::max(maps[0].at(x, y, 0), Beside * maximum(maps[0]));
        return maps;
    }

private:
    static constexpr float Beside = 0.45f;
    static float maximum(const Image& map) { return *std::max_element(map.data.begin(), map.data.end()); }
};

/// Finds red things when asked for a ball, nothing else.
class RedDetector : public edit::TextSegmenter {
public:
    std::pair<Mask, double> segment(const Image& image, const std::string& noun) override {
        Mask mask(image.width, image.height);
        if (noun != "ball") return {mask, 0.0};
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                mask.at(x, y) = image.at(x, y, 0) - image.at(x, y, 1) > 0.2f ? 1 : 0;
        return {mask, 0.9};
    }
};

/// Leaves out the lower part of what is red, as if it had another colour.
class TopSegmenter : public edit::Segmenter {
public:
    Mask segment(const Image& image, const std::vector<edit::PointPrompt>&,
                 const std::optional<edit::BoxPrompt>&, const Image&) override {
        Mask mask(image.width, image.height);
        for (int y = 0; y < image.height / 2 + 2; ++y)
            for (int x = 0; x < image.width; ++x)
                mask.at(x, y) = image.at(x, y, 0) - image.at(x, y, 1) > 0.2f ? 1 : 0;
        return mask;
    }
    bool trusted() const override { return trusted_; }
    std::string name() const override { return "top"; }
    bool trusted_ = false;
};

/// Takes whatever is not black.
class GreedySegmenter : public edit::Segmenter {
public:
    Mask segment(const Image& image, const std::vector<edit::PointPrompt>&,
                 const std::optional<edit::BoxPrompt>&, const Image&) override {
        Mask mask(image.width, image.height);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                mask.at(x, y) = image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2) > 0.2f ? 1 : 0;
        return mask;
    }
    std::string name() const override { return "greedy"; }
};

inline edit::CheckedRequest request_for(const std::string& prompt, const std::string& target) {
    auto request = test::asked("ball", prompt, target);
    request.seed = 3;
    return request;
}

struct Fixture {
    test::BallScene scene = test::ball_scene(200);
    std::vector<View> views = test::ball_views(12, Side);
    std::vector<std::string> words;
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);
    ColourAttention attention;

    edit::LocateInput input(const edit::CheckedRequest& request) const {
        return {scene.set, views, words, request, {}, {0, -1, 0}};
    }
    edit::LocateTools tools(edit::Segmenter* segmenter = nullptr, edit::TextSegmenter* text = nullptr) {
        return {*rasterizer, attention, segmenter, text, {}};
    }
};

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

}  // namespace locate_scenes
