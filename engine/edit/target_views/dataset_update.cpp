// Rounds, orders and the sheet of targets.
#include "engine/edit/target_views/dataset_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/interfaces/stage_timer.h"
#include "engine/edit/target_views/ground_hole_fill.h"
#include "engine/edit/target_views/view_agreement.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

/// Every setting that the redrawn pictures follow from.
std::string redraw_key(const CheckedRequest& request, EditMode mode, const std::string& of_model) {
    const auto plan = round_plan(request, mode);
    return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", request.prompt(), request.seed, plan.rounds,
                       plan.views, plan.view_steps, plan.strength, plan.again_strength, plan.guided_until,
                       of_model);
}

std::shared_ptr<const Image> shown_copy(const Image& image) {
    const int longer = std::max(image.width, image.height);
    if (longer <= ShownSide) return std::make_shared<const Image>(image);
    const auto side = [&](int pixels) { return std::max(1, pixels * ShownSide / longer); };
    return std::make_shared<const Image>(
        localize::resize_image(image, side(image.width), side(image.height)));
}

bool is_missing(const RoundState& state, std::size_t index) {
    return index < state.missing.size() && state.missing[index];
}

std::ptrdiff_t index_of(const std::vector<std::size_t>& views, std::size_t view) {
    const auto found = std::find(views.begin(), views.end(), view);
    return found == views.end() ? -1 : found - views.begin();
}

}  // namespace

DatasetUpdate::DatasetUpdate(const EditPlan& plan, const CheckedRequest& request, const EditTools& tools,
                             const std::vector<Image>& originals, const DynamicMasks& masks,
                             ShapeFinder* shapes)
    : plan_(plan), request_(request), tools_(tools), originals_(originals), masks_(masks),
      anew_(shapes != nullptr), rounds_(plan, request, *tools.views, shapes, tools.known),
      key_(redraw_key(request, plan.mode, tools.redraw_key)) {}

/// Tells whether the edit goes on in the middle of this round, with the same settings from the same cameras.
bool DatasetUpdate::resumes(const RoundState& start, const std::vector<std::size_t>& visible) const {
    const int round = std::min(tools_.start->iteration / request_.fit_steps, request_.rounds - 1);
    if (start.key != key_ || start.round != round) return false;
    for (std::size_t i = 0; i < start.views.size(); ++i) {
        const auto view = start.views[i];
        if (view >= plan_.views.size() || index_of(visible, view) < 0) return false;
        if ((*start.begun)[i].view.camera != plan_.views[view].camera) return false;
    }
    return true;
}

void DatasetUpdate::choose(const std::vector<std::size_t>& visible) {
    const auto* start = tools_.start != nullptr ? tools_.start->round.get() : nullptr;
    if (start == nullptr || !resumes(*start, visible)) {
        std::vector<Mask> masks;
        for (std::size_t v = 0; v < plan_.views.size(); ++v) masks.push_back(masks_.mask(v));
        return rounds_.choose(visible, masks);
    }
    rounds_.resume(*start);
    for (std::size_t i = 0; i < start->views.size(); ++i) {
        const auto view = start->views[i];
        rounds_.replace(view, *start->edited[i], originals_[view], masks_.mask(view));
    }
    state_ = tools_.start->round;
    weigh();
    begin_sheet();
}

GaussianData DatasetUpdate::hole_fill(int sh_degree) const {
    if (!state_ || plan_.mode != EditMode::Replace) return {};
    auto rows = ground_hole_fill(*state_->begun, sh_degree);
    if (rows.size() > 0) log::info("{} splats close the holes that the old thing leaves", rows.size());
    return rows;
}

std::vector<std::size_t> DatasetUpdate::fitted() const {
    if (!state_) return rounds_.views();
    std::vector<std::size_t> views;
    for (std::size_t i = 0; i < state_->views.size(); ++i)
        if (!state_->dropped[i]) views.push_back(state_->views[i]);
    return views;
}

