// Loads the networks' library on first use.
#pragma once

#include <filesystem>

#include "engine/neural/api/api.h"

namespace gse::pipeline {

/// The networks; loads libgse_neural.so on the first call. Throws Error when it is missing.
neural::Api& neural_api();

/// The networks' library, wherever it is; empty where this build has none.
std::filesystem::path neural_library();

/// Threads inside one network operation, 0 = one per core; loads nothing: networks that are not there yet
/// take it over.
void set_network_threads(int count);
int network_threads();

/// Counts what the calling thread has asked of the networks. Loads nothing: zero while they are not loaded.
neural::NetworkUse network_use();
/// The calling thread was given an answer from the disk that networks would have given.
void count_cached_answer();

}  // namespace gse::pipeline
