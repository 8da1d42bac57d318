// The members of an archive that may be its scene, and the choice of one.
#include "engine/io/scene/wrapped_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/scene/supersplat_project.h"

namespace gse::io {
namespace {

constexpr int MostWrappers = 4;  // a download within a download
constexpr std::uint64_t AnyBytes = ~std::uint64_t{0};
constexpr std::uint64_t LargestList = std::uint64_t{64} << 20;  // bytes of a list of parts
constexpr std::size_t MostDescribed = 100;                      // more are several all the same
constexpr const char* UnpackHint = "unpack it and open the one you mean";

std::string_view last_of(std::string_view name) { return name.substr(name.rfind('/') + 1); }
/// "" or a folder that ends in "/".
std::string_view folder_of(std::string_view name) { return name.substr(0, name.rfind('/') + 1); }

/// Scene in an archive: a file, or the description of several (`format` is theirs).
struct Member {
    std::string name;
    const SceneFormat* format = nullptr;
};

Wrapping deeper(const Wrapping& wrapping) {
    if (wrapping.depth >= MostWrappers)
        throw Error(ErrorCode::Unsupported,
                    fmt::format("more than {} archives lie within each other", MostWrappers),
                    "unpack them and open the scene itself");
    return {wrapping.depth + 1, wrapping.file_bytes};
}

/// Files that systems and archivers leave beside others.
bool is_litter(std::string_view name) {
    return name.starts_with("__MACOSX/") || name.find("/__MACOSX/") != std::string_view::npos ||
           last_of(name).starts_with('.');
}

bool has_scene_ending(std::string_view lower_name) {
    const auto formats = scene_formats();
    return std::any_of(formats.begin(), formats.end(),
                       [&](const SceneFormat& format) { return has_extension_of(format, lower_name); });
}

std::string without_gz(std::string name) {
    constexpr std::string_view Ending = ".gz";
    if (name.ends_with(Ending)) name.resize(name.size() - Ending.size());
    return name;
}

/// True for an archive, or a packed scene.
bool is_wrapper(const std::string& lower_name) {
    if (lower_name.ends_with(".gz")) return is_packed_scene(lower_name);
    const auto endings = wrapper_extensions();
    return std::any_of(endings.begin(), endings.end(),
                       [&](const std::string& ending) { return lower_name.ends_with(ending); });
}

/// True for a file beside or below a description of several files.
bool is_part(const std::vector<Member>& described, std::string_view name) {
    return std::any_of(described.begin(), described.end(),
                       [&](const Member& member) { return name.starts_with(folder_of(member.name)); });
}

/// True when the description is the format's.
bool is_described(const PartArchive& files, const ZipEntry& entry, const SceneFormat& format) {
    if (format.describes == nullptr) return true;
    const auto text = files.read(entry.name, LargestList);
    return format.describes({reinterpret_cast<const char*>(text.data()), text.size()});
}

/// Descriptions of scenes of several files. One below another belongs to it.
std::vector<Member> described_scenes(const PartArchive& files) {
    std::vector<Member> members;
    for (const SceneFormat& format : scene_formats())
        for (const std::string& file_name : format.file_names) {
            const std::vector<Member> before = members;
            for (const ZipEntry& entry : files.entries())
                if (lower_case(std::string(last_of(entry.name))) == file_name && !is_litter(entry.name) &&
                    members.size() < MostDescribed && !is_part(before, entry.name) &&
                    is_described(files, entry, format))
                    members.push_back({entry.name, &format});
        }
    std::vector<Member> own;
    for (const Member& member : members) {
        const auto holds = [&](const Member& other) {
            return folder_of(other.name) != folder_of(member.name) &&
                   folder_of(member.name).starts_with(folder_of(other.name));
        };
        if (std::none_of(members.begin(), members.end(), holds)) own.push_back(member);
    }
    return own;
}

/// Every scene in the archive. Archives within count where there is no other, and files that are scenes by
/// their names only where there is nothing else.
std::vector<Member> scenes_in(const PartArchive& files) {
    std::vector<Member> scenes = described_scenes(files), wrapped, by_name;
    const std::vector<Member> described = scenes;
    for (const ZipEntry& entry : files.entries()) {
        const std::string name = lower_case(std::string(last_of(entry.name)));
        if (is_litter(entry.name) || is_part(described, entry.name)) continue;
        if (is_wrapper(name)) wrapped.push_back({entry.name});
        else if (!has_scene_ending(name)) continue;
        else if (entry.locked ||
                 looks_like_scene(name, [&] { return files.start_of(entry, SceneFormat::StartBytes); }))
            scenes.push_back({entry.name});
        else by_name.push_back({entry.name});
    }
    return !scenes.empty() ? scenes : !wrapped.empty() ? wrapped : by_name;
}

/// The highest iteration, where all are iterations of one training.
std::optional<Member> highest_of(const std::vector<Member>& scenes) {
    std::optional<Member> best;
    long highest = -1;
    std::string training;
    for (const Member& scene : scenes) {
        const std::filesystem::path folder = std::filesystem::path(scene.name).parent_path();
        const long iteration = iteration_of(folder.filename().string());
        if (iteration < 0 || (best && folder.parent_path() != training)) return std::nullopt;
        training = folder.parent_path().string();
        if (iteration > highest) best = scene;
        highest = std::max(highest, iteration);
    }
    return best;
}

Scene read_member(const PartArchive& files, const Member& member, const Wrapping& wrapping) {
    const std::string name(last_of(member.name));
    if (member.format != nullptr) {
        const std::string folder(folder_of(member.name));
        return folder.empty() ? member.format->read_parts(files, name)
                              : member.format->read_parts(*files.below(folder), name);
    }
    return read_content(files.read(member.name, AnyBytes), name, wrapping);
}

[[noreturn]] void throw_no_scene(const PartArchive& files) {
    std::vector<std::string> names;
    for (const ZipEntry& entry : files.entries())
        if (!is_litter(entry.name)) names.push_back(entry.name);
    throw Error(ErrorCode::Unsupported,
                names.empty()
                    ? "the archive is empty"
                    : fmt::format("the archive holds no scene that can be read ({})", some_of(names)),
                readable_hint());
}

}  // namespace

bool is_packed_scene(const std::string& lower_name) {
    return !lower_name.starts_with('.') &&
           (lower_name.ends_with(".ssproj") ||
            (lower_name.ends_with(".gz") && has_scene_ending(without_gz(lower_name))));
}

Scene read_gzip(Bytes bytes, const std::string& name, const Wrapping& wrapping) {
    const Wrapping inner = deeper(wrapping);
    return read_content(unpack_gzip(bytes, wrapping.file_bytes), without_gz(name), inner);
}

Scene read_zip(Bytes bytes, const std::string& name, const Wrapping& wrapping) {
    const Wrapping inner = deeper(wrapping);
    const auto files = open_archive(bytes, "the archive", wrapping.file_bytes);
    if (const auto project = supersplat_project_in(*files)) return read_supersplat_project(*project, inner);
    const std::vector<Member> scenes = scenes_in(*files);
    if (scenes.size() == 1) return read_member(*files, scenes.front(), inner);
    if (const auto highest = highest_of(scenes)) return read_member(*files, *highest, inner);
    if (scenes.empty()) {
        for (const SceneFormat& format : scene_formats())  // what it says of itself is more exact
            if (format.detect != nullptr && format.detect(bytes) && has_extension_of(format, name))
                return format.read(bytes);
        throw_no_scene(*files);
    }
    std::vector<std::string> names;
    for (const Member& scene : scenes) names.push_back(scene.name);
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("the archive holds {} scenes ({})", scenes.size(), some_of(names)), UnpackHint);
}

}  // namespace gse::io
