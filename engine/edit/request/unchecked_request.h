// Meaning of a request that is not checked: it is still being typed, or another version has written it. For
// hints and estimates; stages of a run take a CheckedRequest.
#pragma once

#include <string>

#include "engine/edit/request/request.h"
#include "engine/language/sentence.h"

namespace gse::edit {

/// The words as they stand; any of them may be missing, and the target may not be in the prompt.
language::EditSentence unchecked_sentence(const EditRequest& request);

/// Mode as the words say so far.
EditMode planned_mode(const EditRequest& request);

/// Optimisation steps as the words and the mode say so far.
int planned_steps(const EditRequest& request);

/// The order that instruction_of() a CheckedRequest makes of these words.
std::string instruction_of(const EditRequest& request);

}  // namespace gse::edit
