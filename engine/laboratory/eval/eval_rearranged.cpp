// The job of a sentence with one step; rows against maps, pictures against the world's truth.
#include "engine/laboratory/eval/eval_rearranged.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/error.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/eval/hole_figures.h"
#include "engine/laboratory/eval/rearranged_truth.h"
#include "engine/localize/clusters.h"
#include "engine/pipeline/steps/edit_steps.h"
#include "engine/pipeline/steps/step_judgement.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using Bits = std::vector<std::uint8_t>;

constexpr int Side = 192;                     // of a held-out picture, pixels
constexpr double Elevation = 0.35;            // radians, between those of an edit's views
constexpr double FromAfar = 0.55;             // zoom from which places beside the thing are seen
constexpr double LeftShare = 0.1;             // of a pixel that remains of a thing may make up unseen
constexpr double HoleDifference = 4.0 / 255;  // between truth and plain deletion: it must be filled
constexpr double FarAway = 1;                 // sizes of the thing from its foot: no hole is there

Bits without(Bits bits) {
    for (auto& bit : bits) bit = bit == 0 ? 1 : 0;
    return bits;
}

std::size_t count_of(const Bits& bits) {
    return static_cast<std::size_t>(std::count(bits.begin(), bits.end(), std::uint8_t{1}));
}

/// True for rows with equal bits of opacity and of the first extent, which moves keep.
bool same_opacity_and_size(const GaussianSet& a, std::size_t i, const GaussianSet& b, std::size_t j) {
    return a.opacity_logit()[i] == b.opacity_logit()[j] && a.log_scale()[i * 3] == b.log_scale()[j * 3];
}

/// A case whose edit has run.
class Rearranged {
public:
    Rearranged(const EvalCase& edit, const synth::SynthScene& scene, pipeline::EditJob& job,
               const CompoundTools& tools)
        : edit_(edit), scene_(scene), job_(job), tools_(tools), thing_(rows_of(scene, synth::Part::Object)),
          label_(*job.located().label.bits), things_(scene.scene.gaussians.filtered(thing_)),
          axes_(front_axes(edit.source)), extent_(extent_of(things_, axes_)) {
        const double zoom = edit.asked.things == 0 ? 1 : FromAfar;
        for (int i = 0; i < tools.held_out_views; ++i)
            cameras_.push_back(synth::scene_camera(
                scene, 2 * std::numbers::pi * (i + 0.5) / tools.held_out_views, Elevation, zoom, Side, Side));
    }

    Json figures() {
        Json json{{"label_iou", label_iou()}, {"labelled", count_of(label_)}};
        json["rows_changed_outside"] = job_.result().changed_outside_label;
        if (edit_.asked.things > 0) add_maps(json);
        json["rows_removed_lit"] = removed(0);
        json["rows_removed_far"] = removed(FarAway * extent_.longest());
        json["rows_added"] = count_of(job_.result().hole_fill);
        if (const auto front = job_.front_read())
            json["front_error_degrees"] =
                std::abs(std::remainder(*front - synth::turn_of(edit_.source), 2 * std::numbers::pi)) * 180 /
                std::numbers::pi;
        const GaussianSet truth = true_scene();
        if (edit_.asked.things == 0) add_hole(truth, json);
        else add_pictures(truth, json);
        add_row(truth);
        return json;
    }

private:
    const GaussianSet& base() const { return scene_.scene.gaussians; }

    Image paint(const GaussianSet& set, const Camera& camera) {
        Image image = tools_.eval.painter.paint(set.spans(), camera, {}).colour;
        for (auto& value : image.data) value = std::clamp(value, 0.0f, 1.0f);
        return image;
    }

    Mask shown(const GaussianSet& set, const Bits& bits, const Camera& camera, double share) {
        const std::vector<float> values(bits.begin(), bits.end());
        Image seen;
        tools_.eval.painter.rasterizer().forward_values(set.spans(), camera, {}, values, seen);
        Mask mask(camera.width, camera.height);
        for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = seen.data[p] > share ? 1 : 0;
        return mask;
    }

    double label_iou() const {
        double both = 0, either = 0;
        for (std::size_t row = 0; row < label_.size(); ++row) {
            both += label_[row] & thing_[row];
            either += label_[row] | thing_[row];
        }
        return either > 0 ? both / either : 0;
    }

    /// Number of rows that are gone, and neither labelled nor in the thing's shadow before or after, and
    /// farther from its foot than `distance`.
    std::size_t removed(double distance) const {
        const Bits dark = shadowed_rows(scene_, places_);
        std::size_t count = 0;
        for (std::size_t row = 0; row < label_.size(); ++row) {
            if (label_[row] != 0 || dark[row] != 0 || job_.result().base_to_new[row] >= 0) continue;
            const auto p = base().position().subspan(row * 3, 3);
            count += length(Vec3{p[0], p[1], p[2]} - extent_.foot) >= distance ? 1 : 0;
        }
        return count;
    }

