// The viewport: which splats and values are shown, from where.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/cli/engine_names.h"
#include "app/session/application.h"
#include "engine/base/log.h"
#include "engine/localize/focus.h"
#include "engine/pipeline/run/scene_tools.h"
#include "engine/scene/row_values.h"
#include "engine/scene/viewpoints.h"

namespace gse::app {
namespace {

using Values = std::shared_ptr<const std::vector<float>>;

Values from_bits(const std::vector<std::uint8_t>& bits) {
    return std::make_shared<const std::vector<float>>(bits.begin(), bits.end());
}

}  // namespace

Values Application::shown_values(const GaussianSet& set) const {
    const auto& state = document_.state();
    const auto mode = static_cast<ui::DisplayMode>(model_.view.mode);
    const NamedLabel* label =
        state.active_label >= 0 && state.active_label < static_cast<int>(state.labels.size())
            ? &state.labels[static_cast<std::size_t>(state.active_label)]
            : nullptr;
    Values values;
    if (picking_ && picking_->rows()) {
        values = from_bits(*picking_->rows());
    } else if (mode == ui::DisplayMode::Changed) {
        values = std::make_shared<const std::vector<float>>(changed_values(state));
    } else if (mode == ui::DisplayMode::Attention) {
        if (attention_values_ && attention_set_.shares_all_with(state.current)) values = attention_values_;
    } else if (mode == ui::DisplayMode::LabelWeight) {
        if (label && label->weight) values = label->weight;
    } else if (label && label->bits) {
        values = from_bits(*label->bits);
    }
    return on_screen(values, set);
}

/// Values of the document's rows on the splats that are shown; what is new there has 1. Null where they do
/// not fit.
Values Application::on_screen(const Values& values, const GaussianSet& set) const {
    const auto& current = document_.state().current;
    if (!values || values->size() != current.size()) return nullptr;
    if (set.shares_all_with(current)) return values;
    const int snapshot = model_.shown_snapshot;
    std::vector<std::int64_t> rows;  // of `set`, of each row of the state before
    if (pending_ && snapshot < 0) rows = *pending_->base_to_new;
    else if (!snapshots_.empty())
        rows =
            (snapshot < 0 ? snapshots_.back() : snapshots_[static_cast<std::size_t>(snapshot)]).base_to_new();
    if (rows.size() != current.size()) return nullptr;
    return std::make_shared<const std::vector<float>>(carried(*values, rows, set.size(), 1.0f));
}

bool Application::shows_snapshot() const {
    return (edit_running() || pending_) && !snapshots_.empty();  // a search has none
}

/// What is to be seen: a snapshot that is looked at, the result that waits, the newest snapshot, else the
/// document.
GaussianSet Application::set_on_screen() {
    const int snapshot = model_.shown_snapshot;
    const bool live = shows_snapshot();
    if (live && snapshot >= 0 && snapshot < static_cast<int>(snapshots_.size()))
        return snapshot_set(snapshots_[static_cast<std::size_t>(snapshot)]);
    if (pending_) return pending_->set;
    return live ? snapshot_set(snapshots_.back()) : document_.state().current;
}

/// Before and after: a step that the artist chose; else a waiting or running edit is compared with the state
/// before it, else with the scene as loaded.
const GaussianSet& Application::before_on_screen() const {
    if (model_.compared_revision != 0) return compared_.set;
    return shows_snapshot() || pending_ ? document_.state().current : document_.state().base;
}

PictureRequest Application::picture_request() {
    const auto& state = document_.state();
    const int snapshot = model_.shown_snapshot;
    const ShownKey key{document_.revision(),
                       content_,
                       model_.view.mode,
                       snapshot,
                       state.active_label,
                       (model_.view.tint_labels || picking_) && model_.comparison == ui::Comparison::None,
                       pending_.shown()};
    if (!(key == shown_key_)) {
        shown_key_ = key;
        shown_set_ = set_on_screen();
        const GaussianSet seen_set = seen(shown_set_);
        const auto mode = static_cast<ui::DisplayMode>(model_.view.mode);
        const bool tints = mode == ui::DisplayMode::Beauty && key.tint;
        shown_values_ = tints || mode >= ui::DisplayMode::Labels ? shown_values(shown_set_) : nullptr;
        shown_set_ = seen_set;
    }
    PictureRequest request;
    request.set = shown_set_;
    request.values = shown_values_;
    request.original = seen(before_on_screen());
    request.antialiased = state.info.antialiased;
    request.camera = camera_.resized(std::max(viewport_width_, 1), std::max(viewport_height_, 1));
    request.settings = model_.view;
    request.settings.tint_labels |= picking_.has_value();
    request.comparison = model_.comparison;
    request.moving = std::chrono::duration<double>(Clock::now() - last_move_).count() < MovingSeconds;
    request.content = content_ * 1000003 + static_cast<std::uint64_t>(model_.view.mode) * 31 +
                      (key.tint ? 7 : 0) + document_.revision() * 131;
    return request;
}

void Application::go_home() {
    camera_ = home_camera(model_.orbit, model_.framing, model_.view.fov_degrees * std::numbers::pi / 180,
                          std::max(viewport_width_, 64), std::max(viewport_height_, 64));
}

void Application::set_camera(const Camera& camera) {
    camera_ = camera;
    last_move_ = Clock::now();
}

void Application::set_viewport_size(int width, int height) {
    viewport_width_ = std::clamp(width, 1, 16384);
    viewport_height_ = std::clamp(height, 1, 16384);
}

void Application::set_view_settings(const ui::ViewSettings& settings) { model_.view = settings; }

void Application::set_comparison(ui::Comparison comparison) { model_.comparison = comparison; }

void Application::compare_with(std::size_t position) {
    if (document_.empty() || position >= document_.names().size()) return;
    const auto revision = document_.revision_at(position);
    const bool again = revision == model_.compared_revision;
    model_.compared_revision = again ? 0 : revision;
    model_.compared_name = again ? std::string() : document_.names()[position];
    const DocumentState state = document_.state_at(position);
    compared_ = {again ? GaussianSet() : state.current, state.row_ids};
    model_.comparison = again ? ui::Comparison::None : ui::Comparison::Wipe;
    ++content_;
}

/// Comparisons are with what an edit begins with again, or with the original.
void Application::compare_as_usual() {
    compared_ = {};
    model_.compared_revision = 0;
    model_.compared_name.clear();
    ++content_;
}

void Application::look_through(std::size_t view) {
    if (document_.empty() || view >= document_.state().views.size()) return;
    // The whole view fits into the viewport, whatever their shapes are.
    camera_ = fitted(document_.state().views[view].camera, std::max(viewport_width_, 1),
                     std::max(viewport_height_, 1));
    ++camera_version_;
    last_move_ = Clock::now();
}

void Application::add_view() {
    if (!require_scene()) return;
    DocumentState state = document_.state();
    state.views.push_back({"view " + std::to_string(state.views.size() + 1), model_.camera, false});
    document_.apply("Add view", std::move(state));
}

void Application::delete_view(std::size_t view) {
    if (!require_scene() || view >= document_.state().views.size()) return;
    DocumentState state = document_.state();
    state.views.erase(state.views.begin() + static_cast<std::ptrdiff_t>(view));
    document_.apply("Delete view", std::move(state));
}

OrbitParameters Application::export_orbit() const {
    OrbitParameters orbit = model_.orbit;
    const auto& state = document_.state();
    if (model_.exports.around_label && state.active_label >= 0) {
        const auto& bits = state.labels[static_cast<std::size_t>(state.active_label)].bits;
        if (bits && std::any_of(bits->begin(), bits->end(), [](auto bit) { return bit != 0; })) {
            orbit = localize::focus_orbit(state.current, *bits, orbit);
            orbit.radius *= 1.3;  // room around
        }
    }
    orbit.radius *= model_.exports.radius_factor;
    orbit.elevation = model_.exports.elevation_degrees * std::numbers::pi / 180;
    return orbit;
}

}  // namespace gse::app
