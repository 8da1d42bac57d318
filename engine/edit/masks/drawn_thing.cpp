// Outlines, differences and attention of redrawn pictures, cleaned.
#include "engine/edit/masks/drawn_thing.h"

#include <algorithm>
#include <cmath>

#include "engine/edit/masks/neighbours.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

// Attention of a pixel that shows the object, as a share of the threshold, or half-way from it to the
// largest. PossibleShare is enough where the picture differs from the scene behind. Attention alone reaches
// beyond the object or misses parts (a mushroom's stem). The difference alone takes shadows along.
constexpr double CertainShare = 1.2, PossibleShare = 0.85;
// Difference of the channel that differs most: what the autoencoder loses is mostly less.
constexpr float LeastDifference = 0.1f;
// Change by which a pixel shows the object, where the model's change is known. CertainChange is enough where
// the attention is certain (a black hat before the dark). Faint attention counts at least AttentionFloor: the
// attention often misses one of two wings.
constexpr float LeastChange = 0.1f, CertainChange = 0.03f, AttentionFloor = 0.5f;
// Rim of a told outline: beyond it what is covered in part belongs to something else.
constexpr double OutlineRimPx = 3;
constexpr double LeastPart = 0.2;  // attention of a part beside that of the largest: a pair of wings has two
constexpr double LeastArea = 0.002;  // of the picture

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
               near = localize::dilate(whole, OutlineRimPx);
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
    // Lines along edges, which the autoencoder blurs, are no thing.
    const Image smooth = mean_of_neighbours(change);
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

}  // namespace gse::edit
