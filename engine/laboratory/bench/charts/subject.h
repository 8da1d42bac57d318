// A subject of `gseditpro-lab bench`: figures, a picture, tables; the same for the terminal, for files and
// for the page of all.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/image.h"

namespace gse::bench {

/// Rows of cells; the first column is text, the others are numbers.
struct Table {
    std::string title;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
};

struct Subject {
    std::string name, title;        // "raster", "The rasterizer: ..."
    nlohmann::ordered_json report;  // with "parameters"
    Image picture;
    std::vector<Table> tables;
    std::vector<std::string> remarks;  // sentences: where the default lies, what was left out
};

/// A column of a table over measured points: the key of the figure and what stands above it.
struct Column {
    std::string key, title;
};

/// A row per point of points_json(); the default has a mark in the last column.
Table points_table(const std::string& title, const nlohmann::ordered_json& points,
                   const std::vector<Column>& columns);

/// Sentences about fronts_of(): whether the default lies on them, and if not, what beats it. `titles`: what
/// each is about.
std::vector<std::string> front_remarks(const nlohmann::ordered_json& fronts,
                                       const std::vector<std::string>& titles);

/// Tables and remarks as text for a terminal.
std::string subject_text(const Subject& subject);

/// NAME.json and NAME.png in a folder that appears whole. Throws Error (Unwritable).
void leave_subject(const Subject& subject, const std::filesystem::path& folder);

/// Words of a list with spaces or commas between them.
std::vector<std::string> words_in_list(const std::string& text);
/// Numbers of a list, each once and ascending. Throws Error (InvalidArgument) that names the setting unless
/// all are numbers from `low` to `high`.
std::vector<double> numbers_in_list(const std::string& name, const std::string& text, double low,
                                    double high);

/// "1280x720". Throws Error (InvalidArgument).
void parse_picture_size(const std::string& text, int& width, int& height);

}  // namespace gse::bench
