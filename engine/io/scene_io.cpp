// Which reader or writer takes a file; folders of known layouts; messages that end with the path.
#include "engine/io/scene_io.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/formats.h"

namespace gse {
namespace {

constexpr std::string_view LfsPointer = "version https://git-lfs";
constexpr const char* ReadableHint = "known are .ply, .compressed.ply, .splat, .ksplat, .spz and .sog";

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char letter) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    });
    return text;
}

/// Adds the path to errors of readers, which know only bytes.
template <class F>
auto with_path(const std::filesystem::path& path, F&& body) {
    try {
        return body();
    } catch (const Error& error) {
        if (!error.path().empty()) throw;
        throw Error(error.code(), error.message(), error.hint(), path);
    }
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
    const MappedFile file(path);
    return parse_scene(file.bytes(), name);
}

Scene load_folder(const std::filesystem::path& folder) {
    std::error_code ignored;
    if (std::filesystem::exists(folder / "lod-meta.json", ignored))
        return load_file(folder / "lod-meta.json");
    if (std::filesystem::exists(folder / "meta.json", ignored)) return load_file(folder / "meta.json");
    for (const std::filesystem::path& candidate : {folder / "point_cloud", folder})
        if (const auto scene = highest_iteration(candidate)) return load_file(*scene);
    if (std::filesystem::exists(folder / "point_cloud.ply", ignored))
        return load_file(folder / "point_cloud.ply");
    throw Error(ErrorCode::NotFound,
                "the folder holds neither meta.json nor point_cloud/iteration_N/point_cloud.ply",
                "name a scene file", folder);
}

std::string format_of_name(const std::filesystem::path& path) {
    const std::string name = lower(path.filename().string());
    for (const std::string format : {"compressed.ply", "ply", "splat", "spz"})
        if (name.ends_with("." + format)) return format;
    throw Error(ErrorCode::InvalidArgument, "the name does not end in a scene format that can be written",
                "use .ply, .compressed.ply, .splat or .spz", path);
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

Scene load_scene(const std::filesystem::path& path) {
    Scene scene = with_path(path, [&] {
        std::error_code ignored;
        return std::filesystem::is_directory(path, ignored) ? load_folder(path) : load_file(path);
    });
    for (const std::string& warning : scene.info.warnings)
        log::warning("{}: {}", path.filename().string(), warning);
    return scene;
}

std::vector<std::string> writable_formats() { return {"ply", "compressed.ply", "splat", "spz"}; }

void save_scene(const std::filesystem::path& path, const Scene& scene, const SaveOptions& options) {
    const std::string format = options.format.empty() ? format_of_name(path) : options.format;
    const bool labelled =
        options.from_label != nullptr || !options.label.empty() || !options.label_weight.empty();
    if (labelled && format != "ply")
        throw Error(ErrorCode::InvalidArgument, "only a plain .ply file has room for labels", "save as .ply",
                    path);
    const std::string bytes = with_path(path, [&]() -> std::string {
        if (format == "ply") return io::write_gaussian_ply(scene, options);
        if (format == "compressed.ply") return io::write_compressed_ply(scene);
        if (format == "splat") return io::write_splat(scene);
        if (format == "spz") return io::write_spz(scene);
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"{}\" is no scene format that can be written", format),
                    "use ply, compressed.ply, splat or spz");
    });
    if (format == "compressed.ply")
        log::info("a compressed PLY is stored in another order: splat numbers change");
    write_file(path, bytes);
}

}  // namespace gse
