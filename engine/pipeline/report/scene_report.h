// Contents and possible defects of a scene file, or the making of a picture, as JSON and as text.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/scene/reading_options.h"

namespace gse::pipeline {

/// Loads the scene and its cameras and sums both up: format, counts, bounds (in the world of the file), odd
/// rows, warnings. For a .png: its size in pixels and its text, as pictures of edits carry it. Throws Error.
nlohmann::ordered_json scene_report(const std::filesystem::path& path, const ReadingOptions& options = {});

/// The report for a terminal, a line each. Text from the file is escaped.
std::string report_text(const nlohmann::ordered_json& report);

}  // namespace gse::pipeline
