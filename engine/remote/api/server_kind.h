// Names of the protocols of image servers.
#pragma once

#include <string_view>

#include "engine/remote/api/image_server.h"

namespace gse::remote {

/// Name on the command line and in recipes: "webui", "openai", "sdcpp" or "comfy".
std::string_view server_kind_name(ServerKind kind);

/// Throws Error (InvalidArgument) for another name.
ServerKind server_kind_of(std::string_view name);

}  // namespace gse::remote
