// Plans of requests: scenes assumed, steps described, refusals in words.
#include "engine/edit/request/sentence_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "engine/language/grammar.h"
#include "engine/language/plan/plan_sentence.h"
#include "engine/language/plan/plan_text.h"
#include "engine/language/plan/words/lexicon.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

namespace plan = language::plan;
using plan::Operation;

struct Refusal {
    std::string_view reason;  // of the notation
    const char* message;
    const char* hint;
};

constexpr auto Articles = language::WordClass::IndefiniteArticle | language::WordClass::DefiniteArticle;
constexpr const char* DescribeScene = "describe the scene after the edit in one English sentence";
constexpr std::array<Refusal, 9> Refusals{{
    {plan::reason::Empty, "the sentence says nothing", DescribeScene},
    {plan::reason::NotASentence, "the sentence is not understood", DescribeScene},
    {plan::reason::Question, "the sentence asks a question, and no change", DescribeScene},
    {plan::reason::Language, "the sentence is not English", DescribeScene},
    {plan::reason::Contradiction, "the sentence contradicts itself", "leave one of its wishes out"},
    {plan::reason::Ambiguous, "the sentence may mean several things", "name the thing that is to change"},
    {plan::reason::Incomplete, "the sentence does not say what is to become of the thing",
     "say how it looks after the edit"},
    {plan::reason::NotAnEdit, "the sentence asks for no change of the scene", DescribeScene},
    {plan::reason::NotInScene, "the sentence is about something else than the source",
     "say what in the scene it is about"},
}};

/// Words of a step that are news: the look, or the new thing.
std::vector<std::string> news_of(const plan::Step& step) {
    auto words = language::words_of(step.text + " " + step.text2);
    if (step.thing.noun.empty()) return words;
    words = language::words_of(step.thing.noun);
    for (const auto& attribute : step.thing.attributes)
        for (auto& word : language::words_of(attribute)) words.push_back(std::move(word));
    return words;
}

bool is_said(const plan::Step& step, const std::vector<std::string>& said) {
    const auto words = news_of(step);
    return !words.empty() && std::all_of(words.begin(), words.end(),
                                         [&](const auto& word) { return language::contains(said, word); });
}

std::vector<plan::Step> news_among(std::vector<plan::Step> steps, const News& news) {
    std::erase_if(steps, [&](const auto& step) { return is_said(step, news.said); });
    return steps;
}

/// True for a look that the sentence names right before the thing: the scene may show it already.
bool describes(const plan::Step& step, const language::Sentence& sentence) {
    if (!plan::changes_look(step.operation) || step.subject.links.size() != 1) return false;
    return sentence.contains(language::normalised_prompt(step.text + " " + step.subject.links[0].noun));
}

/// True for a sentence that describes the scene after the edit, and is no order.
bool is_description(const language::Sentence& sentence) {
    return !sentence.empty() && language::is_a(sentence.words().front(), language::Article);
}

/// True for an addition that a description names: the scene may show it already.
bool may_be_shown(const plan::Step& step, const language::Sentence& sentence) {
    return describes(step, sentence) || (step.operation == Operation::Add && is_description(sentence));
}

/// True where the sentence is about what wears the source, or stands on it, and does not name it: "a bear
/// wearing a crown" for a hat. Which of its words is new, pictures say.
bool is_around_source(const EditRequest& request, const language::Sentence& sentence) {
    const auto source = language::normalised_prompt(request.source);
    const auto scene = plan::scene_words(source);
    const bool carried =
        scene.ground() || language::listed_place(source) || (plan::kinds_of(source) & plan::Worn) != 0;
    return carried && !sentence.contains(source);
}

/// True for operations that no model is asked to draw. One that cannot be described cannot be done either.
bool is_never_drawn(Operation operation) {
    return operation == Operation::Remove || operation == Operation::Transform ||
           operation == Operation::Duplicate;
}

/// True for "behind the museum": the thing is a place, and there already.
bool is_place(const std::string& preposition, const std::string& noun) {
    if (!language::is_a(preposition, language::WordClass::Stop | language::WordClass::Beside)) return false;
    constexpr auto Things = plan::Artifact | plan::Object | plan::Plant;
    return (plan::kinds_of(noun) & Things) != 0 && !plan::has(plan::Class::part, noun) &&
           !plan::has(plan::Class::body_place, noun) && !plan::has(plan::Class::whole_part, noun);
}

