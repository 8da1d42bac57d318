// One edit after the other with one loaded model: the same seed gives the same figures.
#include "engine/laboratory/eval/eval_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/process_memory.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/eval/eval_compound.h"
#include "engine/laboratory/eval/eval_figures.h"
#include "engine/laboratory/eval/eval_rearranged.h"
#include "engine/laboratory/eval/eval_scenes.h"
#include "engine/laboratory/eval/eval_sheet.h"
#include "engine/laboratory/eval/eval_suite.h"
#include "engine/laboratory/eval/eval_summary.h"
#include "engine/laboratory/eval/rearranged_truth.h"
#include "engine/language/words.h"
#include "engine/pipeline/report/edit_output.h"
#include "engine/pipeline/steps/step_judgement.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Parts of the method that are left out.
const std::vector<EvalVariant>& ablations() {
    static const std::vector<EvalVariant> list{
        {"no_localization",
         "every splat may change, and everywhere in the pictures",
         {{"localize", false}, {"gate_guidance", false}}},
        {"no_pseudo_gt",
         "nothing holds the pictures outside the mask, neither the loss nor the gate",
         {{"preserve", 0}, {"gate_guidance", false}}},
        {"no_gate",
         "the loss alone holds the pictures outside the mask, as in the paper",
         {{"gate_guidance", false}}},
        {"static_mask", "the masks stay as they were found", {{"dynamic_mask", false}}},
        {"no_anchor",
         "labelled splats may move freely",
         {{"anchor_position", 0},
          {"anchor_rotation", 0},
          {"anchor_opacity", 0},
          {"anchor_scale", 0},
          {"anchor_colour", 0}}},
    };
    return list;
}

Json spec_json(const synth::SceneSpec& spec) {
    return {{"caption", synth::full_caption(spec).text},
            {"held_out", synth::held_out(spec)},
            {"seed", spec.seed}};
}

/// Verdict on the redrawn views of the last round, and on the fit to them.
Json redrawing_figures(const edit::EditResult& result) {
    Json figures;
    for (const auto& record : result.history)
        for (const auto& [name, value] : record.guidance) figures[name] = value;
    figures["kept_chroma"] = result.kept_chroma;
    return figures;
}

Json case_json(const EvalCase& edit, std::size_t index) {
    return {{"index", index},
            {"kind", edit.kind},
            {"prompt", edit.prompt},
            {"word", edit.word},
            {"target", edit.target_word},
            {"from", spec_json(edit.source)},
            {"to", spec_json(edit.target)}};
}

class Evaluation {
public:
    Evaluation(const EvalRun& run, const std::filesystem::path& folder, const JobControl& job)
        : run_(run), job_(job), sheets_(folder, "edits", run.parameters.sheet_rows),
          scene_sheets_(folder, "scenes", run.parameters.sheet_rows) {
        suite_ = make_suite(run.parameters.seed, run.parameters.edits,
                            language::words_of(run.parameters.kinds), run.parameters.drawn_words);
        if (run.parameters.mode != "auto" && run.parameters.mode != "right")
            throw Error(ErrorCode::InvalidArgument, "the mode \"" + run.parameters.mode + "\" is not known",
                        "use auto or right");
        times_.begin("load_model");
        model_ = pipeline::load_recipe_model(run.settings.job);
        times_.end();
        for (const auto& text : run.scenes) real_.push_back(parse_real_edit(text, model_->known_words()));
        score_ = model_->image_text_encoder();
    }

    Json run() {
        Json report;
        report["model"] = model_->name();
        report["parameters"] = fields_to_json(run_.parameters);
        report["request"] = fields_to_json(run_.settings.request);
        report["guidance"] = fields_to_json(run_.settings.guidance);
        report["text_image_score"] = score_ != nullptr;
        report["stopped"] = false;
        report["edits"] = report["ablations"] = report["scenes"] = Json::array();
        if (run_.parameters.ablations) begin_variants(ablations(), report["ablations"]);
        begin_variants(run_.variants, report["ablations"]);
        try {
            synthetic(report);
            real(report["scenes"]);
        } catch (const Error& error) {  // what was reached is kept
            if (error.code() != ErrorCode::Cancelled) throw;
            report["stopped"] = true;
        }
        report["sheets"] = sheets_.finish();
        for (const auto& name : scene_sheets_.finish()) report["sheets"].push_back(name);
        report["summary"] = eval_summary(report);
        report["seconds"] = times_.to_json();
        report["peak_rss_mb"] = peak_rss_mb();
        return report;
    }

private:
    JobControl quiet() const { return {{}, job_.stop}; }

    void check_stop() const {
        if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the evaluation was stopped");
    }

    static void begin_variants(const std::vector<EvalVariant>& variants, Json& list) {
        for (const auto& variant : variants)
            list.push_back({{"name", variant.name},
                            {"meaning", variant.meaning},
                            {"settings", variant.settings},
                            {"edits", Json::array()}});
    }

