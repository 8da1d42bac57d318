// Text from files made fit to be shown. A terminal obeys control characters, so none is printed as it is.
#pragma once

#include <string>
#include <string_view>

namespace gse {

/// `text` with escapes (\x1b, \u202e) for control characters, bytes that are not UTF-8, and marks that turn
/// the writing direction. Line ends and tabs stay with `lines`.
std::string printable(std::string_view text, bool lines = false);

}  // namespace gse