    /// Pairs of labelled rows and what became of them.
    RowPairs pairs_of_thing() const {
        RowPairs pairs;
        for (std::size_t row = 0; row < label_.size(); ++row)
            if (const auto now = job_.result().base_to_new[row]; label_[row] != 0 && now >= 0)
                pairs.emplace_back(row, static_cast<std::size_t>(now));
        if (pairs.size() != count_of(label_))
            throw Error(ErrorCode::InvalidArgument, "the result lacks rows of the thing");
        return pairs;
    }

    /// Pairs of rows and their copies, copy by copy: behind the rows that stay, in their order. A copy has
    /// what the thing wears or holds, too.
    std::vector<RowPairs> pairs_of_copies() const {
        const auto& result = job_.result();
        const auto staying = static_cast<std::size_t>(std::count_if(
            result.base_to_new.begin(), result.base_to_new.end(), [](std::int64_t row) { return row >= 0; }));
        const auto copies = static_cast<std::size_t>(edit_.asked.things - 1);
        const std::size_t rows =
            copies > 0 ? (result.set.size() - staying - count_of(result.hole_fill)) / copies : 0;
        std::vector<RowPairs> list(copies);
        for (std::size_t copy = 0; copy < copies; ++copy) {
            std::size_t next = staying + copy * rows;
            const std::size_t end = next + rows;
            for (std::size_t row = 0; row < label_.size() && next < end; ++row)
                if (same_opacity_and_size(base(), row, result.set, next))
                    list[copy].emplace_back(row, next++);
            if (next != end || rows < count_of(label_))
                throw Error(ErrorCode::InvalidArgument, "the result lacks rows of a copy");
        }
        return list;
    }

    void add_maps(Json& json) {
        MapError error;
        const auto& result = job_.result();
        synth::Placing map = asked_map(edit_, extent_, axes_);
        const Vec3 wanted = map.shift;
        const auto follow = [&](const RowPairs& pairs) {
            map.shift = fitted_shift(base(), result.set, pairs, map);
            error.add(map_error(base(), result.set, pairs, map));
        };
        follow(pairs_of_thing());
        json["place_error"] = length(map.shift - wanted) / extent_.longest();
        places_.push_back(map);
        places_.back().shift = settled(wanted, map.shift);
        double nearest = 1e300;
        for (const auto& pairs : pairs_of_copies()) {
            follow(pairs);
            for (const auto& other : places_) nearest = std::min(nearest, length(map.shift - other.shift));
            places_.push_back(map);
        }
        json["position_error"] = error.position / extent_.longest();
        json["covariance_error"] = error.covariance;
        json["colour_error"] = error.colour;
        if (edit_.asked.things > 1) json["copies_apart"] = nearest / extent_.longest();
    }

    /// True place of the thing. The sentence leaves the middle of turns and sizes open, but not the height.
    Vec3 settled(const Vec3& wanted, const Vec3& found) const {
        const bool about_foot = edit_.asked.degrees != 0 || edit_.asked.size != 1;
        return about_foot ? found + axes_.up * dot(axes_.up, wanted - found) : wanted;
    }

    GaussianSet true_scene() const {
        GaussianSet ground = synth::ground_under(edit_.source, places_);
        if (places_.empty()) return ground;
        GaussianData padded = ground.to_data();  // of the things' SH degree
        const auto stride = static_cast<std::size_t>(things_.sh().size() / things_.size());
        std::vector<float> sh(padded.size() * stride, 0.0f);
        for (std::size_t row = 0; row < padded.size(); ++row)
            std::copy_n(padded.sh.begin() + static_cast<std::ptrdiff_t>(row * 3), 3,
                        sh.begin() + static_cast<std::ptrdiff_t>(row * stride));
        padded.sh = std::move(sh);
        padded.sh_degree = things_.sh_degree();
        std::vector<GaussianSet> parts{GaussianSet(std::move(padded))};
        for (const auto& place : places_) parts.push_back(placed(things_, place));
        return joined_sets(parts);
    }

