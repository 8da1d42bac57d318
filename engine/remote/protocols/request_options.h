// Options of an artist in the requests of a protocol: which fields are known, and which the program sets.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/remote/api/server_option.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/protocols/openai_request.h"
#include "engine/remote/protocols/webui_request.h"

namespace gse::remote {

/// Throws Error (InvalidArgument) for the first option that a WebUI does not know, unless it is forced.
/// Others that are refused are set by the program, or would change the server's model or settings for others.
void check_webui_options(const std::vector<ServerOption>& options, WebuiProduct product,
                         const ServerUrl& url);
/// As check_webui_options(), for sd-server's jobs. Inner fields have dots: "sample_params.flow_shift".
void check_sdcpp_options(const std::vector<ServerOption>& options, const ServerUrl& url);
/// Throws Error (InvalidArgument) for an option of that name whose value is not among those that the server
/// offers: sd-server passes over it without a word. A forced option, and a server that offers none, may be
/// right.
void check_offered_value(const std::vector<ServerOption>& options, std::string_view name,
                         const std::vector<std::string>& offered, const ServerUrl& url);
/// As check_webui_options(), for forms of the OpenAI protocol. sd-server takes there what its jobs take.
void check_openai_options(const std::vector<ServerOption>& options, OpenAiProduct product,
                          const ServerUrl& url);

/// Sets the fields of checked options in a body. Dots lead into inner objects.
void add_options(nlohmann::json& body, const std::vector<ServerOption>& options);

}  // namespace gse::remote
