// Rounds, outlines, figures.
#include "engine/remote/views/remote_view_editor.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/edit/request/scales.h"
#include "engine/remote/views/change_map.h"

namespace gse::remote {
namespace {

constexpr double ChangeBlurPx = 2;  // of a picture of ReferenceSide

}  // namespace

/// Names that an artist gave mean views of the first round.
void RemoteViewEditor::check_names(const std::vector<edit::EditView>& views) {
    if (std::exchange(names_checked_, true)) return;
    std::vector<std::string> wanted, known;
    for (const auto& own : drawing_.own) wanted.push_back(own.view);
    if (!drawing_.key_view.empty()) wanted.push_back(drawing_.key_view);
    for (const auto& view : views) known.push_back(printable(view.view.name));
    for (const auto& name : wanted)
        if (std::none_of(views.begin(), views.end(), [&](const auto& view) { return is_named(view, name); }))
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" is none of the views that are drawn", printable(name)),
                        fmt::format("they are {}", fmt::join(known, ", ")));
}

/// A round whose views are of two models is drawn once more.
DrawnRound RemoteViewEditor::draw(const std::vector<edit::EditView>& views,
                                  const edit::EditViewsRequest& request, const JobControl& job) {
    check_names(views);
    RemoteDrawing drawing = drawing_;
    if (!request.sentence.empty()) drawing.text.description = request.sentence;
    const auto changes = source_.model_changes();
    auto drawn = RoundDrawing(source_, drawing, views, request, job).draw(key_);
    const bool partial = std::find(drawn.missing.begin(), drawn.missing.end(), 1) != drawn.missing.end();
    if (source_.model_changes() == changes || views.size() < 2 || partial) return drawn;
    log::warning("its views are of two models and are all drawn once more");
    return RoundDrawing(source_, drawing, views, request, job).draw(key_);
}

edit::EditedViews RemoteViewEditor::edit(const std::vector<edit::EditView>& views,
                                         const edit::EditViewsRequest& request, const JobControl& job) {
    const auto before = source_.use();
    auto drawn = draw(views, request, job);
    const auto rejected =
        static_cast<std::size_t>(std::count(drawn.rejected.begin(), drawn.rejected.end(), 1));
    if (!views.empty() && rejected == views.size())
        throw Error(ErrorCode::Model,
                    fmt::format("none of the {} pictures from the server can be used: {}", views.size(),
                                drawn.notes.empty() ? "" : drawn.notes.front()),
                    "look at the server's model and settings; gseditpro server URL --draw shows one picture");
    const auto missing = static_cast<std::size_t>(std::count(drawn.missing.begin(), drawn.missing.end(), 1));
    if (rejected > missing)
        log::warning("{} of {} pictures from the server are left out: {}", rejected - missing, views.size(),
                     drawn.notes.empty() ? "" : drawn.notes.front());
    edit::EditedViews edited;
    const auto& use = source_.use();
    edited.scalars = {{"requests", static_cast<double>(use.requests - before.requests)},
                      {"cached_requests", static_cast<double>(use.cached - before.cached)},
                      {"megapixels", use.megapixels - before.megapixels},
                      {"server_seconds", use.seconds - before.seconds},
                      {"rejected", static_cast<double>(rejected)},
                      {"drift", drawn.drift}};
    if (drawn.redrawn > 0) edited.scalars["redrawn_outliers"] = drawn.redrawn;
    if (request.anew) add_outlines(views, drawn, edited);
    edited.rejected = std::move(drawn.rejected);
    edited.warnings = std::move(drawn.warnings);
    if (missing > 0) {
        edited.missing = std::move(drawn.missing);
        edited.unfinished = true;  // what was not drawn looks as it did
        edited.warnings.push_back(
            fmt::format("{} of {} views were not drawn, and the scene is fitted without them: Redo has one "
                        "drawn, and so does another run",
                        missing, views.size()));
    }
    edited.images = std::move(drawn.pictures);
    return edited;
}

void RemoteViewEditor::add_outlines(const std::vector<edit::EditView>& views, const DrawnRound& drawn,
                                    edit::EditedViews& edited) const {
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto& view = views[v];
        const auto& without =
            view.clean_plate.picture.data.empty() ? view.original : view.clean_plate.picture;
        const double blur = ChangeBlurPx * view.mask.width / edit::ReferenceSide;
        edited.outlines.push_back(
            drawn.rejected[v] != 0
                ? Image(view.mask.width, view.mask.height, 1)
                : outline_of_change(change_map(without, drawn.pictures[v], blur), view.mask));
    }
}

}  // namespace gse::remote
