// Loads the networks' library on first use.
#pragma once

#include "engine/neural/api.h"

namespace gse::pipeline {

/// The networks; loads libgse_neural.so on the first call. Throws Error when it is missing.
neural::Api& neural_api();

}  // namespace gse::pipeline
