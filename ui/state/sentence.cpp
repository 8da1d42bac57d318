// Facts about a sentence before anything runs: known words, the target it implies, why it cannot be run.
#include "ui/state/sentence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "engine/base/error.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/language/news.h"
#include "engine/language/plan/plan_text.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::ui {
namespace {

std::string first_letter_up(std::string text) {
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

/// Words that stand, in part at least, where the text encoder has stopped reading.
bool unread(const std::string& sentence, const std::string& phrase, const SentenceGround& ground) {
    if (ground.draws_any_word) return false;
    return ground.words_read > 0 && language::has_phrase(sentence, phrase) &&
           language::position_of(sentence, phrase) + language::words_of(phrase).size() > ground.words_read;
}

/// Tells whether nothing says where the source is: no word that the model finds, and no label.
bool source_is_missing(const std::string& source, const SentenceGround& ground) {
    return !ground.labelled_by_hand && !language::unknown_word(ground.known, source).empty();
}

std::string unknown_source(const std::string& source, const SentenceGround& ground) {
    const char* remedy = ground.server_finds ? "let the server find it, or click on it in the view"
                                             : "click on it in the view";
    if (language::vocabulary_contains(language::promptable_vocabulary(ground.known, ground.drawn), source))
        return fmt::format("The model can draw \"{}\" but not find it: {}", source, remedy);
    return fmt::format("The model does not know the word \"{}\" and cannot find it: {}",
                       language::unknown_word(ground.known, source), remedy);
}

/// Instead of a target that cannot be made: words near to it; where there are none, all of them would fill
/// the panel.
std::string what_to_say(const std::string& target, const std::vector<std::string>& known, bool dyes,
                        const std::string& hint) {
    const auto word = language::unknown_word(known, target);
    if (!language::nearest_words(word, known).empty()) return hint;
    return std::string("the words that it knows are under Models") +
           (dyes ? "; colours and patterns go by their names" : "");
}

/// Tells whether the word number `index` of the sentence belongs to the phrase.
bool within(const std::string& sentence, const std::string& phrase, std::size_t index) {
    if (!language::has_phrase(sentence, phrase)) return false;
    const std::size_t first = language::position_of(sentence, phrase);
    return index >= first && index < first + language::words_of(phrase).size();
}

/// Why the model cannot draw or find the request's words; empty = it can.
std::string words_problem(const edit::CheckedRequest& valid, const SentenceGround& ground, bool labelled) {
    const auto& words = valid.sentence();
    const bool draws = edit::method_of(valid).draws_views();
    const auto drawn = draws ? ground.drawn : std::vector<std::string>{};
    const auto require = ground.draws_any_word ? edit::require_findable_words : edit::require_known_words;
    try {
        require(valid, ground.known, drawn, labelled, {});
    } catch (const Error& error) {
        return fmt::format("{}: {}", first_letter_up(error.message()),
                           what_to_say(words.target(), language::promptable_vocabulary(ground.known, drawn),
                                       !drawn.empty(), error.hint()));
    }
    for (const auto& word : {words.source(), words.target()})
        if (unread(valid.prompt(), word, ground))
            return fmt::format(
                "The model stops reading before \"{}\": shorten the sentence, or move the word forward",
                word);
    return {};
}

StepFacts step_facts(const edit::EditRequest& request, const edit::PlannedStep& planned,
                     const SentenceGround& ground) {
    StepFacts facts{language::plan::step_text(planned.step),
                    language::plan::to_string(planned.step),
                    {},
                    planned.may_be_shown,
                    {}};
    if (!planned.words) {
        facts.problem =
            fmt::format("{}: {}", first_letter_up(planned.problem.reason), planned.problem.remedy);
        return facts;
    }
    facts.rearranges = !edit::is_drawn(planned.words->mode);
    const auto source = language::normalised_prompt(request.source);
    const bool about_source = planned.words->source == source;
    const bool labelled =
        (ground.labelled_by_hand && about_source) || language::contains(ground.made, planned.words->source);
    if (about_source && source_is_missing(source, ground)) {
        facts.problem = fmt::format("Waits until \"{}\" is labelled", source);
        return facts;
    }
    try {
        const auto valid = edit::check(edit::request_of(request, *planned.words), {ground.said, {}});
        facts.problem = words_problem(valid, ground, labelled);
        if (facts.problem.empty()) facts.told = valid.words();
    } catch (const Error& error) { facts.problem = first_letter_up(error.message()); }
    return facts;
}

/// Obstacle of a sentence with several changes: none of them can be done. Fills the words of the first.
std::string problem_of_steps(SentenceFacts& facts) {
    const auto first = std::find_if(facts.steps.begin(), facts.steps.end(),
                                    [](const auto& step) { return step.problem.empty(); });
    if (first == facts.steps.end()) return facts.steps.front().problem;
    facts.told = first->told;
    facts.guessed_target = first->told.target;
    return {};
}

/// Sentence of the engine, in the window's words if they are clearer.
std::string problem_of(const edit::EditRequest& request, const SentenceGround& ground, SentenceFacts& facts) {
    if (request.prompt.empty() || facts.chips.empty())
        return "Describe the scene after the edit in one sentence";
    if (request.source.empty() && request.target.empty())
        return "Type what in the scene the edit is about, or click the word of the sentence that is new";
    facts.missing = edit::missing_thing(request, edit::assumed_scene(request, ground.made));
    if (facts.follows_plan) {
        const auto problem = problem_of_steps(facts);
        const auto source = language::normalised_prompt(request.source);
        return !problem.empty() && source_is_missing(source, ground) ? unknown_source(source, ground)
                                                                     : problem;
    }
    if (const auto problem = edit::single_edit_problem(request, {ground.said, ground.read_target})) {
        facts.refused = true;
        return fmt::format("{}: {}", first_letter_up(problem->message()), problem->hint());
    }
    std::optional<edit::CheckedRequest> valid;
    try {
        valid = edit::check(request, {ground.said, ground.read_target});
    } catch (const Error& error) {
        if (!request.source.empty() && request.target.empty())
            return "Click the word of the sentence that is new";
        return first_letter_up(error.message());
    }
    const auto& words = valid->sentence();
    facts.guessed_target = request.target.empty() ? words.target() : std::string();
    if (valid->prompt() != request.prompt) facts.told = valid->words();
    if (!facts.source_known && !ground.labelled_by_hand)  // the words to use stand beside the source already
        return unknown_source(words.source(), ground);
    return words_problem(*valid, ground, ground.labelled_by_hand);
}

/// Why the source on its own cannot be looked for.
std::string locate_problem_of(const std::string& source, const SentenceGround& ground,
                              const SentenceFacts& facts) {
    if (source.empty()) return facts.problem;
    return facts.source_known ? std::string() : unknown_source(source, ground);
}

/// Words of a step that the model is told; of one that draws nothing, those of the thing alone.
std::string told_words(const StepFacts& step, const edit::EditRequest& request) {
    if (!step.rearranges) return step.told.prompt;
    return step.told.source.empty() ? language::normalised_prompt(request.source) : step.told.source;
}

/// Chips of words that are news, and of words of an order, which are not for the model.
void mark_chips(const edit::EditRequest& request, SentenceFacts& facts) {
    std::string told = facts.rearranges ? language::normalised_prompt(request.source) : facts.told.prompt;
    std::vector<std::string> targets{request.target.empty() ? facts.guessed_target : request.target};
    if (facts.steps.size() > 1)
        for (const auto& step : facts.steps) {
            told += " " + told_words(step, request);
            targets.push_back(step.told.target);
        }
    for (std::size_t index = 0; index < facts.chips.size(); ++index) {
        auto& chip = facts.chips[index];
        const bool slip =
            !facts.rearranges && !chip.suggestion.empty() && language::has_phrase(told, chip.suggestion);
        if (!told.empty() && !slip && !language::has_phrase(told, chip.text))
            chip.known = true, chip.suggestion.clear();
        chip.target = std::any_of(targets.begin(), targets.end(),
                                  [&](const auto& target) { return within(request.prompt, target, index); });
        chip.guessed = chip.target && request.target.empty();
    }
}

}  // namespace

SentenceFacts facts_of(const edit::EditRequest& request, const SentenceGround& ground) {
    SentenceFacts facts;
    const auto say = language::promptable_vocabulary(ground.known, ground.drawn);
    for (const auto& word : language::words_of(request.prompt)) {
        Chip chip;
        chip.text = word;
        chip.source = within(request.prompt, request.source, facts.chips.size());
        chip.known = ground.draws_any_word || language::vocabulary_contains(say, word) ||
                     (chip.source && ground.labelled_by_hand);  // the label says where it is
        if (!chip.known) {
            const auto near = language::nearest_words(word, say, 1);
            if (!near.empty()) chip.suggestion = near.front();
        }
        chip.read = ground.words_read == 0 || facts.chips.size() < ground.words_read;
        if (!chip.read && facts.cut_at.empty()) facts.cut_at = word;
        facts.chips.push_back(std::move(chip));
    }
    const auto unknown = language::unknown_word(ground.known, request.source);
    facts.source_known = unknown.empty();
    if (!facts.source_known) {
        const std::size_t index = language::position_of(request.source, unknown);
        for (const auto& near : language::nearest_words(unknown, ground.known))
            facts.source_suggestions.push_back(with_word(request.source, index, near));
        facts.source_help = language::words_to_use(unknown, language::things_among(ground.known));
    }
    const auto planned =
        edit::changes_of(request, edit::assumed_scene(request, ground.made),
                         {ground.said, {ground.known.empty() || ground.draws_any_word, ground.known}});
    for (const auto& step : planned) facts.steps.push_back(step_facts(request, step, ground));
    facts.rearranges = facts.steps.size() == 1 && facts.steps.front().rearranges;
    facts.follows_plan = edit::follows_plan(request, planned, {ground.said, {}});
    facts.problem = problem_of(request, ground, facts);
    facts.locate_problem = locate_problem_of(language::normalised_prompt(request.source), ground, facts);
    mark_chips(request, facts);
    return facts;
}

void forget_scope(edit::EditRequest& request) {
    request.part_of.clear();
    request.whole_scene = false;
}

edit::EditRequest as_change(edit::EditRequest request, const std::string& thing) {
    std::string said;
    for (const auto& phrase : language::Sentence(request.prompt).noun_phrases()) {
        if (phrase.head != thing) continue;
        for (const auto& attribute : phrase.attributes) said += (said.empty() ? "" : " ") + attribute;
    }
    const bool vowel =
        !said.empty() && std::string_view("aeiou").find(said.front()) != std::string_view::npos;
    request.source = thing;
    request.prompt = said.empty() ? "" : fmt::format("{} {} {}", vowel ? "an" : "a", said, thing);
    request.target = said;
    request.instruction.clear();
    request.mode = "auto";
    forget_scope(request);
    return request;
}

std::string target_to(const std::string& sentence, const std::string& target, std::size_t index) {
    const auto words = language::words_of(sentence);
    if (index >= words.size()) return target;
    if (!language::has_phrase(sentence, target)) return words[index];
    const std::size_t first = language::position_of(sentence, target),
                      last = first + language::words_of(target).size() - 1;
    std::string phrase;
    for (std::size_t i = std::min(first, index); i <= std::max(last, index); ++i)
        phrase += (phrase.empty() ? "" : " ") + words[i];
    return phrase;
}

std::string with_word(const std::string& sentence, std::size_t index, const std::string& word) {
    std::string result;
    for (std::size_t at = 0; const auto& present : language::words_of(sentence)) {
        if (!result.empty()) result += ' ';
        result += at == index ? word : present;
        ++at;
    }
    return result;
}

}  // namespace gse::ui
