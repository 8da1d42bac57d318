// Differences, box blur, Otsu's threshold (Otsu 1979), pieces.
#include "engine/remote/views/change_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"
#include "engine/math/quantile.h"
#include "engine/remote/views/registration.h"

namespace gse::remote {
namespace {

constexpr std::size_t Bins = 256;
constexpr double LeastLevel = 12.0 / 255;  // a smaller change is the server's error
constexpr double Softness = 0.25;          // of the threshold: width of the step from outside to inside
// Parts of a picture (changed_part()).
constexpr double LeastPart = 0.001, MostPart = 0.6;  // of the pixels
constexpr double PartBlur = 2.0 / 512;               // of the picture's side
constexpr double MeansOfDiffEdit = 3;                // multiple of the mean that is the level
// Differences are of two kinds where Otsu's classes explain so much of their variance, and their means differ
// by this factor.
constexpr double TwoKinds = 0.7, KindsApart = 4;
constexpr double PartMargin = 8.0 / 512;  // of the side: width of the rim between inside and outside
constexpr double OutsideShare = 0.95,
                 OutsideMargin = 1.5;  // quantile of the changes outside, and its multiple
constexpr double KeptMass = 0.25;      // of the largest piece's change
constexpr double FloorShare = 0.25;    // of the pixels that are below the server's own error

/// Mean over squares of 2 radius + 1 pixels, along one axis after the other.
Image box_blurred(const Image& image, int radius) {
    if (radius < 1) return image;
    const auto along = [radius](const Image& from, bool rows) {
        Image result(from.width, from.height, 1);
        const int length = rows ? from.width : from.height;
        for (int line = 0; line < (rows ? from.height : from.width); ++line)
            for (int i = 0; i < length; ++i) {
                const int first = std::max(0, i - radius), last = std::min(length - 1, i + radius);
                float sum = 0;
                for (int j = first; j <= last; ++j) sum += rows ? from.at(j, line, 0) : from.at(line, j, 0);
                (rows ? result.at(i, line, 0) : result.at(line, i, 0)) =
                    sum / static_cast<float>(last - first + 1);
            }
        return result;
    };
    return along(along(image, true), false);
}

/// Two classes of values in [0,1].
struct OtsuClasses {
    double level = 0;             // between them
    double explained = 0;         // share of the variance that lies between the classes
    double below = 0, above = 0;  // their means
};

using Histogram = std::array<double, Bins>;

/// Adds a value in [0,1].
void count_value(Histogram& histogram, float value) {
    histogram[static_cast<std::size_t>(std::clamp(value, 0.0f, 0.999f) * Bins)] += 1;
}

/// The level that parts the values best into two classes.
OtsuClasses otsu_classes(const Histogram& histogram) {
    double count = 0, sum = 0, squares = 0;
    for (std::size_t i = 0; i < Bins; ++i) {
        const auto value = static_cast<double>(i);
        count += histogram[i], sum += value * histogram[i], squares += value * value * histogram[i];
    }
    double below = 0, sum_below = 0, best = -1;
    OtsuClasses classes;
    for (std::size_t i = 0; i + 1 < Bins; ++i) {
        below += histogram[i], sum_below += static_cast<double>(i) * histogram[i];
        const double above = count - below;
        if (below <= 0 || above <= 0) continue;
        const double distance = sum_below / below - (sum - sum_below) / above;
        const double between = below * above * distance * distance;
        if (between <= best) continue;
        best = between;
        classes.level = (static_cast<double>(i) + 1) / Bins;
        classes.below = (sum_below / below + 0.5) / Bins;
        classes.above = ((sum - sum_below) / above + 0.5) / Bins;
    }
    const double variance = count * squares - sum * sum;
    classes.explained = variance > 0 ? std::max(best, 0.0) / variance : 0;
    if (classes.level == 0) classes.level = 1.0 / Bins;
    return classes;
}

/// Value below which that share of the values lies.
float quantile(std::vector<float> values, double share) {
    return values.empty() ? 0 : lower_quantile(values, share);
}

/// The picture without its even shift of each channel against `before`.
Image without_shift(const Image& before, Image after) {
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float> shifts;
        for (std::size_t i = c; i < after.data.size(); i += 3)
            shifts.push_back(after.data[i] - before.data[i]);
        const float shift = quantile(std::move(shifts), 0.5);
        for (std::size_t i = c; i < after.data.size(); i += 3) after.data[i] -= shift;
    }
    return after;
}

/// Blur of differences in a picture of that width, px.
double blur_of(int width) { return std::max(1.0, std::round(PartBlur * width)); }

/// Change of every pixel that all pictures show.
Image common_change(const Image& before, std::span<const Image> after) {
    const double blur = blur_of(before.width);
    Image least;
    for (const auto& picture : after) {
        Image change = change_map(before, without_shift(before, picture), blur);
        if (least.data.empty()) least = std::move(change);
        else
            std::transform(least.data.begin(), least.data.end(), change.data.begin(), least.data.begin(),
                           [](float one, float other) { return std::min(one, other); });
    }
    return least;
}

/// Takes the server's own error off; false where what is left of it is no error any more.
bool take_floor_off(Image& change) {
    const float floor = quantile(change.data, FloorShare);
    for (auto& value : change.data) value = std::max(0.0f, value - floor);
    return floor <= LeastLevel;
}

/// Level of the part that was changed, and whether the changes are of two kinds.
struct PartLevel {
    double level = 0;
    bool two_kinds = false;
};

PartLevel part_level(const Image& change) {
    Histogram histogram{};
    double mean = 0;
    for (const float value : change.data) count_value(histogram, value), mean += value;
    mean /= static_cast<double>(std::max<std::size_t>(1, change.data.size()));
    const auto classes = otsu_classes(histogram);
    const bool two_kinds = classes.explained >= TwoKinds && classes.above >= KindsApart * classes.below;
    return {std::max(LeastLevel, two_kinds ? classes.level : MeansOfDiffEdit * mean), two_kinds};
}

/// Share of the values above a level.
double share_above(const Image& change, double level) {
    const auto above =
        std::count_if(change.data.begin(), change.data.end(), [level](float value) { return value > level; });
    return static_cast<double>(above) / static_cast<double>(std::max<std::size_t>(1, change.data.size()));
}

/// Pixels above a lower level that neighbours join to the part. A thing has places that change less: black
/// ones, and those of the new colour. The level is above nearly all of what lies outside.
Mask grown_part(const Image& change, const Mask& part, double level) {
    const Mask around = localize::dilate(part, std::max(2.0, PartMargin * change.width));
    std::vector<float> outside;
    for (std::size_t i = 0; i < change.data.size(); ++i)
        if (around.data[i] == 0) outside.push_back(change.data[i]);
    const double low =
        std::clamp<double>(OutsideMargin * quantile(std::move(outside), OutsideShare), LeastLevel, level);
    Mask open(change.width, change.height);
    for (std::size_t i = 0; i < change.data.size(); ++i) open.data[i] = change.data[i] > low ? 1 : 0;
    const Mask grown = localize::flood_fill(open, part);
    Mask more = grown;
    for (std::size_t i = 0; i < more.data.size(); ++i)
        if (part.data[i] != 0) more.data[i] = 0;
    const double rim = blur_of(change.width);  // the blur alone makes a rim of this width
    more = localize::dilate(localize::dilate(more, -rim), rim);
    for (std::size_t i = 0; i < more.data.size(); ++i)
        more.data[i] = part.data[i] | (more.data[i] & grown.data[i]);
    return more;
}

double mean_difference(const Image& one, const Image& other) {
    double sum = 0;
    for (std::size_t i = 0; i < one.data.size(); ++i) sum += std::abs(one.data[i] - other.data[i]);
    return sum / static_cast<double>(std::max<std::size_t>(1, one.data.size()));
}

}  // namespace

