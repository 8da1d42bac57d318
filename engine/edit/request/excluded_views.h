// Views of a search that an artist has seen to be wrong: a list of their numbers, as text of a request.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gse::edit {

/// The numbers of a list as "3, 17", ascending, each once; views are numbered from 0, as evidence files are.
/// Throws Error (InvalidArgument) for text that is no such list.
std::vector<std::size_t> excluded_views_of(const std::string& text);

/// The list with a view in it (`out`) or not.
std::string with_view(const std::string& text, std::size_t view, bool out);

}  // namespace gse::edit
