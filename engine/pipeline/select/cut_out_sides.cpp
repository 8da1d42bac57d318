// Candidates, views around them, one outline after the other, votes.
#include "engine/pipeline/select/cut_out_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <span>

#include "engine/base/error.h"
#include "engine/localize/back_projection.h"
#include "engine/localize/clusters.h"
#include "engine/localize/propagate_labels.h"
#include "engine/math/quantile.h"

namespace gse::pipeline {
namespace {

constexpr int Side = 256;  // pixels of a picture
constexpr double Fov = 40 * Degree;
constexpr double Behind = 2;  // how far behind its front a thing may reach, in its longer side on the screen
constexpr double Gap = 0.1;   // of its longer side: what lies farther behind it is something else
constexpr double Half = 0.5;  // of what a pixel shows, or of a row's votes
constexpr double LeastSeen = 0.3;       // of the candidates' pixels: less where something stands in the way
constexpr double LeastAgreement = 0.4;  // IoU of outline and expectation
// How probably a row that no view has shown yet is the thing's: above a half, its other sides are.
constexpr float Unseen = 0.6f;

/// Places of the views: turned from the first one about the vertical, and raised. Those next to known sides
/// come first.
struct Turn {
    double azimuth = 0, raised = 0;  // degrees
};
constexpr std::array<Turn, 10> Turns{
    {{40, 0}, {-40, 0}, {0, 40}, {80, 0}, {-80, 0}, {120, 0}, {-120, 0}, {180, 40}, {160, 0}, {-160, 0}}};

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
        const auto at = [&](double share) { return static_cast<double>(lower_quantile(values, share)); };
        bounds.low[axis] = at(trim), bounds.high[axis] = at(1 - trim);
    }
    return bounds;
}

std::optional<edit::BoxPrompt> box_of(const Mask& mask) {
    const auto box = localize::bounds_of(mask);
    if (box.width == 0) return std::nullopt;
    return edit::BoxPrompt{1.0 * box.left, 1.0 * box.top, 1.0 * box.left + box.width,
                           1.0 * box.top + box.height};
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

/// Those of `rows` that a way of neighbouring cells joins to the front: what stands behind a gap is another
/// thing.
void keep_joined(const GaussianSet& set, const std::vector<std::uint8_t>& front, double cell,
                 std::vector<std::uint8_t>& rows) {
    using Cell = std::array<std::int64_t, 3>;
    const auto positions = set.spans().position;
    const auto cell_of = [&](std::size_t row) {
        Cell at{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] =
                static_cast<std::int64_t>(std::floor(static_cast<double>(positions[row * 3 + axis]) / cell));
        return at;
    };
    std::map<Cell, bool> reached;  // of the cells that hold a row
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) reached.emplace(cell_of(row), false);
    std::vector<Cell> open;
    const auto reach = [&](const Cell& at) {
        const auto found = reached.find(at);
        if (found == reached.end() || found->second) return;
        found->second = true;
        open.push_back(at);
    };
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (front[row] != 0) reach(cell_of(row));
    while (!open.empty()) {
        const Cell at = open.back();
        open.pop_back();
        for (std::int64_t z = -1; z <= 1; ++z)
            for (std::int64_t y = -1; y <= 1; ++y)
                for (std::int64_t x = -1; x <= 1; ++x) reach({at[0] + x, at[1] + y, at[2] + z});
    }
    for (std::size_t row = 0; row < rows.size(); ++row)
        rows[row] &= rows[row] != 0 && reached[cell_of(row)] ? 1 : 0;
}

/// Rows that touch each other, by cells that their ellipsoids reach.
class Parts {
public:
    Parts(const GaussianSet& set, double cell)
        : positions_(set.spans().position), scales_(set.spans().log_scale), cell_(cell),
          parents_(set.size()) {
        std::iota(parents_.begin(), parents_.end(), 0u);
    }
    void add(std::uint32_t row) {
        constexpr double deviations = 2, most = 4;  // cells
        double widest = 0;
        std::array<std::int64_t, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            widest = std::max(widest, std::exp(static_cast<double>(scales_[row * std::size_t{3} + axis])));
            at[axis] = static_cast<std::int64_t>(
                std::floor(static_cast<double>(positions_[row * std::size_t{3} + axis]) / cell_));
        }
        const auto reach =
            static_cast<std::int64_t>(std::clamp(std::ceil(deviations * widest / cell_), 1.0, most));
        for (std::int64_t z = -reach; z <= reach; ++z)
            for (std::int64_t y = -reach; y <= reach; ++y)
                for (std::int64_t x = -reach; x <= reach; ++x)
                    join(row, owners_.try_emplace({at[0] + x, at[1] + y, at[2] + z}, row).first->second);
    }
    std::uint32_t part_of(std::uint32_t row) {
        while (parents_[row] != row) row = parents_[row] = parents_[parents_[row]];
        return row;
    }

private:
    void join(std::uint32_t a, std::uint32_t b) { parents_[part_of(a)] = part_of(b); }

    std::span<const float> positions_, scales_;
    double cell_;
    std::vector<std::uint32_t> parents_;
    std::map<std::array<std::int64_t, 3>, std::uint32_t> owners_;  // of each cell that is reached
};

