// LoRA that a server has, as an artist names it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gse::remote {

/// LoRAs that a server draws with.
enum class LoraNames {
    None,    // it takes none
    Listed,  // those that it lists
    Any,     // any name or path: it has no list, and refuses what it lacks itself
};

struct ServerLora {
    std::string name;  // at the server: with or without a folder and ".safetensors"
    double weight = 1;
};

/// Name of these names: "none", "listed" or "any".
std::string_view lora_names_name(LoraNames names);

/// LoRA of a text "NAME" or "NAME:WEIGHT". Throws Error (InvalidArgument) for no name, for characters that
/// prompts give a meaning ("<", ">"), and for a weight outside of -10 to 10.
ServerLora parse_server_lora(std::string_view text);
std::vector<ServerLora> parse_server_loras(const std::vector<std::string>& texts);

}  // namespace gse::remote
