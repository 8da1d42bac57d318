// Text of lexicon.txt and words.txt, compiled in.
#pragma once

#include <string_view>

namespace gse::language::plan {

std::string_view lexicon_text();
std::string_view words_text();

}  // namespace gse::language::plan
