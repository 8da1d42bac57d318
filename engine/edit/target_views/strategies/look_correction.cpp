// Parts of one colour, the light on each, and tones mixed into pictures that lack them.
#include "engine/edit/target_views/strategies/look_correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/log.h"
#include "engine/edit/words/colour_word.h"
#include "engine/math/quantile.h"

namespace gse::edit {
namespace {

constexpr double DarkRank = 0.03, LightRank = 0.97;  // of luma in a part: its shade and its light
constexpr float LeastContrast = 0.3f;  // of luma between them: an even part gets no grain from it
constexpr std::size_t Parts = 5;       // colours of a thing that are told apart, at most
constexpr double OtherColour = 18;     // CIELAB units in a and b between them, at least

using Chroma = std::array<double, 2>;  // a and b of CIELAB

double squared(const Chroma& a, const Chroma& b) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

std::array<double, 3> pixel_of(const Image& picture, std::size_t p) {
    return {picture.data[p * 3], picture.data[p * 3 + 1], picture.data[p * 3 + 2]};
}

Chroma chroma_of(const Image& picture, std::size_t p) {
    const auto lab = lab_of(pixel_of(picture, p));
    return {lab[1], lab[2]};
}

/// Calls call(v, p) for the pixels of all masks.
template <class F> void each_pixel(const std::vector<EditView>& views, F&& call) {
    for (std::size_t v = 0; v < views.size(); ++v)
        for (std::size_t p = 0; p < views[v].mask.data.size(); ++p)
            if (views[v].mask.data[p] != 0) call(v, p);
}

/// Share of the light that a pixel of the unedited thing gets. What is dark by its paint is not in the shade:
/// luma is compared within parts of one hue and chroma (k-means from the farthest colours).
class Shading {
public:
    explicit Shading(const std::vector<EditView>& views) {
        std::vector<Chroma> colours;
        std::vector<float> lumas;
        each_pixel(views, [&](std::size_t v, std::size_t p) {
            colours.push_back(chroma_of(views[v].original, p));
            lumas.push_back(luma_of(views[v].original, p));
        });
        if (colours.empty()) return;
        choose_centres(colours);
        for (int pass = 0; pass < 4; ++pass) move_centres(colours);
        std::vector<std::vector<float>> parts(centres_.size());
        for (std::size_t i = 0; i < colours.size(); ++i) parts[nearest(colours[i])].push_back(lumas[i]);
        for (auto& part : parts) ranges_.push_back(range_of(part));
    }
    /// Part of a pixel, and its share of the light there.
    std::size_t part(const Image& original, std::size_t p) const { return nearest(chroma_of(original, p)); }
    float light(const Image& original, std::size_t p) const {
        const auto& [low, high] = ranges_[part(original, p)];
        return std::clamp((luma_of(original, p) - low) / (high - low), 0.0f, 1.0f);
    }
    std::size_t parts() const { return ranges_.size(); }

private:
    std::size_t nearest(const Chroma& colour) const {
        const auto closer = [&](const Chroma& a, const Chroma& b) {
            return squared(a, colour) < squared(b, colour);
        };
        return static_cast<std::size_t>(std::min_element(centres_.begin(), centres_.end(), closer) -
                                        centres_.begin());
    }
    void choose_centres(const std::vector<Chroma>& colours) {
        Chroma mean{};
        for (const auto& colour : colours)
            for (std::size_t c = 0; c < 2; ++c) mean[c] += colour[c] / static_cast<double>(colours.size());
        centres_ = {mean};
        while (centres_.size() < Parts) {
            const auto away = [&](const Chroma& colour) {
                return squared(colour, centres_[nearest(colour)]);
            };
            const auto farthest =
                *std::max_element(colours.begin(), colours.end(),
                                  [&](const Chroma& a, const Chroma& b) { return away(a) < away(b); });
            if (away(farthest) < OtherColour * OtherColour) return;
            centres_.push_back(farthest);
        }
    }
    void move_centres(const std::vector<Chroma>& colours) {
        std::vector<Chroma> sums(centres_.size());
        std::vector<double> counts(centres_.size());
        for (const auto& colour : colours) {
            const auto part = nearest(colour);
            ++counts[part];
            for (std::size_t c = 0; c < 2; ++c) sums[part][c] += colour[c];
        }
        for (std::size_t i = 0; i < centres_.size(); ++i)
            for (std::size_t c = 0; c < 2 && counts[i] > 0; ++c) centres_[i][c] = sums[i][c] / counts[i];
    }
    static std::array<float, 2> range_of(std::vector<float>& values) {
        if (values.empty()) return {0, 1};
        float low = lower_quantile(values, DarkRank), high = lower_quantile(values, LightRank);
        const float lacking = LeastContrast - (high - low);
        if (lacking > 0) low -= 0.5f * lacking, high += 0.5f * lacking;
        return {low, high};
    }

    std::vector<Chroma> centres_;
    std::vector<std::array<float, 2>> ranges_;  // luma of shade and light, of each part
};

}  // namespace

EditedViews LookCorrection::edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                                 const JobControl& job) {
    auto targets = guidance_.edit(views, input, job);
    if (targets.images.size() != views.size()) return targets;
    const LookTest test(look_);
    const Shading shading(views);
    std::vector<double> all(shading.parts()), with(shading.parts());
    each_pixel(views, [&](std::size_t v, std::size_t p) {
        const auto& original = views[v].original;
        const auto part = shading.part(original, p);
        ++all[part];
        with[part] += test.has(pixel_of(targets.images[v], p), shading.light(original, p)) ? 1 : 0;
    });
    std::vector<float> much(shading.parts());
    for (std::size_t part = 0; part < much.size(); ++part)
        much[part] = static_cast<float>(std::clamp(
            (LookEnough - with[part] / std::max(all[part], 1.0)) / (LookEnough - LookPoor), 0.0, 1.0));
    if (std::any_of(much.begin(), much.end(), [](float share) { return share > 0; }))
        log::info("parts of the redrawn views lack the look that is asked for: they are brought to it");
    double pixels = 0, right = 0;
    each_pixel(views, [&](std::size_t v, std::size_t p) {
        const auto& original = views[v].original;
        const float light = shading.light(original, p), share = much[shading.part(original, p)];
        float* at = &targets.images[v].data[p * 3];
        if (share > 0 && !test.has(pixel_of(targets.images[v], p), light)) {
            const auto tone = look_.tone(light);
            for (std::size_t c = 0; c < 3; ++c) at[c] += share * (tone[c] - at[c]);
        }
        ++pixels;
        right += test.has(pixel_of(targets.images[v], p), light) ? 1 : 0;
    });
    if (pixels > 0) share_ = right / pixels;
    return targets;
}

}  // namespace gse::edit
