// Checks of a request before anything is loaded or computed.
#include "engine/edit/request/request.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/edit/placement/voxel_region.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/request/relation.h"
#include "engine/edit/request/scales.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// Lower-case words with one space between them; throws when there are none.
std::string phrase_of(const std::string& text, const char* what) {
    auto phrase = as_told(text);
    if (phrase.empty())
        throw Error(ErrorCode::InvalidArgument,
                    std::string("the ") + what + " \"" + text + "\" is not a word",
                    "give the word or the words that matter");
    return phrase;
}

}  // namespace

namespace {

using Words = std::vector<std::string>;

const Words Articles{"a",    "an",   "the",  "its",   "his",     "her", "their",
                     "some", "this", "that", "photo", "picture", "of",  Identifier};
const Words Joiners{"wearing", "with", "holding", "has",  "having", "carrying",
                    "plus",    "and",  "made",    "into", "as"};
const Words Stops{"on",   "in", "at", "under", "beside",   "near",    "behind", "over",   "by",
                  "from", "to", "is", "of",    "standing", "sitting", "lying",  "turned", "changed"};
const Words Turning{"made", "of", "into", "as"};  // what follows is not a thing beside the others

const Words Pronouns{"it", "him", "her", "them", "itself", "himself", "herself"};

}  // namespace

std::vector<std::string> noun_terms(const std::string& sentence, const std::vector<std::string>& phrases) {
    auto whole = compound_prepositions();
    whole.insert(whole.end(), phrases.begin(), phrases.end());
    return terms_of(sentence, whole);
}

bool ends_phrase(const std::string& term) {
    return contains(Joiners, term) || contains(Stops, term) || relation_named(term).has_value();
}

bool is_pronoun(const std::string& term) { return contains(Pronouns, term); }

namespace {

/// Last word of the noun phrase that begins at `first`: articles and the "of" of "made of" are passed over.
std::string head_of_phrase(const Words& words, std::size_t first) {
    while (first < words.size() && contains(Articles, words[first])) ++first;
    std::string head;
    for (std::size_t i = first; i < words.size() && !ends_phrase(words[i]); ++i) head = words[i];
    return head;
}

}  // namespace

bool says_something(const std::string& word) {
    static const Words others{"add",   "remove", "without", "no",   "turn",  "make", "it",
                              "front", "side",   "back",    "left", "right", "view"};
    return !contains(Articles, word) && !ends_phrase(word) && !contains(others, word);
}

bool says_worn(const std::vector<std::string>& words, std::size_t i) {
    static const Words one{"a", "an", "its", "his", "her", "their"};
    if (words[i] != "in" || i + 1 >= words.size()) return false;
    return contains(one, words[i + 1]) || has_usual_place(words[i + 1]);
}

