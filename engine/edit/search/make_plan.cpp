// Masks grown and joined with the label, the room of what is new, its colour.
#include "engine/edit/search/make_plan.h"

#include <algorithm>

#include "engine/base/check.h"
#include "engine/edit/masks/view_vote.h"
#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

// Level of a map: towards a thing's rim its colour is in part that of what is behind it.
constexpr float SurelyIt = 0.9f;

/// Colour of the new object in the pictures that show its place.
std::string colour_of_drawn(const LocateResult& located, const std::vector<std::string>& known) {
    ColourVote sure(known), all(known);
    for (const auto& view : located.views) {
        if (view.drawn.data.empty()) continue;
        Image share = mask_image(view.region);
        all.add(view.drawn, share);
        for (std::size_t i = 0; i < share.data.size(); ++i)
            if (view.map.data[i] < SurelyIt) share.data[i] = 0;
        sure.add(view.drawn, share);
    }
    const auto winner = sure.winner();
    return winner.empty() ? all.winner() : winner;
}

}  // namespace

EditPlan make_plan(const LocateInput& input, const LocateResult& located, raster::Rasterizer& rasterizer) {
    GSE_CHECK_EQ(located.views.size(), input.views.size());
    EditPlan plan;
    plan.views = input.views;
    plan.view_words = input.view_words;
    plan.label = *located.label.bits;
    plan.seeds = located.seeds;
    plan.settings = input.settings;
    plan.mode = located.mode;
    if (located.mode == EditMode::Add &&
        !language::is_described(input.request.sentence().prompt(), input.request.target()))
        plan.drawn_colour = colour_of_drawn(located, input.known);
    const std::vector<float> values(plan.label.begin(), plan.label.end());
    const bool any = std::find(plan.label.begin(), plan.label.end(), std::uint8_t{1}) != plan.label.end();
    if (located.mode == EditMode::Replace)
        plan.room = !located.room.empty() ? located.room
                                          : room_around(input.gaussians, plan.label, input.up, input.front,
                                                        input.request.shape_room);
    Image seen;
    for (std::size_t v = 0; v < input.views.size(); ++v) {
        const Camera& camera = input.views[v].camera;
        Mask mask = located.views[v].failed ? Mask(camera.width, camera.height) : located.views[v].mask;
        if (any) {
            rasterizer.forward_values(input.gaussians.spans(), camera, input.settings, values, seen);
            for (std::size_t i = 0; i < mask.data.size(); ++i)
                if (seen.data[i] > 0.5f) mask.data[i] = 1;
        }
        mask = localize::dilate(mask, mask_growth(input.request, located.mode, mask));
        if (!plan.room.empty() && mask.count() > 0) {
            const Mask room = region_mask(plan.room, camera);
            for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] |= room.data[i];
        }
        plan.masks.push_back(std::move(mask));
    }
    if (!input.request.localize) std::fill(plan.label.begin(), plan.label.end(), std::uint8_t{1});
    return plan;
}

}  // namespace gse::edit
