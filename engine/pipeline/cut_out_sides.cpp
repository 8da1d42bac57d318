// Candidates, views around them, one outline after the other, votes.
#include "engine/pipeline/cut_out_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/localize/back_projection.h"
#include "engine/localize/spread.h"

namespace gse::pipeline {
namespace {

constexpr int Side = 256;             // pixels of a picture
constexpr double Fov = 40 * Degree;
constexpr double Behind = 2;          // how far behind its front a thing may reach, in its longer side on the screen
constexpr double Half = 0.5;          // of what a pixel shows, or of a row's votes
constexpr double LeastSeen = 0.3;     // of the candidates' pixels: less where something stands in the way
constexpr double LeastAgreement = 0.4;   // IoU of outline and expectation

/// Where the views lie: turned from the first one about the vertical, raised; those next to what is known come first.
struct Turn {
    double azimuth = 0, raised = 0;   // degrees
};
constexpr std::array<Turn, 10> Turns{{{40, 0}, {-40, 0}, {0, 40}, {80, 0}, {-80, 0}, {120, 0}, {-120, 0}, {180, 40}, {160, 0}, {-160, 0}}};

/// Trimmed bounds along the axes.
struct Bounds {
    Vec3 low, high;
};

std::optional<Bounds> bounds_of(const GaussianSet& set, const std::vector<std::uint8_t>& rows) {
    constexpr double trim = 0.02;
    Bounds bounds;
    const auto positions = set.spans().position;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> values;
        for (std::size_t row = 0; row < rows.size(); ++row)
            if (rows[row] != 0) values.push_back(positions[row * 3 + static_cast<std::size_t>(axis)]);
        if (values.empty()) return std::nullopt;
        const auto at = [&](double share) {
            const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
            std::nth_element(values.begin(), place, values.end());
            return static_cast<double>(*place);
        };
        bounds.low[axis] = at(trim), bounds.high[axis] = at(1 - trim);
    }
    return bounds;
}

std::optional<edit::BoxPrompt> box_of(const Mask& mask) {
    edit::BoxPrompt box{1e9, 1e9, -1e9, -1e9};
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (mask.at(x, y) != 0) box = {std::min<double>(box.x0, x), std::min<double>(box.y0, y), std::max<double>(box.x1, x + 1), std::max<double>(box.y1, y + 1)};
    if (box.x1 < box.x0) return std::nullopt;
    return box;
}

Mask above_half(const Image& image) {
    Mask mask(image.width, image.height);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = image.data[i] > Half ? 1 : 0;
    return mask;
}

double depth_of(const GaussianSet& set, const Camera& camera, std::size_t row) {
    const auto positions = set.spans().position;
    const Vec3 at{positions[row * 3], positions[row * 3 + 1], positions[row * 3 + 2]};
    return dot(camera.forward(), at - camera.centre());
}

/// The rows that can be the thing.
std::vector<std::uint8_t> candidates_of(const GaussianSet& set, const SeenThing& seen) {
    std::vector<double> depths;
    for (std::size_t row = 0; row < set.size(); ++row)
        if (seen.front[row] != 0) depths.push_back(depth_of(set, seen.camera, row));
    std::vector<std::uint8_t> rows = seen.front;
    if (depths.empty()) return rows;
    std::sort(depths.begin(), depths.end());
    const auto at = [&](double share) { return depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))]; };
    const auto box = box_of(seen.mask);
    const double longer = box ? std::max((box->x1 - box->x0) / seen.camera.fx, (box->y1 - box->y0) / seen.camera.fy) * at(0.5) : 0;
    const double nearest = at(0.02) - 0.1 * longer, farthest = at(0.98) + Behind * longer;
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (seen.cone[row] == 0) continue;
        const double depth = depth_of(set, seen.camera, row);
        if (depth >= nearest && depth <= farthest) rows[row] = 1;
    }
    return rows;
}

/// Cameras around the bounds of what is known, from far enough for what may come.
std::vector<Camera> cameras_around(const SeenThing& seen, const Bounds& bounds) {
    const Vec3 centre = (bounds.low + bounds.high) * 0.5;
    const double radius = std::max(1e-6, length(bounds.high - bounds.low) * 0.5);
    const double distance = 1.15 * radius / std::sin(Fov / 2);
    const Vec3 up = normalized(seen.up);
    const Vec3 from = normalized(seen.camera.centre() - centre);
    const double elevation = std::asin(std::clamp(dot(from, up), -1.0, 1.0));
    Vec3 level = from - up * dot(from, up);
    if (length(level) < 1e-3) level = up * dot(seen.camera.rotation.row(1), up) - seen.camera.rotation.row(1);   // seen from right above
    level = normalized(level);
    const Vec3 side = cross(up, level);
    std::vector<Camera> cameras;
    for (const auto& turn : Turns) {
        const double azimuth = turn.azimuth * Degree;
        const double height = std::clamp(std::clamp(elevation, 5 * Degree, 35 * Degree) + turn.raised * Degree, -1.3, 1.3);
        const Vec3 outward = (level * std::cos(azimuth) + side * std::sin(azimuth)) * std::cos(height) + up * std::sin(height);
        cameras.push_back(Camera::look_at(centre + outward * distance, centre, up, Fov, Side, Side));
    }
    return cameras;
}

