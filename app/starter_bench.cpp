// Held-out scenes, true labels and true targets from the synthetic world.
#include "app/starter_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/neural_loader.h"
#include "engine/base/error.h"
#include "engine/edit/grabcut_segmenter.h"
#include "engine/evaluate/metrics.h"
#include "engine/synth/synth.h"

namespace gse::app {
namespace {

using Json = nlohmann::ordered_json;

double mean_of(const Json& cases, const char* key) {
    double sum = 0;
    for (const auto& entry : cases) sum += entry[key].get<double>();
    return cases.empty() ? 0 : sum / static_cast<double>(cases.size());
}

std::vector<std::uint8_t> rows_of(const synth::SynthScene& scene, synth::Part part) {
    std::vector<std::uint8_t> bits;
    for (const auto p : scene.parts) bits.push_back(p == part ? 1 : 0);
    return bits;
}

class StarterBench {
public:
    StarterBench(const StarterBenchParameters& parameters, const EditRecipe& settings, const JobControl& job)
        : parameters_(parameters), settings_(settings), job_(job) {
        neural_api().set_threads(settings.job.threads);
        const auto path = settings.job.model.empty() ? starter_model_path() : std::filesystem::path(settings.job.model);
        model_ = neural_api().load_model(path, settings.job.device);
        attention_ = model_->attention();
        segmenter_ = edit::make_default_segmenter();
    }

    Json run() {
        Json report;
        report["model"] = model_->name();
        report["seed"] = parameters_.seed;
        report["localization"] = localization();
        report["recolour"] = recolour();
        report["add"] = addition();
        return report;
    }

private:
    struct Setting {
        synth::SynthScene scene;
        std::vector<View> views;
        std::vector<std::string> words;
        edit::EditRequest request;
    };

    Setting make_setting(const synth::SceneSpec& spec, const std::string& prompt, const std::string& source,
                         const std::string& target, const std::string& mode) const {
        Setting setting{synth::generate(spec), {}, {}, settings_.request};
        const int side = settings_.request.image_size, count = settings_.request.views;
        for (int i = 0; i < count; ++i) {
            const double azimuth = 2 * std::numbers::pi * i / count;
            setting.views.push_back({fmt::format("ring_{}", i),
                                     synth::scene_camera(setting.scene, azimuth, i % 2 == 0 ? 0.2 : 0.5, 1, side, side)});
            setting.words.push_back(synth::view_words(azimuth));
        }
        setting.request.prompt = prompt;
        setting.request.source = source;
        setting.request.target = target;
        setting.request.mode = mode;
        setting.request = edit::validated(setting.request);
        return setting;
    }

    edit::LocateInput input(const Setting& setting) const {
        return {setting.scene.scene.gaussians, setting.views, setting.words, setting.request, {},
                setting.scene.scene.info.up};
    }

    edit::LocateResult locate(const Setting& setting) {
        const edit::LocateTools tools{painter_.rasterizer(), *attention_, segmenter_.get(), nullptr, {{}, job_.stop}};
        return edit::locate(input(setting), tools);
    }

    edit::EditResult edit_scene(const Setting& setting, const edit::LocateResult& located, edit::EditPlan& plan) {
        plan = edit::make_plan(input(setting), located, painter_.rasterizer());
        const auto guidance = model_->guidance(setting.request.prompt,
                                               with_sentence_before(settings_.guidance, setting.request));
        return edit::run_edit(setting.scene.scene.gaussians, plan, setting.request,
                              {painter_.rasterizer(), *guidance, {}, {{}, job_.stop}});
    }

    Json localization() {
        Json cases = Json::array();
        Random random(parameters_.seed);
        for (int i = 0; i < parameters_.scenes; ++i) {
            const auto spec = synth::held_out_spec(random, 0.5);
            const auto caption = synth::full_caption(spec).text;
            const auto setting = make_setting(spec, caption, spec.object, spec.object, "modify");
            Json entry{{"caption", caption}, {"word", spec.object}};
            try {
                const auto located = locate(setting);
                const auto truth = rows_of(setting.scene, synth::Part::Object);
                const auto plain = evaluate::row_overlap(*located.label.bits, truth);
                entry["iou"] = plain.iou;
                entry["precision"] = plain.precision;
                entry["recall"] = plain.recall;
                entry["weighted_iou"] = evaluate::row_overlap(*located.label.bits, truth, located.weights.evidence).iou;
            } catch (const Error& error) {   // not found at all counts as zero
                if (error.code() == ErrorCode::Cancelled) throw;
                entry["iou"] = entry["precision"] = entry["recall"] = entry["weighted_iou"] = 0.0;
                entry["error"] = error.message();
            }
            cases.push_back(std::move(entry));
            job_.report("locating", i + 1, parameters_.scenes);
        }
        return {{"mean_iou", mean_of(cases, "iou")}, {"mean_weighted_iou", mean_of(cases, "weighted_iou")},
                {"cases", cases}};
    }

