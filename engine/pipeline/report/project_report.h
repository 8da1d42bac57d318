// Contents of a project file, as JSON and as text for a terminal.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/project/project_file.h"

namespace gse::pipeline {

nlohmann::ordered_json project_json(const ProjectSummary& summary, const std::filesystem::path& path);
/// Text of a line each. Text from the file is escaped.
std::string project_text(const ProjectSummary& summary, const std::filesystem::path& path);

}  // namespace gse::pipeline