namespace {

/// A word that may be the news of a sentence, with the words that describe it.
struct Candidate {
    std::string head;
    Words phrase;
};

/// The word right before the source ("blue" bear, "blue" * bear); empty where it is not described.
std::string description_of(const EditRequest& edit) {
    auto words = noun_terms(edit.prompt, {edit.source});
    std::erase(words, Identifier);
    const auto found = std::find(words.begin(), words.end(), edit.source);
    if (found == words.begin() || found == words.end()) return {};
    const auto& word = *(found - 1);
    return contains(Articles, word) || ends_phrase(word) ? std::string() : word;
}

/// Whatever describes the source that stands at `at`, the nearest first.
void add_descriptions(const Words& words, std::size_t at, std::vector<Candidate>& list) {
    for (std::size_t i = at; i > 0; --i) {
        const auto& word = words[i - 1];
        if (word == Identifier) continue;
        if (contains(Articles, word) || ends_phrase(word)) break;
        list.push_back({word, {word}});
    }
}

/// "The bear is golden", "make the bear golden".
void add_predicates(const Words& words, std::size_t at, std::vector<Candidate>& list) {
    static const Words verbs{"make", "turn", "paint", "colour", "color", "dye"},
        copulas{"is", "are", "becomes", "looks", "turns"};
    std::size_t next = at + 1;
    const bool copula = next < words.size() && contains(copulas, words[next]);
    if (copula) ++next;
    else if (!contains(verbs, words.front())) return;
    if (next < words.size() && !ends_phrase(words[next]) && !contains(Articles, words[next]))
        list.push_back({words[next], {words[next]}});
}

/// Everything a sentence says of the source, in the order in which it is taken for the news.
std::vector<Candidate> candidates_of(const Words& words, const std::string& source) {
    std::vector<Candidate> list;
    const auto found = std::find(words.begin(), words.end(), source);
    const auto add_phrase = [&](std::size_t first) {
        const auto head = head_of_phrase(words, first);
        if (head.empty()) return;
        const auto begin = words.begin() + static_cast<std::ptrdiff_t>(first);
        list.push_back({head, Words(begin, std::find(begin, words.end(), head) + 1)});
    };
    if (source.empty() || found == words.end()) {
        add_phrase(0);
        for (std::size_t i = 0; i < words.size(); ++i)
            if (ends_phrase(words[i])) add_phrase(i + 1);
        // "A bear wearing a crown" for the hat: what is worn takes the place of what is worn.
        std::stable_partition(list.begin(), list.end(), [&](const Candidate& candidate) {
            return has_usual_place(source) && has_usual_place(candidate.head);
        });
        // And what things stand on that of what they stood on: "a robot on the snow" for the ground.
        std::stable_partition(list.begin(), list.end(), [&](const Candidate& candidate) {
            return is_ground(source) && is_ground(candidate.head);
        });
        return list;
    }
    const auto at = static_cast<std::size_t>(found - words.begin());
    for (std::size_t i = at + 1; i < words.size(); ++i)
        if (contains(Joiners, words[i]) || says_worn(words, i)) add_phrase(i + 1);
    std::erase_if(list, [&](const Candidate& candidate) {
        return candidate.head == source;
    });  // "into a golden bear": what describes it is new
    add_predicates(words, at, list);
    for (std::size_t place = at; place < words.size(); ++place)
        if (words[place] == source) add_descriptions(words, place, list);
    return list;
}

}  // namespace

namespace {

/// The thing that has the source at `at` on, or holds it: "bear" in "a bear wearing a red hat"; empty where
/// none does.
std::string wearer_of(const Words& words, std::size_t at) {
    static const Words having{"wearing", "with", "has", "having", "holding", "carrying", "in"};
    std::size_t first = at;
    while (first > 0 && !ends_phrase(words[first - 1])) --first;  // of the source's phrase
    if (first < 2 || !contains(having, words[first - 1])) return {};
    std::size_t begin = first - 1;
    while (begin > 0 && !ends_phrase(words[begin - 1])) --begin;
    return head_of_phrase(words, begin);
}

}  // namespace

std::string guessed_target(const std::string& prompt, const std::string& source,
                           const std::vector<std::string>& said) {
    const auto words = noun_terms(prompt, {source});
    const auto candidates = candidates_of(words, source);
    const auto is_new = [&](const std::string& word) {
        return !contains(said, word) && !contains(Articles, word);
    };
    for (const auto& candidate : candidates)
        if (is_new(candidate.head)) return candidate.head;
    for (const auto& candidate : candidates)  // "a red hat" where the hat was blue
        if (std::any_of(candidate.phrase.begin(), candidate.phrase.end(), is_new)) return candidate.head;
    if (!candidates.empty()) return candidates.front().head;
    return !words.empty() && !has_word(prompt, source) ? words.back() : source;
}

std::vector<std::string> possible_targets(const std::string& prompt, const std::string& source,
                                          const Words& said) {
    const auto words = noun_terms(prompt, {source});
    Words targets{guessed_target(prompt, source, said)};
    if (is_ground(source) && is_ground(targets.front()) && !has_word(prompt, source))
        return targets;  // however little a scene looks like the rest
    const auto add = [&](const std::string& word) {
        if (word != source && says_something(word) && !contains(targets, word) && !contains(said, word))
            targets.push_back(word);
    };
    for (const auto& candidate : candidates_of(words, source)) add(candidate.head);
    const auto found = std::find(words.begin(), words.end(), source);
    // What wears the source is there as that is, where the sentence has something else to say of it.
    const auto wearer = found != words.end() && targets.front() != source
                            ? wearer_of(words, static_cast<std::size_t>(found - words.begin()))
                            : std::string();
    for (std::size_t i = 0; i < words.size(); ++i)
        if (i == 0 || ends_phrase(words[i - 1])) {
            const auto head = head_of_phrase(words, i);
            if (head != wearer) add(head);
        }
    return targets;
}