/// What is known of the rows after some views.
class Knowledge {
public:
    explicit Knowledge(const std::vector<std::uint8_t>& candidates) : candidates_(candidates), masked_(candidates.size()), total_(candidates.size()) {}
    void vote(std::span<const double> masked, std::span<const double> total) {
        for (std::size_t row = 0; row < masked_.size(); ++row) masked_[row] += masked[row], total_[row] += total[row];
    }
    bool known(std::size_t row) const { return total_[row] > LeastEvidence; }
    bool inside(std::size_t row) const { return candidates_[row] != 0 && known(row) && masked_[row] > Half * total_[row]; }
    /// [N] 1 for the rows that count.
    void counting(std::vector<float>& values) const {
        values.resize(masked_.size());
        for (std::size_t row = 0; row < values.size(); ++row) values[row] = inside(row) ? 1.0f : 0.0f;
    }
    /// [N] 1 for the candidates that no view has seen.
    void unseen(std::vector<float>& values) const {
        values.resize(masked_.size());
        for (std::size_t row = 0; row < values.size(); ++row) values[row] = candidates_[row] != 0 && !known(row) ? 1.0f : 0.0f;
    }
    localize::LabelWeights weights() const {
        localize::LabelWeights result;
        result.weight.resize(masked_.size());
        result.evidence = total_;
        for (std::size_t row = 0; row < masked_.size(); ++row)
            if (total_[row] > 0) result.weight[row] = candidates_[row] != 0 ? static_cast<float>(masked_[row] / total_[row]) : 0.0f;
        return result;
    }

private:
    static constexpr double LeastEvidence = 0.5;   // pixels, as spread_to_unseen counts
    const std::vector<std::uint8_t>& candidates_;
    std::vector<double> masked_, total_;
};

/// What a view shows, clamped to [0,1].
struct Shot {
    Image colour, alpha;
};

/// Colours of the thing and of what is around it, as the views that voted show them.
class Colours {
public:
    void add(const Shot& shot, const Mask& mask) {
        double inside = 0, outside = 0;
        for (std::size_t p = 0; p < mask.data.size(); ++p)
            if (shot.alpha.data[p] > Half) ++(mask.data[p] != 0 ? inside : outside);
        for (std::size_t p = 0; p < mask.data.size(); ++p)
            if (shot.alpha.data[p] > Half)   // where the scene shows nothing there is no colour
                (mask.data[p] != 0 ? inside_ : outside_)[bin_of(&shot.colour.data[p * 3])] += 1 / (mask.data[p] != 0 ? inside : outside);
    }
    /// How probable it is that a pixel of a side that was not seen yet is the thing's.
    double of_thing(const float* colour) const {
        constexpr double before = 0.6;       // other sides of a thing are what is expected behind its front
        constexpr double strength = 0.002;   // share of a picture that counts as much
        const auto bin = bin_of(colour);
        return (inside_[bin] + before * strength) / (inside_[bin] + outside_[bin] + strength);
    }

private:
    static constexpr std::size_t Levels = 12;   // of a channel
    static std::size_t bin_of(const float* colour) {
        std::size_t bin = 0;
        for (int c = 0; c < 3; ++c) bin = bin * Levels + std::min(Levels - 1, static_cast<std::size_t>(std::clamp(colour[c], 0.0f, 1.0f) * Levels));
        return bin;
    }
    std::vector<double> inside_ = std::vector<double>(Levels * Levels * Levels), outside_ = inside_;
};

/// Votes view by view.
class Follower {
public:
    Follower(const GaussianSet& set, const std::vector<std::uint8_t>& candidates, const raster::Settings& settings, edit::Segmenter& segmenter, Painter& painter)
        : set_(set), settings_(settings), segmenter_(segmenter), painter_(painter), candidates_(candidates.begin(), candidates.end()),
          alone_(set.filtered(candidates)), ones_(alone_.size(), 1), masked_(set.size()), total_(set.size()) {}

