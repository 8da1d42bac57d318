// Installations at their usual places, and the lists of folders that ComfyUI reads besides.
#include "engine/pipeline/models/model_places.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace gse::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t LongestYaml = std::size_t{1} << 20;  // bytes
constexpr std::size_t MostExtraFolders = 200;

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

fs::path home() { return environment("HOME"); }

/// Folders of the user's own list.
std::vector<ModelPlace> own_places() {
    std::vector<ModelPlace> places;
    std::istringstream list(environment("GSE_MODELS"));
    for (std::string folder; std::getline(list, folder, ':');)
        if (!folder.empty()) places.push_back({folder, "GSE_MODELS"});
    return places;
}

std::string without_comment(const std::string& line) {
    for (std::size_t at = line.find('#'); at != std::string::npos; at = line.find('#', at + 1))
        if (at == 0 || line[at - 1] == ' ' || line[at - 1] == '\t') return line.substr(0, at);
    return line;
}

std::string trimmed(const std::string& text) {
    const auto begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
    if (begin == std::string::npos) return {};
    auto inner = text.substr(begin, end - begin + 1);
    const bool quoted =
        inner.size() > 1 && (inner.front() == '"' || inner.front() == '\'') && inner.back() == inner.front();
    return quoted ? inner.substr(1, inner.size() - 2) : inner;
}

fs::path expanded(const std::string& text) {
    return text.starts_with("~/") ? home() / text.substr(2) : fs::path(text);
}

/// One section of the file.
struct PathSection {
    std::string base;
    std::vector<std::string> folders;
};

std::vector<PathSection> sections_of(const std::string& yaml) {
    std::vector<PathSection> sections;
    std::istringstream lines(yaml);
    std::size_t list_indent = 0;  // of the key whose values stand on lines of their own; 0 = none
    for (std::string line; std::getline(lines, line);) {
        line = without_comment(line);
        const auto indent = line.find_first_not_of(' ');
        const auto text = trimmed(line);
        if (text.empty()) continue;
        if (indent == 0) {
            sections.emplace_back();
            list_indent = 0;
            continue;
        }
        if (sections.empty()) continue;
        if (list_indent > 0 && indent > list_indent) {
            sections.back().folders.push_back(text);
            continue;
        }
        list_indent = 0;
        const auto colon = text.find(':');
        if (colon == std::string::npos) continue;
        const auto key = trimmed(text.substr(0, colon)), value = trimmed(text.substr(colon + 1));
        if (key == "base_path") sections.back().base = value;
        else if (value.starts_with('|') || value.starts_with('>')) list_indent = indent;
        else if (!value.empty() && key != "is_default" && key != "custom_nodes" && key != "configs")
            sections.back().folders.push_back(value);
    }
    return sections;
}

void add_installation(const fs::path& root, const std::string& program, std::vector<ModelPlace>& places) {
    for (const char* folder : {"models", "embeddings"}) places.push_back({root / folder, program});
}

void add_comfy(const fs::path& root, const std::string& program, std::vector<ModelPlace>& places) {
    places.push_back({root / "models", program});
    const auto list = root / "extra_model_paths.yaml";
    std::error_code ignored;
    if (!fs::is_regular_file(list, ignored)) return;
    try {
        for (const auto& folder : extra_model_folders(read_start(list, LongestYaml), root))
            places.push_back({folder, program});
    } catch (const Error&) {}  // a list that cannot be read names nothing
}

/// Every folder once, the first time that it is named.
std::vector<ModelPlace> each_once(std::vector<ModelPlace> places) {
    std::vector<ModelPlace> kept;
    for (auto& place : places) {
        place.folder = place.folder.lexically_normal();
        if (std::none_of(kept.begin(), kept.end(),
                         [&](const ModelPlace& other) { return other.folder == place.folder; }))
            kept.push_back(std::move(place));
    }
    return kept;
}

}  // namespace

std::vector<fs::path> extra_model_folders(const std::string& yaml, const fs::path& folder) {
    std::vector<fs::path> folders;
    for (const auto& section : sections_of(yaml)) {
        const auto base = section.base.empty() ? folder : folder / expanded(section.base);
        for (const auto& text : section.folders)
            if (folders.size() < MostExtraFolders)
                folders.push_back((base / expanded(text)).lexically_normal());
    }
    return folders;
}

std::vector<ModelPlace> model_places() {
    auto places = own_places();
    const auto user = home();
    const auto data_home = environment("XDG_DATA_HOME");
    const auto data = data_home.empty() ? user / ".local/share" : fs::path(data_home);
    if (user.empty() && data_home.empty()) return places;
    places.push_back({data / "gseditpro/models", "GSEditPro"});
    if (const auto root = environment("COMFYUI_PATH"); !root.empty()) add_comfy(root, "ComfyUI", places);
    for (const char* root : {"ComfyUI", "comfy/ComfyUI", "Documents/ComfyUI"})
        add_comfy(user / root, "ComfyUI", places);
    for (const auto& root : {data / "krita/ai_diffusion/server", data / "krita-ai-diffusion/server",
                             user / ".var/app/org.kde.krita/data/krita/ai_diffusion/server"}) {
        places.push_back({root / "models", "krita-ai-diffusion"});
        add_comfy(root / "ComfyUI", "krita-ai-diffusion", places);
    }
    for (const auto& [root, program] :
         {std::pair{"stable-diffusion-webui", "A1111"}, std::pair{"stable-diffusion-webui-forge", "Forge"},
          std::pair{"stable-diffusion-webui-reForge", "Forge"}, std::pair{"sdnext", "SD.Next"},
          std::pair{"automatic", "SD.Next"}})
        add_installation(user / root, program, places);
    if (const auto root = environment("SD_DATADIR"); !root.empty()) add_installation(root, "SD.Next", places);
    if (const auto folder = environment("SD_MODELSDIR"); !folder.empty())
        places.push_back({folder, "SD.Next"});
    return each_once(std::move(places));
}

std::vector<ModelPlace> places_below(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::is_directory(folder / "models", ignored)) return {{folder, ""}};
    std::vector<ModelPlace> places;
    add_comfy(folder, "", places);
    if (fs::is_directory(folder / "embeddings", ignored)) places.push_back({folder / "embeddings", ""});
    return each_once(std::move(places));
}

}  // namespace gse::pipeline
