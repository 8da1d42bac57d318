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
// Of a redrawn picture that pixel is the thing which the segmenter keeps and whose attention is this share of the threshold, or
// half-way from the threshold to the most there is: attention reaches beyond what it is of. Of 16 replaced things on seeds 56 and 57
// (`gseditpro eval --kinds replace --edits 8`) the shares .4 (and .8 without the segmenter) / 1 / 1.2 / 1.4 removed 28 / 34 / 37 / 40 %
// of the error, with outlines of an IoU of .65 / .67 / .68 / .65.
constexpr double LeastShare = 1.2;

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
    if (!found.found()) return Image(picture.width, picture.height, 1);
    const double least = std::min(LeastShare * level, (1 + level) / 2);
    for (std::size_t i = 0; i < found.mask.data.size(); ++i) {
        const bool inside = found.mask.data[i] != 0 && maps.front().data[i] >= least;
        found.mask.data[i] = inside && view.mask.data[i] != 0 ? 1 : 0;
    }
    return softened(found.mask);
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
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "cutting out the new thing was stopped");
        const auto seed = Random::stream(request_.seed, 60000 + static_cast<std::uint64_t>(round) * 1000 + v).next();
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
