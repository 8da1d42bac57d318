// Halves by height; the head by slices from the top downwards.
#include "engine/edit/placement/body_part.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"
#include "engine/language/lexicon.h"

namespace gse::edit {
namespace {

constexpr float PartSeenLogit = -2.2f;  // opacity 0.1: a haze is no part
constexpr int Slices = 50;              // of a thing's height
constexpr int PlanCells = 24;           // across a thing, of the plan in which pieces are told apart
constexpr double MostRows = 0.6;        // of a thing's: more is the thing itself
constexpr double LeastRows = 0.15;      // of a thing's, that are a head
constexpr double LeastHigh = 0.6, MostHigh = 1.1;  // height of a head over its mean width
// Width of a neck beside what is above and below it. Measured on generated figures: necks of heads that are
// found right have up to 0.81, those of wrong ones 0.82 and more.
constexpr double MostNeck = 0.82;
constexpr double Shoulders = 1.15;      // width below a neck, beside the neck's
constexpr double HeadTrimShare = 0.03;  // of a piece's rows, at either end: a strand, a ray of a crown

struct PartRow {
    std::size_t row;
    Vec3 at;  // in the frame
};

struct Visible {
    std::vector<PartRow> rows;  // from the top downwards
    Box box;                    // without outliers
};

Visible visible_rows(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up) {
    const Frame frame = make_frame(up, {0, 0, -1});
    Visible seen;
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        if (bits[row] == 0 || !(set.opacity_logit()[row] > PartSeenLogit)) continue;
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
        seen.rows.push_back({row, frame.to_frame({p[0], p[1], p[2]})});
        points.push_back(seen.rows.back().at);
    }
    if (points.empty()) return seen;
    seen.box = trimmed_box(points, BoundsTrim);
    std::sort(seen.rows.begin(), seen.rows.end(),
              [](const PartRow& a, const PartRow& b) { return a.at.y > b.at.y; });
    return seen;
}

/// Plan of a thing: its rows seen from above, in pieces that touch each other.
class PlanOfRows {
public:
    explicit PlanOfRows(const Box& box)
        : box_(box), side_(std::max({box.size().x, box.size().z, 1e-9}) / PlanCells) {}

    void add(const Vec3& at) { ++rows_[cell_of(at)]; }

    /// PlanCells [PlanCells * PlanCells] of the piece with the most rows.
    std::array<bool, PlanCells * PlanCells> largest_piece() const {
        std::array<int, PlanCells * PlanCells> piece{};
        std::array<bool, PlanCells * PlanCells> best{};
        int most = 0, count = 0;
        for (int start = 0; start < PlanCells * PlanCells; ++start) {
            if (rows_[start] == 0 || piece[start] != 0) continue;
            const int rows = fill(start, ++count, piece);
            if (rows <= most) continue;
            most = rows;
            for (int cell = 0; cell < PlanCells * PlanCells; ++cell) best[cell] = piece[cell] == count;
        }
        return best;
    }
    int cell_of(const Vec3& at) const {
        const auto index = [&](double value, double low) {
            return std::clamp(static_cast<int>((value - low) / side_), 0, PlanCells - 1);
        };
        return index(at.z, box_.low.z) * PlanCells + index(at.x, box_.low.x);
    }

private:
    int fill(int start, int number, std::array<int, PlanCells * PlanCells>& piece) const {
        std::vector<int> open{start};
        piece[start] = number;
        int rows = 0;
        while (!open.empty()) {
            const int cell = open.back(), x = cell % PlanCells, z = cell / PlanCells;
            open.pop_back();
            rows += rows_[cell];
            for (int dz = -1; dz <= 1; ++dz)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int nx = x + dx, nz = z + dz;
                    if (nx < 0 || nz < 0 || nx >= PlanCells || nz >= PlanCells) continue;
                    const int next = nz * PlanCells + nx;
                    if (rows_[next] == 0 || piece[next] != 0) continue;
                    piece[next] = number;
                    open.push_back(next);
                }
        }
        return rows;
    }

