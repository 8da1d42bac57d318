// Choice of a file's reader or writer, folders of known layouts, and messages that end with the path.
#include "engine/io/scene/scene_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/pending_file.h"
#include "engine/io/bytes/activation.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/scene/format_loss.h"
#include "engine/io/scene/scene_content.h"
#include "engine/io/scene/wrapped_scene.h"
#include "engine/scene/origin/world_offset.h"

namespace gse {
namespace {

constexpr const char* PointCloud = "point_cloud.ply";  // of an iteration of a training

/// The entry of the folder with that name, whatever its capitals. Nothing when there is none.
std::optional<std::filesystem::path> entry_named(const std::filesystem::path& folder,
                                                 const std::string& lower_name) {
    std::error_code failure;
    if (std::filesystem::exists(folder / lower_name, failure)) return folder / lower_name;
    std::filesystem::directory_iterator entry(folder, failure);
    for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure))
        if (io::lower_case(entry->path().filename().string()) == lower_name) return entry->path();
    return std::nullopt;
}

/// point_cloud.ply of the highest iteration below `point_cloud`.
std::optional<std::filesystem::path> highest_iteration(const std::filesystem::path& point_cloud) {
    std::optional<std::filesystem::path> best;
    long best_iteration = -1;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(point_cloud, ignored)) {
        const long iteration = io::iteration_of(entry.path().filename().string());
        if (iteration <= best_iteration) continue;
        const auto scene = entry_named(entry.path(), PointCloud);
        if (!scene) continue;
        best = scene;
        best_iteration = iteration;
    }
    return best;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

Scene load_file(const std::filesystem::path& path) {
    const std::string name = io::lower_case(path.filename().string());
    for (const io::SceneFormat& format : scene_formats())
        if (contains(format.file_names, name))
            return format.read_parts(
                *io::open_folder(path.parent_path(), fmt::format("the {} scene", format.title)),
                path.filename().string());
    for (const io::SceneFormat& format : scene_formats())
        if (format.read_pieces != nullptr)
            if (auto scene = format.read_pieces(InputFile(path))) return std::move(*scene);
    const FileBytes file(path);
    return parse_scene(file.bytes(), name);
}

/// The scene a folder stands for by itself: an unpacked format, or an Inria output folder.
std::optional<std::filesystem::path> scene_of_layout(const std::filesystem::path& folder) {
    for (const io::SceneFormat& format : scene_formats())
        for (const std::string& name : format.file_names)
            if (auto description = entry_named(folder, name)) return description;
    const auto iterations = entry_named(folder, "point_cloud");
    for (const auto& candidate : {iterations.value_or(folder), folder})
        if (const auto scene = highest_iteration(candidate)) return scene;
    return entry_named(folder, PointCloud);
}

/// First bytes of a file, none when it cannot be read.
std::string start_of(const std::filesystem::path& path) {
    std::string start(io::SceneFormat::StartBytes, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return start;
}

/// True for a file that is a scene by its name and start.
bool is_scene_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) &&
           io::looks_like_scene(io::lower_case(path.filename().string()), [&] { return start_of(path); });
}

bool is_packed_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return io::is_packed_scene(io::lower_case(path.filename().string())) &&
           std::filesystem::is_regular_file(path, ignored);
}

Scene load_folder(const std::filesystem::path& folder) {
    if (const auto scene = scene_of_layout(folder)) return load_file(*scene);
    const auto files = scenes_in_folder(folder);
    if (files.size() == 1) return load_file(files.front());
    if (files.empty())
        throw Error(ErrorCode::NotFound, "the folder holds no scene", io::readable_hint(), folder);
    std::vector<std::string> names;
    for (const auto& file : files) names.push_back(file.filename().string());
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("the folder holds {} scenes ({})", files.size(), io::some_of(names)),
                "name the one you mean", folder);
}

/// Format of `options`, else of the file's name. Throws Error when there is no such writer.
const io::SceneFormat& format_to_write(const std::filesystem::path& path, const std::string& name) {
    const io::SceneFormat* format = name.empty() ? format_written_to(path) : find_format(name);
    if (format != nullptr && format->writable()) return *format;
    if (name.empty())
        throw Error(ErrorCode::InvalidArgument, "the name does not end in a scene format that can be written",
                    "use " + in_words(writable_extensions(), "or"), path);
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("\"{}\" is no scene format that can be written", name),
                "use " + in_words(writable_formats(), "or"), path);
}

/// Warns of a format's losses by reading back the bytes that are about to be written. The errors are
/// measured, not estimated.
void warn_of_losses(const std::string& name, const Scene& scene, const GaussianSet& rows,
                    const std::string& bytes, const io::SceneFormat& format,
                    const std::vector<std::uint32_t>& order) {
    const auto view = std::as_bytes(std::span(bytes));
    const Scene back = parse_scene(view, "written" + format.extensions.front());
    const std::string loss = io::describe_loss(rows, back.gaussians, order);
    if (!loss.empty()) log::warning("{} keeps rounded values: {}", name, loss);
    if (scene.info.antialiased && !back.info.antialiased)
        log::warning("{} does not say that the scene was trained with antialiasing; {} do", name,
                     in_words(extensions_that_keep(&io::SceneFormat::keeps_antialiasing), "and"));
    if (scene.info.up_known && !back.info.up_known)
        log::warning("{} does not say which way is up in the scene; {} do", name,
                     in_words(extensions_that_keep(&io::SceneFormat::keeps_up), "and"));
}

