// Points of one view are looked up in the others by depth.
#include "engine/edit/target_views/view_agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/base/check.h"
#include "engine/localize/clusters.h"
#include "engine/math/quantile.h"
#include "engine/math/unproject.h"

namespace gse::edit {
namespace {

// Relative difference of two depths of one point: VICA-NeRF's 1 % of the width, twice.
constexpr double SameDepth = 0.02;
constexpr std::size_t LeastSeen = 3;  // views of a point: of two, none is the odd one
constexpr double HardlyAnything = 4.0 / 255;
constexpr double MostUnchanged = 0.5;  // the limits of METHOD.md, Agreement of views
constexpr double MostDisagreement = 0.2;
constexpr double LeastChroma = 0.1;  // of views of which it can be said that they lose colour
constexpr double LeastKept = 0.7;
constexpr double TrustedDistance = 0.15, LeastTrust = 0.1;  // METHOD.md, Agreement of views
// Share of the change at the rim of a mask that cuts it off (METHOD.md, Agreement of views).
constexpr double MostAtRim = 0.35;
constexpr double MoreThanElsewhere = 1.1;  // what turns a thin thing red evenly is not cut off
constexpr double RimCells = 2,
                 CellsPerSide = 64;  // of Stable Diffusion's latents; the same share of smaller pictures

/// Pixel of a view that shows the point, or -1.
std::ptrdiff_t pixel_that_shows(const EditView& view, const Vec3& point) {
    const Camera& camera = view.view.camera;
    const Vec3 seen = camera.to_camera(point);
    if (!(seen.z > 0)) return -1;
    const double x = std::floor(camera.fx * seen.x / seen.z + camera.cx),
                 y = std::floor(camera.fy * seen.y / seen.z + camera.cy);
    if (!(x >= 0 && y >= 0 && x < view.depth.width && y < view.depth.height)) return -1;
    const auto pixel = static_cast<std::ptrdiff_t>(y) * view.depth.width + static_cast<std::ptrdiff_t>(x);
    const double depth = view.depth.data[static_cast<std::size_t>(pixel)];
    return depth > 0 && std::abs(depth - seen.z) <= SameDepth * seen.z ? pixel : -1;
}

Vec3 point_of(const EditView& view, int x, int y) {
    return unprojected(view.view.camera, x + 0.5, y + 0.5, static_cast<double>(view.depth.at(x, y, 0)));
}

/// Colours of one point in all views that show it.
class PointColours {
public:
    PointColours(const std::vector<EditView>& views, const std::vector<Image>& pictures)
        : views_(views), pictures_(pictures) {}

    /// Finds the point that a pixel of view `of` shows. Returns false if it shows none inside the mask, or
    /// too few views show it.
    bool look(std::size_t of, int x, int y) {
        if (views_[of].mask.at(x, y) == 0 || !(views_[of].depth.at(x, y, 0) > 0)) return false;
        const Vec3 point = point_of(views_[of], x, y);
        for (auto& channel : values_) channel.clear();
        for (std::size_t v = 0; v < views_.size(); ++v) {
            const auto pixel = pixel_that_shows(views_[v], point);
            if (pixel < 0) continue;
            for (std::size_t c = 0; c < 3; ++c)
                values_[c].push_back(pictures_[v].data[static_cast<std::size_t>(pixel) * 3 + c]);
        }
        return values_[0].size() >= LeastSeen;
    }
    /// Distance of the pixel looked up last from the median over the views; mean over the channels.
    double distance(std::size_t of, int x, int y) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c)
            sum += std::abs(pictures_[of].at(x, y, static_cast<int>(c)) - upper_median(values_[c]));
        return sum / 3;
    }

private:
    const std::vector<EditView>& views_;
    const std::vector<Image>& pictures_;
    std::array<std::vector<float>, 3> values_;
};

/// Sum of distances from medians, and their number.
struct Distances {
    double sum = 0;
    std::size_t points = 0;
    double mean() const { return points > 0 ? sum / static_cast<double>(points) : 0; }
};

void add_distances(const EditView& view, std::size_t v, PointColours& colours, Distances& distances) {
    for (int y = 0; y < view.depth.height; ++y)
        for (int x = 0; x < view.depth.width; ++x) {
            if (!colours.look(v, x, y)) continue;
            distances.sum += colours.distance(v, x, y);
            ++distances.points;
        }
}

double disagreement_of(const std::vector<EditView>& views, const std::vector<Image>& pictures) {
    PointColours colours(views, pictures);
    Distances distances;
    for (std::size_t v = 0; v < views.size(); ++v) add_distances(views[v], v, colours, distances);
    return distances.mean();
}

/// Change of a pixel inside the mask; mean over the channels.
double change_at(const EditView& view, const Image& picture, std::size_t pixel) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
        sum += std::abs(picture.data[pixel * 3 + c] - view.original.data[pixel * 3 + c]);
    return sum / 3;
}

Mask inverse(Mask mask) {
    for (auto& bit : mask.data) bit = bit != 0 ? 0 : 1;
    return mask;
}

struct Change {
    double all = 0, at_rim = 0;
    std::size_t pixels = 0, rim_pixels = 0;
};

