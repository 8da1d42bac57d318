// Texts for the desktop: entries of the MIME database, types and keywords of the desktop file.
#pragma once

#include <string>
#include <vector>

namespace gse {

/// Types of all scene formats, each once, in the table's order: "model/ply".
std::vector<std::string> scene_mime_types();
/// Entries <mime-type> of those types (shared-mime-info specification), indented by two spaces.
std::string scene_mime_entries();
/// Words by which a desktop finds the program: last parts of all endings, each once ("ply").
std::vector<std::string> scene_keywords();

}  // namespace gse
