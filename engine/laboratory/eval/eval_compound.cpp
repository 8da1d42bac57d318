// Follows parts and rows from step to step.
#include "engine/laboratory/eval/eval_compound.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/evaluate/metrics.h"
#include "engine/pipeline/steps/edit_steps.h"
#include "engine/pipeline/steps/step_judgement.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using language::plan::Operation;

/// A step that has run, with the world's truth about it.
struct DoneStep {
    EvalSetting setting;
    edit::EditResult result;
    std::vector<std::uint8_t> label;  // of the scene before
};

Error not_of_this_world(const language::plan::Step& step) {
    return Error(ErrorCode::InvalidArgument,
                 "the synthetic world has no such step: " + language::plan::to_string(step));
}

/// Mean colour error inside masks, pooled over views.
class ColourError {
public:
    void add(const Image& shown, const Image& wanted, const Mask& mask) {
        const auto area = static_cast<double>(mask.count());
        if (area == 0) return;
        error_ += area * evaluate::mean_colour_error(shown, wanted, {&mask, true});
        pixels_ += area;
    }
    double mean() const { return pixels_ > 0 ? error_ / pixels_ : 0; }

private:
    double error_ = 0, pixels_ = 0;
};

Image shown_from(pipeline::Painter& painter, const GaussianSet& set, const Camera& camera) {
    Image image = painter.paint(set.spans(), camera, {}).colour;
    for (auto& value : image.data) value = std::clamp(value, 0.0f, 1.0f);
    return image;
}

/// Colours of what step `k` changed, where the end shows it: then, and at the end.
std::pair<double, double> colour_errors(const std::vector<DoneStep>& steps, std::size_t k,
                                        pipeline::Painter& painter) {
    const auto &step = steps[k], &last = steps.back();
    ColourError then, finally;
    for (const auto& view : step.setting.held_out.views) {
        const auto paint = [&](const GaussianSet& set) { return shown_from(painter, set, view.camera); };
        const Mask mask =
            part_mask(painter, last.setting.target, step.setting.edit.part, view.camera, PartShare);
        then.add(paint(step.result.set), paint(step.setting.target.scene.gaussians), mask);
        finally.add(paint(last.result.set), paint(last.setting.target.scene.gaussians), mask);
    }
    return {then.mean(), finally.mean()};
}

Json kept_json(const std::vector<DoneStep>& steps, pipeline::Painter& painter) {
    std::vector<StepRows> rows;
    for (std::size_t k = 0; k < steps.size(); ++k)
        rows.push_back(
            {&steps[k].result, k + 1 < steps.size() ? steps[k + 1].label : std::vector<std::uint8_t>{}});
    Json list = Json::array();
    for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
        const auto kept = kept_rows(rows, k);
        const auto [then, finally] = colour_errors(steps, k, painter);
        list.push_back({{"step", k},
                        {"rows", kept.rows},
                        {"met", kept.met},
                        {"lost", kept.lost},
                        {"colour_error", then},
                        {"colour_error_at_end", finally}});
    }
    return list;
}

/// The case's scene, as the steps so far have left it, beside the truth of the step.
EvalSetting setting_of(const EvalCase& edit, const pipeline::EditJob& job, std::vector<synth::Part> parts,
                       int held_out_views) {
    EvalSetting setting = make_setting(edit, job.recipe().request.plain(), held_out_views);
    setting.source.scene = job.scene();
    setting.source.parts = std::move(parts);
    setting.seen = {job.views(), job.view_words()};
    return setting;
}

Json measured(EvalSetting& setting, pipeline::EditJob& job, const EvalTools& tools) {
    const auto& result = job.result();
    if (result.stopped) throw Error(ErrorCode::Cancelled, "the evaluation was stopped");
    if (result.failure) throw *result.failure;
    Json figures = located_figures(setting, job.located(), tools);
    settle_pose(setting, result.set, tools);
    figures.update(edited_figures(setting, job.plan(), result, tools));
    figures["drift"] = evaluate::drifted_rows(setting.source.scene.gaussians, result.set, result.base_to_new,
                                              *job.located().label.bits);
    figures["judgement"] = pipeline::judgement_to_json(pipeline::judge_step(job));
    return figures;
}

void add_row(ContactSheets& sheets, const std::vector<DoneStep>& steps, const std::string& title,
             pipeline::Painter& painter) {
    const Camera& camera = steps.front().setting.held_out.views.front().camera;
    std::vector<Image> cells{shown_from(painter, steps.front().setting.source.scene.gaussians, camera)};
    for (const auto& step : steps) cells.push_back(shown_from(painter, step.result.set, camera));
    cells.push_back(shown_from(painter, steps.back().setting.target.scene.gaussians, camera));
    sheets.add(cells, title);
}

double sum_of(const Json& steps, const char* key) {
    double sum = 0;
    for (const auto& step : steps) sum += step[key].get<double>();
    return sum;
}

}  // namespace

std::string scene_words_of(const synth::SceneSpec& spec) {
    std::string words = spec.material + " " + spec.object;
    if (!spec.accessory.empty())
        words += "; " + (spec.accessory_colour.empty() ? "" : spec.accessory_colour + " ") + spec.accessory;
    return words + "; " + spec.ground;
}