    void first(const SeenThing& seen, Knowledge& knowledge) { vote(seen.camera, shot_of(seen.camera), seen.mask, knowledge); }

    void look(const Camera& camera, Knowledge& knowledge) {
        const Mask possible = above_half(shown(set_, camera, candidates_));
        if (hidden(camera, possible)) return;
        const Shot shot = shot_of(camera);
        const Image expected = expectation(camera, shot.colour, knowledge);
        const Mask before = above_half(expected);
        const auto box = box_of(before);
        if (!box) return;
        Mask mask = segmenter_.segment(shot.colour, {}, *box, expected);
        std::size_t both = 0, any = 0;
        for (std::size_t i = 0; i < mask.data.size(); ++i) {
            mask.data[i] &= possible.data[i];
            both += mask.data[i] & before.data[i], any += mask.data[i] | before.data[i];
        }
        if (static_cast<double>(both) >= LeastAgreement * static_cast<double>(any)) vote(camera, shot, mask, knowledge);
    }

private:
    Shot shot_of(const Camera& camera) {
        const auto& painted = painter_.paint(set_.spans(), camera, settings_);
        Shot shot{painted.colour, painted.alpha};
        for (auto& value : shot.colour.data) value = std::clamp(value, 0.0f, 1.0f);
        return shot;
    }
    /// [H,W,1] in [0,1]: what shows rows that count, and of rows that no view has seen what has the thing's colours.
    Image expectation(const Camera& camera, const Image& picture, const Knowledge& knowledge) {
        knowledge.counting(values_);
        Image expected = shown(set_, camera, values_);
        knowledge.unseen(values_);
        const Image unseen = shown(set_, camera, values_);
        for (std::size_t p = 0; p < expected.data.size(); ++p)
            expected.data[p] += unseen.data[p] * static_cast<float>(colours_.of_thing(&picture.data[p * 3]));
        return expected;
    }
    Image shown(const GaussianSet& set, const Camera& camera, const std::vector<float>& values) {
        Image image;
        painter_.rasterizer().forward_values(set.spans(), camera, settings_, values, image);
        return image;
    }
    /// Whether something stands in the way of most of the candidates.
    bool hidden(const Camera& camera, const Mask& possible) {
        const Mask whole = above_half(shown(alone_, camera, ones_));
        std::size_t pixels = 0, seen = 0;
        for (std::size_t i = 0; i < whole.data.size(); ++i) pixels += whole.data[i], seen += whole.data[i] & possible.data[i];
        return pixels == 0 || static_cast<double>(seen) < LeastSeen * static_cast<double>(pixels);
    }
    void vote(const Camera& camera, const Shot& shot, const Mask& mask, Knowledge& knowledge) {
        colours_.add(shot, mask);
        Image image(mask.width, mask.height, 1);
        std::copy(mask.data.begin(), mask.data.end(), image.data.begin());
        std::fill(masked_.begin(), masked_.end(), 0), std::fill(total_.begin(), total_.end(), 0);
        painter_.rasterizer().contributions(set_.spans(), camera, settings_, image, masked_, total_);
        knowledge.vote(masked_, total_);
    }

    const GaussianSet& set_;
    const raster::Settings& settings_;
    edit::Segmenter& segmenter_;
    Painter& painter_;
    std::vector<float> candidates_;   // [N] 1 for the rows that can be the thing
    GaussianSet alone_;               // these rows only
    std::vector<float> ones_;
    std::vector<double> masked_, total_;
    std::vector<float> values_;
    Colours colours_;
};

}  // namespace

std::vector<std::uint8_t> follow_around(const GaussianSet& set, const SeenThing& seen, const raster::Settings& settings, edit::Segmenter& segmenter, Painter& painter,
                                        const JobControl& control) {
    const auto candidates = candidates_of(set, seen);
    const auto bounds = bounds_of(set, candidates);
    if (!bounds) return candidates;
    Knowledge knowledge(candidates);
    Follower follower(set, candidates, settings, segmenter, painter);
    follower.first(seen, knowledge);
    const auto cameras = cameras_around(seen, *bounds);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "cutting out the thing was stopped");
        control.report("cutting it out from all sides", static_cast<int>(i), static_cast<int>(cameras.size()));
        follower.look(cameras[i], knowledge);
    }
    auto weights = knowledge.weights();
    localize::spread_to_unseen(set.spans(), {}, weights, &painter.pool());
    std::vector<std::uint8_t> rows(set.size(), 0);
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = candidates[row] != 0 && static_cast<double>(weights.weight[row]) > Half ? 1 : 0;
    return rows;
}

}  // namespace gse::pipeline
