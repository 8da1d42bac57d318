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
#include "engine/edit/masks/drawn_thing.h"
#include "engine/edit/masks/view_choice.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/edit/placement/voxel_region.h"

namespace gse::edit {
namespace {

constexpr std::uint64_t QuestionStream = 1;  // of the seed, + the view

}  // namespace

double guided_steps_of_place(const SearchSettings& settings) {
    RoundPlan plan;
    plan.view_steps = settings.place_steps;
    plan.strength = 1;
    plan.guided_until = UsualGuidedUntil;
    return plan.guided_steps_of(0);
}

ContentKey drawing_key(const PlaceDrawing& drawing, const std::vector<std::uint8_t>& source_bits,
                       bool plain_ground) {
    const auto& request = drawing.request;
    ContentHash hash;
    hash.text(request.prompt());
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
        view.clean_plate = {drawing.renders[v], drawing.depths[v]};
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
                           drawing.request.sentence().prompt(),
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
