// Words in the name of a file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gse::language::plan {

/// Words of a file's name in lower case. They end at separators, digits and capitals: "my", "guitar", "v" of
/// "my-guitar_v2", "lego", "house" of "LEGOHouse".
std::vector<std::string> words_of_file_name(std::string_view name);

/// Word for the thing that a name like that of a file stands for: "guitar" for "object_guitar" and
/// "Guitar 01". It is the last word that names a thing, else the last one. What says only that a file holds a
/// scan ("splat", "final") is passed over. Empty for a name in plain words, which a sentence says itself.
std::string thing_of_file_name(std::string_view name);

}  // namespace gse::language::plan
