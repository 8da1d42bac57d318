// The viewport: camera, display settings, comparisons, hidden splats, and the picture that is wanted.
#include "app/session/view_controller.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include "app/engine_names.h"
#include "app/session/shown_picture.h"
#include "engine/base/clock.h"
#include "engine/edit/placement/thing_bounds.h"
#include "engine/io/cameras/camera_json.h"
#include "engine/math/framing.h"
#include "engine/pipeline/run/views.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/framing.h"
#include "engine/scene/row_values.h"
#include "engine/scene/viewpoints.h"

namespace gse::app {
namespace {

namespace command = ui::command;

RowValues from_bits(const std::vector<std::uint8_t>& bits) {
    return std::make_shared<const std::vector<float>>(bits.begin(), bits.end());
}

}  // namespace

void ViewController::take_document() {
    hidden_.show_all();
    compare_as_usual();
    wanted_ = {};
    pictures_.take_document();
    up_shown_ = state().info.up;
    orbit_ = scene_orbit(Scene{state().base, state().info, {}}, RenderParameters{});
    framing_ = framing_bounds(state().current);
    home_ = edit::thing_bounds(state().current, normalized(state().info.up));
    camera_ = {};
}

void ViewController::settle() {
    if (camera_.width == 0) go_home();
}

void ViewController::follow_document() {
    ++workspace_.content;
    if (!(up_shown_ == state().info.up)) stand_up();
    hidden_.follow_document();
}

void ViewController::stand_up() {
    up_shown_ = state().info.up;
    orbit_ = scene_orbit(Scene{state().base, state().info, {}}, RenderParameters{});
    home_ = edit::thing_bounds(state().current, normalized(state().info.up));
    go_home();
}

void ViewController::go_home() {
    camera_ = home_camera(orbit_, home_, settings_.fov_degrees * std::numbers::pi / 180, std::max(width_, 64),
                          std::max(height_, 64));
}

bool ViewController::moving() const { return seconds_since(last_move_) < 2 * MovingSeconds; }

void ViewController::set_camera(const Camera& camera) {
    camera_ = camera;
    last_move_ = Clock::now();
}

void ViewController::look_from(const Camera& camera) {
    set_camera(fitted(camera, std::max(width_, 1), std::max(height_, 1)));
}

std::string ViewController::direction() const { return turned_to(camera_, state().info.up); }

/// Overlays and tools work in pixels of the whole viewport; while moving the picture has fewer and is
/// stretched.
Camera ViewController::shown_camera() const {
    if (shown_.camera.width > 0) return shown_.camera;
    return camera_.width > 0 ? camera_.resized(width_, height_) : Camera();
}

void ViewController::untint() {
    if (!tint_before_) tint_before_ = std::exchange(settings_.tint_labels, false);
}

void ViewController::tint_again() {
    settings_.tint_labels |= std::exchange(tint_before_, std::nullopt).value_or(false);
}

void ViewController::compare_as_usual() {
    compared_ = {};
    ++workspace_.content;
}

// Pictures

RowValues ViewController::values_of(const Stage& stage) const {
    const auto mode = static_cast<ui::DisplayMode>(settings_.mode);
    const NamedLabel* label = workspace_.active_label();
    RowValues values;
    if (stage.picked) values = from_bits(*stage.picked);
    else if (mode == ui::DisplayMode::Changed)
        values = std::make_shared<const std::vector<float>>(changed_values(state()));
    else if (mode == ui::DisplayMode::Attention) values = stage.attention;
    else if (mode == ui::DisplayMode::LabelWeight) values = label ? label->weight : nullptr;
    else if (label && label->bits) values = from_bits(*label->bits);
    return on_screen(values, stage.set, stage);
}

RowValues ViewController::on_screen(const RowValues& values, const GaussianSet& set,
                                    const Stage& stage) const {
    const auto& current = state().current;
    if (!values || values->size() != current.size()) return nullptr;
    if (set.shares_all_with(current)) return values;
    const auto rows = stage.new_rows();  // of `set`, of each row of the state before
    if (rows.size() != current.size()) return nullptr;
    return std::make_shared<const std::vector<float>>(carried(*values, rows, set.size(), 1.0f));
}

GaussianSet ViewController::before_on_screen(const Stage& stage) const {
    return compared_.revision != 0 ? compared_.set : stage.before;
}

PictureRequest ViewController::request(const Stage& stage) {
    const bool tint = (settings_.tint_labels || stage.picking) && comparison_ == ui::Comparison::None;
    const DrawnKey key{workspace_.document.revision(),
                       workspace_.content,
                       settings_.mode,
                       state().active_label,
                       stage.snapshot,
                       stage.result,
                       tint};
    if (!(key == drawn_.key)) {
        const auto mode = static_cast<ui::DisplayMode>(settings_.mode);
        const bool tints = mode == ui::DisplayMode::Beauty && tint;
        const bool shows_values = tints || mode >= ui::DisplayMode::Labels;
        drawn_ = {key, seen(stage.set, stage), shows_values ? values_of(stage) : nullptr};
    }
    PictureRequest request;
    request.set = drawn_.set;
    request.values = drawn_.values;
    request.original = seen(before_on_screen(stage), stage);
    request.antialiased = state().info.antialiased;
    request.camera = camera_.resized(std::max(width_, 1), std::max(height_, 1));
    request.settings = settings_;
    request.settings.tint_labels |= stage.picking;
    request.comparison = comparison_;
    request.moving = seconds_since(last_move_) < MovingSeconds;
    request.content = workspace_.content * 1000003 + static_cast<std::uint64_t>(settings_.mode) * 31 +
                      (tint ? 7 : 0) + workspace_.document.revision() * 131;
    return request;
}

void ViewController::draw(PreviewHost& preview, const Stage& stage) {
    wanted_ = request(stage);
    preview.want(wanted_);
    pictures_.refresh(drawn_.set, wanted_);
    shown_ = preview.state();
}

void ViewController::show(ui::ViewportPart& model) const {
    model.view = settings_;
    model.comparison = comparison_;
    model.compared_revision = compared_.revision;
    model.compared_name = compared_.name;
    model.hidden = hidden_.count();
    model.orbit = orbit_;
    model.home = home_;
    model.framing = framing_;
    model.viewport = shown_.texture;
    if (workspace_.document.empty()) return;
    model.viewport_original = shown_.original;
    model.camera = shown_camera();
    model.viewport_width = model.camera.width;
    model.viewport_height = model.camera.height;
    model.viewport_depth = shown_.depth;
    model.view_pictures = pictures_.of_views();
    model.seen_colour = seen_colour_;
    model.render_ms = shown_.render_ms;
    model.renderer = shown_.renderer;
}

// Hidden splats

std::vector<std::uint8_t> ViewController::hidden_rows(const GaussianSet& set, const Stage& stage) const {
    if (compared_.revision != 0 && set.shares_all_with(compared_.set)) return hidden_.of_rows(*compared_.ids);
    if (set.shares_all_with(state().base) && !set.shares_all_with(state().current)) {
        std::vector<RowId> ids(set.size());
        std::iota(ids.begin(), ids.end(), RowId{0});
        return hidden_.of_rows(ids);
    }
    const auto rows = hidden_.of_document();
    std::vector<float> visible(rows.size());
    std::transform(rows.begin(), rows.end(), visible.begin(),
                   [](auto hidden) { return hidden != 0 ? 0.0f : 1.0f; });
    const auto shown = on_screen(std::make_shared<const std::vector<float>>(std::move(visible)), set, stage);
    std::vector<std::uint8_t> hidden(set.size(), 0);
    for (std::size_t row = 0; shown && row < hidden.size(); ++row) hidden[row] = (*shown)[row] == 0 ? 1 : 0;
    return hidden;
}

GaussianSet ViewController::seen(const GaussianSet& set, const Stage& stage) {
    return hidden_.seen(set, [&](const GaussianSet& whole) { return hidden_rows(whole, stage); });
}

GaussianSet ViewController::seen_document() { return seen(state().current, {}); }

// Settings and projects

void ViewController::to_json(nlohmann::json& json) const {
    json["view"] = fields_to_json(settings_);
    json["camera"] = camera_to_json(camera_);
}

void ViewController::from_json(const nlohmann::json& json) {
    if (json.contains("view")) fields_from_json(settings_, json["view"]);
    if (json.contains("camera")) camera_ = camera_from_json(json["camera"]);
}

// Commands

template <> void ViewController::on(const command::HideLabel&) { hidden_.hide_label(false); }

template <> void ViewController::on(const command::IsolateLabel&) { hidden_.hide_label(true); }

template <> void ViewController::on(const command::ShowHidden&) { hidden_.show_all(); }

template <> void ViewController::on(const command::SetCamera& one) { set_camera(one.camera); }

template <> void ViewController::on(const command::SetViewSettings& one) { settings_ = one.settings; }

template <> void ViewController::on(const command::SetComparison& one) { comparison_ = one.comparison; }

template <> void ViewController::on(const command::CompareWith& one) {
    const auto& document = workspace_.document;
    if (document.empty() || one.position >= document.names().size()) return;
    const auto revision = document.revision_at(one.position);
    const bool again = revision == compared_.revision;
    const DocumentState step = document.state_at(one.position);
    compared_ =
        again ? Comparing() : Comparing{revision, document.names()[one.position], step.current, step.row_ids};
    comparison_ = again ? ui::Comparison::None : ui::Comparison::Wipe;
    ++workspace_.content;
}

template <> void ViewController::on(const command::LookThrough& one) {
    if (workspace_.document.empty() || one.view >= state().views.size()) return;
    look_from(state().views[one.view].camera);  // all of it, whatever the shapes are
}

template <> void ViewController::on(const command::AddView&) {
    if (!workspace_.require_scene()) return;
    DocumentState next = state();
    next.views.push_back({"view " + std::to_string(next.views.size() + 1), shown_camera(), false});
    workspace_.document.apply("Add view", std::move(next));
}

template <> void ViewController::on(const command::DeleteView& one) {
    if (!workspace_.require_scene() || one.view >= state().views.size()) return;
    DocumentState next = state();
    next.views.erase(next.views.begin() + static_cast<std::ptrdiff_t>(one.view));
    workspace_.document.apply("Delete view", std::move(next));
}

template <> void ViewController::on(const command::RenameView& one) {
    if (!workspace_.require_scene() || one.view >= state().views.size()) return;
    DocumentState next = state();
    next.views[one.view].name = one.name;
    workspace_.document.apply("Rename view", std::move(next));
}

template <> void ViewController::on(const command::DrawView& one) { pictures_.want(one.view); }

template <> void ViewController::on(const command::PickColour& one) {
    if (workspace_.document.empty() || wanted_.camera.width <= 0) return;
    seen_colour_ = {seen_colour_.number + 1, seen_colour(wanted_, one.x, one.y)};
}

template <> void ViewController::on(const command::SetViewportSize& one) {
    width_ = std::clamp(one.width, 1, 16384);
    height_ = std::clamp(one.height, 1, 16384);
}

void ViewController::run(const ui::ViewCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