/// Takes in the candidates that hang on nothing but the thing: crumbs that no view gave to it, and that would
/// float where it goes.
void take_in_crumbs(const GaussianSet& set, const std::vector<std::uint8_t>& candidates, const Bounds& bounds,
                    std::vector<std::uint8_t>& rows) {
    constexpr double cell_share = 0.03, around = 0.25,
                     // Shares of the longest side, and of the object's rows: more of them are something else.
        most = 0.05;
    const Vec3 sides = bounds.high - bounds.low;
    const double longest = std::max({sides[0], sides[1], sides[2]});
    if (!(longest > 0)) return;
    const auto positions = set.spans().position;
    const auto near = [&](std::size_t row) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto value = static_cast<double>(positions[row * 3 + static_cast<std::size_t>(axis)]);
            if (!(value > bounds.low[axis] - around * longest &&
                  value < bounds.high[axis] + around * longest))
                return false;
        }
        return true;
    };
    Parts parts(set, cell_share * longest);
    std::vector<std::uint32_t> left;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] == 0 && near(row))
            left.push_back(static_cast<std::uint32_t>(row)), parts.add(left.back());
    std::map<std::uint32_t, std::size_t>
        sizes;  // of the parts; those with a row that cannot be the thing are too large
    const auto thing = static_cast<std::size_t>(std::count(rows.begin(), rows.end(), std::uint8_t{1}));
    for (const auto row : left) sizes[parts.part_of(row)] += candidates[row] != 0 ? 1 : rows.size();
    for (const auto row : left)
        if (static_cast<double>(sizes[parts.part_of(row)]) < most * static_cast<double>(thing)) rows[row] = 1;
}

/// The rows that can be the thing.
std::vector<std::uint8_t> candidates_of(const GaussianSet& set, const SeenThing& seen) {
    std::vector<double> depths;
    for (std::size_t row = 0; row < set.size(); ++row)
        if (seen.front[row] != 0) depths.push_back(depth_of(set, seen.camera, row));
    std::vector<std::uint8_t> rows = seen.front;
    if (depths.empty()) return rows;
    std::sort(depths.begin(), depths.end());
    const auto at = [&](double share) {
        return depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))];
    };
    const auto box = box_of(seen.mask);
    const double longer =
        box ? std::max((box->x1 - box->x0) / seen.camera.fx, (box->y1 - box->y0) / seen.camera.fy) * at(0.5)
            : 0;
    const double nearest = at(0.02) - 0.1 * longer, farthest = at(0.98) + Behind * longer;
    for (std::size_t row = 0; row < set.size(); ++row) {
        if (seen.cone[row] == 0) continue;
        const double depth = depth_of(set, seen.camera, row);
        if (depth >= nearest && depth <= farthest) rows[row] = 1;
    }
    if (longer > 0) keep_joined(set, seen.front, Gap * longer, rows);
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
    if (length(level) < 1e-3)
        // Seen from right above.
        level = up * dot(seen.camera.rotation.row(1), up) - seen.camera.rotation.row(1);
    level = normalized(level);
    const Vec3 side = cross(up, level);
    std::vector<Camera> cameras;
    for (const auto& turn : Turns) {
        const double azimuth = turn.azimuth * Degree;
        const double height =
            std::clamp(std::clamp(elevation, 5 * Degree, 35 * Degree) + turn.raised * Degree, -1.3, 1.3);
        const Vec3 outward =
            (level * std::cos(azimuth) + side * std::sin(azimuth)) * std::cos(height) + up * std::sin(height);
        cameras.push_back(Camera::look_at(centre + outward * distance, centre, up, Fov, Side, Side));
    }
    return cameras;
}

/// Rows known after some views.
class Knowledge {
public:
    explicit Knowledge(const std::vector<std::uint8_t>& candidates)
        : candidates_(candidates), masked_(candidates.size()), total_(candidates.size()) {}
    void vote(std::span<const double> masked, std::span<const double> total) {
        for (std::size_t row = 0; row < masked_.size(); ++row)
            masked_[row] += masked[row], total_[row] += total[row];
    }
    bool known(std::size_t row) const { return total_[row] > LeastEvidence; }
    bool inside(std::size_t row) const {
        return candidates_[row] != 0 && known(row) && masked_[row] > Half * total_[row];
    }
    /// [N] 1 for rows that count, `unseen` for candidates that no view has shown yet, 0 for the rest.
    void expectation(float unseen, std::vector<float>& values) const {
        values.assign(masked_.size(), 0);
        for (std::size_t row = 0; row < values.size(); ++row)
            if (candidates_[row] != 0) values[row] = known(row) ? (inside(row) ? 1.0f : 0.0f) : unseen;
    }
    LabelField field() const {
        LabelField result;
        result.probability.resize(masked_.size());
        result.coverage = total_;
        for (std::size_t row = 0; row < masked_.size(); ++row)
            if (total_[row] > 0)
                result.probability[row] =
                    candidates_[row] != 0 ? static_cast<float>(masked_[row] / total_[row]) : 0.0f;
        return result;
    }

private:
    static constexpr double LeastEvidence = 0.5;  // pixels, as propagate_labels_knn counts
    const std::vector<std::uint8_t>& candidates_;
    std::vector<double> masked_, total_;
};

