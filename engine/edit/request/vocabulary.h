// Models that know a fixed list of words: what they cannot be asked for is refused before anything runs.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/request/checked_request.h"

namespace gse::edit {

/// Checks the words of a request. Throws Error (InvalidArgument) with the nearest known words when
/// the source is not in `known`. The target must be there or in `drawn`, whose words can be made and not
/// found. With a label made by hand the source may be anything, since nothing is looked for. Neither is what
/// one of the scene's `labels` is named for.
void require_known_words(const CheckedRequest& request, const std::vector<std::string>& known,
                         const std::vector<std::string>& drawn, bool labelled_by_hand,
                         const std::vector<std::string>& labels = {});

/// Part of require_known_words() that is about what is looked for. It is all there is to check where the
/// views are drawn by a model of an open vocabulary.
void require_findable_words(const CheckedRequest& request, const std::vector<std::string>& known,
                            const std::vector<std::string>& drawn, bool labelled_by_hand,
                            const std::vector<std::string>& labels = {});

}  // namespace gse::edit
