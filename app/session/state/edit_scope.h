// Scope of an edit: the shown label, or a search for the words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/request/request.h"
#include "engine/language/sentence.h"
#include "engine/scene/document.h"

namespace gse::app {

/// The artist's choice about a label: it drives the edits of a source, or these are searched for.
struct ScopeChoice {
    bool by_label = false;
    std::string label;   // its name
    std::string source;  // as told; empty = of any source that is typed next
};

/// Painted or cut out, not found by words.
bool made_by_hand(const NamedLabel& label);

/// Tells whether a search corrected, or a whole label made, by hand says more than the views do.
bool corrected_by_hand(const NamedLabel& label);

/// Tells whether a label found by a search for one of the words was corrected by hand.
bool corrected_after_search(const std::vector<NamedLabel>& labels, const std::vector<std::string>& words);

/// Tells whether it is the label of that word: by its name, or because a search for the word made it.
bool is_label_of(const NamedLabel& label, const std::string& word);

/// is_label_of(), or its name is that of a file with a thing of that word: "object_guitar" for "guitar".
bool answers_to(const NamedLabel& label, const std::string& word);

/// True when the label, and not a search, is the scope of the request. Its name is in the request's words,
/// and the model does not know them and it was made by hand, or the artist chose it. `known` holds the words
/// of the model; empty = it takes any.
bool label_says(const NamedLabel& label, const edit::EditRequest& request,
                const std::vector<std::string>& known, const std::optional<ScopeChoice>& choice);

/// Tells whether all that is labelled was added by edits. `row_ids`: identity of each row.
bool is_addition(const NamedLabel& label, const std::vector<RowId>& row_ids);

/// Index of the label that is the scope of the request, else nothing: a search is. The active label goes
/// first, as label_says() has it, then the one that the artist chose for this source or that is named for its
/// thing. What an edit added is no scope for another thing, nor is a label that was chosen for another
/// source.
std::optional<std::size_t> scope_label(const DocumentState& state, const edit::EditRequest& request,
                                       const std::vector<std::string>& known,
                                       const std::optional<ScopeChoice>& choice);

/// Name of the thing that an addition puts there, where the scene has one already; empty otherwise. An edit
/// of the stack added it, or a label is named for it. Or a search saw that only what is said of it is new:
/// `read_target` is "red" of "a red hat".
std::string present_already(const DocumentState& state, const edit::EditRequest& request,
                            const std::string& read_target = {});

/// True when nothing has to be found for a request whose scope is the label. It was made by hand, or its
/// object is one that the model cannot find (for example one that it drew).
bool stands_alone(const NamedLabel& label, const edit::EditRequest& request,
                  const std::vector<std::string>& known);

/// Request of an edit of the stack; nothing for edits by hand. Throws Error for one of another version.
std::optional<edit::EditRequest> recorded_request(const EditNode& node);

/// Prompts of the edits of a stack that are switched on. Edits by hand, or of another version, are passed
/// over.
std::vector<language::EditSentence> applied_sentences(const std::vector<EditNode>& stack);

/// Things that the edits of a stack have put into the scene.
std::vector<std::string> things_made(const std::vector<EditNode>& stack);

/// Things that edits have put into the scene: those of sentences, and those that labels of added rows are
/// named for.
std::vector<std::string> things_added(const DocumentState& state);

/// Things that labels made by hand are named for.
std::vector<std::string> things_labelled(const DocumentState& state);

/// Search settings of the active label: thresholds and excluded views. A negative attention threshold = not
/// by a search.
struct FoundWith {
    std::string label;
    edit::LabelThresholds with{-1, -1, {}};
};
FoundWith found_with(const DocumentState& state);

/// True when views vote alike with both, whatever share of the vote labels.
bool same_vote(const edit::LabelThresholds& a, const edit::LabelThresholds& b);

}  // namespace gse::app
