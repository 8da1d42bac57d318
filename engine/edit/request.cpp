// Checks of a request before anything is loaded or computed.
#include "engine/edit/request.h"

#include <algorithm>
#include <cctype>

#include "engine/base/error.h"
#include "engine/edit/add_region.h"

namespace gse::edit {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// One lower-case word; throws when there are several or none.
std::string single_word(const std::string& text, const char* what) {
    const auto words = words_of(text);
    if (words.size() != 1)
        throw Error(ErrorCode::InvalidArgument, std::string("the ") + what + " must be one word, not \"" + text + "\"",
                    "give the one word that matters");
    return words.front();
}

}  // namespace

std::vector<std::string> words_of(const std::string& sentence) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : sentence + " ") {
        const auto byte = static_cast<unsigned char>(letter);
        const bool part_of_word = std::isalnum(byte) != 0 || byte >= 0x80 || letter == '-' || letter == '\'';
        if (part_of_word) {
            word += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
        } else if (!word.empty()) {
            words.push_back(std::move(word));
            word.clear();
        }
    }
    return words;
}

namespace {

using Words = std::vector<std::string>;

const Words Articles{"a", "an", "the", "its", "his", "her", "their", "some", "this", "that", "photo", "picture", "of"};
const Words Joiners{"wearing", "with", "holding", "has", "having", "carrying", "plus", "and", "made", "into", "as"};
const Words Stops{"on",   "in", "at", "under", "beside",   "near",    "behind", "over",   "by",
                  "from", "to", "is", "of",    "standing", "sitting", "lying",  "turned", "changed"};
const Words Turning{"made", "of", "into", "as"};   // what follows is not a thing beside the others

/// Last word of the noun phrase that begins at `first`: articles and the "of" of "made of" are passed over.
std::string head_of_phrase(const Words& words, std::size_t first) {
    while (first < words.size() && contains(Articles, words[first])) ++first;
    std::string head;
    for (std::size_t i = first; i < words.size() && !contains(Joiners, words[i]) && !contains(Stops, words[i]); ++i)
        head = words[i];
    return head;
}

}  // namespace

bool has_word(const std::string& sentence, const std::string& word) { return contains(words_of(sentence), word); }

bool says_worn(const std::vector<std::string>& words, std::size_t i) {
    static const Words one{"a", "an", "its", "his", "her", "their"};
    if (words[i] != "in" || i + 1 >= words.size()) return false;
    return contains(one, words[i + 1]) || has_usual_place(words[i + 1]);
}

std::string guessed_target(const std::string& prompt, const std::string& source) {
    const auto words = words_of(prompt);
    const auto found = std::find(words.begin(), words.end(), source);
    if (source.empty() || found == words.end()) {
        const auto head = head_of_phrase(words, 0);
        return head.empty() && !words.empty() ? words.back() : head;
    }
    const auto at = static_cast<std::size_t>(found - words.begin());
    for (std::size_t i = at + 1; i < words.size(); ++i) {
        if (!contains(Joiners, words[i]) && !says_worn(words, i)) continue;
        const auto head = head_of_phrase(words, i + 1);
        if (!head.empty()) return head;
    }
    const bool described = at > 0 && !contains(Articles, words[at - 1]) && !contains(Stops, words[at - 1]) &&
                           !contains(Joiners, words[at - 1]);
    return described ? words[at - 1] : source;
}

std::string sentence_before(const EditRequest& request) {
    auto words = words_of(request.prompt);
    const auto target = std::find(words.begin(), words.end(), request.target) - words.begin();
    const auto source = std::find(words.begin(), words.end(), request.source) - words.begin();
    const auto count = static_cast<std::ptrdiff_t>(words.size());
    const auto joins = [&](std::ptrdiff_t i) {
        const auto& word = words[static_cast<std::size_t>(i)];
        return contains(Joiners, word) || contains(Stops, word);
    };
    if (target < count && (source == count || source == target)) {
        words[static_cast<std::size_t>(target)] = request.source;
    } else if (target < count) {
        std::ptrdiff_t first = target, last = target + 1;
        if (source < target) {
            while (first > source + 1 && !joins(first)) --first;
            while (first > source + 1 && joins(first - 1)) --first;
            while (last < count && !joins(last)) ++last;
        }
        words.erase(words.begin() + first, words.begin() + last);
    }
    std::string sentence;
    for (const auto& word : words) sentence += (sentence.empty() ? "" : " ") + word;
    return sentence;
}

std::vector<std::string> things_named(const std::string& sentence) {
    const auto words = words_of(sentence);
    std::vector<std::string> things;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const bool begins = i == 0 || contains(Joiners, words[i - 1]) || contains(Stops, words[i - 1]);
        if (!begins || (i > 0 && contains(Turning, words[i - 1])) || contains(Turning, words[i])) continue;
        auto head = head_of_phrase(words, i);
        if (!head.empty() && !contains(things, head)) things.push_back(std::move(head));
    }
    return things;
}

EditRequest validated(EditRequest request) {
    const auto words = words_of(request.prompt);
    if (words.empty())
        throw Error(ErrorCode::InvalidArgument, "the edit has no prompt", "describe the scene after the edit with --prompt");
    if (request.mode != "auto" && request.mode != "modify" && request.mode != "add")
        throw Error(ErrorCode::InvalidArgument, "\"" + request.mode + "\" is not an edit mode", "use auto, modify or add");
    if (!request.source.empty()) request.source = single_word(request.source, "source");
    if (request.target.empty()) {
        if (request.source.empty())
            throw Error(ErrorCode::InvalidArgument, "neither a source nor a target word is given",
                        "name what the edit is about with --source, and what is new with --target");
        request.target = guessed_target(request.prompt, request.source);
    }
    request.target = single_word(request.target, "target");
    if (!contains(words, request.target))
        throw Error(ErrorCode::InvalidArgument,
                    "the prompt \"" + request.prompt + "\" does not contain the target word \"" + request.target + "\"",
                    "use the word in the sentence, or choose another target");
    if (request.source.empty()) request.source = request.target;
    return request;
}

EditMode chosen_mode(const EditRequest& request, bool target_exists) {
    if (request.mode == "add") return EditMode::Add;
    if (request.mode == "modify") return EditMode::Modify;
    return target_exists ? EditMode::Modify : EditMode::Add;
}

}  // namespace gse::edit
