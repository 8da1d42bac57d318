// Candidates for the news of a sentence, in the order in which they are taken for it.
#include "engine/language/news.h"

#include <algorithm>

#include "engine/language/grammar.h"
#include "engine/language/words.h"

namespace gse::language {
namespace {

using Terms = std::vector<std::string>;

/// A word that may be the news of a sentence, with the words that describe it.
struct Candidate {
    std::string head;
    Terms phrase;
};

/// The word right before the source ("blue" bear, "blue" * bear); empty where it is not described.
std::string description_of(const EditSentence& edit) {
    auto terms = edit.sentence().terms({edit.source()});
    std::erase(terms, Identifier);
    const auto found = std::find(terms.begin(), terms.end(), edit.source());
    if (found == terms.begin() || found == terms.end()) return {};
    const auto& word = *(found - 1);
    return is_leading(word) || ends_phrase(word) ? std::string() : word;
}

/// Whatever describes the source that stands at `at`, the nearest first.
void add_descriptions(const Terms& terms, std::size_t at, std::vector<Candidate>& list) {
    for (std::size_t i = at; i > 0; --i) {
        const auto& word = terms[i - 1];
        if (word == Identifier) continue;
        if (is_leading(word) || ends_phrase(word)) break;
        list.push_back({word, {word}});
    }
}

/// "The bear is golden", "make the bear golden".
void add_predicates(const Terms& terms, std::size_t at, std::vector<Candidate>& list) {
    std::size_t next = at + 1;
    const bool copula = next < terms.size() && is_a(terms[next], WordClass::Copula);
    if (copula) ++next;
    else if (!is_a(terms.front(), WordClass::MakingVerb)) return;
    if (next < terms.size() && !ends_phrase(terms[next]) && !is_leading(terms[next]))
        list.push_back({terms[next], {terms[next]}});
}

void add_phrase(const Terms& terms, std::size_t first, std::vector<Candidate>& list) {
    const auto head = head_of_phrase(terms, first);
    if (head.empty()) return;
    const auto begin = terms.begin() + static_cast<std::ptrdiff_t>(first);
    list.push_back({head, Terms(begin, std::find(begin, terms.end(), head) + 1)});
}

/// Candidates in a sentence that does not name the source: all objects. A replacement of the source's kind
/// comes first. It is a worn object for a worn one ("a bear wearing a crown" for the hat), a ground for a
/// ground ("a robot on the snow").
std::vector<Candidate> candidates_without(const Terms& terms, const std::string& source) {
    std::vector<Candidate> list;
    add_phrase(terms, 0, list);
    for (std::size_t i = 0; i < terms.size(); ++i)
        if (ends_phrase(terms[i])) add_phrase(terms, i + 1, list);
    std::stable_partition(list.begin(), list.end(), [&](const Candidate& candidate) {
        return has_usual_place(source) && has_usual_place(candidate.head);
    });
    std::stable_partition(list.begin(), list.end(), [&](const Candidate& candidate) {
        return is_ground(source) && is_ground(candidate.head);
    });
    return list;
}

/// Everything a sentence says of the source, in the order in which it is taken for the news.
std::vector<Candidate> candidates_of(const Terms& terms, const std::string& source) {
    const auto found = std::find(terms.begin(), terms.end(), source);
    if (source.empty() || found == terms.end()) return candidates_without(terms, source);
    std::vector<Candidate> list;
    const auto at = static_cast<std::size_t>(found - terms.begin());
    for (std::size_t i = at + 1; i < terms.size(); ++i)
        if (is_a(terms[i], WordClass::Joiner) || says_worn(terms, i)) add_phrase(terms, i + 1, list);
    std::erase_if(list, [&](const Candidate& candidate) {
        return candidate.head == source;
    });  // "into a golden bear": what describes it is new
    add_predicates(terms, at, list);
    for (std::size_t place = at; place < terms.size(); ++place)
        if (terms[place] == source) add_descriptions(terms, place, list);
    return list;
}

/// The thing that has the source at `at` on, or holds it: "bear" in "a bear wearing a red hat"; empty where
/// none does.
std::string wearer_of(const Terms& terms, std::size_t at) {
    std::size_t first = at;
    while (!begins_phrase(terms, first)) --first;  // of the source's phrase
    if (first < 2 || !is_a(terms[first - 1], WordClass::Having)) return {};
    std::size_t begin = first - 1;
    while (!begins_phrase(terms, begin)) --begin;
    return head_of_phrase(terms, begin);
}

std::string guess_of(const Sentence& sentence, const Terms& terms, const std::string& source,
                     const std::vector<std::string>& said) {
    const auto candidates = candidates_of(terms, source);
    const auto is_new = [&](const std::string& word) { return !contains(said, word) && !is_leading(word); };
    for (const auto& candidate : candidates)
        if (is_new(candidate.head)) return candidate.head;
    for (const auto& candidate : candidates)  // "a red hat" where the hat was blue
        if (std::any_of(candidate.phrase.begin(), candidate.phrase.end(), is_new)) return candidate.head;
    if (candidates.empty()) return !terms.empty() && !sentence.contains(source) ? terms.back() : source;
    const auto& first = candidates.front().head;
    // "a bear wearing a hat in the snow" where it wears the hat: no second one is put on
    for (std::size_t i = 0; has_usual_place(first) && i < terms.size(); ++i)
        if (is_ground(terms[i]) && is_new(terms[i])) return terms[i];
    return first;
}

}  // namespace

std::string guessed_target(const Sentence& sentence, const std::string& source,
                           const std::vector<std::string>& said) {
    return guess_of(sentence, sentence.terms({source}), source, said);
}

std::vector<std::string> possible_targets(const Sentence& sentence, const std::string& source,
                                          const std::vector<std::string>& said) {
    const auto terms = sentence.terms({source});
    std::vector<std::string> targets{guess_of(sentence, terms, source, said)};
    if (is_ground(source) && is_ground(targets.front()) && !sentence.contains(source))
        return targets;  // however little a scene looks like the rest
    const auto add = [&](const std::string& word) {
        if (word != source && says_something(word) && !contains(targets, word) && !contains(said, word))
            targets.push_back(word);
    };
    for (const auto& candidate : candidates_of(terms, source)) add(candidate.head);
    const auto found = std::find(terms.begin(), terms.end(), source);
    // The wearer of the source is there, too, where the sentence has something else to say of it.
    const auto wearer = found != terms.end() && targets.front() != source
                            ? wearer_of(terms, static_cast<std::size_t>(found - terms.begin()))
                            : std::string();
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const auto head = begins_phrase(terms, i) ? head_of_phrase(terms, i) : wearer;
        if (head != wearer) add(head);
    }
    return targets;
}

std::vector<std::string> words_said(const std::vector<EditSentence>& applied) {
    std::vector<std::string> said;
    const auto forget = [&](const std::string& word) { std::erase(said, word); };
    for (std::size_t i = 0; i < applied.size(); ++i) {
        const auto& edit = applied[i];
        if (!edit.sentence().contains(edit.source()))  // replaced by the target
            for (const auto& word : words_of(edit.source())) forget(word);
        const auto target = words_of(edit.target());
        const bool described = !target.empty() && description_of(edit) == target.back();
        for (std::size_t earlier = 0; described && earlier < i; ++earlier)  // described anew
            if (applied[earlier].source() == edit.source()) forget(description_of(applied[earlier]));
        for (const auto& word : edit.sentence().words())
            if (!contains(said, word)) said.push_back(word);
    }
    return said;
}

}  // namespace gse::language