    /// Removal: the hole that the true thing leaves, what is left of the thing, everything else.
    void add_hole(const GaussianSet& truth, Json& json) {
        HoleFigures hole_figures;
        OutsideFigures outside;
        double left = 0, pixels = 0;
        const GaussianSet truly_deleted = base().filtered(without(thing_));
        const GaussianSet deleted = base().filtered(without(label_));
        const auto& result = job_.result();
        Bits remains(result.set.size(), 0);
        for (std::size_t row = 0; row < thing_.size(); ++row)
            if (thing_[row] != 0 && result.base_to_new[row] >= 0)
                remains[static_cast<std::size_t>(result.base_to_new[row])] = 1;
        for (const auto& camera : cameras_) {
            const Image wanted = paint(truth, camera), healed = paint(result.set, camera);
            const Mask hole = localize::dilate(
                evaluate::changed_pixels(wanted, paint(truly_deleted, camera), HoleDifference), 1);
            hole_figures.add(wanted, paint(deleted, camera), healed, hole);
            const Mask seen = shown(base(), thing_, camera, PartShare);
            const Mask still = shown(result.set, remains, camera, LeftShare);
            Mask touched = shown(base(), thing_, camera, TraceShare);
            for (std::size_t p = 0; p < seen.data.size(); ++p) {
                pixels += seen.data[p];
                left += seen.data[p] & still.data[p];
                touched.data[p] |= hole.data[p];
            }
            outside.add(wanted, healed, localize::dilate(touched, 2));
        }
        json.update(hole_figures.json());
        json["thing_left"] = pixels > 0 ? left / pixels : 0;
        json["psnr_outside_truth_db"] = outside.psnr_db();
    }

    /// Rearrangement: where the thing truly is, and the whole picture.
    void add_pictures(const GaussianSet& truth, Json& json) {
        double inside = 0, whole = 0, before = 0;
        Bits things(truth.size(), 1);
        std::fill_n(things.begin(), truth.size() - places_.size() * things_.size(), std::uint8_t{0});
        const auto error = [](double psnr) { return std::pow(10, -psnr / 10); };
        for (const auto& camera : cameras_) {
            const Image wanted = paint(truth, camera), found = paint(job_.result().set, camera);
            const Mask there = shown(truth, things, camera, PartShare);
            inside += error(evaluate::psnr_db(found, wanted, {&there, true}));
            whole += error(evaluate::psnr_db(found, wanted));
            before += error(evaluate::psnr_db(paint(base(), camera), wanted));
        }
        const auto views = static_cast<double>(cameras_.size());
        const auto db = [&](double sum) { return -10 * std::log10(sum / views); };
        json["psnr_thing_db"] = db(inside);
        json["psnr_scene_db"] = db(whole);
        json["psnr_scene_before_db"] = db(before);
    }

    /// Before, label, after and truth from the front; after and truth from behind.
    void add_row(const GaussianSet& truth) {
        const Camera& front = cameras_.front();
        const Camera& behind = cameras_[cameras_.size() / 2];
        const Image before = paint(base(), front);
        tools_.sheets.add({before, with_mask(before, shown(base(), label_, front, PartShare)),
                           paint(job_.result().set, front), paint(truth, front),
                           paint(job_.result().set, behind), paint(truth, behind)},
                          edit_.kind + ": " + edit_.prompt);
    }

    const EvalCase& edit_;
    const synth::SynthScene& scene_;
    pipeline::EditJob& job_;
    const CompoundTools& tools_;
    Bits thing_, label_;
    GaussianSet things_;
    FrontAxes axes_;
    ThingExtent extent_;
    std::vector<Camera> cameras_;
    std::vector<synth::Placing> places_;  // of the thing and its copies in the true scene
};

}  // namespace

Json rearranged_figures(const EvalCase& edit, const pipeline::EditRecipe& recipe, const CompoundTools& tools,
                        const JobControl& control) {
    auto scene = edit.asked.things > 0 ? directional_scene(edit.source) : synth::generate(edit.source);
    if (edit.asked.scanned) scene = scanned(std::move(scene), tools.eval.painter.rasterizer());
    auto planned =
        pipeline::steps_of_sentence(recipe, language::plan::scene_words(scene_words_of(edit.source)), false);
    Json json{{"plan", language::plan::to_string(planned.plan)}, {"scanned", edit.asked.scanned}};
    pipeline::StepSequence sequence(recipe, std::move(planned));
    if (sequence.size() != 1)
        throw Error(ErrorCode::InvalidArgument,
                    "the sentence is not one step: " + json["plan"].get<std::string>());
    const auto first = [&](pipeline::EditRecipe begun) {
        return std::make_unique<pipeline::EditJob>(
            std::move(begun), pipeline::EditJobInput{scene.scene, {}, tools.model}, control);
    };
    auto job = sequence.job_of(0, first, control);
    job->locate();
    edit::require_found(job->located());
    job->run();
    if (job->result().stopped) throw Error(ErrorCode::Cancelled, "the evaluation was stopped");
    if (job->result().failure) throw *job->result().failure;
    json["job"]["seconds"] = job->times().to_json();
    json["rearranged"] = Rearranged(edit, scene, *job, tools).figures();
    json["judgement"] = pipeline::judgement_to_json(pipeline::judge_step(*job));
    return json;
}

}  // namespace gse::bench
