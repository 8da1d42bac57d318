// Rooms as masks, one round of redrawing, one question per picture.
#include "engine/edit/search/place_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/check.h"
#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/edit/interfaces/broken_values.h"
#include "engine/edit/masks/neighbours.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/edit/target_views/view_round.h"
#include "engine/language/grammar.h"
#include "engine/language/words.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

// Of a redrawn picture that pixel is the thing whose attention is CertainShare of the threshold (or half-way
// from it to the most there is), or PossibleShare of it where the picture differs from what is behind the
// thing. Attention alone either reaches beyond the thing or leaves out parts of it (a mushroom's stem); the
// difference alone takes shadows along. Of 8 added things each on seeds 55 | 56
// (`gseditpro-lab eval --kinds add --edits 8`) a PossibleShare of .5 removed 14 | 7 % of the error with
// outlines of an IoU of .46 | .39, .85 removes 16 | 10 % with .46 | .41; the attention and the segmenter
// alone removed 15 | 8 % with .41 | .36.
constexpr double CertainShare = 1.2, PossibleShare = 0.85;
constexpr float LeastDifference =
    0.1f;  // of the channel that differs most: what the autoencoder loses is mostly less
// The same where it is known what the model changed: LeastChange of it does, or CertainChange where the
// attention is certain (a black hat before the dark). What has little attention counts little, but counts:
// the attention often leaves out one of two wings.
constexpr float LeastChange = 0.1f, CertainChange = 0.03f, AttentionFloor = 0.5f;
constexpr double RimPx = 3;  // of a told outline: beyond it what is covered in part belongs to something else
constexpr double LeastPart = 0.2;  // attention of a part beside that of the largest: a pair of wings has two
constexpr double LeastArea = 0.002;          // of the picture
constexpr std::uint64_t QuestionStream = 1;  // of the seed, + the view

/// Largest difference of a channel.
float difference(const Image& a, const Image& b, std::size_t pixel) {
    float most = 0;
    for (std::size_t c = pixel * 3; c < pixel * 3 + 3; ++c)
        most = std::max(most, std::abs(a.data[c] - b.data[c]));
    return most;
}

Mask cleaned(const Mask& found, const Image& map) {
    const Mask whole = localize::clean_clusters(localize::without_holes(found), map, {1.5, 4}, LeastPart);
    const bool shows =
        static_cast<double>(whole.count()) >= LeastArea * static_cast<double>(whole.data.size());
    return shows ? whole : Mask(found.width, found.height);
}

}  // namespace

Mask covered_pixels(const Image& share, double least) {
    Mask mask(share.width, share.height);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = share.data[i] >= least ? 1 : 0;
    return mask;
}

Image told_thing(const Image& outline, const Mask& inside) {
    Image share = outline;
    for (std::size_t i = 0; i < share.data.size(); ++i)
        if (inside.data[i] == 0 || !(share.data[i] > 0)) share.data[i] = 0;  // also what is not a number
    const Mask half = covered_pixels(share), whole = cleaned(half, share),
               near = localize::dilate(whole, RimPx);
    for (std::size_t i = 0; i < share.data.size(); ++i) {
        if (near.data[i] == 0) share.data[i] = 0;
        if (whole.data[i] != 0 && half.data[i] == 0)
            share.data[i] = inside.data[i] != 0 ? 1.0f : 0.0f;  // a hole
    }
    return share;
}

Mask thing_in_picture(const Image& picture, const Image& without, const Mask& inside, const Image& map,
                      double level) {
    const double certain = std::min(CertainShare * level, (1 + level) / 2), possible = PossibleShare * level;
    Mask found(picture.width, picture.height);
    for (std::size_t i = 0; i < found.data.size(); ++i) {
        const bool differs = difference(picture, without, i) >= LeastDifference;
        found.data[i] = inside.data[i] != 0 && map.data[i] >= (differs ? possible : certain) ? 1 : 0;
    }
    return cleaned(found, map);
}

Mask changed_thing(const Image& change, const Mask& inside, const Image& map, double level) {
    const double certain = std::min(CertainShare * level, (1 + level) / 2);
    const Image smooth =
        mean_of_neighbours(change);  // lines along edges, which the autoencoder blurs, are no thing
    Mask found(change.width, change.height);
    Image weight(change.width, change.height, 1);
    for (std::size_t i = 0; i < found.data.size(); ++i) {
        const float least = map.data[i] >= certain ? CertainChange : LeastChange;
        found.data[i] = inside.data[i] != 0 && std::min(change.data[i], smooth.data[i]) >= least ? 1 : 0;
        weight.data[i] = smooth.data[i] * (AttentionFloor + map.data[i]);
    }
    found = cleaned(found, weight);
    for (std::size_t i = 0; i < found.data.size(); ++i)
        found.data[i] &= inside.data[i] != 0 ? 1 : 0;  // holes lie anywhere
    return found;
}

