// Attention, outlines, composites, seeds.
#include "engine/edit/target_views/shape_round.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/edit/masks/drawn_thing.h"
#include "engine/edit/masks/neighbours.h"
#include "engine/edit/masks/view_vote.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/edit/words/colour_word.h"

namespace gse::edit {
namespace {

// Views frame what something is added to: a tall hat reaches out of some.
constexpr double LeastFramedAdded = 0.5;
// Share of a pixel that an outline of an addition covers. Thin parts are missed more often than drawn too
// wide (METHOD.md, Drawing new things).
constexpr double LevelOfAdded = 0.4;
constexpr std::size_t LeastOutlines = 3;  // fewer do not enclose a space
/// The rim of a thing is part of a pixel.
Image softened(const Mask& mask) { return mean_of_neighbours(mask_image(mask)); }

Image over(const Image& picture, const Image& share, const Image& clean_plate) {
    GSE_CHECK_EQ(picture.data.size(), clean_plate.data.size());
    Image result = clean_plate;
    for (std::size_t i = 0; i < result.data.size(); ++i)
        result.data[i] = share.data[i / 3] * picture.data[i] + (1 - share.data[i / 3]) * clean_plate.data[i];
    return result;
}

}  // namespace

ShapeFinder::ShapeFinder(const EditPlan& plan, const CheckedRequest& request, std::string word,
                         AttentionSource& attention)
    : plan_(plan), request_(request), word_(std::move(word)), attention_(attention) {}

AttentionQuery ShapeFinder::query_of(const EditView& view, const Image& picture, std::uint64_t seed) const {
    return {picture, request_.sentence().prompt(), {word_}, view.view_words, false, 1, seed};
}

Image ShapeFinder::outline_of(const EditView& view, const EditedViews& drawn, std::size_t index,
                              std::uint64_t seed) const {
    if (!drawn.outlines.empty()) return told_thing(drawn.outlines[index], view.mask);
    const Image& picture = drawn.images[index];
    const auto query = query_of(view, picture, seed);
    auto maps = attention_.locate(query);
    GSE_CHECK_EQ(maps.size(), std::size_t{1});
    normalise_maximum(maps.front());
    const double level =
        request_.attention_threshold > 0 ? request_.attention_threshold : attention_.threshold();
    return softened(drawn.changes.empty()
                        ? thing_in_picture(picture, view.clean_plate.picture, view.mask, maps.front(), level)
                        : changed_thing(drawn.changes[index], view.mask, maps.front(), level));
}

bool ShapeFinder::take_out(const EditView& view, EditedViews& drawn, std::size_t index, std::uint64_t seed,
                           Image* outline) const {
    Image share = outline_of(view, drawn, index, seed);
    const bool shows =
        std::any_of(share.data.begin(), share.data.end(), [](float value) { return value > 0.5f; });
    drawn.images[index] = over(drawn.images[index], share, view.clean_plate.picture);
    if (outline != nullptr) *outline = std::move(share);
    return shows;
}

std::string ShapeFinder::colour_in(const EditView& view, const EditedViews& drawn, std::uint64_t seed,
                                   const std::vector<std::string>& known) const {
    return colour_shown(drawn.images.front(), outline_of(view, drawn, 0, seed), known);
}

CutOut ShapeFinder::cut_out(const std::vector<EditView>& views, EditedViews& drawn, int round,
                            const JobControl& job) {
    GSE_CHECK_EQ(views.size(), drawn.images.size());
    for (const auto* maps : {&drawn.changes, &drawn.outlines})
        GSE_CHECK(maps->empty() || maps->size() == views.size());
    CutOut found;
    const auto seed_of = [&](std::size_t v) {
        return Random::stream(request_.seed, 60000 + static_cast<std::uint64_t>(round) * 1000 + v).next();
    };
    const std::size_t at_once = attention_.at_once();
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "cutting out the new thing was stopped");
        if (drawn.outlines.empty() && at_once > 1 && v % at_once == 0) {
            std::vector<AttentionQuery> queries;
            for (std::size_t i = v; i < std::min(v + at_once, views.size()); ++i)
                queries.push_back(query_of(views[i], drawn.images[i], seed_of(i)));
            attention_.prepare(queries);
        }
        const auto seed = seed_of(v);
        const Image picture = drawn.images[v];
        Image outline;
        if (take_out(views[v], drawn, v, seed, &outline)) {
            found.usable.push_back(v);
            found.outlines.push_back(
                {views[v].view.camera, std::move(outline), views[v].clean_plate.depth, picture});
        }
        job.report("cutting out the new thing", static_cast<int>(v + 1), static_cast<int>(views.size()));
    }
    found.scalars["views_with_thing"] = static_cast<double>(found.usable.size());
    if (found.usable.size() < LeastOutlines)
        throw Error(ErrorCode::Model,
                    fmt::format("the model drew \"{}\" into only {} of {} views", word_, found.usable.size(),
                                views.size()),
                    "try another seed, or a word that the model knows better");
    return found;
}

GaussianData ShapeFinder::seeds(const CutOut& found, const HullBox& box, int sh_degree) const {
    HullParameters parameters;
    if (plan_.mode == EditMode::Add)
        parameters.least_framed = LeastFramedAdded, parameters.level = LevelOfAdded;
    const auto hull = best_hull(found.outlines, box, parameters);
    log::info("\"{}\" takes {} cubes of {:.4g} in what {} views enclose", word_, hull.centres.size(),
              hull.side, found.usable.size());
    return hull_seeds(hull, found.outlines, sh_degree);
}

}  // namespace gse::edit
