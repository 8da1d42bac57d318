// Which reader or writer takes a file; folders of known layouts; messages that end with the path.
#include "engine/io/scene/scene_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/pending_file.h"
#include "engine/io/formats/formats.h"
#include "engine/io/scene/format_loss.h"

namespace gse {
namespace {

constexpr std::string_view LfsPointer = "version https://git-lfs";
constexpr std::size_t LongestPlyHeader = 16384;  // of a PLY that is looked at in a folder
constexpr const char* ReadableHint = "known are .ply, .compressed.ply, .splat, .ksplat, .spz and .sog";

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char letter) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    });
    return text;
}

/// N of a folder "iteration_N".
std::optional<long> iteration_of(const std::filesystem::path& folder) {
    const std::string name = folder.filename().string();
    constexpr std::string_view prefix = "iteration_";
    if (!name.starts_with(prefix)) return std::nullopt;
    long iteration = 0;
    const auto [end, failure] =
        std::from_chars(name.data() + prefix.size(), name.data() + name.size(), iteration);
    if (failure != std::errc{} || end != name.data() + name.size()) return std::nullopt;
    return iteration;
}

/// point_cloud.ply of the highest iteration below `point_cloud`.
std::optional<std::filesystem::path> highest_iteration(const std::filesystem::path& point_cloud) {
    std::optional<std::filesystem::path> best;
    long best_iteration = -1;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(point_cloud, ignored)) {
        const auto iteration = iteration_of(entry.path());
        const std::filesystem::path scene = entry.path() / "point_cloud.ply";
        if (!iteration || *iteration <= best_iteration || !std::filesystem::exists(scene, ignored)) continue;
        best = scene;
        best_iteration = *iteration;
    }
    return best;
}

Scene load_file(const std::filesystem::path& path) {
    const std::string name = lower(path.filename().string());
    if (name == "lod-meta.json") return io::load_sog_levels(path);
    if (name == "meta.json") return io::load_sog_folder(path);
    if (auto scene = io::load_gaussian_ply(InputFile(path))) return std::move(*scene);
    const FileBytes file(path);
    return parse_scene(file.bytes(), name);
}

/// The scene a folder stands for by itself: unpacked SOG, or an Inria output folder.
std::optional<std::filesystem::path> scene_of_layout(const std::filesystem::path& folder) {
    std::error_code ignored;
    for (const char* meta : {"lod-meta.json", "meta.json"})
        if (std::filesystem::exists(folder / meta, ignored)) return folder / meta;
    for (const std::filesystem::path& candidate : {folder / "point_cloud", folder})
        if (const auto scene = highest_iteration(candidate)) return scene;
    if (std::filesystem::exists(folder / "point_cloud.ply", ignored)) return folder / "point_cloud.ply";
    return std::nullopt;
}

/// By its name a scene. PLY files hold meshes and points too: those whose header names nothing that splats
/// have are left out.
bool looks_like_scene(const std::filesystem::path& path) {
    const std::string name = lower(path.filename().string());
    std::error_code ignored;
    if (name.starts_with('.') || !std::filesystem::is_regular_file(path, ignored)) return false;
    for (const char* ending : {".splat", ".ksplat", ".spz", ".sog"})
        if (name.ends_with(ending)) return true;
    if (!name.ends_with(".ply")) return false;
    std::string header(LongestPlyHeader, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(header.data(), static_cast<std::streamsize>(header.size()));
    header.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    const bool whole = header.starts_with("ply") && header.find("end_header") != std::string::npos;
    return !whole || header.find("scale_0") != std::string::npos ||
           header.find("packed_position") != std::string::npos;
}

Scene load_folder(const std::filesystem::path& folder) {
    if (const auto scene = scene_of_layout(folder)) return load_file(*scene);
    const auto files = scenes_in_folder(folder);
    if (files.size() == 1) return load_file(files.front());
    if (files.empty()) throw Error(ErrorCode::NotFound, "the folder holds no scene", ReadableHint, folder);
    constexpr std::size_t most_named = 5;
    std::string names;
    for (std::size_t at = 0; at < std::min(files.size(), most_named); ++at)
        names += (at > 0 ? ", " : "") + files[at].filename().string();
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("the folder holds {} scenes ({}{})", files.size(), names,
                            files.size() > most_named ? ", ..." : ""),
                "name the one you mean", folder);
}

std::string format_of_name(const std::filesystem::path& path) {
    const std::string name = lower(path.filename().string());
    for (const std::string format : {"compressed.ply", "ply", "splat", "spz", "sog"})
        if (name.ends_with("." + format)) return format;
    throw Error(ErrorCode::InvalidArgument, "the name does not end in a scene format that can be written",
                "use .ply, .compressed.ply, .splat, .spz or .sog", path);
}

