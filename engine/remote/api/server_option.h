// Settings of a server's own, as an artist writes them: "scheduler=karras".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace gse::remote {

/// Field of a server's requests that the program does not set itself.
struct ServerOption {
    std::string name;  // of a field ("eta", "sample_params.flow_shift"), or of ComfyUI's ("KSampler.cfg")
    std::string value;
    bool forced = false;  // sent also where the program does not know the name
};

/// Option of a text "NAME=VALUE", or "force:NAME=VALUE" for a name that the program does not know. Throws
/// Error (InvalidArgument) for another form, for more than 4 KiB, and for names of secrets, which belong into
/// no option.
ServerOption parse_server_option(std::string_view text);

/// Options of these texts. Throws Error as parse_server_option(), for a name that is given twice, and for one
/// inside of another ("a" and "a.b").
std::vector<ServerOption> parse_server_options(const std::vector<std::string>& texts);

/// The value as JSON where it reads as JSON ("3", "true", "[1, 2]"), else as a text.
nlohmann::json json_value(const ServerOption& option);

}  // namespace gse::remote