/// Votes view by view.
class Follower {
public:
    Follower(const GaussianSet& set, const std::vector<std::uint8_t>& candidates,
             const raster::Settings& settings, edit::Segmenter& segmenter, Painter& painter)
        : set_(set), settings_(settings), segmenter_(segmenter), painter_(painter),
          candidates_(candidates.begin(), candidates.end()), alone_(set.filtered(candidates)),
          ones_(alone_.size(), 1), masked_(set.size()), total_(set.size()) {}

    void first(const SeenThing& seen, Knowledge& knowledge) {
        Mask mask = seen.mask;
        close_holes(mask, above_half(shown(set_, seen.camera, candidates_)));
        vote(seen.camera, mask, knowledge);
    }

    void look(const Camera& camera, Knowledge& knowledge) {
        const Mask possible = above_half(shown(set_, camera, candidates_));
        if (hidden(camera, possible)) return;
        knowledge.expectation(Unseen, values_);
        const Image expected = shown(set_, camera, values_);
        const Mask before = above_half(expected);
        const auto box = box_of(before);
        if (!box) return;
        Mask mask = segmenter_.segment(picture_of(camera), {}, *box, expected);
        for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] &= possible.data[i];
        close_holes(mask, possible);
        if (localize::mask_iou(mask, before) >= LeastAgreement) vote(camera, mask, knowledge);
    }

private:
    Image picture_of(const Camera& camera) {
        Image picture = painter_.paint(set_.spans(), camera, settings_).colour;
        for (auto& value : picture.data) value = std::clamp(value, 0.0f, 1.0f);
        return picture;
    }
    Image shown(const GaussianSet& set, const Camera& camera, const std::vector<float>& values) {
        Image image;
        painter_.rasterizer().forward_values(set.spans(), camera, settings_, values, image);
        return image;
    }
    /// Tells whether something stands in the way of most of the candidates.
    bool hidden(const Camera& camera, const Mask& possible) {
        const Mask whole = above_half(shown(alone_, camera, ones_));
        std::size_t pixels = 0, seen = 0;
        for (std::size_t i = 0; i < whole.data.size(); ++i)
            pixels += whole.data[i], seen += whole.data[i] & possible.data[i];
        return pixels == 0 || static_cast<double>(seen) < LeastSeen * static_cast<double>(pixels);
    }
    void vote(const Camera& camera, const Mask& mask, Knowledge& knowledge) {
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
    std::vector<float> candidates_;  // [N] 1 for the rows that can be the thing
    GaussianSet alone_;              // these rows only
    std::vector<float> ones_;
    std::vector<double> masked_, total_;
    std::vector<float> values_;
};

}  // namespace

void close_holes(Mask& mask, const Mask& possible) {
    std::vector<std::uint8_t> outside(mask.data.size(), 0);
    std::vector<int> open;
    const auto reach = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= mask.width || y >= mask.height) return;
        const int at = y * mask.width + x;
        const auto place = static_cast<std::size_t>(at);
        if (mask.data[place] != 0 || outside[place] != 0) return;
        outside[place] = 1;
        open.push_back(at);
    };
    for (int x = 0; x < mask.width; ++x) reach(x, 0), reach(x, mask.height - 1);
    for (int y = 0; y < mask.height; ++y) reach(0, y), reach(mask.width - 1, y);
    while (!open.empty()) {
        const int x = open.back() % mask.width, y = open.back() / mask.width;
        open.pop_back();
        reach(x - 1, y), reach(x + 1, y), reach(x, y - 1), reach(x, y + 1);
    }
    for (std::size_t i = 0; i < outside.size(); ++i)
        if (outside[i] == 0) mask.data[i] |= possible.data[i];
}

std::vector<std::uint8_t> follow_around(const GaussianSet& set, const SeenThing& seen,
                                        const raster::Settings& settings, edit::Segmenter& segmenter,
                                        Painter& painter, const JobControl& control) {
    const auto candidates = candidates_of(set, seen);
    const auto bounds = bounds_of(set, candidates);
    if (!bounds) return candidates;
    Knowledge knowledge(candidates);
    Follower follower(set, candidates, settings, segmenter, painter);
    follower.first(seen, knowledge);
    const auto cameras = cameras_around(seen, *bounds);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "cutting out the thing was stopped");
        control.report("cutting it out from all sides", static_cast<int>(i),
                       static_cast<int>(cameras.size()));
        follower.look(cameras[i], knowledge);
    }
    const auto field = localize::propagate_labels_knn(set.spans(), {}, knowledge.field(), &painter.pool());
    std::vector<std::uint8_t> rows(set.size(), 0);
    for (std::size_t row = 0; row < rows.size(); ++row)
        rows[row] = candidates[row] != 0 && static_cast<double>(field.probability[row]) > Half ? 1 : 0;
    take_in_crumbs(set, candidates, *bounds, rows);
    return rows;
}

}  // namespace gse::pipeline
