// Label or search.
#include "app/session/state/edit_scope.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/scene/label_ops.h"

namespace gse::app {

bool made_by_hand(const NamedLabel& label) {
    if (count_labelled(label) == 0) return false;
    return !label.weight ||
           std::all_of(label.weight->begin(), label.weight->end(), [](float w) { return w == 0; });
}

bool corrected_by_hand(const NamedLabel& label) {
    return label.manual &&
           std::any_of(label.manual->begin(), label.manual->end(), [](auto by_hand) { return by_hand != 0; });
}

bool corrected_after_search(const std::vector<NamedLabel>& labels, const std::vector<std::string>& words) {
    return std::any_of(labels.begin(), labels.end(), [&](const NamedLabel& label) {
        return !label.found_for.empty() &&
               std::find(words.begin(), words.end(), label.found_for) != words.end() &&
               corrected_by_hand(label);
    });
}

bool is_label_of(const NamedLabel& label, const std::string& word) {
    return !word.empty() && (label.name == word || label.found_for == word);
}

std::optional<edit::EditRequest> recorded_request(const EditNode& node) {
    const auto json = try_parse_json<nlohmann::ordered_json>(node.recipe);
    if (!json.is_object() || !json.contains("request")) return {};
    edit::EditRequest request;
    edit::read_request(request, json["request"]);
    return request;
}

std::vector<language::EditSentence> applied_sentences(const std::vector<EditNode>& stack) {
    std::vector<language::EditSentence> applied;
    for (const auto& node : stack) {
        if (!node.enabled) continue;
        try {
            if (const auto request = recorded_request(node))
                applied.push_back(edit::unchecked_sentence(*request));
        } catch (const Error&) {  // of another version: what it said is not known
        }
    }
    return applied;
}

FoundWith found_with(const DocumentState& state) {
    if (state.active_label < 0 || state.active_label >= static_cast<int>(state.labels.size())) return {};
    const auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (label.attention_threshold < 0) return {};
    // With the fewest digits, so that what was 0.4 is 0.4 again.
    return {label.name,
            {label.attention_threshold, std::stod(fmt::format("{}", label.threshold)), label.excluded_views}};
}

bool same_vote(const edit::LabelThresholds& a, const edit::LabelThresholds& b) {
    return a.attention_threshold == b.attention_threshold && a.excluded_views == b.excluded_views;
}

bool stands_alone(const NamedLabel& label, const edit::EditRequest& request,
                  const std::vector<std::string>& known) {
    return made_by_hand(label) ||
           (is_label_of(label, language::normalised_prompt(request.source)) &&
            !language::vocabulary_contains(known, language::normalised_prompt(request.source)));
}

bool label_says(const NamedLabel& label, const edit::EditRequest& request,
                const std::vector<std::string>& known, const std::optional<ReachChoice>& choice) {
    if (count_labelled(label) == 0) return false;
    const auto source = language::normalised_prompt(request.source),
               target = language::normalised_prompt(request.target);
    if (choice && choice->label == label.name && (choice->source.empty() || choice->source == source))
        return choice->by_label;
    if (is_label_of(label, source) || is_label_of(label, target)) return true;
    return made_by_hand(label) && !language::vocabulary_contains(known, source.empty() ? target : source);
}

}  // namespace gse::app
