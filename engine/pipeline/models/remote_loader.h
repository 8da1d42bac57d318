// Loads the library that speaks to image servers on first use.
#pragma once

#include <filesystem>

#include "engine/remote/api/remote_api.h"

namespace gse::pipeline {

/// Image servers; loads libgse_remote.so on the first call. Throws Error when it is missing.
remote::RemoteApi& remote_api();

/// The library, wherever it is; empty where this build has none.
std::filesystem::path remote_library();

}  // namespace gse::pipeline
