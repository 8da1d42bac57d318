// Jobs that heal, and placements as one step of undo each.
#include "app/session/place_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "app/session/state/screen_area.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/shown_surface.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/stack_edits.h"
#include "engine/scene/transform/merge.h"
#include "engine/scene/transform/merge_place.h"
#include "ui/widgets/controls.h"

namespace gse::app {

namespace command = ui::command;

bool PlaceController::free_stack() {
    if (!workspace_.require_scene()) return false;
    if (!workspace_.results && !workspace_.jobs->works()) return true;
    workspace_.notices.toast(workspace_.results ? "Apply or discard the edit first."
                                                : "The edit stack can be changed when the job is done.");
    return false;
}

const NamedLabel* PlaceController::labelled() {
    if (!free_stack()) return nullptr;
    const NamedLabel* label = workspace_.active_label();
    if (label != nullptr && count_labelled(*label) > 0) return label;
    workspace_.notices.toast("Nothing is labelled.");
    return nullptr;
}

/// Direction from the scene to who looks at its front.
Vec3 PlaceController::front() const {
    const auto& orbit = view_.orbit();
    return normalized(orbit_camera(orbit, 0, 1, 1).centre() - orbit.centre);
}

// Healing

template <> void PlaceController::on(const command::HealLabelledSplats&) {
    if (const NamedLabel* label = labelled()) heal(state(), label->bits, false);
}

template <> void PlaceController::on(const command::HealPlace&) {
    if (!step_ || !thing_ || workspace_.document.revision() != step_->revision)
        return workspace_.notices.toast("Nothing was just placed.");
    if (thing_->put_in())
        return workspace_.notices.toast("There is no hole to heal: the thing came from another scene.");
    if (labelled() == nullptr) return;
    const bool known = measured_ && measured_->done && !measured_->healed.removed.empty();
    if (known) return take_healed_place(measured_->healed);
    heal(thing_->before(), std::make_shared<const std::vector<std::uint8_t>>(thing_->rows()), true);
}

namespace {

/// Healing of a hole in that state. `stays`: what stood there is elsewhere by now.
std::function<heal::Healed(const JobControl&)> healing_of(
    const DocumentState& from, std::shared_ptr<const std::vector<std::uint8_t>> rows, bool stays) {
    return [set = from.current, rows = std::move(rows), up = from.info.up, stays](const JobControl& control) {
        heal::HealSettings settings;
        settings.held_parts = !stays;
        return heal::remove_and_heal({set, *rows, up, control}, settings);
    };
}

}  // namespace

/// Heals the hole of `rows` in that state. `stays`: they are elsewhere by now, and not deleted.
void PlaceController::heal(const DocumentState& from, std::shared_ptr<const std::vector<std::uint8_t>> rows,
                           bool stays) {
    start_healing(stays ? "Heal the place" : "Delete and heal", from, rows, stays,
                  healing_of(from, rows, stays));
}

void PlaceController::start_healing(const std::string& title, const DocumentState& from,
                                    std::shared_ptr<const std::vector<std::uint8_t>> rows, bool stays,
                                    std::function<heal::Healed(const JobControl&)> healing) {
    auto healed = std::make_shared<heal::Healed>();
    auto work = [healed, healing = std::move(healing)](const JobControl& control) {
        control.report("healing the hole", 0, 0);
        *healed = healing(control);
    };
    auto done = [this, title, from, healed, rows, stays,
                 revision = workspace_.document.revision()](const Error* error) {
        if (error != nullptr) return workspace_.report_end(*error);
        if (workspace_.document.revision() != revision) return;
        if (stays) take_healed_place(*healed);
        else take_healed(title, from, *healed, nullptr);
    };
    workspace_.jobs->start_work(JobKind::Place, {title, work, done, true});
}

void PlaceController::take_healed(const std::string& title, const DocumentState& from,
                                  const heal::Healed& healed,
                                  const std::shared_ptr<const std::vector<std::uint8_t>>& stays) {
    auto gone = healed.removed;
    for (std::size_t row = 0; row < gone.size(); ++row)
        if (stays && (*stays)[row] != 0) gone[row] = 0;
    EditNode node = exchange_of(from, gone, healed.added, workspace_.next_edit_id++);
    const auto removed = node.delta->removed.size(), added = node.delta->added.size();
    if (removed == gone.size() && added == 0)
        return workspace_.notices.toast("That is every splat; an empty scene cannot be kept.");
    if (removed + added == 0) return workspace_.notices.toast("There is no hole to heal.");
    node.name = title;
    auto stack = state().stack;
    stack.push_back(node);
    workspace_.document.apply(node.name, with_stack(state(), std::move(stack)));
    workspace_.toast_step(fmt::format("{} splats are deleted, {} fill the hole.{}{}", ui::count_text(removed),
                                      ui::count_text(added), healed.open.empty() ? "" : " ", healed.open));
}

/// The hole that the placed thing has left is healed, and its shadow goes along.
void PlaceController::take_healed_place(const heal::Healed& healed) {
    if (!thing_ || !step_) return;
    const auto& shadow = healed.shadow_measured;
    const Step step = *step_;
    place(step.settings, &shadow);
    heal::Healed shaded = healed;
    shaded.added = thing_->in_its_shadow(healed.added, step.settings, shadow);
    take_healed("Heal the place", thing_->before(), shaded,
                std::make_shared<const std::vector<std::uint8_t>>(thing_->rows()));
}

namespace {

/// Ball of the world.
struct Ball {
    Vec3 centre;
    double radius = 0;
};

/// Depth of the picture at a point of it, or at the nearest of the points around; nothing where none has one.
std::optional<double> depth_near(const Image& depth, const Camera& camera, double x, double y, double reach) {
    constexpr std::array<std::array<double, 2>, 9> Around{
        {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {0.7, 0.7}, {-0.7, 0.7}, {0.7, -0.7}, {-0.7, -0.7}}};
    for (const auto& [right, down] : Around) {
        const auto px = static_cast<int>((x + right * reach) / camera.width * depth.width),
                   py = static_cast<int>((y + down * reach) / camera.height * depth.height);
        if (px < 0 || py < 0 || px >= depth.width || py >= depth.height) continue;
        const double value = depth.at(px, py, 0);
        if (std::isfinite(value) && value > 0) return value;
    }
    return std::nullopt;
}

/// Ball around the surface under a stroke; nothing where the picture shows none.
std::optional<Ball> ball_under(const ui::ScreenRegion& stroke, const Image& depth, const Camera& camera) {
    constexpr double Beyond = 1.5;  // of the brush's radius, where a hole's rim is looked for
    std::vector<Ball> dabs;
    Vec3 sum;
    for (const auto& [x, y] : stroke.circles) {
        const auto z = depth_near(depth, camera, x, y, Beyond * stroke.radius_px);
        if (!z) continue;
        const Vec3 seen{(x - camera.cx) / camera.fx * *z, (y - camera.cy) / camera.fy * *z, *z};
        const Vec3 at = camera.rotation.transposed() * (seen - camera.translation);
        dabs.push_back({at, stroke.radius_px * *z / camera.fx});
        sum = sum + at;
    }
    if (dabs.empty()) return std::nullopt;
    Ball ball{sum * (1.0 / static_cast<double>(dabs.size())), 0};
    for (const auto& dab : dabs)
        ball.radius = std::max(ball.radius, length(dab.centre - ball.centre) + dab.radius);
    return ball;
}

/// Ball around the marked rows; nothing where none is.
std::optional<Ball> ball_around(const GaussianSet& set, const std::vector<std::uint8_t>& rows) {
    const auto position = set.position();
    const auto at = [&](std::size_t row) {
        return Vec3{position[3 * row], position[3 * row + 1], position[3 * row + 2]};
    };
    Vec3 sum;
    std::size_t count = 0;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) sum = sum + at(row), ++count;
    if (count == 0) return std::nullopt;
    Ball ball{sum * (1.0 / static_cast<double>(count)), 0};
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) ball.radius = std::max(ball.radius, length(at(row) - ball.centre));
    return ball;
}

}  // namespace

