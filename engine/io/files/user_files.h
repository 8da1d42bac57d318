// Files of the user: settings and recent files in the configuration folder, and the folder of the state.
// Losing or breaking one is never fatal.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gse {

/// $GSE_CONFIG_DIR, else $XDG_CONFIG_HOME/gseditpro, else ~/.config/gseditpro.
std::filesystem::path config_folder();
/// $GSE_STATE_DIR, else $XDG_STATE_HOME/gseditpro, else ~/.local/state/gseditpro.
std::filesystem::path state_folder();
/// $GSE_CACHE_DIR, else $XDG_CACHE_HOME/gseditpro, else ~/.cache/gseditpro.
std::filesystem::path cache_folder();

/// Object in `path`, or an empty one when the file is missing. A file that is no JSON object is renamed to
/// NAME.damaged, with a warning.
nlohmann::json load_user_json(const std::filesystem::path& path);
/// Merges `values` into the file, atomically. Keys that `values` does not name stay; objects are merged. A
/// folder that cannot be written is a warning; returns false then.
bool save_user_json(const std::filesystem::path& path, const nlohmann::json& values);

/// settings.json of the configuration folder.
nlohmann::json load_settings();
bool save_settings(const nlohmann::json& values);

/// Absolute paths of recent.json in the configuration folder, newest first. Missing files are not listed but
/// kept: the disk may come back.
std::vector<std::filesystem::path> load_recent();
/// Puts `path` first and keeps the newest `most`.
void add_recent(const std::filesystem::path& path, std::size_t most = 20);
void forget_recent(const std::filesystem::path& path);

}  // namespace gse