Image change_map(const Image& before, const Image& after, double blur_px) {
    GSE_CHECK_EQ(before.data.size(), after.data.size());
    Image change(before.width, before.height, 1);
    for (std::size_t i = 0; i < change.data.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            change.data[i] =
                std::max(change.data[i], std::abs(before.data[i * 3 + c] - after.data[i * 3 + c]));
    return box_blurred(change, static_cast<int>(std::lround(blur_px)));
}

ChangedPart changed_part(const Image& before, std::span<const Image> after) {
    ChangedPart part;
    part.map = Image(before.width, before.height, 1);
    part.mask = Mask(before.width, before.height);
    if (after.empty()) return part;
    Image change = common_change(before, after);
    if (!take_floor_off(change)) {
        part.found = ChangeFound::Everywhere;
        return part;
    }
    const auto [level, two_kinds] = part_level(change);
    part.level = level;
    if (share_above(change, two_kinds ? level : LeastLevel) > MostPart) {
        part.found = ChangeFound::Everywhere;
        return part;
    }
    const auto largest = *std::max_element(change.data.begin(), change.data.end());
    if (largest <= part.level) return part;
    Image scaled = change;
    for (auto& value : scaled.data) value /= largest;
    const auto pixels = static_cast<double>(change.data.size());
    Mask mask = localize::threshold_map(scaled, part.level / largest);
    // Distances of neighbours: four, and those across corners.
    mask = localize::clean_clusters(mask, scaled, {1.5, 1}, KeptMass);
    mask = localize::without_holes(grown_part(change, mask, part.level));
    if (static_cast<double>(mask.count()) < LeastPart * pixels) return part;
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (mask.data[i] == 0) continue;
        const double sure = 0.5 + (change.data[i] - part.level) / (2 * Softness * part.level);
        part.map.data[i] = static_cast<float>(std::clamp(sure, 0.5 + Softness, 1.0));  // holes too
    }
    part.mask = std::move(mask);
    part.found = ChangeFound::Part;
    return part;
}

Image aligned(const Image& before, Image drawn) {
    Mask changed(before.width, before.height);
    constexpr int Passes = 2;  // the second leaves out what the first finds changed
    for (int pass = 0; pass < Passes; ++pass) {
        const auto similarity = register_pictures(before, drawn, changed);
        if (!similarity) break;
        Image moved = moved_back(drawn, *similarity);
        const auto part = changed_part(before, std::span(&moved, 1));
        if (pass + 1 < Passes && part.found == ChangeFound::Part) {
            changed = localize::dilate(part.mask, 2);
            continue;
        }
        return mean_difference(before, moved) < mean_difference(before, drawn) ? moved : drawn;
    }
    return drawn;
}

Image outline_of_change(const Image& change, const Mask& mask) {
    GSE_CHECK_EQ(change.data.size(), mask.data.size());
    Histogram histogram{};
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0) count_value(histogram, change.data[i]);
    Image outline(change.width, change.height, 1);
    if (mask.count() == 0) return outline;
    const double level = std::max(LeastLevel, otsu_classes(histogram).level);
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0)
            outline.data[i] =
                static_cast<float>(std::clamp(0.5 + (change.data[i] - level) / (Softness * level), 0.0, 1.0));
    return outline;
}

}  // namespace gse::remote
