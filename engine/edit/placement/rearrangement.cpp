// Maps in the frame of the scene: about the foot for sizes, beside another thing for places.
#include "engine/edit/placement/rearrangement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/edit/placement/free_place.h"
#include "engine/edit/words/change_words.h"
#include "engine/scene/transform/transform_edits.h"

namespace gse::edit {
namespace {

constexpr float LeastShownLogit = -5.5373f;  // opacity 1/255
constexpr double AboveGap = 0.25;            // of a thing's height: how far it floats above another
constexpr double Headroom = 0.9;             // of a thing's height that must fit below another
constexpr double Degree = std::numbers::pi / 180;

double longest_of(const Box& box) {
    const Vec3 size = box.size();
    return std::max({size.x, size.y, size.z});
}

[[noreturn]] void refuse(const char* message, const char* hint) {
    throw Error(ErrorCode::InvalidArgument, message, hint);
}

/// Works out one change in frame coordinates.
class Arranger {
public:
    Arranger(const ThingFrame& thing, const ThingFrame* anchor, std::span<const Vec3> others)
        : thing_(thing), anchor_(anchor), others_(others), foot_(thing.foot()), level_(foot_.y) {}

    void apply(const PlacementChange& change) {
        if (change.needs_anchor() && (anchor_ == nullptr || !anchor_->found()))
            refuse("the other thing that the change names was not found", "label the other thing first");
        switch (change.kind) {
            case ChangeKind::Resize: return resize(change.amount);
            case ChangeKind::MatchSize: return resize(longest_of(anchor_->box) / longest_of(thing_.box));
            case ChangeKind::Stretch: return stretch(change.extent, change.amount);
            case ChangeKind::Move: return move(change);
            case ChangeKind::Place: return place(change.place);
            case ChangeKind::Turn: return turn(change.amount);
            case ChangeKind::Face: return face(change.way);
            case ChangeKind::Flip: return flip();
            case ChangeKind::Mirror: return mirror();
            case ChangeKind::Swap: return swap();
        }
    }

    /// Numbers on top of the words.
    void apply(const RearrangeSettings& numbers) {
        if (numbers.resize != 1) resize(numbers.resize);
        if (numbers.mirror) mirror();
        const Vec3 centre = map_(thing_.box.centre());
        const auto lean = [&](const Vec3& axis, double degrees) {
            add(Affine::turn_about(axis, degrees * Degree, centre));
            leaves_ = drop_ = true;
        };
        if (numbers.roll != 0) lean({0, 0, 1}, -numbers.roll);
        if (numbers.tilt != 0) lean({1, 0, 0}, numbers.tilt);
        if (numbers.turn != 0) turn(numbers.turn);
        const Vec3 by{numbers.move_right, numbers.move_up, numbers.move_forward};
        if (by != Vec3{}) shift(by);
        if (by.y != 0) drop_ = false;
    }

    /// World maps. `copies` is how many there are afterwards.
    Rearrangement result(int copies) {
        if (drop_) put_down();
        Rearrangement result;
        result.thing = in_world(map_);
        result.leaves_place = leaves_;
        result.drop = drop_;
        if (swapped_) result.anchor = in_world(*swapped_);
        for (const Vec3& offset : places_of_copies(moved_box(), copies - 1, others_))
            result.copies.push_back(in_world(Affine::move_by(offset) * map_));
        return result;
    }

private:
    void add(const Affine& next) { map_ = next * map_; }

    void shift(const Vec3& by) {
        add(Affine::move_by(by));
        leaves_ = true;
        drop_ = by.y == 0;
    }

    void resize(double factor) {
        add(Affine::scale_about(factor, map_(foot_)));
        leaves_ = leaves_ || factor < 1;
    }

