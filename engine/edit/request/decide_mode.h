// Which kind of edit a sentence asks for.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "engine/edit/request/checked_request.h"

namespace gse::edit {

/// Decides "auto" from the sentence and, when there is a text segmenter, from whether it finds the target
/// word. Returns the mode and the reason.
std::pair<EditMode, std::string> decide_mode(const CheckedRequest& request,
                                             std::optional<double> target_found_share);

/// Tells whether the place of an addition can be seen by drawing it: no word names it ("beside the bear"
/// does).
bool draws_place(const SearchSettings& settings, const language::EditSentence& sentence, EditMode mode);
bool draws_place(const CheckedRequest& request, EditMode mode);

}  // namespace gse::edit