    Box box_;
    double side_;
    std::array<int, PlanCells * PlanCells> rows_{};
};

/// Mean width of the points, without outliers.
double width_of(const std::vector<Vec3>& points) {
    if (points.empty()) return 0;
    const Vec3 size = trimmed_box(points, HeadTrimShare).size();
    return 0.5 * (size.x + size.z);
}

/// One slice of the topmost piece.
struct Slice {
    double width = 0;
    double high = 0;                // height of all down to here, over its mean width
    std::vector<std::size_t> rows;  // of all down to here
};

/// Slices from the top downwards: of the largest piece among what is above.
std::vector<Slice> slices_of(const Visible& seen) {
    PlanOfRows plan(seen.box);
    std::vector<Slice> slices;
    std::size_t count = 0, above = 0;
    for (int i = 1; i <= Slices; ++i, above = count) {
        const double bottom = seen.box.high.y - i * seen.box.size().y / Slices;
        for (; count < seen.rows.size() && seen.rows[count].at.y >= bottom; ++count)
            plan.add(seen.rows[count].at);
        const auto piece = plan.largest_piece();
        Slice slice;
        std::vector<Vec3> points, here;
        for (std::size_t row = 0; row < count; ++row) {
            const auto& [index, at] = seen.rows[row];
            if (!piece[plan.cell_of(at)]) continue;
            slice.rows.push_back(index);
            points.push_back(at);
            if (row >= above) here.push_back(at);
        }
        slice.width = width_of(here);
        const double width = width_of(points);
        slice.high = width > 0 ? trimmed_box(points, HeadTrimShare).size().y / width : 0;
        slices.push_back(std::move(slice));
    }
    return slices;
}

/// The topmost piece down to its neck: the slice that is narrowest beside the widest above and below it.
std::vector<std::size_t> head_among(const Visible& seen) {
    auto slices = slices_of(seen);
    std::vector<double> below(slices.size() + 1, 0);
    for (std::size_t i = slices.size(); i-- > 0;) below[i] = std::max(below[i + 1], slices[i].width);
    const auto share = [&](const Slice& slice) {
        return static_cast<double>(slice.rows.size()) / static_cast<double>(seen.rows.size());
    };
    double above = 0, narrowest = MostNeck;
    Slice* neck = nullptr;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        auto& slice = slices[i];
        if (neck != nullptr && slice.width > Shoulders * neck->width) break;  // further down is another neck
        const double beside = std::min(above, below[i + 1]);
        above = std::max(above, slice.width);
        if (share(slice) < LeastRows || share(slice) > MostRows || slice.high < LeastHigh ||
            slice.high > MostHigh)
            continue;
        if (beside <= 0 || slice.width >= narrowest * beside) continue;
        narrowest = slice.width / beside;
        neck = &slice;
    }
    return neck != nullptr ? std::move(neck->rows) : std::vector<std::size_t>{};
}

}  // namespace

bool is_told_by_shape(std::string_view part) { return language::shape_of_part(part).has_value(); }

std::vector<std::uint8_t> labelled_part(std::string_view part, const GaussianSet& set,
                                        std::span<const std::uint8_t> bits, const Vec3& up) {
    GSE_CHECK_EQ(bits.size(), set.size());
    std::vector<std::uint8_t> result(bits.size(), 0);
    const auto shape = language::shape_of_part(part);
    if (!shape) return result;
    const Visible seen = visible_rows(set, bits, up);
    if (seen.rows.empty()) return result;
    if (*shape == language::PartShape::Head) {
        for (const auto row : head_among(seen)) result[row] = 1;
        return result;
    }
    const double middle = 0.5 * (seen.box.low.y + seen.box.high.y);
    for (const auto& [row, at] : seen.rows)
        result[row] = (at.y >= middle) == (*shape == language::PartShape::UpperHalf) ? 1 : 0;
    return result;
}

}  // namespace gse::edit
