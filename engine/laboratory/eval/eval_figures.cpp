// Renders before, after and truth, and compares.
#include "engine/laboratory/eval/eval_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/check.h"
#include "engine/edit/request/checked_request.h"
#include "engine/evaluate/consistency.h"
#include "engine/evaluate/direction.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/eval/sharpness.h"
#include "engine/localize/clusters.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

// Difference of display values that an artist sees as "something was added here".
constexpr double ClearChange = 0.1;

EvalViews ring(const synth::SynthScene& scene, int count, double offset, int side) {
    EvalViews ring;
    for (int i = 0; i < count; ++i) {
        const double azimuth = 2 * std::numbers::pi * (i + offset) / count;
        // The edit's views alternate between two heights; what is held out lies between them.
        const double elevation = offset > 0 ? 0.35 : i % 2 == 0 ? 0.2 : 0.5;
        ring.views.push_back(
            {fmt::format("ring_{}", i), synth::scene_camera(scene, azimuth, elevation, 1, side, side)});
        ring.words.push_back(synth::view_words(azimuth));
    }
    return ring;
}

Mask mask_of_rows(pipeline::Painter& painter, const GaussianSet& set, std::span<const std::uint8_t> bits,
                  const Camera& camera, double share) {
    const std::vector<float> values(bits.begin(), bits.end());
    Image seen;
    painter.rasterizer().forward_values(set.spans(), camera, {}, values, seen);
    Mask mask(camera.width, camera.height);
    for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = seen.data[p] > share ? 1 : 0;
    return mask;
}

Image picture(pipeline::Painter& painter, const GaussianSet& set, const Camera& camera) {
    Image image = painter.paint(set.spans(), camera, {}).colour;
    for (auto& value : image.data) value = std::clamp(value, 0.0f, 1.0f);
    return image;
}

/// Overlap of masks, pooled over views: a view that shows little counts little.
struct PooledOverlap {
    double both = 0, found = 0, wanted = 0;
    void add(const Mask& predicted, const Mask& truth) {
        for (std::size_t p = 0; p < truth.data.size(); ++p) {
            both += predicted.data[p] != 0 && truth.data[p] != 0 ? 1 : 0;
            found += predicted.data[p] != 0 ? 1 : 0;
            wanted += truth.data[p] != 0 ? 1 : 0;
        }
    }
    double recall() const { return wanted > 0 ? both / wanted : 0; }
    double precision() const { return found > 0 ? both / found : 0; }
    double iou() const { return found + wanted - both > 0 ? both / (found + wanted - both) : 0; }
};

double outline_score(const Mask& predicted, const Mask& truth) {
    return evaluate::boundary_f(predicted, truth, evaluate::boundary_tolerance_px(truth.width, truth.height));
}

/// A silhouette that is new is not known to the pixel.
bool new_outline(const EvalCase& edit) { return edit.kind == "add" || edit.kind == "replace"; }

double growth_px(const EvalSetting& setting) {
    const double doubled = new_outline(setting.edit) ? 2 : 1;
    return setting.request.dilate_px * doubled * setting.request.image_size / edit::ReferenceSide;
}

/// Error against the truth inside a mask, pooled over views.
struct InsideFigures {
    double absolute = 0, squared = 0, similar = 0, colour = 0, pixels = 0;
    void add(const Image& shown, const Image& wanted, const Mask& mask) {
        const auto area = static_cast<double>(mask.count());
        if (area == 0) return;
        const evaluate::Region inside{&mask, true};
        absolute += area * evaluate::mean_absolute_error(shown, wanted, inside);
        squared += area * std::pow(10, -evaluate::psnr_db(shown, wanted, inside) / 10);
        similar += area * evaluate::ssim(shown, wanted, inside);
        colour += area * evaluate::mean_colour_error(shown, wanted, inside);
        pixels += area;
    }
    double mean(double sum) const { return pixels > 0 ? sum / pixels : 0; }
    double psnr_db() const {
        return pixels > 0 && squared > 0 ? -10 * std::log10(squared / pixels) : evaluate::PsnrLimitDb;
    }
};