std::vector<std::string> words_said(const std::vector<EditRequest>& applied) {
    std::vector<std::string> said;
    const auto forget = [&](const std::string& word) { std::erase(said, word); };
    for (std::size_t i = 0; i < applied.size(); ++i) {
        const auto& edit = applied[i];
        if (!has_word(edit.prompt, edit.source))  // replaced by the target
            for (const auto& word : words_of(edit.source)) forget(word);
        const auto target = words_of(edit.target);
        const bool described = !target.empty() && description_of(edit) == target.back();
        for (std::size_t earlier = 0; described && earlier < i; ++earlier)  // described anew
            if (applied[earlier].source == edit.source) forget(description_of(applied[earlier]));
        for (const auto& word : words_of(edit.prompt))
            if (!contains(said, word)) said.push_back(word);
    }
    return said;
}

namespace {

/// Where the words that bring the target begin and end: its description alone, or with what joins it to the
/// source.
std::pair<std::size_t, std::size_t> bringing(const Words& words, std::size_t source, std::size_t target) {
    const auto joins = [&](std::size_t i) { return ends_phrase(words[i]); };
    std::size_t first = target, last = target + 1;
    if (source < target) {
        while (first > source + 1 && !joins(first)) --first;
        while (first > source + 1 && joins(first - 1)) --first;
        while (last < words.size() && !joins(last)) ++last;
        if (last + 1 < words.size() && is_pronoun(words[last + 1])) last += 2;  // "beside it"
    } else if (last < source && source < words.size() &&
               names_thing(words, target)) {  // "a ball beside" a bear
        while (first > 0 && !joins(first - 1)) --first;
        for (last = source; !joins(last - 1);) --last;
    }
    return {first, last};
}

}  // namespace

std::string sentence_before(const EditRequest& request) {
    auto words = noun_terms(request.prompt, {request.source, request.target});
    const auto place = [&](const std::string& phrase) {
        return static_cast<std::size_t>(std::find(words.begin(), words.end(), phrase) - words.begin());
    };
    const std::size_t target = place(request.target), source = place(request.source);
    if (target < words.size() && (source == words.size() || source == target)) {
        words[target] = request.source;
        std::size_t first = target;  // what describes the new thing says nothing of the old one
        while (source == words.size() && first > 0 && !ends_phrase(words[first - 1]) &&
               !contains(Articles, words[first - 1]))
            --first;
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(first),
                    words.begin() + static_cast<std::ptrdiff_t>(target));
    } else if (target < words.size()) {
        const auto [first, last] = bringing(words, source, target);
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(first),
                    words.begin() + static_cast<std::ptrdiff_t>(last));
    }
    return joined(words);
}

std::vector<std::string> things_named(const std::string& sentence, const std::vector<std::string>& phrases) {
    const auto words = noun_terms(sentence, phrases);
    std::vector<std::string> things;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const bool begins = i == 0 || ends_phrase(words[i - 1]);
        if (!begins || (i > 0 && contains(Turning, words[i - 1])) || contains(Turning, words[i])) continue;
        auto head = head_of_phrase(words, i);
        if (!head.empty() && !contains(things, head)) things.push_back(std::move(head));
    }
    return things;
}

std::string instance_sentence(const EditRequest& request) {
    const bool identified = has_word(request.prompt, Identifier) && !has_word(request.source, Identifier);
    return "a photo of a " + (identified ? Identifier + " " : std::string()) + request.source;
}

namespace {

/// Whether a version before numbers could be unset has written the request: all of those had this field.
bool of_earlier_version(const nlohmann::ordered_json& json) {
    return json.contains(LoopSettings::RetiredFields.front().name);
}

}  // namespace

