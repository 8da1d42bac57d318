// The head of a figure: what wears hats, glasses and scarves, where it is small beside the whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/edit/interfaces/model_traits.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/request/checked_request.h"
#include "engine/math/vec.h"
#include "engine/scene/gaussian_set.h"

namespace gse::edit {

/// The upper part of a labelled thing.
struct HeadRegion {
    std::vector<std::uint8_t> bits;  // [N]
    // Its height, as a share of the whole thing's: the topmost part that is as high as it is wide, whose
    // lower half is hardly wider than its upper one.
    double head = 1;
};

/// Head of the rows that `bits` [N] label, as high as so many `heads`. Its width is the mean horizontal
/// extent, or the narrowest one of an elongated part. Rows farther to the side than 0.75 of that are left
/// out. All rows if no part is as high as wide, or none can be seen.
HeadRegion bust_of(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                   const Vec3& front, double heads = 1);

/// Tells whether no head rises above the rows that `bits` [N] label. None is found then, and the topmost
/// tenth is long, like the back of an animal whose head is lower. False for a part of a larger thing: it was
/// pointed at.
bool is_head_unclear(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                     const Vec3& front, const ModelTraits& traits);

/// Tells whether the request adds something that is worn at the head.
bool is_worn_at_head(const CheckedRequest& request);

/// Part of an object that wears something new.
struct AttachmentTarget {
    std::vector<std::uint8_t> bits;  // [N]
    UprightBounds standing;
    double head = 1;  // where it is the head: its height, as a share of the whole thing's
};

/// Head of the rows that `bits` [N] label, if it is small for the model (ModelTraits::small_head). The target
/// must have its place there (language::usual_place()) and be `drawn` into the views. All rows otherwise. A
/// model draws what suits the figure that it is shown.
AttachmentTarget wearer_of(const CheckedRequest& request, const GaussianSet& set,
                           std::span<const std::uint8_t> bits, const Vec3& up, const Vec3& front, bool drawn,
                           const ModelTraits& traits);

/// Tells whether a worn object replaces another worn one ("crown" for "hat"). The wearer stays and is shown.
bool replaces_accessory(const language::EditSentence& sentence, EditMode mode);
/// Tells whether it is worn elsewhere than that ("sunglasses" of "hat").
bool moves_worn_place(const language::EditSentence& sentence, EditMode mode);

}  // namespace gse::edit
