// Contents of project.json: everything of a project but its arrays, with the names of the members that hold
// those.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/document.h"

namespace gse::io {

inline constexpr int ProjectVersion = 1;
inline constexpr const char* ProjectFormat = "gseditpro-project";

/// Relation of the document's base to the scene's file.
enum class BaseKind {
    File,   // it is what the file holds
    Kept,   // some rows of the file, told by a bit each
    Whole,  // the project holds it
};

struct ProjectDescription {
    int version = ProjectVersion;
    std::string program;
    // Scene
    std::string scene_path, scene_relative;  // absolute, and from the project's folder; empty = no file
    std::uint64_t scene_bytes = 0, scene_fingerprint = 0;
    BaseKind base = BaseKind::File;
    std::string base_member;  // for Kept and Whole
    std::uint64_t file_rows = 0, base_rows = 0, current_rows = 0;
    SceneInfo info;
    struct ExtraEntry {
        std::string name;
        ColumnType type = ColumnType::Float32;
        std::string member;
    };
    std::vector<ExtraEntry> extra;  // columns of a whole base, [base_rows] each
    // Work; arrays are null here and named beside
    struct Edit {
        EditNode node;
        std::string delta, thumbnail;
    };
    struct LabelEntry {
        NamedLabel label;
        std::string weight, manual, absent;
        std::string probability, coverage;  // of what the views said
        LabelRule rule;
    };
    /// Results of an edit of the stack, each with the seed that made it. The delta of the one on the stack
    /// is the stack's member.
    struct VariationsEntry {
        std::uint64_t edit = 0;
        std::vector<Edit> results;
        std::vector<std::uint64_t> seeds;  // [results]
    };
    std::vector<Edit> stack;
    std::vector<VariationsEntry> variations;
    std::vector<LabelEntry> labels;
    int active_label = -1;
    std::vector<View> views;
    std::string thumbnail;
    nlohmann::json ui = nlohmann::json::object(), jobs = nlohmann::json::object();
    nlohmann::json unknown = nlohmann::json::object();  // fields of newer programs, kept
};

std::string write_description(const ProjectDescription& description);
/// Parses project.json. Throws Error with one sentence for any invalid value. Unknown fields are kept in
/// `unknown`.
ProjectDescription parse_description(std::string_view text);

}  // namespace gse::io
