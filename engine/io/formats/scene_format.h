// One scene format: its names, its reader and its writer. A new format is one file that returns such a value,
// and its line in scene_formats.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/file.h"
#include "engine/io/bytes/part_files.h"
#include "engine/io/formats/save_options.h"
#include "engine/scene/scene.h"

namespace gse::io {

using Bytes = std::span<const std::byte>;
/// Receives the bytes of a file that is written, a piece at a time.
using TakePiece = std::function<void(std::string_view piece)>;

/// File type of the desktop (shared-mime-info specification). Formats of one type share the first one's
/// entry.
struct MimeType {
    std::string type;          // "model/x-spz"
    std::string comment;       // shown by file managers
    std::string acronym = {};  // with its expansion: both or neither
    std::string expanded_acronym = {};
    std::string parent = {};  // type of which this one is a special case
    std::string alias = {};   // another name of the type
    // First bytes, printable or as XML escapes them; any of them suffices.
    std::vector<std::string> magic = {};
    int magic_priority = 50;
    int weight = 50;       // of the name's ending against other types with the same one
    bool own_icon = true;  // false where other programs' files have the type too
};

/// Option that only this format has, offered by the command line and the export panel.
struct FormatOption {
    struct Value {
        int value = 0;
        std::string label;  // on a button
        std::string note;   // one sentence that says when to choose it
    };
    std::string name;  // key of FormatChoices: "spz_version", --spz-version on the command line
    std::string help;
    std::vector<Value> values;  // ascending, without gaps
    int standard = 0;           // value when nothing is chosen
};

/// Scene format. Function pointers that are null say that the format cannot do it.
struct SceneFormat {
    std::string name;                     // "compressed.ply": of SaveOptions::format and SceneInfo::format
    std::string title;                    // "compressed PLY": in sentences
    std::vector<std::string> extensions;  // ".compressed.ply"
    // "meta.json": files that stand for a folder's scene, first wins.
    std::vector<std::string> file_names = {};
    MimeType mime;

    /// True when the content begins like this format. Never throws. Null when only the name tells the format.
    bool (*detect)(Bytes bytes) = nullptr;
    /// True when a file of this name is a scene at all, by its first StartBytes bytes. Null = it always is.
    bool (*may_be_scene)(std::string_view start) = nullptr;
    /// Reads a file in memory. Throws Error when the content is broken.
    Scene (*read)(Bytes bytes) = nullptr;
    /// Reads without ever holding the whole file. Nothing when only read() can read or refuse it.
    std::optional<Scene> (*read_pieces)(const InputFile& file) = nullptr;
    /// True when a file of one of `file_names` is this format's, by its content. Asked where other scenes are
    /// beside it.
    bool (*describes)(std::string_view description) = nullptr;
    /// Reads the scene for which `file`, one of `file_names`, stands among others. Throws Error.
    Scene (*read_parts)(const PartFiles& files, const std::string& file) = nullptr;

    /// Hands on the bytes of a file. Throws Error before the first piece or not at all. Formats that are not
    /// exact leave out unusable rows with a warning. Returns the order: row order[i] of the usable rows
    /// became row i. An empty order means that rows stay in their places.
    std::vector<std::uint32_t> (*write)(const Scene& scene, const SaveOptions& options,
                                        const TakePiece& take) = nullptr;

    bool exact = false;               // keeps every bit of every row
    bool keeps_labels = false;        // has room for label columns
    bool keeps_antialiasing = false;  // says whether the scene was trained with antialiasing
    bool keeps_up = false;            // says which way is up
    bool keeps_columns = false;       // has room for the columns of Scene::extra
    bool keeps_view_colour = true;    // has colour that depends on the direction it is seen from
    bool keeps_offset = false;        // holds the coordinates of the world, or says what is off them
    std::vector<FormatOption> options = {};

    static constexpr std::size_t StartBytes = 16384;
    bool readable() const { return read != nullptr; }
    bool writable() const { return write != nullptr; }
};

/// Value of a format's option in `options`, or its standard value. `option` must be one of `format.options`.
int chosen_value(const FormatOption& option, const SaveOptions& options);

}  // namespace gse::io
