// Text from files made fit to be shown: a terminal obeys control characters, so none of them is printed as it
// is.
#pragma once

#include <string>
#include <string_view>

namespace gse {

/// `text` with control characters, bytes that are not UTF-8 and marks that turn the writing direction as
/// escapes (\x1b, \u202e). Line ends and tabs stay where `lines` says so.
std::string printable(std::string_view text, bool lines = false);

}  // namespace gse
