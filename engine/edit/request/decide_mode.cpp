// Change what is there, put something else in its place, or add something: read off the sentence.
#include "engine/edit/request/decide_mode.h"

#include <algorithm>
#include <array>

#include "engine/language/grammar.h"

namespace gse::edit {
namespace {

constexpr std::array<std::pair<const char*, EditMode>, 5> Modes{{{"modify", EditMode::Modify},
                                                                 {"add", EditMode::Add},
                                                                 {"replace", EditMode::Replace},
                                                                 {"remove", EditMode::Remove},
                                                                 {"transform", EditMode::Transform}}};

}  // namespace

const char* mode_name(EditMode mode) {
    return std::find_if(Modes.begin(), Modes.end(), [&](const auto& entry) { return entry.second == mode; })
        ->first;
}

std::optional<EditMode> mode_named(const std::string& name) {
    for (const auto& [known, mode] : Modes)
        if (name == known) return mode;
    return std::nullopt;
}

std::pair<EditMode, std::string> decide_mode(const CheckedRequest& request,
                                             std::optional<double> target_found_share) {
    return language::decide_mode(request.sentence(), request.mode, target_found_share);
}

bool draws_place(const SearchSettings& settings, const language::EditSentence& sentence, EditMode mode) {
    return mode == EditMode::Add && settings.place_views > 0 && sentence.source() != sentence.target() &&
           language::place_name(sentence.relation()).empty();
}

bool draws_place(const CheckedRequest& request, EditMode mode) {
    return draws_place(request, request.sentence(), mode);
}

}  // namespace gse::edit