Change change_of(const EditView& view, const Image& picture) {
    Change change;
    const Mask near_rim = localize::dilate(inverse(view.mask), RimCells * view.mask.width / CellsPerSide);
    for (std::size_t i = 0; i < view.mask.data.size(); ++i) {
        if (view.mask.data[i] == 0) continue;
        const double here = change_at(view, picture, i);
        change.all += here;
        if (near_rim.data[i] != 0) change.at_rim += here, ++change.rim_pixels;
        ++change.pixels;
    }
    return change;
}

}  // namespace

std::map<std::string, double> ViewAgreement::scalars() const {
    return {{"disagreement", disagreement}, {"unchanged_views", unchanged}, {"change_at_rim", at_rim}};
}

ViewAgreement view_agreement(const std::vector<EditView>& views, const std::vector<Image>& pictures) {
    GSE_CHECK_EQ(views.size(), pictures.size());
    ViewAgreement agreement;
    if (views.empty()) return agreement;
    double all = 0, at_rim = 0;
    std::size_t unchanged = 0, pixels = 0, rim_pixels = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto change = change_of(views[v], pictures[v]);
        all += change.all;
        at_rim += change.at_rim;
        pixels += change.pixels;
        rim_pixels += change.rim_pixels;
        unchanged += change.all <= HardlyAnything * static_cast<double>(change.pixels) ? 1 : 0;
    }
    agreement.unchanged = static_cast<double>(unchanged) / static_cast<double>(views.size());
    agreement.at_rim = all > 0 ? at_rim / all : 0;
    agreement.rim_share = pixels > 0 ? static_cast<double>(rim_pixels) / static_cast<double>(pixels) : 0;
    agreement.disagreement = disagreement_of(views, pictures);
    return agreement;
}

std::vector<double> view_disagreements(const std::vector<EditView>& views,
                                       const std::vector<Image>& pictures) {
    GSE_CHECK_EQ(views.size(), pictures.size());
    PointColours colours(views, pictures);
    std::vector<double> means;
    for (std::size_t v = 0; v < views.size(); ++v) {
        Distances distances;
        add_distances(views[v], v, colours, distances);
        means.push_back(distances.mean());
    }
    return means;
}

std::vector<Image> trust_weights(const std::vector<EditView>& views, const std::vector<Image>& pictures) {
    GSE_CHECK_EQ(views.size(), pictures.size());
    PointColours colours(views, pictures);
    std::vector<Image> weights;
    for (std::size_t v = 0; v < views.size(); ++v) {
        Image weight(views[v].depth.width, views[v].depth.height, 1);
        std::fill(weight.data.begin(), weight.data.end(), 1.0f);
        for (int y = 0; y < weight.height; ++y)
            for (int x = 0; x < weight.width; ++x) {
                if (!colours.look(v, x, y)) continue;
                weight.at(x, y, 0) = static_cast<float>(
                    std::max(LeastTrust, std::exp(-colours.distance(v, x, y) / TrustedDistance)));
            }
        weights.push_back(std::move(weight));
    }
    return weights;
}

bool hardly_edited(const ViewAgreement& agreement) { return agreement.unchanged > MostUnchanged; }

double mean_chroma(const Image& picture, const Mask& mask) {
    GSE_CHECK_EQ(mask.data.size(), picture.pixel_count());
    double sum = 0;
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (mask.data[i] == 0) continue;
        const auto [least, most] =
            std::minmax({picture.data[i * 3], picture.data[i * 3 + 1], picture.data[i * 3 + 2]});
        sum += static_cast<double>(most) - static_cast<double>(least);
        ++pixels;
    }
    return pixels > 0 ? sum / static_cast<double>(pixels) : 0;
}

double kept_chroma(std::vector<double> of_views, const std::vector<double>& of_scene) {
    if (of_views.empty() || of_scene.empty()) return -1;
    const double usual = upper_median(of_views);
    if (usual < LeastChroma) return -1;
    return std::accumulate(of_scene.begin(), of_scene.end(), 0.0) / static_cast<double>(of_scene.size()) /
           usual;
}

std::string warning_of_chroma(double kept) {
    if (kept < 0 || kept >= LeastKept) return {};
    return fmt::format(
        "the scene has {:.0f} % of the colour of the redrawn views: they cancel each other (drop those that "
        "differ in the "
        "panel Targets), or the fit is too short (fit_steps)",
        100 * kept);
}

std::vector<std::string> warnings_of(const ViewAgreement& agreement, bool anew) {
    std::vector<std::string> warnings;
    if (hardly_edited(agreement))
        warnings.push_back(fmt::format(
            "{:.0f} % of the redrawn views hardly differ from the scene: raise the strength of redrawing "
            "(view_strength), or use words the model knows better",
            100 * agreement.unchanged));
    if (!anew && agreement.disagreement > MostDisagreement)
        warnings.push_back(fmt::format(
            "the redrawn views disagree (by {:.2f} of the colour range): drop those that differ in the panel "
            "Targets, or try another seed",
            agreement.disagreement));
    if (!anew && agreement.at_rim > std::max(MostAtRim, MoreThanElsewhere * agreement.rim_share))
        warnings.push_back(
            fmt::format("{:.0f} % of the change lies at the mask's rim, which may cut it off: let the mask "
                        "grow more (dilate_px), "
                        "or replace the thing (mode replace) where it gets another shape",
                        100 * agreement.at_rim));
    return warnings;
}

}  // namespace gse::edit
