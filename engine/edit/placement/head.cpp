// Slices from the top downwards.
#include "engine/edit/placement/head.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/edit/placement/region_frame.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/language/grammar.h"

namespace gse::edit {
namespace {

constexpr float SeenLogit = -2.2f;    // opacity 0.1: a haze above is no head
constexpr double Steps = 50;          // slices of a thing
constexpr double LeastHead = 0.08;    // of its height: a tip is no head
constexpr double HeadTrim = 0.03;     // of a slice's rows, at either end: a strand, a ray of a crown
constexpr double HeadProportion = 1;  // height over width
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

}  // namespace

HeadRegion bust_of(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                   const Vec3& front, double heads) {
    GSE_CHECK_EQ(bits.size(), set.size());
    HeadRegion bust{{bits.begin(), bits.end()}, 1};
    auto rows = seen_rows(set, bits, make_frame(up, front));
    if (rows.empty()) return bust;
    std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.at.y > b.at.y; });
    std::vector<Vec3> points;
    for (const auto& row : rows) points.push_back(row.at);
    const Box all = trimmed_box(points, BoundsTrim);
    const double height = all.size().y;
    points.clear();
    for (double share = LeastHead; share < 1; share += 1 / Steps) {
        while (points.size() < rows.size() && rows[points.size()].at.y >= all.high.y - share * height)
            points.push_back(rows[points.size()].at);
        if (points.empty()) continue;
        const Vec3 size = trimmed_box(points, HeadTrim).size();
        if (share * height < HeadProportion * 0.5 * (size.x + size.z)) continue;
        bust.head = share;
        const double bottom = all.high.y - std::min(1.0, heads * share) * height;
        std::fill(bust.bits.begin(), bust.bits.end(), std::uint8_t{0});
        for (const auto& row : rows) bust.bits[row.row] = row.at.y >= bottom ? 1 : 0;
        break;
    }
    return bust;
}

AttachmentTarget wearer_of(const CheckedRequest& request, const GaussianSet& set,
                           std::span<const std::uint8_t> bits, const Vec3& up, const Vec3& front, bool drawn,
                           const ModelTraits& traits) {
    const auto& target = request.target();
    const bool at_head = language::has_usual_place(target) && language::usual_place(target) != "around";
    if (drawn && at_head && draws_place(request, EditMode::Add)) {
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
