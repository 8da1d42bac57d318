// Lists of LoRAs, and the two ways in which servers are told of them.
#include "engine/remote/protocols/server_loras.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/remote/protocols/server_error.h"
#include "engine/remote/protocols/server_link.h"

namespace gse::remote {
namespace {

/// Name of a file without folders and ".safetensors".
std::string bare_name(std::string_view path) {
    const auto slash = path.find_last_of("/\\");
    if (slash != std::string_view::npos) path.remove_prefix(slash + 1);
    constexpr std::string_view Ending = ".safetensors";
    if (path.ends_with(Ending)) path.remove_suffix(Ending.size());
    return std::string(path);
}

/// LoRAs of a server that lists none. A name with a slash is a path at the server.
std::vector<ChosenLora> unlisted_loras(const std::vector<ServerLora>& wanted) {
    std::vector<ChosenLora> chosen;
    for (const auto& [name, weight] : wanted) {
        const bool path = name.find_first_of("/\\") != std::string::npos;
        chosen.push_back({path ? bare_name(name) : name, path ? name : std::string(), weight});
    }
    return chosen;
}

}  // namespace

std::vector<OfferedLora> offered_loras(const nlohmann::json& list) {
    std::vector<OfferedLora> loras;
    if (!list.is_array()) return loras;
    for (const auto& item : list)
        if (auto name = text_of(item, "name"); !name.empty())
            loras.push_back({std::move(name), text_of(item, "path")});
    return loras;
}

std::vector<std::string> names_of(const std::vector<OfferedLora>& loras) {
    std::vector<std::string> names;
    for (const auto& lora : loras) names.push_back(lora.name);
    return names;
}

std::vector<ChosenLora> chosen_loras(const std::vector<ServerLora>& wanted,
                                     const std::vector<OfferedLora>& offered, const ServerUrl& url) {
    std::vector<ChosenLora> chosen;
    for (const auto& [name, weight] : wanted) {
        auto found = std::find_if(offered.begin(), offered.end(), [&name = name](const auto& lora) {
            return lora.name == name || lora.path == name;
        });
        if (found == offered.end())
            found = std::find_if(offered.begin(), offered.end(), [&name = name](const auto& lora) {
                return bare_name(lora.name) == bare_name(name) || bare_name(lora.path) == bare_name(name);
            });
        if (found == offered.end())
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("{} has no LoRA \"{}\"", url.nickname(), shown(name)),
                        offered.empty() ? "it tells of none" : "it has: " + listed(names_of(offered)));
        chosen.push_back({found->name, found->path, weight});
    }
    return chosen;
}

std::vector<ChosenLora> named_loras(const std::vector<ServerLora>& wanted,
                                    const std::vector<OfferedLora>& offered, LoraNames names,
                                    const ServerUrl& url) {
    return names == LoraNames::Any ? unlisted_loras(wanted) : chosen_loras(wanted, offered, url);
}

std::string prompt_with_loras(const std::string& prompt, const std::vector<ChosenLora>& loras) {
    auto with = prompt;
    for (const auto& lora : loras) with += fmt::format(" <lora:{}:{}>", lora.name, lora.weight);
    return with;
}

nlohmann::json lora_list(const std::vector<ChosenLora>& loras) {
    auto list = nlohmann::json::array();
    for (const auto& lora : loras)
        list.push_back({{"path", lora.path.empty() ? lora.name : lora.path}, {"multiplier", lora.weight}});
    return list;
}

nlohmann::json vllm_loras(const std::vector<ChosenLora>& loras) {
    auto list = nlohmann::json::array();
    for (const auto& lora : loras) {
        list.push_back({{"name", lora.name}, {"scale", lora.weight}});
        if (!lora.path.empty()) list.back()["local_path"] = lora.path;
    }
    return list.size() == 1 ? list.front() : list;
}

}  // namespace gse::remote
