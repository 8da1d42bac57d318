// What can be said about a sentence before anything runs: known words, the target it implies, why it cannot
// be run.
#include "ui/sentence.h"

#include <algorithm>
#include <cctype>

#include "engine/base/error.h"
#include "engine/base/spelling.h"

namespace gse::ui {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_known(const std::vector<std::string>& known, const std::string& word) {
    return known.empty() || contains(known, word);
}

/// The nearest known word; letters that changed places count as near, whatever the length.
std::string suggestion_of(const std::string& word, const std::vector<std::string>& known) {
    for (const auto& candidate : known) {
        if (candidate.size() != word.size()) continue;
        const auto [here, there] = std::mismatch(word.begin(), word.end(), candidate.begin());
        std::string swapped = word;
        const auto at = static_cast<std::size_t>(here - word.begin());
        if (at + 1 < word.size()) std::swap(swapped[at], swapped[at + 1]);
        if (swapped == candidate) return candidate;
    }
    return nearest_word(word, known);
}

std::string first_letter_up(std::string text) {
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

/// What the engine would say, in the window's words where they are clearer.
std::string problem_of(const edit::EditRequest& request, SentenceFacts& facts) {
    if (request.prompt.empty() || facts.chips.empty())
        return "Describe the scene after the edit in one sentence";
    if (request.source.empty() && request.target.empty())
        return "Type what in the scene the edit is about, or click the word of the sentence that is new";
    try {
        const auto valid = edit::validated(request);
        facts.guessed_target = request.target.empty() ? valid.target : std::string();
    } catch (const Error& error) {
        if (!request.source.empty() && request.target.empty())
            return "Click the word of the sentence that is new";
        return first_letter_up(error.message());
    }
    return {};
}

}  // namespace

SentenceFacts facts_of(const edit::EditRequest& request, const std::vector<std::string>& known) {
    SentenceFacts facts;
    const auto source = edit::words_of(request.source);
    for (const auto& word : edit::words_of(request.prompt)) {
        Chip chip;
        chip.text = word;
        chip.known = is_known(known, word);
        if (!chip.known) chip.suggestion = suggestion_of(word, known);
        chip.source = contains(source, word);
        facts.chips.push_back(std::move(chip));
    }
    for (const auto& word : source) {
        if (is_known(known, word)) continue;
        facts.source_known = false;
        facts.source_suggestion = suggestion_of(word, known);
    }
    facts.problem = problem_of(request, facts);
    facts.locate_problem = source.size() == 1 ? std::string() : facts.problem;
    const auto target = edit::words_of(request.target.empty() ? facts.guessed_target : request.target);
    for (auto& chip : facts.chips) {
        chip.target = contains(target, chip.text);
        chip.guessed = chip.target && request.target.empty();
    }
    return facts;
}

edit::EditRequest locate_request(const edit::EditRequest& request) {
    try {
        edit::validated(request);
        return request;
    } catch (const Error&) {
        const auto source = edit::words_of(request.source);
        edit::EditRequest alone = request;
        alone.target = source.empty() ? std::string() : source.front();
        alone.prompt = "a " + alone.target;
        alone.mode = "modify";
        return alone;
    }
}

std::string with_word(const std::string& sentence, std::size_t index, const std::string& word) {
    std::string result;
    for (std::size_t at = 0; const auto& present : edit::words_of(sentence)) {
        if (!result.empty()) result += ' ';
        result += at == index ? word : present;
        ++at;
    }
    return result;
}

}  // namespace gse::ui