void read_request(EditRequest& request, const nlohmann::ordered_json& json) {
    fields_from_json(request, json);
    if (!of_earlier_version(json)) return;
    EditRequest::visit_fields(request, [](const char*, auto& value, const char*, const auto&...) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Overridable>)
            if (value.is_standard()) value.unset();
    });
}

EditRequest validated(EditRequest request) {
    check_fields(request);
    if (words_of(request.prompt).empty())
        throw Error(ErrorCode::InvalidArgument, "the edit has no prompt",
                    "describe the scene after the edit in one sentence");
    if (request.mode != "auto" && !mode_named(request.mode))
        throw Error(ErrorCode::InvalidArgument, "\"" + request.mode + "\" is not an edit mode",
                    "use auto, modify, replace or add");
    if (std::find(Qualities.begin(), Qualities.end(), request.quality) == Qualities.end())
        throw Error(ErrorCode::InvalidArgument, "\"" + request.quality + "\" is not a quality",
                    "use draft, normal or fine");
    require_method(request.method);
    views_left_out(request.left_out);
    if (!request.source.empty()) request.source = phrase_of(request.source, "source");
    if (request.target.empty()) {
        if (request.source.empty())
            throw Error(ErrorCode::InvalidArgument, "neither a source nor a target word is given",
                        "name what the edit is about, or the word of the sentence that is new");
        request.target = guessed_target(request.prompt, request.source);
    }
    request.target = phrase_of(request.target, "target");
    if (!has_word(request.prompt, request.target))
        throw Error(ErrorCode::InvalidArgument,
                    "the prompt \"" + request.prompt + "\" does not contain the target word \"" +
                        request.target + "\"",
                    "use it in the sentence, or choose another target");
    if (request.source.empty()) request.source = request.target;
    return request;
}

std::string new_thing(const EditRequest& request, EditMode mode) {
    const auto thing = mode == EditMode::Replace ? thing_in_place(request) : std::string();
    return thing.empty() ? request.target : thing;
}

int RoundPlan::steps_of(int round) const {
    return std::max(1, static_cast<int>(std::ceil(view_steps * strength_of(round) / strength - 1e-9)));
}

double RoundPlan::guided_steps_of(int round) const {
    constexpr double unguided = 0.5;  // of the two passes of a guided step
    const int steps = steps_of(round);
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        sum += strength_of(round) * (steps - i) / steps > guided_until ? 1 : unguided;
    return sum;
}

int RoundPlan::view_steps_within(int steps) const {
    int sum = 0;
    for (int round = 0; round * fit_steps < steps; ++round) sum += steps_of(round);
    return sum;
}

namespace {

/// Of the views and of their steps.
struct QualityShare {
    double views = 1, steps = 1;
};

QualityShare share_of(const std::string& quality) {
    if (quality == Qualities.front()) return {0.5, 0.75};
    if (quality == Qualities.back()) return {2, 1.5};
    return {};
}

}  // namespace

RoundPlan round_plan(const LoopSettings& settings, EditMode mode) {
    RoundPlan plan{mode == EditMode::Add ? settings.add_rounds : settings.shape_rounds,
                   settings.shape_fit_steps,
                   true,
                   settings.shape_steps,
                   settings.shape_strength,
                   settings.shape_again_strength,
                   settings.shape_views,
                   settings.shape_guided_until};
    if (mode == EditMode::Modify)
        plan = {settings.rounds,      settings.fit_steps,     false,
                settings.view_steps,  settings.view_strength, settings.view_strength,
                settings.edited_views};
    const auto share = share_of(settings.quality);
    const auto scaled = [](int count, double by) {
        return std::max(1, static_cast<int>(std::lround(count * by)));
    };
    plan.views = scaled(plan.views, share.views);
    plan.view_steps = scaled(plan.view_steps, share.steps);
    return plan;
}

double mask_growth(const LoopSettings& settings, EditMode mode, const Mask& mask) {
    const double px = settings.dilate_px * mask.width / ReferenceSide;
    if (mode != EditMode::Add) return px;
    const auto box = localize::bounds_of(mask);
    return std::max(2 * px, settings.add_margin * std::max(box.width, box.height));
}

}  // namespace gse::edit
