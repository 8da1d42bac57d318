// Text of a sentence without what says nothing: weights, tags, flags, quotation marks, invisible characters.
#pragma once

#include <string>
#include <string_view>

namespace gse::language::plan {

struct CleanText {
    std::string text;          // lower case, composed letters with their accents
    std::string_view refused;  // reason (plan.h) for a text that is no sentence; else empty
    bool has_letters = false;  // of any script
};

CleanText clean_text(std::string_view text);

/// The text with letters without accents ("blue" of "bĺue").
std::string without_accents(std::string_view text);

}  // namespace gse::language::plan