double reduction(double before, double after) { return before > 0 ? 1 - after / before : 0; }

/// Everything seen from the held-out views.
struct HeldOut {
    std::vector<Image> before, after, truth;
    std::vector<Mask> inside;  // the true part, before and after, grown
    std::vector<Mask> traces;  // wherever the true part shows at all, before or after, grown
    std::vector<Mask> part;    // the true part: after the edit where it is new
    std::vector<Mask> old;     // the true part before the edit; only where it is replaced
};

/// The scene in which the part that changes is there: new things are in the target only.
const synth::SynthScene& scene_of_part(const EvalSetting& setting) {
    return new_outline(setting.edit) ? setting.target : setting.source;
}

Mask joined(Mask a, const Mask& b) {
    for (std::size_t p = 0; p < a.data.size(); ++p) a.data[p] |= b.data[p];
    return a;
}

HeldOut look(const EvalSetting& setting, const GaussianSet& edited, pipeline::Painter& painter) {
    HeldOut seen;
    const auto& owner = scene_of_part(setting);
    for (const auto& view : setting.held_out.views) {
        seen.before.push_back(picture(painter, setting.source.scene.gaussians, view.camera));
        seen.after.push_back(picture(painter, edited, view.camera));
        seen.truth.push_back(picture(painter, setting.target.scene.gaussians, view.camera));
        seen.part.push_back(part_mask(painter, owner, setting.edit.part, view.camera, PartShare));
        Mask inside = seen.part.back(),
             traces = part_mask(painter, owner, setting.edit.part, view.camera, TraceShare);
        if (setting.edit.kind == "replace") {
            seen.old.push_back(part_mask(painter, setting.source, setting.edit.part, view.camera, PartShare));
            inside = joined(std::move(inside), seen.old.back());
            traces = joined(std::move(traces),
                            part_mask(painter, setting.source, setting.edit.part, view.camera, TraceShare));
        }
        seen.inside.push_back(localize::dilate(inside, growth_px(setting)));
        seen.traces.push_back(localize::dilate(traces, growth_px(setting)));
    }
    return seen;
}

void add_inside(const HeldOut& seen, Json& json) {
    InsideFigures before, after;
    for (std::size_t v = 0; v < seen.before.size(); ++v) {
        before.add(seen.before[v], seen.truth[v], seen.inside[v]);
        after.add(seen.after[v], seen.truth[v], seen.inside[v]);
    }
    json["l1_before"] = before.mean(before.absolute);
    json["l1_after"] = after.mean(after.absolute);
    json["l1_reduction"] = reduction(before.absolute, after.absolute);
    json["colour_error_before"] = before.mean(before.colour);
    json["colour_error_after"] = after.mean(after.colour);
    json["colour_error_reduction"] = reduction(before.colour, after.colour);
    json["psnr_inside_before_db"] = before.psnr_db();
    json["psnr_inside_db"] = after.psnr_db();
    json["ssim_inside_before"] = before.mean(before.similar);
    json["ssim_inside"] = after.mean(after.similar);
}

void add_outside(const HeldOut& seen, Json& json) {
    OutsideFigures outside, of_truth;
    for (std::size_t v = 0; v < seen.before.size(); ++v) {
        outside.add(seen.before[v], seen.after[v], seen.traces[v]);
        of_truth.add(seen.truth[v], seen.after[v], seen.traces[v]);
    }
    json["truth_psnr_outside_db"] = of_truth.psnr_db();
    json["psnr_outside_db"] = outside.psnr_db();
    json["ssim_outside"] = outside.ssim();
    json["leak_rate"] = outside.leak_rate();
}

/// Drift outside the masks that the edit itself worked with: what its preservation could hold.
void add_own_outside(const EvalSetting& setting, const edit::EditPlan& plan, const GaussianSet& edited,
                     pipeline::Painter& painter, Json& json) {
    OutsideFigures outside;
    for (std::size_t v = 0; v < plan.views.size(); ++v) {
        const Camera& camera = plan.views[v].camera;
        const Image before = picture(painter, setting.source.scene.gaussians, camera);
        outside.add(before, picture(painter, edited, camera), plan.masks[v]);
    }
    json["own_psnr_outside_db"] = outside.psnr_db();
    json["own_leak_rate"] = outside.leak_rate();
}

