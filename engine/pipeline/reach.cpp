// Label or search.
#include "engine/pipeline/reach.h"

#include <algorithm>

#include "engine/edit/vocabulary.h"
#include "engine/scene/label_ops.h"

namespace gse::pipeline {

bool made_by_hand(const NamedLabel& label) {
    if (count_labelled(label) == 0) return false;
    return !label.weight || std::all_of(label.weight->begin(), label.weight->end(), [](float w) { return w == 0; });
}

bool corrected_by_hand(const NamedLabel& label) {
    return label.manual && std::any_of(label.manual->begin(), label.manual->end(), [](auto by_hand) { return by_hand != 0; });
}

bool is_label_of(const NamedLabel& label, const std::string& word) {
    return !word.empty() && (label.name == word || label.found_for == word);
}

bool label_says(const NamedLabel& label, const edit::EditRequest& request, const std::vector<std::string>& known,
                const std::optional<ReachChoice>& choice) {
    if (count_labelled(label) == 0) return false;
    const auto source = edit::as_told(request.source), target = edit::as_told(request.target);
    if (choice && choice->label == label.name && (choice->source.empty() || choice->source == source)) return choice->by_label;
    if (is_label_of(label, source) || is_label_of(label, target)) return true;
    return made_by_hand(label) && !edit::knows(known, source.empty() ? target : source);
}

}  // namespace gse::pipeline