    void synthetic(Json& report) {
        for (std::size_t i = 0; i < suite_.size(); ++i) {
            check_stop();
            job_.report("evaluating edits", static_cast<int>(i), static_cast<int>(suite_.size()));
            Json& ablated = report["ablations"];
            const bool chosen = i < static_cast<std::size_t>(run_.parameters.ablation_edits);
            report["edits"].push_back(evaluate_case(i, chosen ? ablated : none_));
        }
        job_.report("evaluating edits", static_cast<int>(suite_.size()), static_cast<int>(suite_.size()));
    }

    void real(Json& list) {
        for (std::size_t i = 0; i < real_.size(); ++i) {
            check_stop();
            job_.report("editing real scenes", static_cast<int>(i), static_cast<int>(real_.size()));
            times_.begin("scenes");
            list.push_back(run_real_edit(real_[i], run_.settings, model_, scene_sheets_, quiet()));
            times_.end();
        }
    }

    /// A case as a user begins it: the scene and the words that are typed. `oracle_views`: with cameras that
    /// know the scene's framing and front, the word that is new, and what each camera sees.
    pipeline::EditJobInput input(const EvalSetting& setting) const {
        pipeline::EditJobInput input{setting.source.scene, {}, model_};
        if (!run_.parameters.oracle_views) return input;
        input.cameras = setting.seen.views;
        input.view_words = setting.seen.words;
        return input;
    }

    pipeline::EditRecipe recipe(const EvalCase& edit) const {
        pipeline::EditRecipe recipe = run_.settings;
        recipe.request.mode = run_.parameters.mode == "auto" ? "auto" : edit::mode_name(right_mode(edit));
        if (edit.kind == "compound" || is_rearranged(edit.kind)) recipe.request.mode = "auto";
        recipe.request.source = edit.word;
        recipe.request.prompt = edit.prompt;
        recipe.request.target = run_.parameters.oracle_views ? edit.target_word : std::string();
        return recipe;
    }

