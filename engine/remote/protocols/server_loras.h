// LoRAs of an artist among those that a server has.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/remote/api/server_lora.h"
#include "engine/remote/api/server_url.h"

namespace gse::remote {

/// A LoRA that a server has.
struct OfferedLora {
    std::string name, path;  // the path as the server tells it; empty = not told
};

/// A LoRA to draw with.
struct ChosenLora {
    std::string name, path;  // as the server has them
    double weight = 1;
};

/// LoRAs of a server's list of objects with "name" and "path".
std::vector<OfferedLora> offered_loras(const nlohmann::json& list);
std::vector<std::string> names_of(const std::vector<OfferedLora>& loras);

/// The LoRAs that are wanted, as the server names them: by name or file, with or without ".safetensors".
/// Throws Error (InvalidArgument) for the first that it does not have; the hint lists those it has.
std::vector<ChosenLora> chosen_loras(const std::vector<ServerLora>& wanted,
                                     const std::vector<OfferedLora>& offered, const ServerUrl& url);

/// The LoRAs that are wanted, of a server that takes those names. Throws Error as chosen_loras().
std::vector<ChosenLora> named_loras(const std::vector<ServerLora>& wanted,
                                    const std::vector<OfferedLora>& offered, LoraNames names,
                                    const ServerUrl& url);

/// The prompt with "<lora:name:weight>" for each.
std::string prompt_with_loras(const std::string& prompt, const std::vector<ChosenLora>& loras);
/// sd-server's list: [{"path", "multiplier"}].
nlohmann::json lora_list(const std::vector<ChosenLora>& loras);
/// vLLM-Omni's object {"name", "scale"}, with "local_path" for a path; a list of them for several.
nlohmann::json vllm_loras(const std::vector<ChosenLora>& loras);

}  // namespace gse::remote
