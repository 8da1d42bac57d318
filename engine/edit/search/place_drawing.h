// Place of an object that the scene does not show yet, by drawing it (METHOD.md, Where something new goes). A
// model that is shown the scene draws the object into the views, anywhere around its owner. Pixels that
// differ and draw the word's attention are its place.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/content_hash.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/interfaces/voxels.h"
#include "engine/edit/request/checked_request.h"

namespace gse::edit {

/// Views, masks and words of the drawing; lists are per view. Refers to its arguments.
struct PlaceDrawing {
    const std::vector<View>& views;
    const std::vector<std::string>& view_words;  // or empty
    const std::vector<double>& azimuths;         // as in EditView, or empty
    const std::vector<double>& elevations;       // of as many views
    const std::vector<Image>& renders;           // [H,W,3] in [0,1]
    const std::vector<Image>& depths;            // [H,W,1], 0 = nothing there
    const VoxelRegion& room;                     // where the thing may be
    const CheckedRequest& request;
    std::string word;  // of the sentence: what is new
    std::uint64_t seed = 0;
};

/// Denoising steps of one drawn view; one that is not guided counts half.
double guided_steps_of_place(const SearchSettings& settings);

/// Key of all inputs of the drawn pictures, but for the scene and the views.
ContentKey drawing_key(const PlaceDrawing& drawing, const std::vector<std::uint8_t>& source_bits,
                       bool plain_ground);

/// Views that were drawn into.
struct DrawnViews {
    std::vector<std::size_t> views;  // of the drawing's, ascending
    std::vector<Image> pictures;     // [H,W,3] in [0,1], as the model would have them
    std::vector<Image> changes;      // as in EditedViews
    std::vector<Image> outlines;     // the same
};

/// As many of the views as an edit redraws, those farthest from each other; none where the room is not seen.
/// Throws Error (Cancelled, Model).
DrawnViews draw_thing(const PlaceDrawing& drawing, MultiViewEditor& guidance, const JobControl& job);

/// Findings in a drawn view.
struct DrawnPlace {
    Image map;  // [H,W,1] attention of the word in the drawn picture, maximum 1; or what the model tells of
                // it, in [0,1]
    Mask mask;  // the thing in it; empty of ones where the picture does not show it
    std::size_t broken = 0;  // values of the attention that were not finite, and count as none
};

/// Findings in each drawn view. A threshold of the request also applies to the model's own outlines: the
/// share of a pixel that counts as the object. Throws Error (Cancelled, NotFound).
std::vector<DrawnPlace> find_drawn(const PlaceDrawing& drawing, const DrawnViews& drawn,
                                   AttentionSource& attention, const JobControl& job);

}  // namespace gse::edit
