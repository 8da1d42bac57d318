// What can be said about a sentence before anything runs: known words, the target it implies, why it cannot
// be run.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/request.h"
#include "ui/widgets/chips.h"

namespace gse::ui {

struct SentenceFacts {
    std::vector<Chip> chips;        // one per word of the sentence
    std::string problem;            // why the request cannot be run, one sentence; empty = it can
    std::string locate_problem;     // why the source cannot be looked for; a sentence is not needed for that
    std::string source_suggestion;  // nearest known word of an unknown source
    bool source_known = true;
    std::string guessed_target;  // the target when none is chosen
};

/// `known` empty = the model takes any word.
SentenceFacts facts_of(const edit::EditRequest& request, const std::vector<std::string>& known);

/// The request that Locate runs: without a sentence that can be run, the source alone is looked for.
edit::EditRequest locate_request(const edit::EditRequest& request);

/// The sentence with its word number `index` replaced.
std::string with_word(const std::string& sentence, std::size_t index, const std::string& word);

}  // namespace gse::ui