bool draws_place(const EditRequest& request, EditMode mode) {
    return mode == EditMode::Add && request.place_views > 0 && request.source != request.target &&
           language::place_name(edit_sentence(request).relation()).empty();
}

double guided_steps_of_place(const EditRequest& request) {
    RoundPlan plan;
    plan.view_steps = request.place_steps;
    plan.strength = 1;
    plan.guided_until = UsualGuidedUntil;
    return plan.guided_steps_of(0);
}

ContentKey drawing_key(const PlaceDrawing& drawing, const std::vector<std::uint8_t>& source_bits,
                       bool plain_ground) {
    const auto& request = drawing.request;
    ContentHash hash;
    hash.text(request.prompt);
    hash.numbers(drawing.seed, request.add_room, request.add_noise, request.place_views, request.place_steps,
                 plain_ground);
    hash.bytes(source_bits.data(), source_bits.size());
    return hash.key();
}

DrawnViews draw_thing(const PlaceDrawing& drawing, MultiViewEditor& guidance, const JobControl& job) {
    std::vector<Mask> rooms;
    std::vector<double> covered;
    for (const auto& view : drawing.views) {
        rooms.push_back(region_mask(drawing.room, view.camera));
        covered.push_back(static_cast<double>(rooms.back().count()) /
                          static_cast<double>(rooms.back().data.size()));
    }
    DrawnViews drawn;
    drawn.views =
        views_to_redraw(drawing.views, covered, static_cast<std::size_t>(drawing.request.place_views));
    if (drawn.views.empty()) return drawn;
    std::vector<EditView> views;
    for (const auto v : drawn.views) {
        EditView view{drawing.renders[v], drawing.renders[v],
                      drawing.depths[v],  rooms[v],
                      drawing.views[v],   drawing.view_words.empty() ? std::string() : drawing.view_words[v]};
        if (!drawing.azimuths.empty())
            view.azimuth = drawing.azimuths[v], view.elevation = drawing.elevations[v];
        view.backdrop = {drawing.renders[v], drawing.depths[v]};
        views.push_back(std::move(view));
    }
    EditViewsRequest input;
    input.steps = drawing.request.place_steps;
    input.strength = 1;  // nothing of what is there says where
    input.seed = drawing.seed;
    input.anew = true;
    input.guided_until = UsualGuidedUntil;
    input.noise = drawing.request.add_noise;
    input.keep = input.tells_changes = true;
    auto targets = guidance.edit(views, input, job);
    mend_broken(views, targets.images);
    drawn.pictures = std::move(targets.images);
    drawn.changes = std::move(targets.changes);
    drawn.outlines = std::move(targets.outlines);
    return drawn;
}

std::vector<DrawnPlace> find_drawn(const PlaceDrawing& drawing, const DrawnViews& drawn,
                                   AttentionSource& attention, const JobControl& job) {
    std::vector<DrawnPlace> places;
    const double asked = drawing.request.attention_threshold;  // 0 = open
    if (!drawn.outlines.empty()) {
        for (std::size_t i = 0; i < drawn.views.size(); ++i) {
            Image share = told_thing(drawn.outlines[i],
                                     region_mask(drawing.room, drawing.views[drawn.views[i]].camera));
            Mask mask = asked > 0 ? covered_pixels(share, asked) : covered_pixels(share);
            places.push_back({std::move(share), std::move(mask)});
        }
        return places;
    }
    const double level = asked > 0 ? asked : attention.threshold();
    std::vector<AttentionQuery> queries;
    for (std::size_t i = 0; i < drawn.views.size(); ++i) {
        const auto v = drawn.views[i];
        queries.push_back({drawn.pictures[i],
                           language::normalised_prompt(drawing.request.prompt),
                           {drawing.word},
                           drawing.view_words.empty() ? std::string() : drawing.view_words[v],
                           false,
                           1,
                           Random::stream(drawing.seed, QuestionStream + v).next()});
    }
    const std::size_t at_once = attention.at_once();
    for (std::size_t i = 0; i < queries.size(); ++i) {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
        if (at_once > 1 && i % at_once == 0)
            attention.prepare(std::span(queries).subspan(i, std::min(at_once, queries.size() - i)));
        auto maps = attention.locate(queries[i]);
        GSE_CHECK_EQ(maps.size(), std::size_t{1});
        const auto broken = normalise_maximum(maps.front());
        const auto v = drawn.views[i];
        const Mask room = region_mask(drawing.room, drawing.views[v].camera);
        auto mask = drawn.changes.empty()
                        ? thing_in_picture(drawn.pictures[i], drawing.renders[v], room, maps.front(), level)
                        : changed_thing(drawn.changes[i], room, maps.front(), level);
        places.push_back({std::move(maps.front()), std::move(mask), broken});
        job.report("looking for what was drawn", static_cast<int>(i + 1), static_cast<int>(queries.size()));
    }
    return places;
}

}  // namespace gse::edit