/// "house" of "a house without balloons" or "a house with no balloons", of balloons: what it is without is
/// there before, and so is the rest. Empty for other sentences.
std::string bare_thing(const language::Sentence& sentence, const std::string& source) {
    using language::WordClass;
    const auto& words = sentence.words();
    auto at = sentence.position_of(source);
    if (at >= words.size()) return {};
    while (at > 0 && (language::is_a(words[at - 1], Articles) || words[at - 1] == "any")) --at;
    if (at > 1 && words[at - 1] == "no" && words[at - 2] == "with") at -= 1;
    else if (at == 0 || words[at - 1] != "without") return {};
    return at > 1 ? words[at - 2] : std::string();
}

/// True where `joint` says that the source is borne by what stands before it: on a support, worn, held.
bool bears(const std::string& joint, const std::string& source) {
    constexpr std::array<std::string_view, 10> Bearing{"with", "wearing", "wears", "holding", "holds",
                                                       "has",  "having",  "wore",  "carries", "carrying"};
    const bool worn = (plan::kinds_of(source) & plan::Worn) != 0;
    if (joint == "on") return plan::names_support(source);
    if (joint == "in") return plan::names_support(source) || worn;
    return std::find(Bearing.begin(), Bearing.end(), joint) != Bearing.end();
}

/// "statue" of "a statue on a white pedestal", "bear" of "a bear wearing a red hat", "vase" of "a vase with
/// red flowers". What the source carries, and what bears it, is there before. Empty for other sentences, and
/// where the source has no new look.
std::string linked_thing(const language::Sentence& sentence, const std::string& source) {
    constexpr std::size_t Joint = 2;  // behind an article and a noun
    const auto& words = sentence.words();
    const auto place = sentence.position_of(source);
    if (place >= words.size() || place <= Joint + 1 || !language::is_a(words.front(), Articles)) return {};
    const bool article = language::is_a(words[Joint + 1], Articles);
    const auto joins = [](const std::string& word) {
        return language::is_a(word, language::WordClass::Stop | language::WordClass::Beside);
    };
    const auto look = words.begin() + Joint + 1, noun = words.begin() + static_cast<std::ptrdiff_t>(place);
    const bool has_look = article ? Joint + 2 < place : std::none_of(look, noun, joins);
    return has_look && bears(words[Joint], source) ? words[1] : std::string();
}

Error several(const std::vector<plan::Step>& steps) {
    std::string list;
    for (std::size_t i = 0; i < steps.size(); ++i)
        list += fmt::format("{}{} {}", i > 0 ? " · " : "", i + 1, plan::step_text(steps[i]));
    return Error(ErrorCode::InvalidArgument,
                 fmt::format("the sentence asks for {} changes ({})", steps.size(), list),
                 "make them one after another");
}

}  // namespace

plan::SceneWords assumed_scene(const EditRequest& request, const std::vector<std::string>& made) {
    const auto source = language::normalised_prompt(request.source);
    auto scene = plan::scene_words(source);
    const language::Sentence sentence(request.prompt);
    const auto add = [&](const std::string& noun, bool is_ground) {
        const bool known = std::any_of(scene.things.begin(), scene.things.end(),
                                       [&](const auto& thing) { return thing.noun == noun; });
        if (!known) scene.things.push_back({noun, {}, is_ground, false});
    };
    const auto& words = sentence.words();
    const bool about_ground = scene.ground().has_value();
    for (std::size_t i = 1; i < words.size(); ++i) {
        if (!language::is_a(words[i - 1], language::WordClass::DefiniteArticle)) continue;
        const bool ground = language::is_a(words[i], language::WordClass::Ground);
        if (ground && !about_ground) add(words[i], true);
        if (!ground && i > 1 && is_place(words[i - 2], words[i])) add(words[i], false);
    }
    if (const auto whole = bare_thing(sentence, source); !whole.empty()) add(whole, false);
    if (const auto linked = linked_thing(sentence, source); !linked.empty()) add(linked, false);
    if (about_ground)  // what stands on it is there, too
        for (const auto& thing : sentence.things())
            if (!language::is_a(thing, language::WordClass::Ground)) {
                add(thing, false);
                break;
            }
    for (const auto& noun : made) add(noun, false);
    return scene;
}

std::vector<std::string> words_naming(const EditRequest& request) {
    auto words = language::words_of(request.source);
    for (const auto& term : language::noun_terms(language::words_of(request.prompt), {}))
        if (language::says_something(term))
            for (auto& word : language::words_of(term)) words.push_back(std::move(word));
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    return words;
}