DatasetUpdate::Surface DatasetUpdate::draw(const GaussianSpans& rows, const Camera& camera,
                                           const raster::Settings& settings) {
    constexpr float LeastAlpha = 0.5f;
    tools_.rasterizer.forward(rows, camera, settings, output_);
    Surface surface{output_.colour, output_.depth, output_.alpha};
    for (auto& value : surface.colour.data) value = std::clamp(value, 0.0f, 1.0f);
    for (std::size_t i = 0; i < surface.depth.data.size(); ++i) {
        const float alpha = surface.alpha.data[i];
        surface.depth.data[i] = alpha > LeastAlpha ? surface.depth.data[i] / alpha : 0.0f;
    }
    return surface;
}

EditView DatasetUpdate::begin_view(std::size_t v, const GaussianSpans& rows, const GaussianSpans& unlabelled,
                                   const raster::Settings& settings) {
    EditView view{{},
                  originals_[v],
                  {},
                  masks_.mask(v),
                  plan_.views[v],
                  plan_.view_words.empty() ? std::string() : plan_.view_words[v]};
    if (!plan_.azimuths.empty()) view.azimuth = plan_.azimuths[v], view.elevation = plan_.elevations[v];
    auto shown = draw(rows, view.view.camera, settings);
    view.rendered = std::move(shown.colour), view.depth = std::move(shown.depth);
    for (auto& value : view.original.data) value = std::clamp(value, 0.0f, 1.0f);
    if (anew_) {
        auto behind = draw(unlabelled, view.view.camera, settings);
        view.clean_plate.picture = std::move(behind.colour), view.clean_plate.depth = std::move(behind.depth);
        fill_holes(view.clean_plate, view.mask, behind.alpha);
    }
    return view;
}

std::map<std::string, double> DatasetUpdate::redraw(int iteration, const GaussianSpans& rows,
                                                    const GaussianSpans& unlabelled,
                                                    const raster::Settings& settings) {
    const StageTimer timer(seconds_);
    auto begun = std::make_shared<std::vector<EditView>>();
    for (const auto v : rounds_.views()) begun->push_back(begin_view(v, rows, unlabelled, settings));
    auto scalars = rounds_.redraw(iteration, *begun, originals_, tools_.job);
    std::erase_if(scalars, [](const auto& scalar) { return !std::isfinite(scalar.second); });
    auto state = std::make_shared<RoundState>();
    state->round = rounds_.round();
    state->key = key_;
    state->views = rounds_.views();
    state->sentence = rounds_.sentence();
    state->warnings = rounds_.warnings();
    state->raised = rounds_.raised();
    state->begun = begun;
    for (const auto view : state->views)
        state->edited.push_back(std::make_shared<const Image>(rounds_.edited(view)));
    state->attempts.assign(state->views.size(), 0);
    state->dropped.assign(state->views.size(), anew_);
    if (anew_)  // only views that show the new thing are fitted to
        for (const auto i : rounds_.found().usable) state->dropped[i] = false;
    for (std::size_t i = 0; i < rounds_.rejected().size(); ++i)
        if (rounds_.rejected()[i] != 0) state->dropped[i] = true;
    state->missing.assign(rounds_.missing().begin(), rounds_.missing().end());
    state_ = std::move(state);
    redrawn_ += state_->views.size();
    weigh();
    begin_sheet();
    return scalars;
}

/// An artist may think about what came of the last orders before giving others.
void DatasetUpdate::take_orders() {
    if (!tools_.target_orders) return;
    for (auto orders = tools_.target_orders(); !orders.empty(); orders = tools_.target_orders()) {
        auto next = std::make_shared<RoundState>(*state_);
        bool changed = false;
        for (const auto& order : orders) changed |= follow(order, *next);
        if (changed) {
            state_ = std::move(next);
            weigh();
        }
        show_sheet();  // also where nothing has changed: the orders are done
    }
    if (tools_.job.stop_requested()) throw Error(ErrorCode::Cancelled, "the edit was stopped");
}

/// True when something has changed.
bool DatasetUpdate::follow(const TargetOrder& order, RoundState& next) {
    const auto found = order.round == next.round ? index_of(next.views, order.view) : -1;
    if (found < 0) return false;  // of a round that is over
    const auto index = static_cast<std::size_t>(found);
    const bool drops = order.choice == TargetChoice::Drop;
    if (order.choice == TargetChoice::Accept && is_missing(next, index)) {
        log::warning("{} was not drawn: Redo has it drawn", plan_.views[order.view].name);
        return false;
    }
    if (drops && std::count(next.dropped.begin(), next.dropped.end(), false) <= 1) {
        log::warning("the last redrawn view cannot be dropped: the scene is fitted to it");
        return false;
    }
    const bool was_dropped = next.dropped[index];
    next.dropped[index] = drops;
    if (order.choice == TargetChoice::Redo) redo(index, next);
    if (is_missing(next, index)) next.dropped[index] = true;  // the server still draws nothing
    sheet_.views[index].dropped = next.dropped[index];
    return order.choice == TargetChoice::Redo || was_dropped != drops;
}