    /// A case that is measured apart: with several changes, or one in which nothing is drawn. A failure
    /// becomes its "error".
    Json evaluate_apart(std::size_t index) {
        const EvalCase& edit = suite_[index];
        Json entry = case_json(edit, index);
        pipeline::StageTimes times;
        times.begin(edit.kind);
        try {
            const CompoundTools with{tools(), model_, sheets_, run_.parameters.held_out_views};
            const auto figures = edit.kind == "compound" ? compound_figures : rearranged_figures;
            entry.update(figures(edit, recipe(edit), with, quiet()));
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) throw;
            entry["error"] = error.message();
        }
        times.end();
        entry["seconds"] = times.to_json();
        entry["peak_rss_mb"] = peak_rss_mb();
        add_times(times);
        return entry;
    }

    /// One case with its ablations; a failure becomes its "error".
    Json evaluate_case(std::size_t index, Json& ablated) {
        const EvalCase& edit = suite_[index];
        if (edit.kind == "compound" || is_rearranged(edit.kind)) return evaluate_apart(index);
        Json entry = case_json(edit, index);
        const auto recipe = this->recipe(edit);
        EvalSetting setting = make_setting(edit, recipe.request, run_.parameters.held_out_views);
        if (run_.parameters.scanned && edit.kind == "replace")
            setting.source = bench::scanned(std::move(setting.source), tools().painter.rasterizer());
        pipeline::EditJob job(recipe, input(setting), quiet());
        try {
            job.locate();
            setting.request = job.recipe().request.plain();
            entry["guessed"] = {{"target", setting.request.target},
                                {"right", setting.request.target == edit.target_word}};
            setting.seen = {job.views(), job.view_words()};
            entry["confidence"] = job.located().confidence.value;
            edit::require_found(job.located());
            entry.update(located_figures(setting, job.located(), tools()));
            entry.update(edit_and_compare(setting, job));
            add_row(setting, job.located(), &job.result());
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) throw;
            entry["error"] = error.message();
            setting.seen = {job.views(), job.view_words()};
            add_row(setting, job.located(), nullptr);
        }
        if (job.found())
            for (auto& ablation : ablated)
                ablation["edits"].push_back(ablate(index, setting, job, ablation["settings"]));
        entry["seconds"] = job.times().to_json();
        entry["networks"] = job.times().networks_json();
        entry["peak_rss_mb"] = peak_rss_mb();
        add_times(job.times());
        return entry;
    }

    void add_times(const pipeline::StageTimes& times) {
        const auto stages = times.to_json();
        for (const auto& [stage, seconds] : stages.items())
            if (stage != "total") times_.add(stage, seconds.get<double>());
    }

    EvalTools tools() { return {painter_, score_.get()}; }

    /// The truth of `setting` becomes the pose that is nearest to the result.
    Json edit_and_compare(EvalSetting& setting, pipeline::EditJob& job) {
        job.run();
        const auto& result = job.result();
        check_stop();  // a stopped edit is no result
        if (result.failure) throw *result.failure;
        job.times().begin("compare");
        settle_pose(setting, result.set, tools());
        Json figures = edited_figures(setting, job.plan(), result, tools());
        // Against what was found, also where an ablation lets more change.
        figures["drift"] = evaluate::drifted_rows(setting.source.scene.gaussians, result.set,
                                                  result.base_to_new, *job.located().label.bits);
        figures["iterations"] = result.iterations;
        const auto& use = job.edited().use;
        figures["cost"] = {
            {"seconds", job.edited().seconds}, {"unet", use.unet}, {"tflop", use.flop * 1e-12}};
        figures["edit_seconds"] = result.seconds;
        if (result.redrawn_views > 0) figures["redrawing"] = redrawing_figures(result);
        if (const auto& verdict = job.edited().verdict) figures["gate"] = pipeline::verdict_to_json(*verdict);
        figures["judgement"] = pipeline::judgement_to_json(pipeline::judge_step(job));
        job.times().end();
        return figures;
    }

    /// Edits the scene of one search with other settings of the loop.
    Json ablate(std::size_t index, EvalSetting setting, pipeline::EditJob& job, const Json& settings) {
        check_stop();
        Json entry{{"index", index}, {"kind", setting.edit.kind}};
        try {
            fields_from_json(setting.request, settings);
            auto recipe = job.recipe().plain();
            recipe.request = setting.request;
            job.take_settings(check(recipe));
            entry.update(edit_and_compare(setting, job));
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) throw;
            entry["error"] = error.message();
        }
        return entry;
    }

    /// The edit's view that shows most of what the edit is about.
    std::size_t telling_view(const EvalSetting& setting) {
        const auto& owner = setting.edit.kind == "add" ? setting.target : setting.source;
        std::size_t best = 0, most = 0;
        for (std::size_t v = 0; v < setting.seen.views.size(); ++v) {
            const auto area =
                part_mask(painter_, owner, setting.edit.part, setting.seen.views[v].camera, PartShare)
                    .count();
            if (area > most) {
                most = area;
                best = v;
            }
        }
        return best;
    }

    /// Before, attention, what was found, after, truth; of new shapes the last two from the other side, too.
    void add_row(const EvalSetting& setting, const edit::LocateResult& located,
                 const edit::EditResult* result) {
        const std::size_t view = telling_view(setting);
        const Camera& camera = setting.seen.views[view].camera;
        const auto paint = [&](const GaussianSet& set) {
            return painter_.paint(set.spans(), camera, {}).colour;
        };
        std::vector<Image> cells(5);
        cells[0] = paint(setting.source.scene.gaussians);
        if (view < located.views.size()) {
            cells[1] = pipeline::heat_map(located.views[view].map);
            cells[2] = with_mask(cells[0], found_mask(setting, located, view));
        }
        if (result != nullptr) cells[3] = paint(result->set);
        cells[4] = paint(setting.target.scene.gaussians);
        if (right_mode(setting.edit) != edit::EditMode::Modify) {
            const auto& held_out = setting.held_out.views;
            const Camera& behind = held_out[opposite(held_out, camera)].camera;
            for (const auto* set :
                 {result != nullptr ? &result->set : nullptr, &setting.target.scene.gaussians}) {
                cells.emplace_back();
                if (set != nullptr) cells.back() = painter_.paint(set->spans(), behind, {}).colour;
            }
        }
        sheets_.add(cells, setting.edit.kind + ": " + setting.edit.prompt);
    }

    /// The view that looks most against the camera.
    static std::size_t opposite(const std::vector<View>& views, const Camera& camera) {
        std::size_t best = 0;
        double least = 2;
        for (std::size_t v = 0; v < views.size(); ++v)
            if (const double along = dot(views[v].camera.forward(), camera.forward()); along < least) {
                least = along;
                best = v;
            }
        return best;
    }

    /// Existing things: the label as seen; added ones: their place.
    Mask found_mask(const EvalSetting& setting, const edit::LocateResult& located, std::size_t view) {
        if (located.mode == edit::EditMode::Add) return located.views[view].mask;
        const std::vector<float> values(located.label.bits->begin(), located.label.bits->end());
        const Camera& camera = setting.seen.views[view].camera;
        Image seen;
        painter_.rasterizer().forward_values(setting.source.scene.gaussians.spans(), camera, {}, values,
                                             seen);
        Mask mask(camera.width, camera.height);
        for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = seen.data[p] > PartShare ? 1 : 0;
        return mask;
    }

    const EvalRun& run_;
    JobControl job_;
    ContactSheets sheets_, scene_sheets_;
    std::vector<EvalCase> suite_;
    std::vector<RealEdit> real_;
    pipeline::StageTimes times_;
    pipeline::Painter painter_;
    std::shared_ptr<neural::TextToImage> model_;
    std::unique_ptr<edit::ImageTextEncoder> score_;
    Json none_ = Json::array();
};

}  // namespace

Json run_eval(const EvalRun& run, const std::filesystem::path& folder, const JobControl& job) {
    return Evaluation(run, folder, job).run();
}

}  // namespace gse::bench