void add_changed(const HeldOut& seen, Json& json) {
    PooledOverlap overlap;
    for (std::size_t v = 0; v < seen.before.size(); ++v)
        overlap.add(evaluate::changed_pixels(seen.before[v], seen.after[v], ClearChange), seen.part[v]);
    json["changed_recall"] = overlap.recall();
    json["changed_precision"] = overlap.precision();
}

/// Agreement of the new object's outline with the true one, seen from the held-out views and pooled over
/// them. All rows that were allowed to change count, but for the ground that the old object hid.
void add_silhouette(const EvalSetting& setting, const edit::EditResult& result, const HeldOut& seen,
                    pipeline::Painter& painter, Json& json) {
    PooledOverlap overlap;
    auto thing = result.label;
    for (std::size_t row = 0; row < thing.size(); ++row) thing[row] &= result.hole_fill[row] == 0 ? 1 : 0;
    for (std::size_t v = 0; v < seen.part.size(); ++v) {
        const Camera& camera = setting.held_out.views[v].camera;
        overlap.add(mask_of_rows(painter, result.set, thing, camera, PartShare), seen.part[v]);
    }
    json["silhouette_iou"] = overlap.iou();
    json["silhouette_recall"] = overlap.recall();
    json["silhouette_precision"] = overlap.precision();
}

/// Sharpness of the new thing in pictures of SharpSide, from the held-out views.
void add_sharpness(const EvalSetting& setting, const GaussianSet& edited, pipeline::Painter& painter,
                   Json& json) {
    SharpnessFigures figures;
    for (const auto& view : setting.held_out.views) {
        const Camera camera = view.camera.resized(SharpSide, SharpSide);
        figures.add(picture(painter, edited, camera),
                    picture(painter, setting.target.scene.gaussians, camera),
                    part_mask(painter, setting.target, setting.edit.part, camera, PartShare));
    }
    json["sharp_ssim"] = figures.ssim();
    json["gradient_energy"] = figures.gradient_energy();
}

/// Shares of the old object's pixels that should clearly change. One counts those nearer to the old object
/// than to the truth, the other those without a clear change.
void add_old_left(const HeldOut& seen, Json& json) {
    double left = 0, unchanged = 0, pixels = 0;
    for (std::size_t v = 0; v < seen.old.size(); ++v) {
        const Mask changes = evaluate::changed_pixels(seen.before[v], seen.truth[v], ClearChange);
        const Mask changed = evaluate::changed_pixels(seen.before[v], seen.after[v], ClearChange);
        for (std::size_t p = 0; p < changes.data.size(); ++p) {
            if (changes.data[p] == 0 || seen.old[v].data[p] == 0) continue;
            double from_old = 0, from_true = 0;
            for (std::size_t c = p * 3; c < p * 3 + 3; ++c) {
                from_old += std::abs(static_cast<double>(seen.after[v].data[c]) - seen.before[v].data[c]);
                from_true += std::abs(static_cast<double>(seen.after[v].data[c]) - seen.truth[v].data[c]);
            }
            pixels += 1;
            left += from_old < from_true ? 1 : 0;
            unchanged += changed.data[p] == 0 ? 1 : 0;
        }
    }
    json["old_left"] = pixels > 0 ? left / pixels : 0;
    json["old_unchanged"] = pixels > 0 ? unchanged / pixels : 0;
}

/// Share of the old thing's pixels that still mainly show splats of it: what the edit has overlooked,
/// whatever the new thing covers.
void add_old_shown(const EvalSetting& setting, const edit::EditResult& result, const HeldOut& seen,
                   pipeline::Painter& painter, Json& json) {
    const auto old = rows_of(setting.source, setting.edit.part);
    GSE_CHECK_EQ(result.base_to_new.size(), old.size());
    std::vector<std::uint8_t> left(result.set.size(), 0);
    for (std::size_t row = 0; row < old.size(); ++row)
        if (old[row] != 0 && result.base_to_new[row] >= 0)
            left[static_cast<std::size_t>(result.base_to_new[row])] = 1;
    PooledOverlap overlap;
    for (std::size_t v = 0; v < seen.old.size(); ++v)
        overlap.add(mask_of_rows(painter, result.set, left, setting.held_out.views[v].camera, PartShare),
                    seen.old[v]);
    json["old_shown"] = overlap.recall();
}

