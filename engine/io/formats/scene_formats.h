// The table of scene formats, and the lists and texts that follow from it.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/formats/scene_format.h"

namespace gse {

/// All scene formats, in the order in which users see them.
std::span<const io::SceneFormat> scene_formats();
/// Format of that name, or null.
const io::SceneFormat* find_format(std::string_view name);
/// Format that is written to a file of that name (longest ending, any case), or null.
const io::SceneFormat* format_written_to(const std::filesystem::path& path);

/// The path with the format's ending in the place of its own: that of a format, else what follows its last
/// dot. A path that ends in one of the format's endings stays as it is.
std::filesystem::path with_ending(const std::filesystem::path& path, const io::SceneFormat& format);
/// Sentences about what a file of the format keeps of a scene, and what it leaves out.
std::string kept_text(const io::SceneFormat& format);

/// Names of the formats that can be written: values of SaveOptions::format.
std::vector<std::string> writable_formats();
/// Endings of files that can be read or written: ".ply", ".compressed.ply", ...
std::vector<std::string> readable_extensions();
std::vector<std::string> writable_extensions();
/// Endings that can be read, and names of files that stand for a folder ("meta.json").
std::vector<std::string> readable_names();
/// Endings of files that hold a scene within: archives, projects of other programs, packed files.
std::vector<std::string> wrapper_extensions();
/// Endings of the formats that can be written and for which `keeps` is true, as the table orders them.
std::vector<std::string> extensions_that_keep(bool io::SceneFormat::*keeps);
/// Options of all formats that can be written, in the table's order. They live as long as the program.
std::vector<const io::FormatOption*> format_options();
/// Every option at its standard value.
FormatChoices standard_choices();

/// Items as a phrase: "a, b and c" for `last` = "and".
std::string in_words(std::span<const std::string> items, std::string_view last);

}  // namespace gse
