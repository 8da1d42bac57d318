// Facts about a sentence before anything runs: known words, the target it implies, why it cannot be run.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/request/request.h"
#include "ui/widgets/chips.h"

namespace gse::ui {

/// Vocabulary and settings that a sentence is held against.
struct SentenceGround {
    std::vector<std::string> known = {};  // words of the model; empty = it takes any word
    std::vector<std::string> said = {};   // words that the scene shows already, from the edits applied
    bool labelled_by_hand = false;        // the label says where: nothing has to be found
    std::size_t words_read = 0;           // of the sentence, by the text encoder; 0 = not known, all of them
    // The word that a search of this sentence saw to be new; empty = none has looked.
    std::string read_target = {};
    std::vector<std::string> made = {};   // things of the scene that are labelled: by edits, or by hand
    std::vector<std::string> drawn = {};  // words that the model draws besides and does not look for
    bool draws_any_word = false;          // a server draws: only what is looked for has to be known
    bool server_finds = false;            // the server is offered to look for the source
};

/// One change that a sentence asks for.
struct StepFacts {
    std::string text;           // "colour: bear, blue"
    std::string notation;       // of the plan: its identity
    std::string problem;        // why it cannot be done, and what would do it, one sentence; empty = it can
    bool may_be_shown = false;  // pictures of the scene may show it already
    edit::EditWords told = {};  // words that the model is told
    bool rearranges = false;    // splats that are there: no word of it is drawn
};

struct SentenceFacts {
    std::vector<Chip> chips;     // one per word of the sentence
    std::string problem;         // why the request cannot be run, one sentence; empty = it can
    std::string locate_problem;  // why the source cannot be looked for
    std::vector<std::string>
        source_suggestions;   // the source with the nearest known words for its unknown one
    std::string source_help;  // what to use instead of it
    bool source_known = true;
    std::string guessed_target;  // the target when none is chosen
    // Words that the model is told in place of the typed ones, by the first step of several; prompt empty =
    // none.
    edit::EditWords told;
    std::vector<StepFacts> steps;  // of the plan; empty = the sentence is told as it is typed, or refused
    bool follows_plan = false;     // the steps run in their own words
    bool refused = false;          // by what the sentence means, whatever the model
    std::string missing;           // noun that it is refused for: nothing in the scene is called so
    std::string cut_at;            // first word that the text encoder does not read; empty = it reads all
    bool rearranges = false;       // the sentence as a whole does: none of its words is drawn
};

SentenceFacts facts_of(const edit::EditRequest& request, const SentenceGround& ground);

/// The target grown to the word number `index` of the sentence: all words between them.
std::string target_to(const std::string& sentence, const std::string& target, std::size_t index);

/// The request is about a thing of its own again, and no part of one or the whole scene.
void forget_scope(edit::EditRequest& request);

/// The sentence with its word number `index` replaced.
std::string with_word(const std::string& sentence, std::size_t index, const std::string& word);

/// The edit of a thing that the sentence would add: about it alone, with what the sentence says of it. "hat"
/// of "a bear wearing a red hat" gives "a red hat", target "red". Target and prompt are empty where nothing
/// is said.
edit::EditRequest as_change(edit::EditRequest request, const std::string& thing);

}  // namespace gse::ui
