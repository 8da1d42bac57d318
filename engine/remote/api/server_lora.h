// LoRA that a server has, as an artist names it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gse::remote {

struct ServerLora {
    std::string name;  // at the server: with or without a folder and ".safetensors"
    double weight = 1;
};

/// LoRA of a text "NAME" or "NAME:WEIGHT". Throws Error (InvalidArgument) for no name, for characters that
/// prompts give a meaning ("<", ">"), and for a weight outside of -10 to 10.
ServerLora parse_server_lora(std::string_view text);
std::vector<ServerLora> parse_server_loras(const std::vector<std::string>& texts);

}  // namespace gse::remote
