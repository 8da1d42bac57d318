// Parts that commands share which write a scene file.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "engine/base/error.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/scene/scene_file.h"

namespace gse::app {

/// Help text of the file that is written.
inline std::string output_help() { return "New file: " + in_words(writable_extensions(), "or"); }

/// Throws Error (InvalidArgument) where the output would replace the input.
inline void refuse_same_file(const std::filesystem::path& input, const std::filesystem::path& output) {
    std::error_code ignored;
    if (std::filesystem::equivalent(input, output, ignored))
        throw Error(ErrorCode::InvalidArgument, "the output is the input itself", "choose another name",
                    output);
}

/// " (3 that the format cannot hold are left out)"; empty where all are written.
inline std::string left_out_text(const SavedRows& rows) {
    return rows.left_out == 0 ? ""
                              : fmt::format(" ({} that the format cannot hold are left out)", rows.left_out);
}

}  // namespace gse::app
