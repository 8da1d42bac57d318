// Label or search.
#include "app/session/state/edit_scope.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/language/plan/words/file_words.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/pipeline/scene/label_names.h"
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

bool answers_to(const NamedLabel& label, const std::string& word) {
    return is_label_of(label, word) ||
           (!word.empty() && language::plan::thing_of_file_name(label.name) == word);
}

std::optional<edit::EditRequest> recorded_request(const EditNode& node) {
    const auto json = try_parse_json<nlohmann::ordered_json>(node.recipe);
    if (!json.is_object() || !json.contains("request")) return {};
    edit::EditRequest request;
    edit::read_request(request, json["request"]);
    return request;
}

namespace {

/// True for an edit that brought a thing of that name.
bool brings(const edit::EditRequest& request, const std::string& thing) {
    const auto mode = edit::planned_mode(request);
    return mode != edit::EditMode::Modify &&
           language::new_thing(edit::unchecked_sentence(request), mode) == thing;
}

/// Takes an edit on top of the others. One that removes a thing takes back what brought it.
void take_request(std::vector<edit::EditRequest>& applied, edit::EditRequest request) {
    const auto mode = edit::planned_mode(request);
    if (edit::is_drawn(mode)) return applied.push_back(std::move(request));
    if (mode == edit::EditMode::Remove)
        std::erase_if(applied, [&](const auto& other) { return brings(other, request.source); });
}

/// Requests of the edits that are switched on and that a version like this one made. What was removed again
/// is none of them.
std::vector<edit::EditRequest> applied_requests(const std::vector<EditNode>& stack) {
    std::vector<edit::EditRequest> applied;
    for (const auto& node : stack) {
        if (!node.enabled) continue;
        try {
            if (auto request = recorded_request(node)) take_request(applied, std::move(*request));
        } catch (const Error&) {  // of another version: what it said is not known
        }
    }
    return applied;
}

}  // namespace

std::vector<language::EditSentence> applied_sentences(const std::vector<EditNode>& stack) {
    std::vector<language::EditSentence> applied;
    for (const auto& request : applied_requests(stack)) applied.push_back(edit::unchecked_sentence(request));
    return applied;
}

std::vector<std::string> things_made(const std::vector<EditNode>& stack) {
    std::vector<std::string> made;
    for (const auto& request : applied_requests(stack)) {
        const auto mode = edit::planned_mode(request);
        if (mode != edit::EditMode::Modify)
            made.push_back(language::new_thing(edit::unchecked_sentence(request), mode));
    }
    return made;
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
           (answers_to(label, language::normalised_prompt(request.source)) &&
            !language::vocabulary_contains(known, language::normalised_prompt(request.source)));
}

bool label_says(const NamedLabel& label, const edit::EditRequest& request,
                const std::vector<std::string>& known, const std::optional<ScopeChoice>& choice) {
    if (count_labelled(label) == 0) return false;
    const auto source = language::normalised_prompt(request.source),
               target = language::normalised_prompt(request.target);
    if (choice && choice->label == label.name && (choice->source.empty() || choice->source == source))
        return choice->by_label;
    if (answers_to(label, source) || answers_to(label, target)) return true;
    return made_by_hand(label) && !language::vocabulary_contains(known, source.empty() ? target : source);
}

bool is_addition(const NamedLabel& label, const std::vector<RowId>& row_ids) {
    if (!label.bits || label.bits->size() != row_ids.size()) return false;
    bool any = false;
    for (std::size_t row = 0; row < row_ids.size(); ++row) {
        if ((*label.bits)[row] == 0) continue;
        if (row_ids[row] >> EditIdShift == 0) return false;
        any = true;
    }
    return any;
}

std::vector<std::string> things_added(const DocumentState& state) {
    auto things = things_made(state.stack);
    for (const NamedLabel& label : state.labels) {
        if (!state.row_ids || !is_addition(label, *state.row_ids)) continue;
        for (auto& name : pipeline::words_for_label(label.name))
            if (!language::contains(things, name)) things.push_back(std::move(name));
    }
    return things;
}

