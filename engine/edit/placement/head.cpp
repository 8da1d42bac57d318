// Slices from the top downwards: a head is as high as wide, and ends where the thing widens.
#include "engine/edit/placement/head.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/language/grammar.h"

namespace gse::edit {
namespace {

constexpr float SeenLogit = -2.2f;     // opacity 0.1: a haze above is no head
constexpr int Steps = 100;             // slices of a thing
constexpr int LeastHead = 8;           // slices: a tip is no head
constexpr double HeadTrim = 0.03;      // of a slice's rows, at either end: a strand, a ray of a crown
constexpr double MostWidening = 1.26;  // from the upper half to the whole: cones have 1.28 and more
constexpr double Elongated = 1.6;      // length over width: a head and what it goes over into, as a neck
constexpr double MostElongated = 3;    // length over width: two ears, the back of a chair
constexpr double Back = 0.1;           // of the height, from the top: what an animal's back is seen in
constexpr double Beside = 0.25;        // of a label's size, around it
constexpr double LeastBeside = 0.1;    // rows there, as a share of the label's
constexpr double LongBack = 2;         // length over width
constexpr double LeastBack = 0.8;      // length over the thing's height
constexpr double HeadSide = 0.75;  // of its width, from its middle: wings and hands beside it are none of it
constexpr double Everywhere = std::numeric_limits<double>::infinity();

struct Row {
    std::size_t row;
    Vec3 at;  // in the frame
};

std::vector<Row> seen_rows(const GaussianSet& set, std::span<const std::uint8_t> bits, const Frame& frame) {
    std::vector<Row> rows;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        if (bits[row] == 0 || !(set.opacity_logit()[row] > SeenLogit)) continue;
        if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
            rows.push_back({row, frame.to_frame({p[0], p[1], p[2]})});
    }
    return rows;
}

/// Rows of a thing from the top downwards.
class TopDown {
public:
    explicit TopDown(std::vector<Row> rows) : rows_(std::move(rows)) {
        if (rows_.empty()) return;
        std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.at.y > b.at.y; });
        std::vector<Vec3> points;
        for (const auto& row : rows_) points.push_back(row.at);
        const Box all = trimmed_box(points, BoundsTrim);
        top_ = all.high.y;
        height_ = all.size().y;
    }

    bool empty() const { return rows_.empty(); }
    double height() const { return height_; }

    /// Rows of the upper `share` of the height.
    std::span<const Row> upper(double share) const {
        const double bottom = top_ - std::min(1.0, share) * height_;
        const auto end = std::partition_point(rows_.begin(), rows_.end(),
                                              [&](const Row& row) { return row.at.y >= bottom; });
        return {rows_.begin(), end};
    }

    /// Horizontal extents of the upper `share` along its principal axes, the shorter first, of rows no
    /// farther than `reach` from `middle` to the side; 0 where there are none.
    std::array<double, 2> extents(double share, const Vec3& middle, double reach) const {
        std::vector<Vec3> near;
        double xx = 0, xz = 0, zz = 0;
        for (const auto& row : upper(share)) {
            const Vec3 from = row.at - middle;
            if (std::hypot(from.x, from.z) > reach) continue;
            xx += from.x * from.x, xz += from.x * from.z, zz += from.z * from.z;
            near.push_back(from);
        }
        if (near.empty()) return {};
        const double longest = 0.5 * std::atan2(2 * xz, xx - zz);
        const double x = std::cos(longest), z = std::sin(longest);
        return {extent(near, -z, x), extent(near, x, z)};
    }

    /// Mean place of the upper `share`.
    Vec3 middle(double share) const {
        const auto rows = upper(share);
        Vec3 sum{};
        for (const auto& row : rows) sum = sum + row.at;
        return rows.empty() ? sum : sum * (1.0 / static_cast<double>(rows.size()));
    }

private:
    /// Along (x, z), without the outermost rows.
    static double extent(const std::vector<Vec3>& points, double x, double z) {
        std::vector<double> along;
        for (const auto& p : points) along.push_back(p.x * x + p.z * z);
        const double low = quantile(along, HeadTrim);
        return quantile(std::move(along), 1 - HeadTrim) - low;
    }

    std::vector<Row> rows_;
    double top_ = 0, height_ = 0;
};

