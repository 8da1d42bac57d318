// Pictures on an orbit around the label, and the border's neighbours.
#include "engine/edit/search/second_look.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/base/log.h"
#include "engine/edit/placement/head.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/search/front_reading.h"
#include "engine/edit/search/picture_words.h"
#include "engine/language/grammar.h"
#include "engine/localize/focus.h"
#include "engine/localize/frame_cut.h"

namespace gse::edit {
namespace {

constexpr int Around = 12;         // pictures
constexpr int PictureSide = 96;    // pixels; encoders of small models take fewer
constexpr double Elevation = 0.3;  // radians: the middle of a model's training pictures
// Share of a picture's side. An object that covers its rim so far is cut off there.
constexpr double CutRim = 1.0 / 7;
constexpr double Nearer = 0.8;  // of the distance of training pictures: the thing fills more of the picture

/// Tells whether a fair share of the picture's edge is masked.
bool fills_rim(const Mask& mask) {
    int rim = 0;
    for (int i = 0; i < mask.width; ++i) rim += (mask.at(i, 0) != 0) + (mask.at(i, mask.height - 1) != 0);
    for (int i = 0; i < mask.height; ++i) rim += (mask.at(0, i) != 0) + (mask.at(mask.width - 1, i) != 0);
    return rim >= CutRim * std::max(mask.width, mask.height);
}

bool reaches_rim(const Mask& mask) {
    const auto row = [&](int y) {
        for (int x = 0; x < mask.width; ++x)
            if (mask.at(x, y) != 0) return true;
        return false;
    };
    const auto column = [&](int x) {
        for (int y = 0; y < mask.height; ++y)
            if (mask.at(x, y) != 0) return true;
        return false;
    };
    return row(0) || row(mask.height - 1) || column(0) || column(mask.width - 1);
}

/// The orbit from which the finding stands in the picture as things do in a model's training pictures.
OrbitParameters framed(const Finding& finding) {
    OrbitParameters orbit = finding.orbit;
    if (language::has_usual_place(finding.word))  // a hat is told from near by
        return localize::focus_orbit(finding.gaussians, *finding.label.bits, orbit);
    const auto standing = standing_of(finding.gaussians, *finding.label.bits, orbit.up, finding.front);
    if (standing.found()) {
        const double height = figure_height(standing);
        orbit.centre = standing.foot + normalized(orbit.up) * (finding.traits.figure_aim * height);
        orbit.radius = Nearer * finding.traits.half_picture * height / std::tan(orbit.fov_x / 2);
    } else {
        orbit = localize::focus_orbit(finding.gaussians, *finding.label.bits, orbit);
    }
    orbit.elevation = Elevation;
    return orbit;
}

std::vector<Image> pictures_around(const Finding& finding, raster::Rasterizer& rasterizer) {
    const auto views = orbit_views(framed(finding), Around, PictureSide, PictureSide);
    return render_views(finding.gaussians, views, finding.settings, finding.ground, rasterizer, {}).renders;
}

}  // namespace

bool is_cut_off(const LocateResult& result, double share) {
    double seen = 0, cut = 0;
    for (const auto& view : result.views) {
        if (view.failed) continue;
        seen += 1, cut += fills_rim(view.mask) ? 1 : 0;
    }
    return seen > 0 && cut >= share * seen;
}

SecondLook look_along_border(const Finding& finding, ThreadPool* threads) {
    SecondLook look;
    std::vector<Camera> cameras;
    for (std::size_t v = 0; v < finding.evidence.size(); ++v) {
        if (finding.evidence[v].failed) continue;
        cameras.push_back(finding.views[v].camera);
        look.cut_views += reaches_rim(finding.evidence[v].mask) ? 1 : 0;
    }
    look.views = static_cast<int>(cameras.size());
    // Masks that keep off the edges tell as much, at once.
    if (2 * look.cut_views <= look.views || language::names_ground(finding.word)) return look;
    look.cut =
        localize::frame_cut(finding.gaussians.spans(), *finding.label.bits, cameras, {}, threads).share();
    return look;
}

bool encoder_knows(const Finding& finding, VocabularyRanker& recognition) {
    const std::size_t count = std::min(finding.evidence.size(), finding.views.size());
    if (count == 0) return true;
    const auto from = [&](std::size_t v) { return finding.views[v].camera.centre() - finding.orbit.centre; };
    const Vec3 up = normalized(finding.orbit.up), side = normalized(cross(up, from(0))),
               ahead = cross(side, up);
    std::vector<std::vector<float>> seen;
    std::vector<double> azimuths;
    for (std::size_t v = 0; v < count; v += std::max<std::size_t>(1, count / Around)) {
        seen.push_back(recognition.viewpoint(finding.evidence[v].render));
        if (seen.back().empty()) return true;
        azimuths.push_back(std::atan2(dot(from(v), side), dot(from(v), ahead)));
    }
    return front_by_viewpoints(seen, azimuths).sure;
}

SecondLook second_look(const Finding& finding, const SecondLookTools& tools) {
    SecondLook look = look_along_border(finding, tools.threads);
    const auto& bits = *finding.label.bits;
    if (tools.recognition == nullptr || !tools.recognition->available() ||
        std::find(bits.begin(), bits.end(), std::uint8_t{1}) == bits.end() ||
        !encoder_knows(finding, *tools.recognition))
        return look;
    const auto said = lead_of(*tools.recognition, finding.word, pictures_around(finding, tools.rasterizer));
    if (!said) return look;
    log::debug("\"{}\" leads by {:.3f}; the encoder sees \"{}\" (fit {:.2f})", finding.word, said->lead,
               said->best, said->fit);
    look.lead = said->lead;
    look.worn = language::has_usual_place(finding.word);
    if (said->lead < 0) look.better = said->best;
    return look;
}

void take_second_look(LocateResult& result, const SecondLook& look, double least) {
    auto verdict = reconsider(
        {std::move(result.confidence), result.problem, std::move(result.message), std::move(result.remedy)},
        result.word, look, least);
    result.confidence = std::move(verdict.confidence);
    result.problem = verdict.problem;
    result.message = std::move(verdict.message);
    result.remedy = std::move(verdict.remedy);
}

void require_head(LocateResult& result, const Finding& finding, const CheckedRequest& request,
                  const SecondLookTools& tools) {
    if (result.mode != EditMode::Add || !is_worn_at_head(request)) return;
    if (tools.recognition == nullptr || !tools.recognition->available()) return;
    if (!is_head_unclear(finding.gaussians, *result.source_label.bits, finding.orbit.up, finding.front,
                         finding.traits) ||
        encoder_knows(finding, *tools.recognition))
        return;
    result.problem = SearchProblem::NoPlace;
    result.message = fmt::format("it is not clear where the head of \"{}\" is, which \"{}\" goes to",
                                 request.source(), request.target());
    result.remedy = "put a box around its head: Cut out in the window, --cut-out on the command line";
}

}  // namespace gse::edit