std::vector<std::string> things_labelled(const DocumentState& state) {
    std::vector<std::string> things;
    for (const NamedLabel& label : state.labels)
        if (made_by_hand(label))
            for (auto& name : pipeline::words_for_label(label.name)) things.push_back(std::move(name));
    return things;
}

namespace {

/// The artist's word about a label for this source; nothing = none was said.
std::optional<bool> chosen(const NamedLabel& label, const std::string& source,
                           const std::optional<ScopeChoice>& choice, bool any_source) {
    if (!choice || choice->label != label.name) return std::nullopt;
    const bool fits = choice->source.empty() ? any_source : choice->source == source;
    return fits ? std::optional(choice->by_label) : std::nullopt;
}

/// Tells whether the active label stands for a thing that is neither its own nor another label's.
bool stands_in(const NamedLabel& label, const DocumentState& state, const std::string& source,
               const std::optional<ScopeChoice>& choice) {
    const bool of_another = choice && choice->label == label.name && !choice->source.empty() &&
                            !source.empty() && choice->source != source;
    return !of_another && !(state.row_ids && is_addition(label, *state.row_ids));
}

}  // namespace

std::optional<std::size_t> scope_label(const DocumentState& state, const edit::EditRequest& request,
                                       const std::vector<std::string>& known,
                                       const std::optional<ScopeChoice>& choice) {
    const auto source = language::normalised_prompt(request.source),
               target = language::normalised_prompt(request.target);
    const auto& labels = state.labels;
    const auto active = static_cast<std::size_t>(std::max(state.active_label, 0));
    // A label with the very name goes before one whose name is that of a file.
    const bool exact = std::any_of(labels.begin(), labels.end(), [&](const NamedLabel& label) {
        return count_labelled(label) > 0 && is_label_of(label, source.empty() ? target : source);
    });
    const auto is_of = exact ? is_label_of : answers_to;
    const bool some = state.active_label >= 0 && active < labels.size() && count_labelled(labels[active]) > 0;
    if (some) {
        const auto& label = labels[active];
        if (const auto said = chosen(label, source, choice, true))
            return *said ? std::optional(active) : std::nullopt;
        if (is_of(label, source) || is_of(label, target)) return active;
    }
    for (std::size_t index = 0; index < labels.size(); ++index) {
        const auto& label = labels[index];
        if ((some && index == active) || count_labelled(label) == 0) continue;
        const auto said = chosen(label, source, choice, false);
        if (said.value_or(is_of(label, source.empty() ? target : source))) return index;
    }
    return some && stands_in(labels[active], state, source, choice) &&
                   label_says(labels[active], request, known, {})
               ? std::optional(active)
               : std::nullopt;
}

namespace {

/// The thing that a request adds, without what is said of it: "hat" of "a red hat". Empty for other requests.
std::string added_thing(const edit::EditRequest& request) {
    if (edit::planned_mode(request) != edit::EditMode::Add) return {};
    const auto words = edit::unchecked_sentence(request);
    for (const auto& phrase : words.sentence().noun_phrases()) {
        const auto says = [&](const std::string& word) { return language::has_phrase(words.target(), word); };
        if (says(phrase.head) || std::any_of(phrase.attributes.begin(), phrase.attributes.end(), says))
            return phrase.head;
    }
    return {};
}

bool added_by(const EditNode& node, const std::string& thing) {
    try {
        const auto request = recorded_request(node);
        return request && added_thing(*request) == thing;
    } catch (const Error&) { return false; }  // of another version: what it said is not known
}

}  // namespace

std::string present_already(const DocumentState& state, const edit::EditRequest& request,
                            const std::string& read_target) {
    const std::string thing = added_thing(request);
    if (thing.empty()) return {};
    if (!read_target.empty() && !language::has_phrase(read_target, thing)) return thing;
    const bool added = std::any_of(state.stack.begin(), state.stack.end(), [&](const EditNode& node) {
        return node.enabled && added_by(node, thing);
    });
    const bool labelled = std::any_of(state.labels.begin(), state.labels.end(), [&](const NamedLabel& label) {
        return answers_to(label, thing) && count_labelled(label) > 0;
    });
    return added || labelled ? thing : std::string();
}

}  // namespace gse::app