void DatasetUpdate::redo(std::size_t index, RoundState& next) {
    const StageTimer timer(seconds_);
    const auto view = next.views[index];
    ++next.attempts[index];
    EditView begun = (*next.begun)[index];
    begun.mask = masks_.mask(view);
    try {
        rounds_.redo(view, begun, next.attempts[index], originals_[view], tools_.job);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;
        return log::warning("{} could not be redrawn and stays as it is: {}", plan_.views[view].name,
                            error.what());
    }
    ++redrawn_;
    next.edited[index] = std::make_shared<const Image>(rounds_.edited(view));
    if (!next.missing.empty()) next.missing[index] = false;
    sheet_.views[index].attempt = next.attempts[index];
    sheet_.views[index].missing = false;
    refresh_sheet(index);
}

double DatasetUpdate::check_colour(const GaussianSpans& rows, const raster::Settings& settings) {
    if (!state_) return -1;
    std::vector<double> of_views, of_scene;
    for (const auto view : fitted()) {
        tools_.rasterizer.forward(rows, plan_.views[view].camera, settings, output_);
        for (auto& value : output_.colour.data) value = std::clamp(value, 0.0f, 1.0f);
        of_views.push_back(mean_chroma(rounds_.target(view), masks_.mask(view)));
        of_scene.push_back(mean_chroma(output_.colour, masks_.mask(view)));
    }
    const double kept = kept_chroma(std::move(of_views), of_scene);
    if (const auto warning = warning_of_chroma(kept); !warning.empty()) {
        log::warning("{}", warning);
        sheet_.warnings.push_back(warning);
        show_sheet();
    }
    return kept;
}

void DatasetUpdate::take_masks() {
    if (!state_) return;
    for (std::size_t i = 0; i < state_->views.size(); ++i) {
        const auto view = state_->views[i];
        rounds_.blend(view, originals_[view], masks_.mask(view));
        refresh_sheet(i);
    }
    show_sheet();
}

/// Views that are fitted to say how much to believe each other; what is drawn anew is not where the depths
/// are.
void DatasetUpdate::weigh() {
    if (anew_) return;
    std::vector<EditView> views;
    std::vector<Image> pictures;
    for (std::size_t i = 0; i < state_->views.size(); ++i) {
        if (state_->dropped[i]) continue;
        views.push_back((*state_->begun)[i]);
        pictures.push_back(*state_->edited[i]);
    }
    auto weights = trust_weights(views, pictures);
    trust_.assign(plan_.views.size(), {});
    for (std::size_t i = 0, next = 0; i < state_->views.size(); ++i)
        if (!state_->dropped[i]) trust_[state_->views[i]] = std::move(weights[next++]);
}

void DatasetUpdate::begin_sheet() {
    sheet_ = {state_->round, round_plan(request_, plan_.mode).rounds, {}, state_->sentence, state_->warnings};
    for (std::size_t i = 0; i < state_->views.size(); ++i) {
        sheet_.views.push_back({state_->views[i],
                                shown_copy((*state_->begun)[i].rendered),
                                {},
                                state_->attempts[i],
                                state_->dropped[i],
                                is_missing(*state_, i)});
        refresh_sheet(i);
    }
    new_sheet_ = true;
}

void DatasetUpdate::refresh_sheet(std::size_t index) {
    Image target = rounds_.target(state_->views[index]);
    for (auto& value : target.data) value = std::clamp(value, 0.0f, 1.0f);
    sheet_.views[index].after = shown_copy(target);
}

void DatasetUpdate::show_new_sheet() {
    if (std::exchange(new_sheet_, false)) show_sheet();
}

void DatasetUpdate::show_sheet() const {
    if (tools_.targets) tools_.targets(sheet_);
}

}  // namespace gse::edit
