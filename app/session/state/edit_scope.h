// What an edit reaches: whether the label that is shown says what may change, or a search for the words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/request/request.h"
#include "engine/scene/document.h"

namespace gse::app {

/// What the artist said of a label: that it drives the edits of a source, or that these are searched for.
struct ReachChoice {
    bool by_label = false;
    std::string label;   // its name
    std::string source;  // as told; empty = of any source that is typed next
};

/// Painted or cut out, not found by words.
bool made_by_hand(const NamedLabel& label);

/// Whether a search corrected, or a whole label made, by hand says more than the views do.
bool corrected_by_hand(const NamedLabel& label);

/// Whether it is the label of that word: by its name, or because a search for the word made it.
bool is_label_of(const NamedLabel& label, const std::string& word);

/// True when the label, and not a search, says what the request may change: it is about the words of the
/// request, the model does not know them and it was made by hand, or the artist said so. `known`: words of
/// the model; empty = it takes any.
bool label_says(const NamedLabel& label, const edit::EditRequest& request,
                const std::vector<std::string>& known, const std::optional<ReachChoice>& choice);

/// Whether nothing has to be found where the label says what the request may change: it was made by hand, or
/// it is of a thing that the model cannot find, as of what it drew.
bool stands_alone(const NamedLabel& label, const edit::EditRequest& request,
                  const std::vector<std::string>& known);

/// What the edits of a stack that are switched on were asked for; those made by hand, or by another version,
/// are passed over.
std::vector<edit::EditRequest> applied_requests(const std::vector<EditNode>& stack);

/// What the active label was found with: thresholds and views left out; a negative attention threshold = not
/// by a search.
struct FoundWith {
    std::string label;
    edit::LabelThresholds with{-1, -1, {}};
};
FoundWith found_with(const DocumentState& state);

/// Whether views vote the same with both, whatever share of the vote labels.
bool same_vote(const edit::LabelThresholds& a, const edit::LabelThresholds& b);

}  // namespace gse::app