std::string with_source(const std::string& words, const EditRequest& request) {
    const auto source = language::normalised_prompt(request.source);
    const auto noun = plan::scene_words(source);
    const auto scene = plan::scene_words(words);
    const bool named = std::any_of(scene.things.begin(), scene.things.end(), [&](const auto& thing) {
        return !noun.things.empty() && thing.noun == noun.things.front().noun;
    });
    return named ? words : source + "; " + words;
}

plan::Plan plan_of(const EditRequest& request, const plan::SceneWords& scene) {
    return plan::plan_sentence(request.prompt, scene, language::normalised_prompt(request.source));
}

std::vector<PlannedStep> planned_steps(const plan::Plan& plan, plan::SceneWords scene,
                                       const plan::ModelAbility& model,
                                       const std::vector<std::string>& left_out) {
    std::vector<PlannedStep> result;
    for (const auto& step : plan.steps) {
        const bool out = !left_out.empty() && language::contains(left_out, plan::to_string(step));
        if (step.operation == Operation::None || out) continue;
        PlannedStep planned{step, std::nullopt, {}, false};
        if (step.operation == Operation::Refuse) {
            if (const auto error = refusal_of({{step}}, {}))
                planned.problem = {error->message(), error->hint()};
        } else {
            planned.words = plan::sentence_of(step, scene, &planned.problem, model);
        }
        scene = plan::after(step, std::move(scene));
        result.push_back(std::move(planned));
    }
    return result;
}

std::vector<PlannedStep> changes_of(const EditRequest& request, const plan::SceneWords& scene,
                                    const ChangesWith& with) {
    if (!is_planned(request)) return {};
    const auto plan = plan_of(request, scene);
    if (plan.is_refusal() || is_told_as_typed(request, plan)) return {};
    const language::Sentence sentence(request.prompt);
    auto steps = planned_steps(plan, scene, with.model, with.left_out);
    std::erase_if(steps, [&](const auto& planned) { return is_said(planned.step, with.said); });
    for (auto& planned : steps) planned.may_be_shown = describes(planned.step, sentence);
    return steps;
}

bool is_planned(const EditRequest& request) {
    return request.target.empty() && request.mode == "auto" && request.instruction.empty() &&
           !request.source.empty() && request.part_of.empty() && !request.whole_scene;
}

bool is_borne(const language::Sentence& sentence, const std::string& source) {
    const auto& words = sentence.words();
    const auto place = sentence.position_of(source);
    if (plan::names_support(source)) return true;
    const bool part = plan::has(plan::Class::part, source) || plan::has(plan::Class::body_place, source);
    if (!part && (plan::kinds_of(source) & (plan::Animal | plan::Person)) != 0) return false;
    for (std::size_t joint = 1; joint < place && place < words.size(); ++joint)
        if (bears(words[joint], source)) return true;
    return false;
}

bool is_about_part(const EditRequest& request) {
    return !request.part_of.empty() ||
           is_borne(language::Sentence(request.prompt), language::normalised_prompt(request.source));
}

bool is_about_part(const CheckedRequest& request) {
    return !request.part_of().empty() || is_borne(request.sentence().sentence(), request.source());
}

bool is_caption(const EditRequest& request) { return is_description(language::Sentence(request.prompt)); }

bool says_itself(const EditRequest& request, const plan::StepSentence& words, const News& news) {
    if (!words.part_of.empty() || words.whole_scene || !words.instruction.empty()) return false;
    if (!is_drawn(words.mode)) return false;
    if (plan::names_support(words.source) &&
        !linked_thing(language::Sentence(request.prompt), words.source).empty())
        return false;
    const auto guessed = with_target(request, news);
    const language::EditSentence sentence(language::Sentence(request.prompt),
                                          language::normalised_prompt(request.source), guessed.target);
    if (sentence.source() != words.source || decide_mode(sentence, std::nullopt).first != words.mode)
        return false;
    const auto told =
        language::words_of(words.mode == EditMode::Replace ? sentence.replacement() : guessed.target);
    const auto wanted = language::words_of(words.target);
    if (words.mode != EditMode::Modify) return !wanted.empty() && language::contains(told, wanted.back());
    const auto all_in = [](const auto& some, const auto& list) {
        return std::all_of(some.begin(), some.end(),
                           [&](const auto& word) { return language::contains(list, word); });
    };
    return !told.empty() && (all_in(wanted, told) || all_in(told, wanted));  // "spotted" of "pink spotted"
}

bool follows_plan(const EditRequest& request, const std::vector<PlannedStep>& steps, const News& news) {
    if (steps.size() != 1) return !steps.empty();
    const auto& words = steps.front().words;
    return !words || !(is_caption(request) && says_itself(request, *words, news));
}