EvalCase case_of_step(const synth::SceneSpec& source, const language::plan::Step& step) {
    EvalCase edit{std::string(name_of(step.operation)), source, source, {}, source.object, {}};
    const auto colour_of = [](const language::plan::Thing& thing) {
        return thing.attributes.empty() ? std::string() : thing.attributes.front();
    };
    const auto change_look = [&] {
        const auto& noun = step.subject.root();
        if (noun != source.object && noun != source.accessory) throw not_of_this_world(step);
        edit.word = noun;
        edit.target_word = step.text;
        edit.part = noun == source.object ? synth::Part::Object : synth::Part::Accessory;
        (noun == source.object ? edit.target.material : edit.target.accessory_colour) = step.text;
    };
    switch (step.operation) {
        case Operation::Recolour:
        case Operation::Material: change_look(); break;
        case Operation::Ground:
            edit.word = source.ground;
            edit.target_word = edit.target.ground = step.thing.noun;
            edit.part = synth::Part::Ground;
            break;
        case Operation::Add:
            edit.target_word = edit.target.accessory = step.thing.noun;
            edit.target.accessory_colour = colour_of(step.thing);
            edit.part = synth::Part::Accessory;
            break;
        case Operation::Replace:
            edit.target_word = edit.target.object = step.thing.noun;
            if (const auto colour = colour_of(step.thing); !colour.empty()) edit.target.material = colour;
            break;
        default: throw not_of_this_world(step);
    }
    return edit;
}

std::vector<synth::Part> parts_after(const std::vector<synth::Part>& before, const edit::EditResult& result,
                                     synth::Part part) {
    std::vector<synth::Part> parts(result.set.size(), part);
    for (std::size_t row = 0; row < parts.size() && row < result.hole_fill.size(); ++row)
        if (result.hole_fill[row] != 0) parts[row] = synth::Part::Ground;
    for (std::size_t row = 0; row < before.size(); ++row)
        if (result.base_to_new[row] >= 0)
            parts[static_cast<std::size_t>(result.base_to_new[row])] = before[row];
    return parts;
}

KeptRows kept_rows(const std::vector<StepRows>& steps, std::size_t k) {
    KeptRows kept;
    const auto& begun = *steps[k].result;
    std::vector<std::int64_t> end_of(begun.set.size());
    std::vector<std::uint8_t> may_differ(begun.set.size(), 1);
    for (std::size_t row = 0; row < end_of.size(); ++row) {
        bool met = false;
        auto now = static_cast<std::int64_t>(row);
        for (std::size_t later = k + 1; later < steps.size() && now >= 0; ++later) {
            const auto at = static_cast<std::size_t>(now);
            met = met || steps[later - 1].next_label[at] != 0;
            now = steps[later].result->base_to_new[at];
        }
        end_of[row] = now;
        if (begun.label[row] == 0) continue;
        ++kept.rows;
        kept.met += met ? 1 : 0;
        may_differ[row] = met ? 1 : 0;
    }
    kept.lost = evaluate::drifted_rows(begun.set, steps.back().result->set, end_of, may_differ);
    return kept;
}

Json compound_figures(const EvalCase& edit, const pipeline::EditRecipe& recipe, const CompoundTools& tools,
                      const JobControl& control) {
    const auto scene = synth::generate(edit.source);
    auto planned =
        pipeline::steps_of_sentence(recipe, language::plan::scene_words(scene_words_of(edit.source)), false);
    Json json{{"plan", language::plan::to_string(planned.plan)}, {"steps", Json::array()}};
    pipeline::StepSequence sequence(recipe, std::move(planned));
    const auto first = [&](pipeline::EditRecipe begun) {
        return std::make_unique<pipeline::EditJob>(
            std::move(begun), pipeline::EditJobInput{scene.scene, {}, tools.model}, control);
    };
    std::vector<DoneStep> done;
    auto spec = edit.source;
    auto parts = scene.parts;
    for (std::size_t i = 0; i < sequence.size(); ++i) {
        auto part_of = case_of_step(spec, sequence.step(i).step);
        part_of.prompt = sequence.step(i).words->prompt;
        auto job = sequence.job_of(i, first, control);
        job->locate();
        edit::require_found(job->located());
        job->run();
        auto setting = setting_of(part_of, *job, parts, tools.held_out_views);
        Json figures{{"kind", part_of.kind}, {"prompt", part_of.prompt}, {"target", part_of.target_word}};
        figures.update(measured(setting, *job, tools.eval));
        figures["seconds"] = job->times().to_json();
        json["steps"].push_back(std::move(figures));
        parts = parts_after(parts, job->result(), part_of.part);
        spec = setting.target.spec;  // in the pose that it was settled in
        done.push_back({std::move(setting), job->result(), *job->located().label.bits});
        sequence.take(i, std::move(job));
    }
    if (spec.object != edit.target.object || spec.material != edit.target.material ||
        spec.ground != edit.target.ground || spec.accessory != edit.target.accessory ||
        spec.accessory_colour != edit.target.accessory_colour)
        throw Error(ErrorCode::InvalidArgument, "the steps do not lead to what the sentence describes: " +
                                                    json["plan"].get<std::string>());
    json["kept"] = kept_json(done, tools.eval.painter);
    json["drift"] = sum_of(json["steps"], "drift");
    json["nonfinite"] = sum_of(json["steps"], "nonfinite");
    add_row(tools.sheets, done, edit.kind + ": " + edit.prompt, tools.eval.painter);
    return json;
}

}  // namespace gse::bench