/// Scene of a file that was said to hold activated values.
Scene raw_scene(Scene scene) {
    const io::SceneFormat* format = find_format(scene.info.format);
    if (format != nullptr && format->exact) return io::with_raw_values(std::move(scene));
    throw Error(
        ErrorCode::InvalidArgument,
        fmt::format("a .{} file always holds activated values, and they are read as such", scene.info.format),
        "leave out --activated");
}

/// Warns of what the scene has beside its splats and the format has no room for.
void warn_of_omissions(const std::string& name, const Scene& scene, const io::SceneFormat& format) {
    if (!scene.extra.empty() && !format.keeps_columns)
        log::warning(
            "{} has no room for the columns {} of the scene's file, which are left out; {} keep them", name,
            in_words(names_of(scene.extra), "and"),
            in_words(extensions_that_keep(&io::SceneFormat::keeps_columns), "and"));
    if (!scene.info.lists.empty())
        log::warning("{} has no room for the list columns {} of the scene's file, which are left out", name,
                     in_words(scene.info.lists, "and"));
    if (has_offset(scene.info.offset) && !format.keeps_offset)
        log::warning("{} holds the positions less the offset {} of the scene; {} keep it", name,
                     offset_text(scene.info.offset),
                     in_words(extensions_that_keep(&io::SceneFormat::keeps_offset), "and"));
}

/// Writes an exact format, never held as a whole. Touches nothing when the scene cannot be written.
void write_in_pieces(const std::filesystem::path& path, const io::SceneFormat& format, const Scene& scene,
                     const SaveOptions& options) {
    std::optional<PendingFile> file;
    format.write(scene, options, [&](std::string_view piece) {
        if (!file) file.emplace(path);
        file->write(piece);
    });
    file->commit();
}

}  // namespace

Scene parse_scene(std::span<const std::byte> bytes, std::string_view name) {
    return io::read_content(bytes, name, {.file_bytes = bytes.size()});
}

Scene load_scene_file(const std::filesystem::path& path, const ReadingOptions& options) {
    Scene scene = with_path(path, [&] {
        std::error_code ignored;
        Scene read = std::filesystem::is_directory(path, ignored) ? load_folder(path) : load_file(path);
        return options.activated ? raw_scene(std::move(read)) : std::move(read);
    });
    for (const std::string& warning : scene.info.warnings)
        log::warning("{}: {}", path.filename().string(), warning);
    return scene;
}

std::vector<std::filesystem::path> scenes_in_folder(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files, packed;
    std::error_code failure;
    if (!std::filesystem::is_directory(folder, failure) || scene_of_layout(folder)) return files;
    std::filesystem::directory_iterator entry(folder, failure);
    for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure))
        if (is_scene_file(entry->path())) files.push_back(entry->path());
        else if (is_packed_file(entry->path())) packed.push_back(entry->path());
    if (failure)
        throw Error(ErrorCode::Unreadable, "the folder cannot be read (" + failure.message() + ")",
                    "check its permissions", folder);
    if (files.empty()) files = std::move(packed);
    std::sort(files.begin(), files.end());
    return files;
}

bool holds_scene(const std::filesystem::path& folder) {
    return scene_of_layout(folder) || !scenes_in_folder(folder).empty();
}

SavedRows save_scene(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options) {
    const io::SceneFormat& format = format_to_write(path, options.format);
    const bool labelled =
        options.from_label != nullptr || !options.label.empty() || !options.label_weight.empty();
    if (labelled && !format.keeps_labels) {
        const std::string able = in_words(extensions_that_keep(&io::SceneFormat::keeps_labels), "or");
        throw Error(ErrorCode::InvalidArgument, fmt::format("only a plain {} file has room for labels", able),
                    "save as " + able, path);
    }
    warn_of_omissions(path.filename().string(), scene, format);
    if (format.exact) {
        with_path(path, [&] { write_in_pieces(path, format, scene, options); });
        return {scene.gaussians.size(), 0};
    }
    std::string bytes;
    const std::vector<std::uint32_t> order = with_path(
        path, [&] { return format.write(scene, options, [&](std::string_view piece) { bytes += piece; }); });
    if (!order.empty()) log::info("a .{} file is stored in another order: splat numbers change", format.name);
    const GaussianSet rows = drop_unusable(scene.gaussians);
    if (rows.empty() && !scene.gaussians.empty())
        throw Error(
            ErrorCode::Malformed,
            fmt::format("none of the {} splats can be written as {}", scene.gaussians.size(), format.name),
            "their values are NaN or infinite", path);
    warn_of_losses(path.filename().string(), scene, rows, bytes, format, order);
    write_file(path, bytes);
    return {rows.size(), scene.gaussians.size() - rows.size()};
}

}  // namespace gse
