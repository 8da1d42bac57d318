// One colour times how bright a pixel is beside the others.
#include "engine/edit/target_views/strategies/default_ground_colour.h"

#include <algorithm>
#include <cmath>

#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"
#include "engine/math/quantile.h"

namespace gse::edit {
namespace {

// Shade is the luminance over the median of all views, to this power (a dark scan is lit unevenly), within
// these limits.
constexpr float ShadePower = 0.5f, DarkestShade = 0.45f, BrightestShade = 1.12f;

/// Median over the pixels of all masks; 0 if they hold nothing.
float median_luminance(const std::vector<EditView>& views) {
    std::vector<float> values;
    for (const auto& view : views)
        for (std::size_t p = 0; p < view.mask.data.size(); ++p)
            if (view.mask.data[p] != 0) values.push_back(luma_of(view.original, p));
    return values.empty() ? 0 : upper_median(values);
}

}  // namespace

std::optional<std::array<float, 3>> default_ground_colour(const language::EditSentence& sentence,
                                                          language::EditMode mode,
                                                          const ModelTraits& traits) {
    if (mode != language::EditMode::Modify || language::is_described(sentence.prompt(), sentence.target()))
        return std::nullopt;
    const auto found = traits.ground_colours.find(sentence.target());
    return found == traits.ground_colours.end() ? std::nullopt : std::optional(found->second);
}

double gone_towards(const std::array<float, 3>& colour, const ViewTargets& round) {
    constexpr float changed = 0.02f;
    constexpr double near = 0.1;  // of the RGB cube's side: nothing can be said of where the pictures went
    std::array<double, 3> before{}, after{};
    double pixels = 0;
    for (const auto& view : round.views)
        for (std::size_t p = 0; p < view.before->data.size() && !view.dropped; p += 3) {
            float most = 0;
            for (std::size_t c = 0; c < 3; ++c)
                most = std::max(most, std::abs(view.after->data[p + c] - view.before->data[p + c]));
            if (most <= changed) continue;
            ++pixels;
            for (std::size_t c = 0; c < 3; ++c)
                before[c] += view.before->data[p + c], after[c] += view.after->data[p + c];
        }
    double left = 0, all = 0;
    for (std::size_t c = 0; c < 3 && pixels > 0; ++c) {
        left += std::pow(after[c] / pixels - colour[c], 2);
        all += std::pow(before[c] / pixels - colour[c], 2);
    }
    if (pixels == 0) return 0;
    return std::sqrt(all) < near ? 1 : 1 - std::sqrt(left / all);
}

EditedViews DefaultGroundColour::edit(const std::vector<EditView>& views, const EditViewsRequest&,
                                      const JobControl&) {
    EditedViews targets;
    const float median = std::max(median_luminance(views), 1e-3f);
    for (const auto& view : views) {
        Image& image = targets.images.emplace_back(view.rendered);
        for (std::size_t p = 0; p < view.mask.data.size(); ++p) {
            if (view.mask.data[p] == 0) continue;
            const float shade = std::clamp(std::pow(luma_of(view.original, p) / median, ShadePower),
                                           DarkestShade, BrightestShade);
            for (std::size_t c = 0; c < 3; ++c) image.data[p * 3 + c] = std::min(colour_[c] * shade, 1.0f);
        }
    }
    return targets;
}

}  // namespace gse::edit
