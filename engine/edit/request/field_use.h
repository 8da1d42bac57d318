// Which kind of guidance a setting belongs to, as a tag in the lists of fields.
#pragma once

#include "engine/base/fields.h"

namespace gse::edit {

/// Bits of FieldHelp::uses. A method says which of them it goes by; settings without a bit always count.
enum FieldUse : unsigned {
    GradientField = 1,     // of a gradient at every step, its masks and the pseudo ground truth
    RedrawnViewField = 2,  // of redrawn views and the fits to them
};

/// Tag a setting that counts with a gradient at every step only, or with redrawn views only.
constexpr FieldHelp of_gradient(const char* help) { return {help, GradientField}; }
constexpr FieldHelp of_views(const char* help) { return {help, RedrawnViewField}; }

}  // namespace gse::edit
