// Settings and recent files as small JSON files.
#include "engine/io/files/user_files.h"

#include <algorithm>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"

namespace gse {
namespace {

using Json = nlohmann::json;

std::filesystem::path from_environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? std::filesystem::path(value) : std::filesystem::path();
}

/// `own` as it is, else `xdg`/gseditpro, else ~/`fallback`/gseditpro. XDG asks for absolute paths.
std::filesystem::path user_folder(const char* own, const char* xdg, const char* fallback) {
    if (const auto folder = from_environment(own); !folder.empty()) return folder;
    if (const auto folder = from_environment(xdg); folder.is_absolute()) return folder / "gseditpro";
    const auto home = from_environment("HOME");
    std::error_code failure;
    return (home.empty() ? std::filesystem::temp_directory_path(failure) : home / fallback) / "gseditpro";
}

void set_aside(const std::filesystem::path& path) {
    std::filesystem::path aside = path;
    aside += ".damaged";
    std::error_code failure;
    std::filesystem::rename(path, aside, failure);
    log::warning("{} is damaged and was set aside as {}; the defaults are used", path.string(),
                 aside.filename().string());
}

void merge(Json& into, const Json& values) {
    for (const auto& [key, value] : values.items()) {
        Json& place = into[key];
        if (place.is_object() && value.is_object()) merge(place, value);
        else place = value;
    }
}

bool write_json(const std::filesystem::path& path, const Json& json) {
    try {
        write_file(path, json_text(json, 2) + "\n");
        return true;
    } catch (const Error& error) {
        log::warning("{}", error.what());
        return false;
    }
}

std::filesystem::path recent_path() { return config_folder() / "recent.json"; }

/// Every path in recent.json, whether or not its file exists.
std::vector<std::string> recent_names() {
    std::vector<std::string> names;
    const Json json = load_user_json(recent_path());
    const auto files = json.find("files");
    if (files == json.end() || !files->is_array()) return names;
    for (const Json& file : *files)
        if (file.is_string()) names.push_back(path_of_text(file.get<std::string>()));
    return names;
}

void save_recent(std::vector<std::string> names) {
    for (std::string& name : names) name = text_of_path(name);
    save_user_json(recent_path(), {{"files", names}});
}

std::string recent_name(const std::filesystem::path& path) {
    std::error_code failure;
    return std::filesystem::absolute(path, failure).lexically_normal().string();
}

}  // namespace

std::filesystem::path config_folder() { return user_folder("GSE_CONFIG_DIR", "XDG_CONFIG_HOME", ".config"); }
std::filesystem::path state_folder() {
    return user_folder("GSE_STATE_DIR", "XDG_STATE_HOME", ".local/state");
}
std::filesystem::path cache_folder() { return user_folder("GSE_CACHE_DIR", "XDG_CACHE_HOME", ".cache"); }

Json load_user_json(const std::filesystem::path& path) {
    std::string text;
    try {
        text = read_file(path);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::NotFound) log::warning("{}", error.what());
        return Json::object();
    }
    Json json = try_parse_json(text);
    if (json.is_object()) return json;
    set_aside(path);
    return Json::object();
}

bool save_user_json(const std::filesystem::path& path, const Json& values) {
    Json json = load_user_json(path);
    merge(json, values);
    return write_json(path, json);
}

Json load_settings() { return load_user_json(config_folder() / "settings.json"); }
bool save_settings(const Json& values) { return save_user_json(config_folder() / "settings.json", values); }

std::vector<std::filesystem::path> load_recent() {
    std::vector<std::filesystem::path> paths;
    for (const std::string& name : recent_names()) {
        std::error_code failure;
        if (std::filesystem::exists(name, failure)) paths.emplace_back(name);
    }
    return paths;
}

void add_recent(const std::filesystem::path& path, std::size_t most) {
    std::vector<std::string> names = recent_names();
    const std::string name = recent_name(path);
    std::erase(names, name);
    names.insert(names.begin(), name);
    if (names.size() > most) names.resize(most);
    save_recent(names);
}

void forget_recent(const std::filesystem::path& path) {
    std::vector<std::string> names = recent_names();
    std::erase(names, recent_name(path));
    save_recent(names);
}

}  // namespace gse
