// Sentences that a server is told.
#pragma once

#include <string>

#include "engine/remote/views/family.h"

namespace gse::remote {

/// An edit in words.
struct EditText {
    std::string description;  // of the scene after the edit: "a golden bear"
    std::string instruction;  // "make the bear golden"
    std::string negative;     // may be empty
};

/// Sentence for one view. `view_words` ("back view") are told with descriptions alone: what edits a picture
/// sees it. `again`: a later round, which begins from the fitted scene.
std::string prompt_for_view(const ModelFamily& family, const EditText& text, const std::string& view_words,
                            bool again);

/// Sentence for a sheet of views.
std::string prompt_for_sheet(const ModelFamily& family, const EditText& text);

/// Sentence for a view that is redrawn like the one shown beside it.
std::string prompt_with_reference(const ModelFamily& family, const EditText& text,
                                  const std::string& view_words);

}  // namespace gse::remote