/// Figures of another true scene of the sentence, in the heading and size in which it comes nearest. They
/// tell how much of the truth the sentence leaves open.
Json figures_of_another_truth(const EvalSetting& setting, const EvalTools& tools) {
    EvalSetting other = setting;
    auto spec = setting.edit.target;
    spec.variant = 1;
    const auto twin = synth::generate(spec);
    settle_pose(other, twin.scene.gaussians, tools);
    const HeldOut seen = look(other, twin.scene.gaussians, tools.painter);
    Json json, inside;
    add_inside(seen, inside);
    json["l1_reduction"] = inside["l1_reduction"];
    PooledOverlap overlap;
    for (std::size_t v = 0; v < seen.part.size(); ++v)
        overlap.add(
            part_mask(tools.painter, twin, setting.edit.part, setting.held_out.views[v].camera, PartShare),
            seen.part[v]);
    json["silhouette_iou"] = overlap.iou();
    add_old_left(seen, json);
    return json;
}

/// Mean picture of several other true scenes in the pose that the edit is compared in. It is about the best
/// guess that the sentence allows, though no picture of anything.
Json figures_of_mean_truth(const EvalSetting& setting, const EvalTools& tools) {
    constexpr int Scenes = 16;
    HeldOut seen = look(setting, setting.target.scene.gaussians, tools.painter);
    for (auto& mean : seen.after) std::fill(mean.data.begin(), mean.data.end(), 0.0f);
    for (int variant = 1; variant <= Scenes; ++variant) {
        auto spec = setting.target.spec;
        spec.variant = static_cast<std::uint64_t>(variant);
        const auto other = synth::generate(spec);
        for (std::size_t v = 0; v < seen.after.size(); ++v) {
            const Image shown =
                picture(tools.painter, other.scene.gaussians, setting.held_out.views[v].camera);
            for (std::size_t i = 0; i < shown.data.size(); ++i)
                seen.after[v].data[i] += shown.data[i] / Scenes;
        }
    }
    Json json, inside;
    add_inside(seen, inside);
    json["l1_reduction"] = inside["l1_reduction"];
    add_old_left(seen, json);
    return json;
}

void add_consistency(const HeldOut& seen, Json& json) {
    json["inconsistency"] = evaluate::path_inconsistency({seen.before, seen.after, seen.part, true});
    json["inconsistency_of_truth"] = evaluate::path_inconsistency({seen.before, seen.truth, seen.part, true});
}

/// Mean signed direction over the held-out views; null without an encoder.
void add_direction(const EvalSetting& setting, const HeldOut& seen, edit::ImageTextEncoder* score,
                   Json& json) {
    json["direction"] = json["direction_of_truth"] = nullptr;
    if (score == nullptr) return;
    const auto words_before = score->text(synth::full_caption(setting.source.spec).text);
    const auto words_after = score->text(setting.edit.prompt);
    double direction = 0, of_truth = 0;
    for (std::size_t v = 0; v < seen.before.size(); ++v) {
        const auto before = score->image(seen.before[v]), after = score->image(seen.after[v]);
        const auto truth = score->image(seen.truth[v]);
        direction += evaluate::direction_score({before, after, words_before, words_after});
        of_truth += evaluate::direction_score({before, truth, words_before, words_after});
    }
    json["direction"] = direction / static_cast<double>(seen.before.size());
    json["direction_of_truth"] = of_truth / static_cast<double>(seen.before.size());
}