EditRequest request_of(EditRequest request, const plan::StepSentence& words) {
    request.source = words.source;
    request.prompt = words.prompt;
    request.target = words.target;
    request.mode = mode_name(words.mode);
    request.part_of = words.part_of;
    request.whole_scene = words.whole_scene;
    request.description = words.description;
    request.change = words.change;
    request.copies = words.copies;
    request.anchor = words.anchor;
    request.instruction = words.instruction;
    return request;
}

bool is_told_as_typed(const EditRequest& request, const plan::Plan& plan) {
    const language::Sentence sentence(request.prompt);
    if (is_around_source(request, sentence)) return true;
    return is_description(sentence) && plan.steps.front().text == plan::reason::NotASentence;
}

bool pictures_decide(const EditRequest& request, const std::vector<std::string>& words) {
    if (!is_planned(request) || !language::vocabulary_contains(words, request.source)) return false;
    const auto scene = assumed_scene(request);
    const auto plan = plan_of(request, scene);
    const language::Sentence sentence(request.prompt);
    const bool looks =
        plan.steps.size() > 1 && std::any_of(plan.steps.begin(), plan.steps.end(),
                                             [&](const auto& step) { return describes(step, sentence); });
    const auto ground = scene.ground();
    return looks || (ground && scene.things[*ground].noun != language::normalised_prompt(request.source));
}

EditRequest in_plan_words(const EditRequest& request, const News& news) {
    if (!is_planned(request) || is_around_source(request, language::Sentence(request.prompt))) return request;
    const auto scene = assumed_scene(request);
    auto plan = plan_of(request, scene);
    plan.steps = news_among(std::move(plan.steps), news);
    if (plan.steps.size() != 1) return request;
    const auto words = plan::sentence_of(plan.steps.front(), scene);
    return words && !says_itself(request, *words, news) ? request_of(request, *words) : request;
}

std::optional<Error> single_edit_problem(const EditRequest& request, const News& news) {
    if (!is_planned(request)) return std::nullopt;
    const language::Sentence sentence(request.prompt);
    const auto plan = plan_of(request, assumed_scene(request));
    if (auto refused = refusal_of(plan, request.source)) {
        if (is_told_as_typed(request, plan)) return std::nullopt;
        return refused;
    }
    const auto steps = news_among(plan.steps, news);
    if (steps.empty() && plan.steps.size() > 1)
        return Error(ErrorCode::InvalidArgument, "all that the sentence asks for is made already",
                     "say what is to be different, or undo an edit first");
    if (steps.empty()) return std::nullopt;  // the same edit once more
    for (const auto& step : steps) {
        plan::StepProblem problem;
        if (!is_never_drawn(step.operation) || plan::sentence_of(step, {}, &problem)) continue;
        return Error(ErrorCode::InvalidArgument, problem.reason + " (" + plan::step_text(step) + ")",
                     problem.remedy);
    }
    const auto certain = std::count_if(steps.begin(), steps.end(),
                                       [&](const auto& step) { return !may_be_shown(step, sentence); });
    if (certain > 1 && !is_around_source(request, sentence)) return several(steps);
    return std::nullopt;
}

std::string missing_thing(const EditRequest& request, const plan::SceneWords& scene) {
    if (!is_planned(request)) return {};
    const auto plan = plan_of(request, scene);
    if (plan.is_refusal() && is_told_as_typed(request, plan)) return {};
    const auto missing = std::find_if(plan.steps.begin(), plan.steps.end(), [](const plan::Step& step) {
        return step.operation == plan::Operation::Refuse && step.text == plan::reason::NotInScene;
    });
    return missing != plan.steps.end() ? missing->text2 : std::string();
}

std::optional<Error> refusal_of(const plan::Plan& plan, const std::string& source) {
    if (!plan.is_refusal()) return std::nullopt;
    const auto& step = plan.steps.front();
    if (step.operation == Operation::None)
        return Error(ErrorCode::InvalidArgument, "the sentence asks for nothing that is not there already",
                     "say what is to be different");
    for (const auto& refusal : Refusals)
        if (refusal.reason == step.text) {
            if (step.text == plan::reason::NotInScene && !step.text2.empty())
                return Error(ErrorCode::InvalidArgument,
                             fmt::format("\"{}\" is not known to be in the scene{}", step.text2,
                                         source.empty() ? "" : ", and the edit is about \"" + source + "\""),
                             refusal.hint);
            return Error(ErrorCode::InvalidArgument, refusal.message, refusal.hint);
        }
    return Error(ErrorCode::InvalidArgument, "the sentence is not understood", DescribeScene);
}

}  // namespace gse::edit