/// Reads back what is about to be written: the error is that of whoever opens the file, not an estimate.
void warn_of_losses(const std::string& name, const Scene& scene, const GaussianSet& rows,
                    const std::string& bytes, const std::string& format,
                    const std::vector<std::uint32_t>& order) {
    const auto view = std::as_bytes(std::span(bytes));
    const Scene back = parse_scene(view, "written." + format);
    const std::string loss = io::describe_loss(rows, back.gaussians, order);
    if (!loss.empty()) log::warning("{} keeps rounded values: {}", name, loss);
    if (scene.info.antialiased && !back.info.antialiased)
        log::warning(
            "{} does not say that the scene was trained with antialiasing; .ply, .compressed.ply, .spz and "
            ".sog do",
            name);
    if (scene.info.up_known && !back.info.up_known)
        log::warning("{} does not say which way is up in the scene; .ply and .compressed.ply do", name);
}

/// A scene as plain PLY, never held as a whole; nothing is touched when it cannot be one.
void write_in_pieces(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options) {
    std::optional<PendingFile> file;
    io::write_gaussian_ply(scene, options, [&](std::string_view piece) {
        if (!file) file.emplace(path);
        file->write(piece);
    });
    file->commit();
}

}  // namespace

namespace io {

std::span<const SceneReader> scene_readers() {
    static constexpr std::array<SceneReader, 6> readers = {
        {{"compressed.ply", detect_compressed_ply, parse_compressed_ply},
         {"ply", detect_ply, parse_gaussian_ply},
         {"spz", detect_spz, parse_spz},
         {"sog", detect_sog, parse_sog},
         {"splat", detect_splat, parse_splat},
         {"ksplat", detect_ksplat, parse_ksplat}}};
    return readers;
}

}  // namespace io

Scene parse_scene(std::span<const std::byte> bytes, std::string_view name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (bytes.empty()) throw Error(ErrorCode::Malformed, "the file is empty");
    if (text.starts_with(LfsPointer))
        throw Error(ErrorCode::Malformed, "this is a Git LFS pointer, not the model itself",
                    "run \"git lfs pull\" where it came from");
    const std::string lower_name = lower(std::string(name));
    for (const io::SceneReader& reader : io::scene_readers())
        if (reader.detect(bytes, lower_name)) return reader.parse(bytes);
    for (const char* known : {"ply", "spz", "sog"})
        if (lower_name.ends_with(std::string(".") + known))
            throw Error(ErrorCode::Malformed,
                        fmt::format("the name says {}, but the content does not begin like one", known),
                        "the file is damaged or misnamed");
    throw Error(ErrorCode::Unsupported, "this is no scene format that can be read", ReadableHint);
}

Scene load_scene_file(const std::filesystem::path& path) {
    Scene scene = with_path(path, [&] {
        std::error_code ignored;
        return std::filesystem::is_directory(path, ignored) ? load_folder(path) : load_file(path);
    });
    for (const std::string& warning : scene.info.warnings)
        log::warning("{}: {}", path.filename().string(), warning);
    return scene;
}

std::vector<std::filesystem::path> scenes_in_folder(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code failure;
    if (!std::filesystem::is_directory(folder, failure) || scene_of_layout(folder)) return files;
    std::filesystem::directory_iterator entry(folder, failure);
    for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure))
        if (looks_like_scene(entry->path())) files.push_back(entry->path());
    if (failure)
        throw Error(ErrorCode::Unreadable, "the folder cannot be read (" + failure.message() + ")",
                    "check its permissions", folder);
    std::sort(files.begin(), files.end());
    return files;
}

bool holds_scene(const std::filesystem::path& folder) {
    return scene_of_layout(folder) || !scenes_in_folder(folder).empty();
}

std::vector<std::string> writable_formats() { return {"ply", "compressed.ply", "splat", "spz", "sog"}; }

SavedRows save_scene(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options) {
    const std::string format = options.format.empty() ? format_of_name(path) : options.format;
    const bool labelled =
        options.from_label != nullptr || !options.label.empty() || !options.label_weight.empty();
    if (labelled && format != "ply")
        throw Error(ErrorCode::InvalidArgument, "only a plain .ply file has room for labels", "save as .ply",
                    path);
    if (format == "ply") {
        with_path(path, [&] { write_in_pieces(path, scene, options); });
        return {scene.gaussians.size(), 0};
    }
    std::vector<std::uint32_t> order;
    const std::string bytes = with_path(path, [&]() -> std::string {
        if (format == "compressed.ply") return io::write_compressed_ply(scene, &order);
        if (format == "splat") return io::write_splat(scene);
        if (format == "sog") return io::write_sog(scene, &order);
        if (format == "spz") return io::write_spz(scene, options.spz_version);
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"{}\" is no scene format that can be written", format),
                    "use ply, compressed.ply, splat, spz or sog");
    });
    if (!order.empty()) log::info("a .{} file is stored in another order: splat numbers change", format);
    const GaussianSet rows = drop_unusable(scene.gaussians);
    if (rows.empty() && !scene.gaussians.empty())
        throw Error(ErrorCode::Malformed,
                    fmt::format("none of the {} splats can be written as {}", scene.gaussians.size(), format),
                    "their values are NaN or infinite", path);
    warn_of_losses(path.filename().string(), scene, rows, bytes, format, order);
    write_file(path, bytes);
    return {rows.size(), scene.gaussians.size() - rows.size()};
}

}  // namespace gse