template <> void PlaceController::on(const command::HealStroke& one) {
    const auto depth = view_.depth();
    if (!free_stack() || one.region.circles.empty()) return;
    const Camera camera = view_.shown_camera();
    PickOptions options;
    options.depth = depth.get();
    auto rows = std::make_shared<const std::vector<std::uint8_t>>(
        rows_in_area(view_.seen_document(), camera, screen_area(one.region), options));
    auto ball = ball_around(state().current, *rows);
    if (!ball && depth) ball = ball_under(one.region, *depth, camera);
    if (!ball) return workspace_.notices.toast("Nothing is seen there that could be healed.");
    start_healing(
        "Heal", state(), rows, false,
        [set = state().current, rows, up = state().info.up, ball = *ball](const JobControl& control) {
            return heal::heal_region({set, *rows, up, control}, ball.centre, ball.radius);
        });
}

// Other scenes

template <> void PlaceController::on(const command::PutIn& one) {
    if (!free_stack()) return;
    auto node = std::make_shared<EditNode>();
    const std::string name = pipeline::name_of_thing(one.path);
    auto work = [node, host = workspace_.scene(), state = state(), path = one.path, name,
                 seen = view_.seen_document(), camera = view_.camera(),
                 id = workspace_.next_edit_id++](const JobControl& control) {
        control.report("reading the scene", 0, 0);
        const Scene guest = pipeline::load_standing_scene(path);
        MergeWishes wishes;
        if (camera.width > 0) wishes.seen = pipeline::shown_surface(seen, camera, host.info.antialiased);
        const auto place = merge_place(host, guest, wishes);
        for (const auto& note : place.notes) log::info("{}: {}", name, note);
        *node = merge_of(state, guest, place.placement, name, id);
    };
    auto done = [this, node, name, revision = workspace_.document.revision()](const Error* error) {
        if (error != nullptr) return workspace_.report_end(*error);
        if (workspace_.document.revision() != revision) return;
        workspace_.document.apply(node->name, with_edit(state(), *node, name, true));
        workspace_.toast_step(fmt::format("\"{}\" is in the scene: drag its handles to place it.", name));
    };
    workspace_.jobs->start_work(JobKind::Place, {fmt::format("Put in {}", name), work, done, true});
}

