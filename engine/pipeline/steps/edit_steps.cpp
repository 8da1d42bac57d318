// Sentences as lists of steps, and jobs that follow each other.
#include "engine/pipeline/steps/edit_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/project/project_file.h"
#include "engine/language/plan/plan_text.h"
#include "engine/language/synonyms.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/pipeline/models/model_words.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/scene/label_names.h"
#include "engine/remote/api/server_settings.h"
#include "engine/scene/row_values.h"

namespace gse::pipeline {
namespace {

namespace plan = language::plan;

void require_all(const EditSteps& steps) {
    const auto undone =
        std::find_if(steps.steps.begin(), steps.steps.end(), [](const auto& step) { return !step.words; });
    if (undone == steps.steps.end()) return;
    const auto text = language::plan::step_text(undone->step);
    throw Error(
        ErrorCode::InvalidArgument,
        steps.steps.size() == 1
            ? fmt::format("{} ({})", undone->problem.reason, text)
            : fmt::format("step {} of {} cannot be done ({}): {}", undone - steps.steps.begin() + 1,
                          steps.steps.size(), text, undone->problem.reason),
        undone->problem.remedy + (steps.steps.size() > 1 ? ", or use --partly to make the other steps" : ""));
}

}  // namespace

std::vector<std::string> names_in_scene(const EditRecipe& recipe) {
    const auto known = model_words(model_path(recipe.job));
    const auto words = edit::words_naming(recipe.request);
    const bool all = std::all_of(words.begin(), words.end(), [&](const auto& word) {
        return language::vocabulary_contains(known, word);
    });
    if (all || !keeps_labels(recipe.job.scene)) return {};
    return label_names(load_scene(recipe.job.scene, {.activated = recipe.job.activated}).labels);
}

plan::SceneWords words_of_scene(const EditRecipe& recipe, const std::string& given,
                                const std::vector<std::string>& labels, const JobControl& control,
                                std::shared_ptr<DiskCache> cache) {
    if (!given.empty()) return plan::scene_words(edit::with_source(given, recipe.request));
    auto scene = edit::assumed_scene(recipe.request, labels);
    const auto path = model_path(recipe.job);
    const auto words = language::promptable_vocabulary(model_words(path), generated_vocabulary(path));
    if (!edit::pictures_decide(recipe.request, words)) return scene;
    EditRecipe looking = recipe;
    looking.request = edit::source_alone(looking.request);
    looking.use_dreambooth = false;
    EditJob job(std::move(looking), control, std::move(cache));
    return job.words_shown(std::move(scene));
}

bool take_named_label(EditRecipe& recipe) {
    const auto source = language::normalised_prompt(recipe.request.source);
    const auto known = model_words(model_path(recipe.job));
    if (source.empty() || recipe.job.brings_label() || known.empty() ||
        language::vocabulary_contains(known, source) || !is_project_file(recipe.job.scene))
        return false;
    const auto labels = read_project_summary(recipe.job.scene).labels;
    recipe.job.use_label = std::any_of(labels.begin(), labels.end(), [&](const NamedLabel& label) {
        return language::normalised_prompt(label.name) == source;
    });
    if (recipe.job.use_label) log::info("\"{}\" is a label of the project", source);
    return recipe.job.use_label;
}

void take_known_words(EditRecipe& recipe) {
    auto& request = recipe.request;
    const auto known = model_words(model_path(recipe.job));
    if (recipe.job.brings_label() || language::vocabulary_contains(known, request.source)) return;
    const auto source = language::in_known_words(request.source, known);
    if (!language::vocabulary_contains(known, source.text)) return;
    for (const auto& word : source.replaced) {
        log::info("{}", language::other_word_text(word));
        // The words of the sentence that name the source; others are the model's to draw.
        const auto own = [&](const std::string& text) {
            auto words = known;
            for (const auto& other : language::words_of(text))
                if (other != word.typed) words.push_back(other);
            return language::in_known_words(text, words).text;
        };
        request.prompt = own(request.prompt);
    }
    request.source = source.text;
}

bool has_steps(const EditRecipe& recipe) {
    return edit::is_planned(recipe.request) && !recipe.job.brings_label();
}

EditSteps steps_of_sentence(const EditRecipe& recipe, const plan::SceneWords& scene, bool partly,
                            const std::vector<std::string>& labels) {
    EditSteps result{edit::plan_of(recipe.request, scene), scene, {}};
    if (edit::is_told_as_typed(recipe.request, result.plan)) return {};
    result.nothing_to_change = result.plan.steps.front().operation == plan::Operation::None;
    if (result.nothing_to_change) return result;
    if (const auto refused = edit::refusal_of(result.plan, recipe.request.source)) throw *refused;
    const auto model = model_path(recipe.job);
    result.model = model_ability(model);
    const bool any_word = recipe.server.used();  // is drawn
    // The server finds the thing of each step, but that of an addition.
    const bool finds =
        any_word && remote::server_search_of(recipe.server.search) != remote::ServerSearch::None;
    result.model.open_vocabulary = result.model.open_vocabulary || any_word;
    result.steps = known_to_model(edit::planned_steps(result.plan, scene, result.model), recipe.request,
                                  model, labels, any_word, finds);
    const bool any = std::any_of(result.steps.begin(), result.steps.end(),
                                 [](const auto& step) { return step.words.has_value(); });
    if (!partly || !any) require_all(result);
    // Models learned from captions: "blue bear" and "not red but green" are told as captions, too.
    if (!edit::follows_plan(recipe.request, result.steps)) result.steps.clear();
    return result;
}

std::vector<edit::PlannedStep> known_to_model(std::vector<edit::PlannedStep> steps,
                                              const edit::EditRequest& request,
                                              const std::filesystem::path& folder,
                                              const std::vector<std::string>& labels, bool draws_any_word,
                                              bool finds_any_word) {
    const auto known = model_words(folder), drawn = generated_vocabulary(folder);
    if (known.empty()) return steps;
    auto there = labels;  // what a step has found is known to the next
    for (auto& step : steps) try {
            if (!step.words) continue;
            const auto valid = edit::check(edit::request_of(request, *step.words));
            const bool draws = edit::method_of(valid).draws_views();
            const auto require = draws_any_word ? edit::require_findable_words : edit::require_known_words;
            const bool adds = edit::decide_mode(valid, std::nullopt).first == edit::EditMode::Add;
            const bool finds = finds_any_word && !adds && !valid.is_rearranged();
            require(valid, known, draws ? drawn : std::vector<std::string>{}, finds, there);
            if (finds) there.push_back(valid.source());
        } catch (const Error& error) {
            step.words.reset();
            step.problem = {error.message(), error.hint()};
        }
    return steps;
}

EditRecipe recipe_of_step(EditRecipe recipe, const edit::PlannedStep& step) {
    recipe.request = edit::request_of(std::move(recipe.request), *step.words);
    recipe.guidance.before_prompt.clear();
    return recipe;
}

EditRecipe with_words(EditRecipe recipe) {
    const auto checked = edit::check(recipe.request);
    recipe.request = checked.plain();
    if (checked.target_open()) recipe.request.target.clear();  // the pictures say which word is new
    return recipe;
}

EditJobInput next_input(EditJob& job, std::vector<std::string> said, const std::string& source) {
    EditJobInput input;
    input.scene = job.scene();
    const auto& result = job.result();
    const auto sources = sources_of(result.base_to_new, result.set.size());
    input.scene.extra = gathered(input.scene.extra, sources);
    input.scene.labels = gathered(input.scene.labels, sources);
    input.scene.gaussians = result.set;
    if (!job.automatic_views()) input.cameras = job.views();
    input.model = job.shared_model();
    input.server = job.shared_server();
    input.said = std::move(said);
    input.segmenters = open_segmenters(job.recipe().job, nullptr);
    const auto& request = job.recipe().request;
    const bool whole = request.part_of().empty() && !request.whole_scene();
    if (whole && request.source() == source) input.found = job.source_in_result();
    input.server_searches = job.server_searches();
    return input;
}

nlohmann::ordered_json plan_to_json(const EditSteps& steps) {
    nlohmann::ordered_json json;
    json["plan"] = plan::to_string(steps.plan);
    json["steps"] = nlohmann::ordered_json::array();
    for (const auto& step : steps.steps) {
        nlohmann::ordered_json entry{{"step", plan::to_string(step.step)},
                                     {"text", language::plan::step_text(step.step)}};
        if (step.words) entry["prompt"] = step.words->prompt;
        else entry["reason"] = step.problem.reason;
        json["steps"].push_back(std::move(entry));
    }
    return json;
}

StepSequence::StepSequence(EditRecipe recipe, EditSteps steps)
    : recipe_(std::move(recipe)),
      steps_(std::move(steps.steps), std::move(steps.scene), std::move(steps.model)) {}

std::unique_ptr<EditJob> StepSequence::job_of(std::size_t i, const FirstJob& first,
                                              const JobControl& control) const {
    auto recipe = recipe_of_step(recipe_, step(i));
    if (job_ == nullptr) return first(std::move(recipe));
    const auto& words = *step(i).words;
    const std::string source = words.part_of.empty() && !words.whole_scene ? words.source : std::string();
    return std::make_unique<EditJob>(std::move(recipe), next_input(*job_, said_, source), control);
}

void StepSequence::take(std::size_t i, std::unique_ptr<EditJob> job) {
    for (auto& word : language::words_of(step(i).words->target)) said_.push_back(std::move(word));
    steps_.take(i);
    job_ = std::move(job);
    ++taken_;
}

}  // namespace gse::pipeline
