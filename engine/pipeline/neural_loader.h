// Loads the networks' library on first use.
#pragma once

#include "engine/neural/api.h"

namespace gse::pipeline {

/// The networks; loads libgse_neural.so on the first call. Throws Error when it is missing.
neural::Api& neural_api();

/// What the calling thread has asked of the networks; nothing while they are not loaded, which this does not change.
neural::NetworkUse network_use();

}  // namespace gse::pipeline