    void stretch(StretchExtent extent, double factor) {
        const Vec3 size = thing_.box.size();
        const auto along = [&](const Vec3& axis) { add(Affine::stretch_along(axis, factor, foot_)); };
        const Vec3 side{1, 0, 0}, up{0, 1, 0}, front{0, 0, 1};
        leaves_ = factor < 1;
        switch (extent) {
            case StretchExtent::Height: return along(up);
            case StretchExtent::Width: return along(side);
            case StretchExtent::Girth: along(side); return along(front);
            case StretchExtent::Length:
                return along(size.y >= size.x && size.y >= size.z ? up : size.x >= size.z ? side : front);
        }
    }

    void move(const PlacementChange& change) {
        const Vec3 size = thing_.box.size();
        const double own = change.unit == MoveUnit::OwnSize ? change.amount : 0;
        const auto distance = [&](double extent) { return own != 0 ? own * extent : change.amount; };
        switch (change.way) {
            case MoveDirection::Left: return shift({-distance(size.x), 0, 0});
            case MoveDirection::Right: return shift({distance(size.x), 0, 0});
            case MoveDirection::Up: return shift({0, distance(size.y), 0});
            case MoveDirection::Down: return shift({0, -distance(size.y), 0});
            case MoveDirection::Forward: return shift({0, 0, distance(size.z)});
            case MoveDirection::Back: return shift({0, 0, -distance(size.z)});
        }
    }

    void place(AnchorPlace where) {
        const FreePlace free(thing_.box, foot_, others_);
        const Box& anchor = anchor_->box;
        const Vec3 middle = anchor.centre();
        Vec3 to{middle.x, anchor_->foot().y, middle.z};
        switch (where) {
            case AnchorPlace::On: to = free.upon(anchor, anchor_->points); break;
            case AnchorPlace::Above: to.y = anchor.high.y + AboveGap * thing_.box.size().y; break;
            case AnchorPlace::In: break;
            case AnchorPlace::Under:
                if (free.clearance_below(anchor, anchor_->points, to.y) < Headroom * thing_.box.size().y)
                    refuse("there is no room for it under the other thing",
                           "make it smaller first, or put it beside");
                break;
            case AnchorPlace::Beside: to = free.beside(anchor, to); break;
            case AnchorPlace::Left: to = free.next_to(anchor, {-1, 0, 0}, to); break;
            case AnchorPlace::Right: to = free.next_to(anchor, {1, 0, 0}, to); break;
            case AnchorPlace::Behind: to = free.next_to(anchor, {0, 0, -1}, to); break;
            case AnchorPlace::Front: to = free.next_to(anchor, {0, 0, 1}, to); break;
        }
        add(Affine::move_by(to - foot_));
        level_ = to.y;
        leaves_ = true;
        drop_ = where == AnchorPlace::Beside || where == AnchorPlace::Left || where == AnchorPlace::Right ||
                where == AnchorPlace::Behind || where == AnchorPlace::Front;
    }

    void turn(double degrees) {
        add(Affine::turn_about({0, 1, 0}, degrees * Degree, map_(foot_)));
        leaves_ = true;
    }

    void face(MoveDirection way) {
        constexpr double Quarter = 90;
        if (way == MoveDirection::Forward)
            refuse("it faces forward already, as far as the scene tells", "turn it by degrees instead");
        turn(way == MoveDirection::Left ? -Quarter : way == MoveDirection::Right ? Quarter : 2 * Quarter);
    }

    void flip() {
        add(Affine::turn_about({0, 0, 1}, std::numbers::pi, map_(thing_.box.centre())));
        leaves_ = drop_ = true;
    }

    void mirror() {
        add(Affine::mirror_at({1, 0, 0}, map_(thing_.box.centre())));
        leaves_ = true;
    }

    void swap() {
        const Vec3 there = anchor_->foot();
        add(Affine::move_by(there - foot_));
        level_ = there.y;
        swapped_ = Affine::move_by(foot_ - there);
        leaves_ = true;
    }

