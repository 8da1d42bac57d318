// Change what is there, or add something: read off the sentence.
#include <algorithm>

#include "engine/edit/locate.h"
#include "engine/edit/relation.h"

namespace gse::edit {
namespace {

/// Position of the word in the sentence, -1 = absent.
int word_position(const std::vector<std::string>& words, const std::string& word) {
    const auto found = std::find(words.begin(), words.end(), word);
    return found == words.end() ? -1 : static_cast<int>(found - words.begin());
}

bool any_of_between(const std::vector<std::string>& words, int begin, int end,
                    const std::vector<std::string>& wanted) {
    for (int i = begin + 1; i < end; ++i)
        if (std::find(wanted.begin(), wanted.end(), words[static_cast<std::size_t>(i)]) != wanted.end())
            return true;
    return false;
}

}  // namespace

std::pair<EditMode, std::string> decide_mode(const EditRequest& request,
                                             std::optional<double> target_found_share) {
    constexpr double present_share = 0.3;  // A7
    if (request.mode == "add") return {EditMode::Add, "as asked"};
    if (request.mode == "modify") return {EditMode::Modify, "as asked"};
    if (target_found_share && *target_found_share >= present_share)
        return {EditMode::Modify, "the scene shows \"" + request.target + "\" already"};
    const auto words = terms_of(request.prompt, {request.source, request.target});
    const int source = word_position(words, request.source), target = word_position(words, request.target);
    if (source < 0) return {EditMode::Modify, "the sentence replaces \"" + request.source + "\""};
    if (source == target) return {EditMode::Modify, "source and target are the same word"};
    static const std::vector<std::string> joining{"wearing",  "with", "and",   "holding", "has",
                                                  "having",   "on",   "under", "beside",  "near",
                                                  "carrying", "plus", "to",    "behind"};
    static const std::vector<std::string> turning{"made", "of", "into", "as"};
    const int first = std::min(source, target), last = std::max(source, target);
    bool worn = false;
    for (int i = first + 1; i < last; ++i) worn = worn || says_worn(words, static_cast<std::size_t>(i));
    const bool related = relation_of(request.prompt, request.source, request.target) != Relation::None;
    const bool joined =
        related ||
        ((worn || any_of_between(words, first, last, joining)) && !any_of_between(words, first, last, turning));
    if (joined)
        return {EditMode::Add,
                "the sentence puts \"" + request.target + "\" beside \"" + request.source + "\""};
    return {EditMode::Modify, "\"" + request.target + "\" describes \"" + request.source + "\""};
}

bool planned_by_views(const EditRequest& request) { return edits_by_views(request, decide_mode(request, std::nullopt).first); }

int planned_steps(const EditRequest& request) { return loop_steps(request, planned_by_views(request)); }

}  // namespace gse::edit
