// Paths in JSON. File names that are not UTF-8 come back as they were; other text gets replacement
// characters.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/json.h"

namespace gse {

bool is_utf8(std::string_view text);

/// The text itself when it is UTF-8 and does not begin with "file:". Otherwise "file:" and its bytes
/// percent-encoded.
std::string text_of_path(const std::string& path);

/// Inverse of text_of_path(). Also takes "file:///..." as other programs write it.
std::string path_of_text(const std::string& text);

}  // namespace gse
