// Models that know a fixed list of words: what they cannot be asked for is refused before anything runs.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/request/request.h"

namespace gse::edit {

/// Throws Error (InvalidArgument) with the nearest known words when the source of a validated request is not
/// in `known`, or its target neither there nor in `drawn`, which can be made and not found. With a label made
/// by hand the source may be anything: nothing is looked for.
void require_known_words(const EditRequest& request, const std::vector<std::string>& known,
                         const std::vector<std::string>& drawn, bool labelled_by_hand);

}  // namespace gse::edit
