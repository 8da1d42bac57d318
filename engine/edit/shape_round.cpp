// Attention, outlines, composites, seeds.
#include "engine/edit/shape_round.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/edit/colour_word.h"
#include "engine/edit/word_mask.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr std::size_t LeastViews = 3;   // fewer do not enclose a space
constexpr double RoomAround = 0.3;      // of the box (views.md 17)
constexpr double TrimmedRows = 0.01;    // at either end of every axis

/// Mean over the pixel and its eight neighbours: the rim of a thing is part of a pixel.
Image softened(const Mask& mask) {
    Image soft(mask.width, mask.height, 1);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            int inside = 0, all = 0;
            for (int v = std::max(0, y - 1); v <= std::min(mask.height - 1, y + 1); ++v)
                for (int u = std::max(0, x - 1); u <= std::min(mask.width - 1, x + 1); ++u, ++all) inside += mask.at(u, v) != 0 ? 1 : 0;
            soft.at(x, y, 0) = static_cast<float>(inside) / static_cast<float>(all);
        }
    return soft;
}

Image over(const Image& picture, const Image& share, const Image& backdrop) {
    GSE_CHECK_EQ(picture.data.size(), backdrop.data.size());
    Image result = backdrop;
    for (std::size_t i = 0; i < result.data.size(); ++i)
        result.data[i] = share.data[i / 3] * picture.data[i] + (1 - share.data[i / 3]) * backdrop.data[i];
    return result;
}

}  // namespace

ShapeFinder::ShapeFinder(const EditPlan& plan, const EditRequest& request, std::string word, AttentionSource& attention, Segmenter* segmenter)
    : plan_(plan), request_(request), word_(std::move(word)), attention_(attention), segmenter_(segmenter) {}

Image ShapeFinder::outline_of(const RoundView& view, const Image& picture, std::uint64_t seed) const {
    const AttentionQuery query{picture, as_told(request_.prompt), {word_}, view.view_words, false, 1, seed};
    auto maps = attention_.locate(query);
    GSE_CHECK_EQ(maps.size(), std::size_t{1});
    normalise_maximum(maps.front());
    const double level = request_.attention_threshold > 0 ? request_.attention_threshold : attention_.threshold();
    WordMask found = find_word_mask(picture, maps.front(), level, word_, request_, {segmenter_, nullptr});
    for (std::size_t i = 0; i < found.mask.data.size(); ++i) found.mask.data[i] &= view.mask.data[i] != 0 ? 1 : 0;
    return found.found() ? softened(found.mask) : Image(picture.width, picture.height, 1);
}

bool ShapeFinder::take_out(const RoundView& view, Image& picture, std::uint64_t seed, Image* outline) const {
    Image share = outline_of(view, picture, seed);
    const bool shows = std::any_of(share.data.begin(), share.data.end(), [](float value) { return value > 0.5f; });
    picture = over(picture, share, view.backdrop);
    if (outline != nullptr) *outline = std::move(share);
    return shows;
}

std::string ShapeFinder::colour_in(const RoundView& view, const Image& picture, std::uint64_t seed,
                                   const std::vector<std::string>& known) const {
    return colour_shown(picture, outline_of(view, picture, seed), known);
}

CutOut ShapeFinder::cut_out(const std::vector<RoundView>& views, std::vector<Image>& pictures, int round, const JobControl& job) {
    GSE_CHECK_EQ(views.size(), pictures.size());
    CutOut found;
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "cutting out the new thing was stopped");
        const auto seed = Random::stream(request_.seed, 60000 + static_cast<std::uint64_t>(round) * 1000 + v).next();
        const Image drawn = pictures[v];
        Image outline;
        if (take_out(views[v], pictures[v], seed, &outline)) {
            found.usable.push_back(v);
            found.outlines.push_back({views[v].view.camera, std::move(outline), views[v].backdrop_depth, drawn});
        }
        job.report("cutting out the new thing", static_cast<int>(v + 1), static_cast<int>(views.size()));
    }
    found.scalars["views_with_thing"] = static_cast<double>(found.usable.size());
    if (found.usable.size() < LeastViews)
        throw Error(ErrorCode::Model,
                    fmt::format("the model drew \"{}\" into only {} of {} views", word_, found.usable.size(), views.size()),
                    "try another seed, or a word that the model knows better");
    return found;
}

GaussianData ShapeFinder::seeds(const CutOut& found, const HullBox& box, int sh_degree) const {
    const auto hull = carve_hull(found.outlines, box);
    log::info("\"{}\" takes {} cubes of {:.4g} in what {} views enclose", word_, hull.centres.size(), hull.side, found.usable.size());
    return hull_seeds(hull, found.outlines, sh_degree);
}

HullBox room_for(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const GaussianData& place) {
    GSE_CHECK_EQ(bits.size(), set.size());
    HullBox box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        std::vector<float> values;
        for (std::size_t row = 0; row < bits.size(); ++row)
            if (bits[row] != 0) values.push_back(set.position()[row * 3 + k]);
        for (std::size_t row = 0; row < place.size(); ++row) values.push_back(place.position[row * 3 + k]);
        if (values.empty()) return {};
        std::sort(values.begin(), values.end());
        const auto cut = static_cast<std::size_t>(TrimmedRows * static_cast<double>(values.size() - 1));
        const double low = values[cut], high = values[values.size() - 1 - cut];
        box.low[axis] = low - RoomAround * (high - low);
        box.high[axis] = high + RoomAround * (high - low);
    }
    return box;
}

}  // namespace gse::edit
