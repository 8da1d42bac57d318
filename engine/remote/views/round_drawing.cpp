// Orders, answers that are checked, and four ways through the views.
#include "engine/remote/views/round_drawing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/base/random.h"
#include "engine/edit/request/scales.h"
#include "engine/edit/target_views/view_agreement.h"
#include "engine/localize/clusters.h"
#include "engine/math/quantile.h"
#include "engine/remote/api/server_settings.h"
#include "engine/remote/views/change_map.h"
#include "engine/remote/views/colour_match.h"
#include "engine/remote/views/depth_warp.h"
#include "engine/remote/views/view_sheet.h"

namespace gse::remote {
namespace {

constexpr std::uint64_t SeedStream = 71000;  // of a round's seed: seeds of further attempts
constexpr int Attempts = 2;                  // at one picture
constexpr double RaisedStrength = 0.1;       // of an attempt at what came back unchanged
constexpr double ShapeStrength = 0.95;       // of what becomes something else
constexpr double SeamStrength = 0.35;        // of the pass over what was carried over and what was filled
constexpr double LeastHole = 0.01;           // of a mask: less is not asked for by itself
constexpr double FrontWeight = 0.5;          // by which a view from behind counts less as the key

// Own pictures (share_outside()). The rim is as wide as blurring and feathering reach.
constexpr double OwnBlurPx = 2, OwnRimPx = 6;  // of a picture of ReferenceSide
constexpr float OwnChange = 0.1f;              // of a channel: less is the trace of a compressed file
constexpr double LeastOutside = 0.002;         // of the picture
constexpr double ToldShare = 0.05;             // of what is changed: from here on it is said

// Views that are drawn once more, since they disagree with the others (METHOD.md, Views that agree).
constexpr std::uint64_t OutlierStream = 73000;  // of a round's seed
constexpr std::size_t LeastOfOutliers = 4;      // views of a round
constexpr double OutlierShare = 0.15;           // of them
constexpr double OutlierDistance = 0.1;         // of the colour range
constexpr double OutlierTimes = 2;              // the usual disagreement

/// The views that disagree most, worst first. The one at `key` is what others are drawn like.
std::vector<std::size_t> outliers_of(const std::vector<double>& disagreements, std::size_t key) {
    auto sorted = disagreements;
    const double least = std::max(OutlierDistance, OutlierTimes * upper_median(sorted));
    std::vector<std::size_t> outliers;
    for (std::size_t v = 0; v < disagreements.size(); ++v)
        if (v != key && disagreements[v] > least) outliers.push_back(v);
    std::stable_sort(outliers.begin(), outliers.end(),
                     [&](auto a, auto b) { return disagreements[a] > disagreements[b]; });
    const auto most = std::ceil(OutlierShare * static_cast<double>(disagreements.size()));
    outliers.resize(std::min(outliers.size(), static_cast<std::size_t>(most)));
    return outliers;
}

Mask difference(const Mask& mask, const Mask& without) {
    Mask result = mask;
    for (std::size_t i = 0; i < result.data.size(); ++i)
        if (without.data[i] != 0) result.data[i] = 0;
    return result;
}

void put_frame(RedrawOrder& order, const ViewFrame& frame) {
    order.picture = frame.picture;
    order.mask = as_image(frame.sent_mask);
}

}  // namespace

bool is_named(const edit::EditView& view, const std::string& name) {
    return !name.empty() && (view.view.name == name || file_name_of_view(view.view.name) == name);
}

double share_outside(const edit::EditView& view, const Image& own) {
    const double scale = view.mask.width / edit::ReferenceSide;
    const auto change = change_map(view.rendered, at_side(own, view.mask.width), OwnBlurPx * scale);
    const auto may = localize::dilate(view.mask, OwnRimPx * scale);
    std::size_t all = 0, outside = 0;
    for (std::size_t i = 0; i < change.data.size(); ++i) {
        if (change.data[i] <= OwnChange) continue;
        ++all;
        if (may.data[i] == 0) ++outside;
    }
    if (static_cast<double>(outside) < LeastOutside * static_cast<double>(change.data.size())) return 0;
    return static_cast<double>(outside) / static_cast<double>(all);
}

RoundDrawing::RoundDrawing(PictureSource& source, const RemoteDrawing& drawing,
                           const std::vector<edit::EditView>& views, const edit::EditViewsRequest& request,
                           const JobControl& job)
    : source_(source), drawing_(drawing), views_(views), request_(request),
      job_(job), drawing_job_{job.progress, ended_.get_token()}, squares_(views.size()),
      tried_(views.size(), false) {
    const int crop = crop_side(views);
    for (const auto& view : views)
        frames_.push_back(
            frame_of(view, crop_around(view.mask, crop), drawing.side, drawing.family.latent_cell));
    take_own_pictures();
}

void RoundDrawing::take_own_pictures() {
    for (const auto& own : drawing_.own)
        for (std::size_t v = 0; v < views_.size(); ++v) {
            if (!is_named(views_[v], own.view)) continue;
            CheckedPicture checked;
            checked.picture = framed(own.picture, frames_[v]);
            take(v, std::move(checked));
            const double outside = request_.round == 0 ? share_outside(views_[v], own.picture) : 0;
            if (outside < ToldShare) continue;
            round_.warnings.push_back(
                fmt::format("{:.0f} % of what your picture of {} changes lies outside of what may change, "
                            "and is left out: widen the label, or let its masks grow (--dilate-px)",
                            100 * outside, printable(views_[v].view.name)));
        }
}

void RoundDrawing::draw_views(KeyPicture& key) {
    switch (drawing_.agreement) {
        case Agreement::Sheet: views_.size() > 1 ? draw_sheets() : draw_each(); break;
        case Agreement::Reference: draw_with_reference(key); break;
        // Depths are those of the scene before: a new shape is not there.
        case Agreement::Warp: request_.anew ? draw_each() : draw_by_warp(); break;
        case Agreement::Auto:
        case Agreement::None: draw_each(); break;
    }
    redraw_outliers(key);
}

DrawnRound RoundDrawing::draw(KeyPicture& key) {
    const std::stop_callback with_job(job_.stop, [this] { ended_.request_stop(); });
    std::optional<Error> failure;
    try {
        draw_views(key);
    } catch (const Error& error) { failure = error; }
    const bool ended = offered_ && !drawing_.partial.stop->withdraw();
    if (ended && !failure) failure = Error(ErrorCode::Cancelled, "redrawing the views was stopped");
    if (failure) go_on_without_rest(*failure);
    for (std::size_t v = 0; v < views_.size(); ++v) {
        const bool drawn = is_there(v);
        round_.pictures.push_back(drawn ? pasted(views_[v], frames_[v], squares_[v]) : views_[v].rendered);
        round_.rejected.push_back(drawn || views_[v].mask.count() == 0 ? 0 : 1);
        round_.missing.push_back(round_.rejected.back() != 0 && !tried_[v] ? 1 : 0);
    }
    if (!views_.empty()) round_.drift /= static_cast<double>(views_.size());
    return std::move(round_);
}

PartialRound RoundDrawing::partial_round(const std::string& reason) const {
    PartialRound round;
    round.reason = reason;
    for (std::size_t v = 0; v < views_.size(); ++v) {
        if (views_[v].mask.count() == 0) continue;  // nothing changes there
        ++round.wanted;
        if (is_there(v)) ++round.drawn;
        else if (!tried_[v]) round.missing.push_back(views_[v].view.name);
    }
    return round;
}

void RoundDrawing::go_on_without_rest(const Error& error) const {
    const bool ended = error.code() == ErrorCode::Cancelled;
    const auto round = partial_round(ended ? std::string() : error.what());
    if (job_.stop_requested() || !is_enough(round.drawn, round.wanted)) throw Error(error);
    if (round.missing.empty() && !ended)
        return log::warning("views that disagree stay as they are: {}", error.what());
    if (!drawing_.partial.fits)
        throw Error(error.code(), error.message(),
                    fmt::format("{}{}{}: --server-fit-partial fits the scene to those, and another run asks "
                                "only for the rest",
                                error.hint(), error.hint().empty() ? "" : "; ", partial_text(round)));
    if (!drawing_.partial.fits(round)) throw Error(error);
    log::warning("{}: the scene is fitted without the rest", partial_text(round));
}

void RoundDrawing::draw_each() {
    std::vector<std::size_t> all(views_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    draw_ahead(all);
    for (const auto v : all)
        if (!is_there(v)) draw_alone(v);
}

void RoundDrawing::draw_alone(std::size_t view) { take(view, ask(frames_[view], order_for(view))); }

/// Four views a sheet. From the second sheet on, its first cell is the edited first view, which is not to
/// change.
void RoundDrawing::draw_sheets() {
    const std::size_t key = key_view();
    auto rest = outwards_from(key);
    rest.erase(rest.begin());
    std::erase_if(rest, [&](auto v) { return is_there(v); });
    std::vector<std::vector<std::size_t>> sheets;
    for (std::size_t next = 0; next < rest.size();) {
        sheets.push_back({key});
        while (sheets.back().size() < SheetCells && next < rest.size()) sheets.back().push_back(rest[next++]);
    }
    bool first = !is_there(key), ahead = false;
    for (std::size_t i = 0; i < sheets.size(); ++i) {
        if (source_.is_spread() && !first && !std::exchange(ahead, true)) {
            std::vector<RedrawOrder> orders;
            for (std::size_t j = i; j < sheets.size(); ++j)
                orders.push_back(sheet(sheets[j], &squares_[key]).order);
            for (auto& order : orders) suit_to_server(order, source_.facts(), drawing_.family);
            ask_ahead(orders, SheetCells - 1);
        }
        draw_sheet(sheets[i], first ? nullptr : &squares_[key]);
        first = first && squares_[key].data.empty();
    }
}

RoundDrawing::Sheet RoundDrawing::sheet(const std::vector<std::size_t>& cells, const Image* key) const {
    const int cell = cell_side(drawing_.side);
    Sheet sheet;
    std::vector<Image> pictures;
    std::vector<Mask> masks;
    for (const auto v : cells) {
        sheet.frames.push_back(frame_of(views_[v], frames_[v].section, cell, drawing_.family.latent_cell));
        pictures.push_back(sheet.frames.back().picture);
        masks.push_back(sheet.frames.back().sent_mask);
    }
    sheet.first = key != nullptr && !key->data.empty() ? 1 : 0;
    if (sheet.first == 1) pictures.front() = at_side(*key, cell), masks.front() = Mask(cell, cell);
    sheet.order = order(prompt_for_sheet(drawing_.family, drawing_.text));
    sheet.order.picture = sheet_of(pictures, drawing_.side);
    sheet.order.mask = as_image(sheet_mask(masks, drawing_.side));
    return sheet;
}

void RoundDrawing::draw_sheet(const std::vector<std::size_t>& cells, const Image* key) {
    const auto [frames, sheet_order, first] = sheet(cells, key);
    std::vector<CheckedPicture> best(cells.size());
    for (int attempt = 0; attempt < Attempts; ++attempt) {
        auto asked = sheet_order;
        if (attempt > 0) asked.seed = server_seed(Random::stream(request_.seed, SeedStream).next());
        const Image came = ask_server(std::move(asked));
        const Image answer = at_side(came, drawing_.side);
        bool flawed = false;
        for (std::size_t i = first; i < cells.size(); ++i) {
            auto checked = check_answer(frames[i], is_square(came) ? cut_cell(answer, i) : came);
            if (best[i].picture.data.empty() || best[i].flaw != Flaw::None) best[i] = std::move(checked);
            flawed = flawed || best[i].flaw != Flaw::None;
        }
        if (!flawed) break;
    }
    for (std::size_t i = first; i < cells.size(); ++i) {
        if (best[i].flaw == Flaw::None) {
            best[i].picture = match_colours(best[i].picture, frames[i].picture, frames[i].sent_mask);
            best[i].picture = at_side(best[i].picture, drawing_.side);
        }
        take(cells[i], std::move(best[i]));
    }
}

void RoundDrawing::draw_with_reference(KeyPicture& key) {
    std::vector<std::size_t> rest(views_.size());
    std::iota(rest.begin(), rest.end(), std::size_t{0});
    const bool again = views_.size() == 1 && !key.picture.data.empty();
    if (!again) {
        rest = outwards_from(key_view());
        if (!is_there(rest.front())) draw_alone(rest.front());
        key.picture = squares_[rest.front()];
        rest.erase(rest.begin());
    }
    std::erase_if(rest, [&](auto v) { return is_there(v); });
    draw_ahead(rest, key.picture.data.empty() ? nullptr : &key.picture);
    for (const auto v : rest) key.picture.data.empty() ? draw_alone(v) : draw_like(v, key.picture);
}

bool RoundDrawing::is_copy(std::size_t view, const Image& drawn, const Image& key) const {
    return drawn.width == key.width && !drawn.data.empty() &&
           edge_correlation(drawn, key) > edge_correlation(drawn, frames_[view].picture);
}

/// Some models copy the reference in place of following it: such a view is drawn by itself.
void RoundDrawing::draw_like(std::size_t view, const Image& key) {
    auto checked = ask(frames_[view], order_like(view, key));
    if (!is_copy(view, checked.picture, key)) return take(view, std::move(checked));
    log::info("the server copied the reference into a view, which is drawn without it");
    draw_alone(view);
}

void RoundDrawing::draw_by_warp() {
    const auto order = outwards_from(key_view());
    std::vector<std::size_t> drawn;
    std::copy_if(order.begin(), order.end(), std::back_inserter(drawn), [&](auto v) { return is_there(v); });
    for (const auto v : order) {
        if (is_there(v)) continue;
        drawn.empty() ? draw_alone(v) : draw_warped(v, drawn);
        if (!squares_[v].data.empty()) drawn.push_back(v);
    }
}

/// Carries over what is drawn already, has the rest filled in, and then all of it drawn once more at a low
/// strength, so that seams close.
void RoundDrawing::draw_warped(std::size_t view, const std::vector<std::size_t>& drawn) {
    std::vector<const edit::EditView*> from;
    std::vector<Image> pictures;
    std::vector<const Image*> shown;
    for (const auto v : drawn) {
        from.push_back(&views_[v]);
        pictures.push_back(pasted(views_[v], frames_[v], squares_[v]));
    }
    for (const auto& picture : pictures) shown.push_back(&picture);
    const auto warped = warp_by_depth(from, shown, views_[view]);
    edit::EditView filled = views_[view];
    filled.rendered = warped.picture;
    filled.mask = difference(views_[view].mask, warped.known);
    const auto mask_pixels = static_cast<double>(views_[view].mask.count());
    if (static_cast<double>(filled.mask.count()) > LeastHole * mask_pixels) {
        const auto frame =
            frame_of(filled, frames_[view].section, drawing_.side, drawing_.family.latent_cell);
        // Parts of the mask may lie beside the object.
        auto checked = ask(frame, order_for(view), true);
        if (checked.flaw != Flaw::None) return take(view, std::move(checked));
        filled.rendered = pasted(filled, frame, checked.picture);
    }
    filled.mask = views_[view].mask;
    auto asked = order_for(view);
    asked.strength = SeamStrength;
    take(view, ask(frame_of(filled, frames_[view].section, drawing_.side, drawing_.family.latent_cell),
                   std::move(asked)));
}

/// A view that disagrees with the others stands out: its points have other colours there than in most views.
void RoundDrawing::redraw_outliers(const KeyPicture& shared) {
    const bool follows =
        drawing_.family.references > 0 &&
        source_.facts().references > (picture_is_reference(source_.facts(), drawing_.family));
    if (request_.anew || !follows || views_.size() < LeastOfOutliers) return;
    const auto key = key_view();
    const Image picture = shared.picture.data.empty() ? squares_[key] : shared.picture;
    if (picture.data.empty()) return;
    const auto before = disagreements();
    for (const auto v : outliers_of(before, key)) {
        if (is_own(v)) continue;
        log::info("{} disagrees with the other views ({:.2f}), and is drawn once more like the key view",
                  views_[v].view.name, before[v]);
        auto order = order_like(v, picture);
        order.seed = server_seed(Random::stream(request_.seed, OutlierStream + v).next());
        const Image old = squares_[v];
        auto checked = ask(frames_[v], std::move(order));
        if (checked.flaw != Flaw::None || is_copy(v, checked.picture, picture)) continue;
        squares_[v] = std::move(checked.picture);
        if (disagreements()[v] < before[v]) ++round_.redrawn;
        else squares_[v] = old;
    }
}

bool RoundDrawing::is_own(std::size_t view) const {
    return std::any_of(drawing_.own.begin(), drawing_.own.end(),
                       [&](const auto& own) { return is_named(views_[view], own.view); });
}

/// Per view, 0 for those that are not there.
std::vector<double> RoundDrawing::disagreements() const {
    std::vector<edit::EditView> views;
    std::vector<Image> pictures;
    for (std::size_t v = 0; v < views_.size(); ++v) {
        if (!is_there(v)) continue;
        views.push_back(views_[v]);
        pictures.push_back(pasted(views_[v], frames_[v], squares_[v]));
    }
    const auto of_there = edit::view_disagreements(views, pictures);
    std::vector<double> all(views_.size(), 0.0);
    for (std::size_t v = 0, next = 0; v < views_.size(); ++v)
        if (is_there(v)) all[v] = of_there[next++];
    return all;
}

RedrawOrder RoundDrawing::order(std::string prompt) const {
    const auto& family = drawing_.family;
    RedrawOrder order = order_of(family);
    order.prompt = std::move(prompt);
    if (family.negative) order.negative_prompt = drawing_.text.negative;
    order.seed = server_seed(request_.seed);
    if (request_.round > 0) order.strength = family.again_strength;
    if (request_.anew && request_.round == 0 && !family.instructed())
        order.strength = std::max(order.strength, ShapeStrength);
    return order;
}

RedrawOrder RoundDrawing::order_for(std::size_t view) const {
    return order(
        prompt_for_view(drawing_.family, drawing_.text, views_[view].view_words, request_.round > 0));
}

RedrawOrder RoundDrawing::order_like(std::size_t view, const Image& key) const {
    auto order = order_for(view);
    order.prompt = prompt_with_reference(drawing_.family, drawing_.text, views_[view].view_words);
    order.references.push_back(key);
    return order;
}

RedrawOrder RoundDrawing::whole_order(std::size_t view, const Image* key) const {
    auto order = key == nullptr ? order_for(view) : order_like(view, *key);
    put_frame(order, frames_[view]);
    suit_to_server(order, source_.facts(), drawing_.family);
    return order;
}

void RoundDrawing::draw_ahead(const std::vector<std::size_t>& views, const Image* key) {
    if (!source_.is_spread()) return;
    std::vector<RedrawOrder> orders;
    for (const auto v : views)
        if (!is_there(v) && frames_[v].mask.count() > 0) orders.push_back(whole_order(v, key));
    try {
        ask_ahead(orders);
    } catch (const Error&) {
        take_kept(views, key);
        throw;
    }
    if (is_drawn_early()) take_kept(views, key);
}

void RoundDrawing::take_kept(const std::vector<std::size_t>& views, const Image* key) {
    for (const auto v : views) {
        if (is_there(v) || frames_[v].mask.count() == 0) continue;
        const auto order = whole_order(v, key);
        if (!source_.is_kept(order)) continue;
        auto checked = check_answer(frames_[v], source_.ask(order, {}));
        if (checked.flaw != Flaw::None) continue;
        checked.picture = match_colours(checked.picture, frames_[v].picture, frames_[v].sent_mask);
        take(v, std::move(checked));
    }
}

void RoundDrawing::ask_ahead(const std::vector<RedrawOrder>& orders, std::size_t views_each) {
    auto hosts = drawing_.nickname;
    for (const auto& one : source_.further())
        if (!one.left_out) hosts += ", " + one.name;
    const int total = static_cast<int>(views_.size()), begin = static_cast<int>(done_);
    const int each = static_cast<int>(views_each);
    source_.prefetch(orders, {[&](std::string_view, int drawn, int) {
                                  shown_ = std::min(begin + drawn * each, total - 1);
                                  job_.report(fmt::format("view {} of {} at {}", shown_ + 1, total, hosts),
                                              shown_, total);
                              },
                              drawing_job_.stop});
}

CheckedPicture RoundDrawing::ask(const ViewFrame& frame, RedrawOrder order, bool may_stay) {
    CheckedPicture checked;
    checked.picture = frame.picture;
    if (frame.mask.count() == 0) return checked;  // nothing may change
    put_frame(order, frame);
    for (int attempt = 0; attempt < Attempts; ++attempt) {
        if (attempt > 0) {
            order.seed = server_seed(Random::stream(request_.seed, SeedStream).next());
            if (checked.flaw == Flaw::Unedited && drawing_.family.has_strength())
                order.strength = std::min(1.0, order.strength + RaisedStrength);
        }
        checked = check_answer(frame, ask_server(order));
        if (may_stay && checked.flaw == Flaw::Unedited) checked.flaw = Flaw::None, checked.note.clear();
        if (checked.flaw != Flaw::None) continue;
        checked.picture = match_colours(checked.picture, frame.picture, frame.sent_mask);
        return checked;
    }
    return checked;
}

Image RoundDrawing::ask_server(RedrawOrder order) {
    if (drawing_job_.stop_requested()) throw Error(ErrorCode::Cancelled, "redrawing the views was stopped");
    suit_to_server(order, source_.facts(), drawing_.family);
    const int total = static_cast<int>(views_.size());
    shown_ = std::max(shown_, std::min(static_cast<int>(done_), total - 1));
    const int now = shown_;
    const auto stage = fmt::format("view {} of {} at {}", now + 1, total, drawing_.nickname);
    job_.report(stage, now, total);
    // Steps inside a view are not shown: few servers tell them.
    const auto waits = [&](std::string_view words, int place, int) {
        if (words == DrawingStage) return job_.report(stage, now, total);
        if (words == SlowStage) return report_slow(stage, place);
        job_.report(fmt::format("{}: {}{}", stage, words, place > 0 ? fmt::format(", place {}", place) : ""),
                    now, total);
    };
    return source_.ask(order, {waits, drawing_job_.stop});
}

/// Says once per view that it is waited for. `usual`: s.
void RoundDrawing::report_slow(const std::string& stage, int usual) {
    const auto text = fmt::format("{}: {} ({} s)", stage, SlowStage, usual);
    job_.report(text, shown_, static_cast<int>(views_.size()));
    if (std::exchange(told_slow_, shown_) != shown_)
        log::warning("{}; it is waited for, and Cancel ends it", text);
}

void RoundDrawing::take(std::size_t view, CheckedPicture checked) {
    ++done_;
    tried_[view] = true;
    round_.drift += checked.drift;
    auto& notes = round_.notes;
    if (!checked.note.empty()) {
        log::info("{}: {}", views_[view].view.name, checked.note);
        if (std::find(notes.begin(), notes.end(), checked.note) == notes.end()) notes.push_back(checked.note);
    }
    if (checked.flaw == Flaw::None) squares_[view] = std::move(checked.picture);
    const auto round = partial_round({});
    if (offered_ || drawing_.partial.stop == nullptr || !is_enough(round.drawn, round.wanted)) return;
    drawing_.partial.stop->offer(ended_);
    offered_ = true;
}

/// The view that the artist names, else one of his own, else that with the most to change; from behind it
/// counts less.
std::size_t RoundDrawing::key_view() const {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t v = 0; v < views_.size(); ++v) {
        const double front = views_[v].azimuth ? (1 + std::cos(*views_[v].azimuth)) / 2 : 1;
        const double named = is_named(views_[v], drawing_.key_view) ? 2 : is_there(v) ? 1 : 0;
        const double pixels = static_cast<double>(views_[v].mask.count()) * (1 - FrontWeight * (1 - front));
        const double weight = pixels + named * static_cast<double>(views_[v].mask.data.size());
        if (weight > most) most = weight, best = v;
    }
    return best;
}

/// All views: this one, then by the angle of their directions to it.
std::vector<std::size_t> RoundDrawing::outwards_from(std::size_t view) const {
    std::vector<std::size_t> order(views_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto direction = views_[view].view.camera.forward();
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        if ((a == view) != (b == view)) return a == view;
        return dot(views_[a].view.camera.forward(), direction) >
               dot(views_[b].view.camera.forward(), direction);
    });
    return order;
}

}  // namespace gse::remote
