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
// Of a redrawn picture that pixel is the thing whose attention is CertainShare of the threshold (or half-way from it to the most
// there is), or PossibleShare of it where the picture differs from what is behind the thing. Attention alone either reaches beyond the
// thing or leaves out parts of it (a mushroom's stem); the difference alone takes shadows along. Of 8 added things each on seeds 55 | 56
// (`gseditpro eval --kinds add --edits 8`) a PossibleShare of .5 removed 14 | 7 % of the error with outlines of an IoU of .46 | .39, .85
// removes 16 | 10 % with .46 | .41; the attention and the segmenter alone removed 15 | 8 % with .41 | .36.
constexpr double CertainShare = 1.2, PossibleShare = 0.85;
constexpr float LeastDifference = 0.1f;   // of the channel that differs most: what the autoencoder loses is mostly less
constexpr double LeastPart = 0.2;         // attention of a part beside that of the largest: a pair of wings has two
constexpr double LeastArea = 0.002;       // of the picture

/// Largest difference of a channel.
float difference(const Image& a, const Image& b, std::size_t pixel) {
    float most = 0;
    for (std::size_t c = pixel * 3; c < pixel * 3 + 3; ++c) most = std::max(most, std::abs(a.data[c] - b.data[c]));
    return most;
}

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

ShapeFinder::ShapeFinder(const EditPlan& plan, const EditRequest& request, std::string word, AttentionSource& attention)
    : plan_(plan), request_(request), word_(std::move(word)), attention_(attention) {}

AttentionQuery ShapeFinder::query_of(const RoundView& view, const Image& picture, std::uint64_t seed) const {
    return {picture, as_told(request_.prompt), {word_}, view.view_words, false, 1, seed};
}

Image ShapeFinder::outline_of(const RoundView& view, const Image& picture, std::uint64_t seed) const {
    const auto query = query_of(view, picture, seed);
    auto maps = attention_.locate(query);
    GSE_CHECK_EQ(maps.size(), std::size_t{1});
    normalise_maximum(maps.front());
    const double level = request_.attention_threshold > 0 ? request_.attention_threshold : attention_.threshold();
    const double certain = std::min(CertainShare * level, (1 + level) / 2), possible = PossibleShare * level;
    const Image& map = maps.front();
    Mask found(picture.width, picture.height);
    for (std::size_t i = 0; i < found.data.size(); ++i) {
        const bool differs = difference(picture, view.backdrop.picture, i) >= LeastDifference;
        found.data[i] = view.mask.data[i] != 0 && map.data[i] >= (differs ? possible : certain) ? 1 : 0;
    }
    found = localize::clean_clusters(localize::without_holes(found), map, {1.5, 4}, LeastPart);
    const bool shows = static_cast<double>(found.count()) >= LeastArea * static_cast<double>(found.data.size());
    return shows ? softened(found) : Image(picture.width, picture.height, 1);
}

bool ShapeFinder::take_out(const RoundView& view, Image& picture, std::uint64_t seed, Image* outline) const {
    Image share = outline_of(view, picture, seed);
    const bool shows = std::any_of(share.data.begin(), share.data.end(), [](float value) { return value > 0.5f; });
    picture = over(picture, share, view.backdrop.picture);
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
    const auto seed_of = [&](std::size_t v) { return Random::stream(request_.seed, 60000 + static_cast<std::uint64_t>(round) * 1000 + v).next(); };
    const std::size_t at_once = attention_.at_once();
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "cutting out the new thing was stopped");
        if (at_once > 1 && v % at_once == 0) {
            std::vector<AttentionQuery> queries;
            for (std::size_t i = v; i < std::min(v + at_once, views.size()); ++i) queries.push_back(query_of(views[i], pictures[i], seed_of(i)));
            attention_.prepare(queries);
        }
        const auto seed = seed_of(v);
        const Image drawn = pictures[v];
        Image outline;
        if (take_out(views[v], pictures[v], seed, &outline)) {
            found.usable.push_back(v);
            found.outlines.push_back({views[v].view.camera, std::move(outline), views[v].backdrop.depth, drawn});
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
    const auto hull = best_hull(found.outlines, box);
    log::info("\"{}\" takes {} cubes of {:.4g} in what {} views enclose", word_, hull.centres.size(), hull.side, found.usable.size());
    return hull_seeds(hull, found.outlines, sh_degree);
}

}  // namespace gse::edit