    /// Mean colour error of the object, and PSNR outside it, against the true target on views between the edit's.
    Json compare(const Setting& setting, const GaussianSet& edited, const synth::SynthScene& target, synth::Part part) {
        double before = 0, after = 0, l1_before = 0, l1_after = 0, outside = 0;
        constexpr int views = 8;
        const int side = settings_.request.image_size;
        const auto truth = rows_of(target, part);
        const std::vector<float> values(truth.begin(), truth.end());
        for (int i = 0; i < views; ++i) {
            const Camera camera =
                synth::scene_camera(target, 0.13 + 2 * std::numbers::pi * i / views, 0.35, 1, side, side);
            Image seen;
            painter_.rasterizer().forward_values(target.scene.gaussians.spans(), camera, {}, values, seen);
            Mask mask(side, side), near(side, side);
            for (std::size_t p = 0; p < mask.data.size(); ++p) {
                mask.data[p] = seen.data[p] > 0.5f ? 1 : 0;
                near.data[p] = seen.data[p] > 0.02f ? 1 : 0;
            }
            const Image source = painter_.paint(setting.scene.scene.gaussians.spans(), camera, {}).colour;
            const Image wanted = painter_.paint(target.scene.gaussians.spans(), camera, {}).colour;
            const Image got = painter_.paint(edited.spans(), camera, {}).colour;
            before += evaluate::mean_colour_error(source, wanted, {&mask, true}) / views;
            after += evaluate::mean_colour_error(got, wanted, {&mask, true}) / views;
            l1_before += evaluate::mean_absolute_error(source, wanted, {&mask, true}) / views;
            l1_after += evaluate::mean_absolute_error(got, wanted, {&mask, true}) / views;
            outside += std::pow(10, -evaluate::psnr_db(source, got, {&near, false}) / 10) / views;
        }
        return {{"colour_error_before", before},
                {"colour_error_after", after},
                {"colour_error_reduction", before > 0 ? 1 - after / before : 0},
                {"l1_reduction", l1_before > 0 ? 1 - l1_after / l1_before : 0},
                {"psnr_outside_true_part_db", -10 * std::log10(outside)}};
    }

    Json recolour() {
        Json cases = Json::array();
        for (int i = 0; i < parameters_.recolours; ++i) {
            synth::SceneSpec spec;
            spec.seed = parameters_.seed + static_cast<std::uint64_t>(i);
            const auto setting = make_setting(spec, "a blue bear on the grass", "bear", "blue", "modify");
            edit::EditPlan plan;
            const auto located = locate(setting);
            const auto result = edit_scene(setting, located, plan);
            const auto target = synth::generate(synth::apply_edit(spec, "a blue bear"));
            Json entry = compare(setting, result.set, target, synth::Part::Object);
            entry["seed"] = spec.seed;
            entry["changed_outside_label"] = result.changed_outside_label;
            cases.push_back(std::move(entry));
            job_.report("recolouring", i + 1, parameters_.recolours);
        }
        return {{"mean_colour_error_reduction", mean_of(cases, "colour_error_reduction")}, {"cases", cases}};
    }

    /// Share of the true accessory's pixels that changed, and share of the changed pixels that are the accessory's.
    Json added_overlap(const Setting& setting, const GaussianSet& edited, const synth::SynthScene& target) {
        const auto truth = rows_of(target, synth::Part::Accessory);
        const std::vector<float> values(truth.begin(), truth.end());
        double both = 0, wanted = 0, changed = 0;
        const int side = settings_.request.image_size;
        for (int i = 0; i < 8; ++i) {
            const Camera camera = synth::scene_camera(target, 0.13 + 2 * std::numbers::pi * i / 8, 0.35, 1, side, side);
            Image seen;
            painter_.rasterizer().forward_values(target.scene.gaussians.spans(), camera, {}, values, seen);
            const Image source = painter_.paint(setting.scene.scene.gaussians.spans(), camera, {}).colour;
            const Image& got = painter_.paint(edited.spans(), camera, {}).colour;
            for (std::size_t p = 0; p < seen.data.size(); ++p) {
                double difference = 0;
                for (std::size_t c = 0; c < 3; ++c)
                    difference = std::max(difference, std::abs(static_cast<double>(source.data[p * 3 + c]) - got.data[p * 3 + c]));
                const bool is_changed = difference > 0.1, is_true = seen.data[p] > 0.5f;
                both += is_changed && is_true ? 1 : 0;
                wanted += is_true ? 1 : 0;
                changed += is_changed ? 1 : 0;
            }
        }
        return {{"recall", wanted > 0 ? both / wanted : 0}, {"precision", changed > 0 ? both / changed : 0}};
    }

    Json addition() {
        Json cases = Json::array();
        for (int i = 0; i < parameters_.additions; ++i) {
            synth::SceneSpec spec;
            spec.seed = parameters_.seed + 100 + static_cast<std::uint64_t>(i);
            const auto setting = make_setting(spec, "a red bear wearing a blue hat on the grass", "bear", "hat", "add");
            edit::EditPlan plan;
            const auto located = locate(setting);
            const auto result = edit_scene(setting, located, plan);
            const auto target = synth::generate(synth::apply_edit(spec, "a bear wearing a blue hat"));
            Json entry = compare(setting, result.set, target, synth::Part::Accessory);
            entry.update(added_overlap(setting, result.set, target));
            entry["place"] = located.region.origin;
            entry["seed"] = spec.seed;
            cases.push_back(std::move(entry));
            job_.report("adding", i + 1, parameters_.additions);
        }
        return {{"mean_recall", mean_of(cases, "recall")}, {"mean_precision", mean_of(cases, "precision")},
                {"mean_l1_reduction", mean_of(cases, "l1_reduction")}, {"cases", cases}};
    }

    StarterBenchParameters parameters_;
    EditRecipe settings_;
    JobControl job_;
    Painter painter_;
    std::unique_ptr<neural::TextToImage> model_;
    std::unique_ptr<edit::AttentionSource> attention_;
    std::unique_ptr<edit::Segmenter> segmenter_;
};

}  // namespace

Json run_starter_bench(const StarterBenchParameters& parameters, const EditRecipe& settings, const JobControl& job) {
    return StarterBench(parameters, settings, job).run();
}

}  // namespace gse::app