    /// Bounds of the thing where it goes.
    Box moved_box() const {
        Box box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 p = map_({(corner & 1) != 0 ? thing_.box.high.x : thing_.box.low.x,
                                 (corner & 2) != 0 ? thing_.box.high.y : thing_.box.low.y,
                                 (corner & 4) != 0 ? thing_.box.high.z : thing_.box.low.z});
            box.low = glm::min(box.low, p);
            box.high = glm::max(box.high, p);
        }
        return box;
    }

    /// Lifts or lowers the thing so that its lowest rows are as high above the ground as before.
    void put_down() {
        double low = moved_box().low.y;
        if (!thing_.points.empty()) {
            std::vector<double> heights;
            for (const Vec3& p : thing_.points) heights.push_back(map_(p).y);
            low = quantile(std::move(heights), BoundsTrim);
        }
        const Vec3 foot = map_(foot_);
        const double ground = FreePlace(thing_.box, foot_, others_).ground_below({foot.x, level_, foot.z});
        add(Affine::move_by({0, ground + (thing_.box.low.y - foot_.y) - low, 0}));
    }

    Affine in_world(const Affine& map) const {
        const Mat3 axes = Mat3::from_columns(thing_.frame.side, thing_.frame.up, thing_.frame.front);
        if (map.linear == Mat3::identity()) return Affine::move_by(axes * map.translation);
        return Affine{axes, {}} * map * Affine{axes.transposed(), {}};
    }

    const ThingFrame& thing_;
    const ThingFrame* anchor_;
    std::span<const Vec3> others_;
    Vec3 foot_;
    double level_;  // height of the ground that it stands on
    Affine map_;
    std::optional<Affine> swapped_;
    bool leaves_ = false, drop_ = false;
};

}  // namespace

std::vector<Vec3> other_points(const GaussianSet& set, std::span<const std::uint8_t> bits,
                               const Frame& frame) {
    GSE_CHECK_EQ(bits.size(), set.size());
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        if (bits[row] != 0 || !(set.opacity_logit()[row] > LeastShownLogit)) continue;
        const auto p = set.position().subspan(row * 3, 3);
        if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
            points.push_back(frame.to_frame({p[0], p[1], p[2]}));
    }
    return points;
}

ThingFrame thing_frame(const GaussianSet& set, std::span<const std::uint8_t> bits, const Vec3& up,
                       const Vec3& front) {
    GSE_CHECK_EQ(bits.size(), set.size());
    ThingFrame thing;
    thing.frame = make_frame(up, front);
    std::vector<std::uint8_t> rest(bits.size());
    for (std::size_t row = 0; row < bits.size(); ++row) rest[row] = bits[row] == 0 ? 1 : 0;
    thing.points = other_points(set, rest, thing.frame);
    if (thing.points.empty()) return thing;
    thing.standing = standing_of(set, bits, up, front);
    thing.box = trimmed_box(thing.points, BoundsTrim);
    return thing;
}

Rearrangement rearrangement(const RearrangeSettings& settings, const ThingFrame& thing,
                            const ThingFrame* anchor, std::span<const Vec3> others) {
    if (!thing.found())
        refuse("nothing of the thing that is to be moved can be seen", "label what is to be moved");
    Arranger arranger(thing, anchor, others);
    if (!settings.change.empty()) arranger.apply(placement_change(settings.change));
    arranger.apply(settings);
    return arranger.result(settings.copies);
}

EditNode rearrangement_edit(const DocumentState& state, std::span<const std::uint8_t> rows,
                            std::span<const std::uint8_t> of_anchor, const Rearrangement& places,
                            std::uint64_t id) {
    std::vector<PlacedRows> parts{{rows, places.thing}};
    if (places.anchor) parts.push_back({of_anchor, *places.anchor});
    EditNode node = transform_of(state, parts, id);
    if (places.copies.empty()) return node;
    const EditNode copies = copies_of(state, rows, places.copies, id);
    SceneDelta delta = *node.delta;
    delta.added = copies.delta->added;
    delta.added_rows = copies.delta->added_rows;
    node.name = copies.name;
    node.delta = std::make_shared<const SceneDelta>(std::move(delta));
    return node;
}

}  // namespace gse::edit