// Placing

namespace {

constexpr double RestSeconds = 0.15;  // without a move, after which the shadow of a large thing comes

}  // namespace

template <> void PlaceController::on(const command::UsePlacing& one) { used_ = one.on; }

const heal::Shadow* PlaceController::known_shadow() const {
    const bool known = measured_ && measured_->done && !measured_->healed.shadow_measured.rows.empty();
    return known ? &measured_->healed.shadow_measured : nullptr;
}

template <> void PlaceController::on(const command::PlaceThing& one) {
    if (!workspace_.require_scene() || workspace_.jobs->works() || workspace_.results || !thing_) return;
    const bool goes_on = step_ && step_->revision == workspace_.document.revision();
    if (one.settings == edit::RearrangeSettings{}) return goes_on ? workspace_.run(command::Undo{}) : void();
    if (!goes_on) step_ = Step{0, workspace_.next_edit_id++};
    try {
        const bool small = thing_->rows().size() <= workspace_.options.most_shaded_while_dragging;
        const auto* shadow = small ? known_shadow() : nullptr;
        place(one.settings, shadow);
        step_->settings = one.settings;
        step_->shadow_at = shadow != nullptr ? Never : one.drag_ends ? 0 : wall_seconds() + RestSeconds;
        view_.set_camera(view_.camera());  // the resolution may drop, as while it moves
    } catch (const Error& error) {
        if (!goes_on) step_.reset();
        workspace_.notices.report(error);
    }
}

/// Throws Error (InvalidArgument).
void PlaceController::place(const edit::RearrangeSettings& settings, const heal::Shadow* shadow) {
    auto next = thing_->placed(settings, step_->id, shadow);
    const std::string name = next.stack.back().name;
    workspace_.document.apply(name, std::move(next), fmt::format("place{}", step_->id));
    step_->revision = workspace_.document.revision();
}

/// Measures the shadow beside the frames; while that thread has other work, not yet.
void PlaceController::measure_shadow() {
    const auto measured = std::make_shared<Measured>();
    const auto rows = std::make_shared<const std::vector<std::uint8_t>>(thing_->rows());
    auto work = [measured, healing = healing_of(thing_->before(), rows, true)](const JobControl& control) {
        measured->healed = healing(control);
    };
    auto done = [measured](const Error* error) {
        if (error != nullptr) log::info("the shadow stays where it is: {}", error->message());
        measured->done = true;
    };
    if (workspace_.jobs->counter.start({"Measure the shadow", work, done})) measured_ = measured;
}

void PlaceController::take_shadow_along() {
    if (wall_seconds() < step_->shadow_at || workspace_.jobs->works() || workspace_.results) return;
    if (thing_->put_in()) return step_->shadow_at = Never, void();
    if (!measured_) return measure_shadow();
    if (!measured_->done) return;
    step_->shadow_at = Never;
    if (const auto* shadow = known_shadow()) place(step_->settings, shadow);
}

void PlaceController::refresh() {
    const bool goes_on = step_ && step_->revision == workspace_.document.revision();
    if (goes_on) return take_shadow_along();
    step_.reset();
    const NamedLabel* label = workspace_.active_label();
    if (!used_ || label == nullptr || count_labelled(*label) == 0) return thing_.reset();
    if (thing_ && thing_->is_of(state(), label->bits)) return;
    measured_.reset();
    thing_.emplace(state(), label->bits, front());
    if (!thing_->found()) thing_.reset();
}

void PlaceController::show(ui::PlacePart& model) const {
    model.placed = thing_ ? std::optional(thing_->shown()) : std::nullopt;
    model.placing = step_.has_value();
}

void PlaceController::run(const ui::PlaceCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
