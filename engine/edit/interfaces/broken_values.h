// Values of redrawn pictures that are not finite: damaged weights and overflows leave such.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// Puts what `views` show now where the redrawn pictures, of the same number and sizes, hold a NaN or an
/// infinity. Returns how many values that were. Throws Error (Model) where it is more than half of a picture:
/// nothing was drawn there.
std::size_t mend_broken(const std::vector<EditView>& views, std::vector<Image>& pictures);

}  // namespace gse::edit
