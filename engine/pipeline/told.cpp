// Nouns put in the place of others.
#include "engine/pipeline/told.h"

#include <algorithm>
#include <string_view>

#include "engine/edit/vocabulary.h"
#include "engine/edit/words.h"

namespace gse::pipeline {
namespace {

/// The sentence with `noun` for `source`; an article right before it follows.
std::string with_noun(const std::string& sentence, const std::string& source, const std::string& noun) {
    auto terms = edit::terms_of(sentence, {source});
    for (std::size_t i = 0; i < terms.size(); ++i) {
        if (terms[i] != source) continue;
        terms[i] = noun;
        if (i == 0 || (terms[i - 1] != "a" && terms[i - 1] != "an")) continue;
        terms[i - 1] = std::string_view("aeiou").find(noun.front()) == std::string_view::npos ? "a" : "an";
    }
    return edit::joined(terms);
}

}  // namespace

Told told_of(const edit::EditRequest& request, edit::EditMode mode, const std::vector<std::string>& known, const std::string& stand_in) {
    const auto source = edit::as_told(request.source), noun = edit::as_told(stand_in);
    Told told{edit::sentence_before(request), edit::as_told(request.prompt), false};
    if (mode != edit::EditMode::Modify || noun.empty() || source.empty() || edit::knows(known, source) || !edit::has_word(told.after, source)) return told;
    return {with_noun(told.before, source, noun), with_noun(told.after, source, noun), true};
}

}  // namespace gse::pipeline