/// Tells whether the thing goes on beside the labelled rows, above their foot: they are a part of it.
bool goes_on_beside(const GaussianSet& set, std::span<const std::uint8_t> bits, const Frame& frame) {
    std::vector<Vec3> points;
    for (const auto& row : seen_rows(set, bits, frame)) points.push_back(row.at);
    if (points.empty()) return false;
    Box near = trimmed_box(points, BoundsTrim);
    const Vec3 margin = near.size() * Beside;
    near.low = near.low + Vec3{-margin.x, margin.y, -margin.z};
    near.high = near.high + Vec3{margin.x, 0, margin.z};
    std::vector<std::uint8_t> others(bits.size());
    for (std::size_t row = 0; row < bits.size(); ++row) others[row] = bits[row] == 0 ? 1 : 0;
    const auto rest = seen_rows(set, others, frame);
    const auto beside =
        std::count_if(rest.begin(), rest.end(), [&](const Row& row) { return near.has(row.at); });
    return static_cast<double>(beside) > LeastBeside * static_cast<double>(points.size());
}

}  // namespace

HeadRegion bust_of(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                   const Vec3& front, double heads) {
    GSE_CHECK_EQ(bits.size(), set.size());
    HeadRegion bust{{bits.begin(), bits.end()}, 1};
    const TopDown thing(seen_rows(set, bits, make_frame(up, front)));
    if (thing.empty()) return bust;
    for (int slices = LeastHead; slices < Steps; ++slices) {
        const double share = static_cast<double>(slices) / Steps;
        const Vec3 middle = thing.middle(share / 2);
        const auto [narrowest, longest] = thing.extents(share / 2, middle, Everywhere);
        const double width = longest > Elongated * narrowest ? narrowest : 0.5 * (narrowest + longest);
        if (!(width > 0) || share * thing.height() < width || longest > MostElongated * width) continue;
        const auto whole = thing.extents(share, middle, width);
        if (whole[0] > MostWidening * narrowest) continue;
        bust.head = share;
        std::fill(bust.bits.begin(), bust.bits.end(), std::uint8_t{0});
        for (const auto& row : thing.upper(heads * share))
            bust.bits[row.row] =
                std::hypot(row.at.x - middle.x, row.at.z - middle.z) <= heads * HeadSide * width ? 1 : 0;
        break;
    }
    return bust;
}

bool is_head_unclear(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                     const Vec3& front, const ModelTraits& traits) {
    if (bust_of(set, bits, up, front).head < traits.small_head) return false;
    const Frame frame = make_frame(up, front);
    const TopDown thing(seen_rows(set, bits, frame));
    if (thing.empty() || goes_on_beside(set, bits, frame)) return false;
    const auto [width, length] = thing.extents(Back, thing.middle(Back), Everywhere);
    return length > LongBack * width && length > LeastBack * thing.height();
}

bool is_worn_at_head(const CheckedRequest& request) {
    const auto& target = request.target();
    return draws_place(request, EditMode::Add) && language::has_usual_place(target) &&
           language::usual_place(target) != "around";
}

AttachmentTarget wearer_of(const CheckedRequest& request, const GaussianSet& set,
                           std::span<const std::uint8_t> bits, const Vec3& up, const Vec3& front, bool drawn,
                           const ModelTraits& traits) {
    const auto& target = request.target();
    if (drawn && is_worn_at_head(request)) {
        auto bust =
            bust_of(set, bits, up, front, language::usual_place(target) == "neck" ? traits.head_and_neck : 1);
        if (bust.head < traits.small_head) {
            const auto standing = standing_alone(set, bust.bits, up, front);
            return {std::move(bust.bits), standing, bust.head};
        }
    }
    return {{bits.begin(), bits.end()}, standing_of(set, bits, up, front)};
}

bool replaces_accessory(const language::EditSentence& sentence, EditMode mode) {
    return mode == EditMode::Replace && language::has_usual_place(sentence.source()) &&
           language::has_usual_place(sentence.target());
}

bool moves_worn_place(const language::EditSentence& sentence, EditMode mode) {
    return replaces_accessory(sentence, mode) &&
           language::usual_place(sentence.source()) != language::usual_place(sentence.target());
}

}  // namespace gse::edit
