// Which settings count with which method: what a panel says of controls that have no effect.
#pragma once

#include <string_view>

namespace gse::edit {

/// Whether a setting of the request or of the guidance (by its name) changes anything in an edit that is led
/// by redrawn views, or by a gradient at every step (sds).
bool has_effect(std::string_view field, bool by_views);

/// Why it does not, in a sentence; empty = it does.
std::string_view why_unused(std::string_view field, bool by_views);

}  // namespace gse::edit