/// Masks and label renders of an existing thing, mean over the edit's views; a view that found nothing counts
/// as zero.
void add_existing(const EvalSetting& setting, const edit::LocateResult& located, pipeline::Painter& painter,
                  Json& json) {
    const auto truth = rows_of(setting.source, setting.edit.part);
    // A search that took the sentence for an addition labels nothing that is there, and has no evidence of
    // it.
    const auto bits = located.label.bits ? *located.label.bits : std::vector<std::uint8_t>(truth.size());
    const auto plain = evaluate::row_overlap(bits, truth);
    json["iou"] = plain.iou;
    json["precision"] = plain.precision;
    json["recall"] = plain.recall;
    const bool weighted = located.found.field.coverage.size() == truth.size();
    json["weighted_iou"] =
        weighted ? evaluate::row_overlap(bits, truth, located.found.field.coverage).iou : plain.iou;
    double mask_iou = 0, mask_outline = 0, label_iou = 0, label_outline = 0;
    const auto count = static_cast<double>(setting.seen.views.size());
    for (std::size_t v = 0; v < setting.seen.views.size(); ++v) {
        const Camera& camera = setting.seen.views[v].camera;
        const Mask wanted = part_mask(painter, setting.source, setting.edit.part, camera, PartShare);
        const Mask& mask = located.views[v].mask;
        const Mask label = mask_of_rows(painter, setting.source.scene.gaussians, bits, camera, PartShare);
        mask_iou += evaluate::mask_overlap(mask, wanted).iou / count;
        mask_outline += outline_score(mask, wanted) / count;
        label_iou += evaluate::mask_overlap(label, wanted).iou / count;
        label_outline += outline_score(label, wanted) / count;
    }
    json["mask_iou"] = mask_iou;
    json["mask_boundary_f"] = mask_outline;
    json["label_iou"] = label_iou;
    json["label_boundary_f"] = label_outline;
}

/// The place of an added thing, pooled over the edit's views, and how well the thing it belongs to was found.
void add_place(const EvalSetting& setting, const edit::LocateResult& located, pipeline::Painter& painter,
               Json& json) {
    PooledOverlap place;
    double outline = 0;
    const auto count = static_cast<double>(setting.seen.views.size());
    for (std::size_t v = 0; v < setting.seen.views.size(); ++v) {
        const Camera& camera = setting.seen.views[v].camera;
        const Mask wanted = part_mask(painter, setting.target, setting.edit.part, camera, PartShare);
        place.add(located.views[v].mask, wanted);
        outline += outline_score(located.views[v].mask, wanted) / count;
    }
    json["place_recall"] = place.recall();
    json["place_precision"] = place.precision();
    json["place_iou"] = place.iou();
    json["place_boundary_f"] = outline;
    json["place_origin"] = located.region.origin;
    const auto truth = rows_of(setting.source, synth::Part::Object);
    json["source_weighted_iou"] =
        located.source_label.bits && located.found.field.coverage.size() == truth.size()
            ? Json(evaluate::row_overlap(*located.source_label.bits, truth, located.found.field.coverage).iou)
            : Json(nullptr);
}

}  // namespace

std::vector<std::uint8_t> rows_of(const synth::SynthScene& scene, synth::Part part) {
    std::vector<std::uint8_t> bits;
    for (const auto p : scene.parts) bits.push_back(p == part ? 1 : 0);
    return bits;
}

EvalSetting make_setting(const EvalCase& edit, const edit::EditRequest& settings, int held_out_views) {
    EvalSetting setting{edit, synth::generate(edit.source), synth::generate(edit.target), {}, {}, settings};
    setting.request.prompt = edit.prompt;
    setting.request.source = edit.word;
    setting.request.target = edit.target_word;
    setting.request = edit::check(setting.request).plain();
    setting.seen = ring(setting.source, settings.views, 0, settings.image_size);
    setting.held_out = ring(setting.source, held_out_views, 0.5, settings.image_size);
    return setting;
}

edit::EditMode right_mode(const EvalCase& edit) {
    return edit.kind == "add"       ? edit::EditMode::Add
           : edit.kind == "replace" ? edit::EditMode::Replace
                                    : edit::EditMode::Modify;
}

