// What a scene file holds and what may be wrong with it, or how a picture was made, as JSON and as text.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace gse::pipeline {

/// Loads the scene and its cameras and sums both up: format, counts, bounds (world units), odd rows,
/// warnings. Of a .png: its size in pixels and its text, as pictures of edits carry it. Throws Error.
nlohmann::ordered_json scene_report(const std::filesystem::path& path);

/// The same for a terminal, a line each; what comes from the file is escaped.
std::string report_text(const nlohmann::ordered_json& report);

}  // namespace gse::pipeline