void settle_pose(EvalSetting& setting, const GaussianSet& edited, const EvalTools& tools) {
    if (setting.edit.kind != "replace") return;
    constexpr int Headings = 8;
    std::vector<Image> shown;
    for (const auto& view : setting.held_out.views)
        shown.push_back(picture(tools.painter, edited, view.camera));
    double least = std::numeric_limits<double>::infinity();
    const auto try_pose = [&](synth::SceneSpec spec) {
        auto scene = synth::generate(spec);
        double error = 0;
        for (std::size_t v = 0; v < shown.size(); ++v)
            error += evaluate::mean_absolute_error(
                shown[v], picture(tools.painter, scene.scene.gaussians, setting.held_out.views[v].camera));
        if (error >= least) return;
        least = error;
        setting.target = std::move(scene);
    };
    const auto asked = setting.edit.target;
    for (int i = 0; i < Headings; ++i) {
        auto spec = asked;
        spec.heading = 2 * std::numbers::pi * i / Headings;
        try_pose(spec);
    }
    for (const double size : {0.85, 1.15}) {
        auto spec = setting.target.spec;
        spec.size = size;
        try_pose(spec);
    }
}

Mask part_mask(pipeline::Painter& painter, const synth::SynthScene& scene, synth::Part part,
               const Camera& camera, double share) {
    return mask_of_rows(painter, scene.scene.gaussians, rows_of(scene, part), camera, share);
}

Json located_figures(const EvalSetting& setting, const edit::LocateResult& located, const EvalTools& tools) {
    Json json;
    const bool added = setting.edit.kind == "add";
    json["mode"] = edit::mode_name(located.mode);
    json["mode_right"] = located.mode == right_mode(setting.edit);
    json["failed_views"] = located.failed_views;
    if (added) add_place(setting, located, tools.painter, json);
    else add_existing(setting, located, tools.painter, json);
    return json;
}

Json edited_figures(const EvalSetting& setting, const edit::EditPlan& plan, const edit::EditResult& result,
                    const EvalTools& tools) {
    Json json;
    const HeldOut seen = look(setting, result.set, tools.painter);
    add_inside(seen, json);
    if (setting.edit.kind == "add") add_changed(seen, json);
    if (new_outline(setting.edit)) {
        add_silhouette(setting, result, seen, tools.painter, json);
        add_sharpness(setting, result.set, tools.painter, json);
    }
    if (setting.edit.kind == "replace") {
        add_old_left(seen, json);
        add_old_shown(setting, result, seen, tools.painter, json);
        json["another_truth"] = figures_of_another_truth(setting, tools);
        json["mean_truth"] = figures_of_mean_truth(setting, tools);
        json["truth"] = {{"heading", setting.target.spec.heading}, {"size", setting.target.spec.size}};
    }
    add_outside(seen, json);
    add_own_outside(setting, plan, result.set, tools.painter, json);
    add_consistency(seen, json);
    add_direction(setting, seen, tools.score, json);
    json["nonfinite"] = result.nonfinite;
    json["splats"] = result.set.size();
    return json;
}

void OutsideFigures::add(const Image& before, const Image& after, const Mask& mask) {
    const evaluate::Region outside{&mask, false};
    const auto area = static_cast<double>(mask.data.size() - mask.count());
    if (area == 0) return;
    double squared = 0;
    for (std::size_t i = 0; i < before.data.size(); ++i)
        if (outside.contains(i / 3)) {
            const double difference = static_cast<double>(before.data[i]) - after.data[i];
            squared += difference * difference / 3;
        }
    squared_error_ += squared;
    ssim_ += area * evaluate::ssim(before, after, outside);
    leaked_ += area * evaluate::leak_rate(before, after, outside);
    pixels_ += static_cast<std::size_t>(area);
}

double OutsideFigures::psnr_db() const {
    if (!(squared_error_ > 0) || pixels_ == 0) return evaluate::PsnrLimitDb;
    return std::min(evaluate::PsnrLimitDb, -10 * std::log10(squared_error_ / static_cast<double>(pixels_)));
}

double OutsideFigures::ssim() const { return pixels_ > 0 ? ssim_ / static_cast<double>(pixels_) : 1; }
double OutsideFigures::leak_rate() const { return pixels_ > 0 ? leaked_ / static_cast<double>(pixels_) : 0; }

}  // namespace gse::bench
