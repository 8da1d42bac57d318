// Streamed SOG: the parts of the finest level and the environment, from a folder or an archive.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/base/memory.h"
#include "engine/base/printable.h"
#include "engine/io/bytes/json_numbers.h"
#include "engine/io/bytes/placed_sets.h"
#include "engine/io/formats/sog/sog_files.h"
#include "engine/io/formats/sog/sog_format.h"
#include "engine/io/formats/sog/sog_json.h"

namespace gse::io {
namespace {

using LevelJson = nlohmann::json;

constexpr std::uint64_t LargestPart = std::uint64_t{1} << 40;  // bytes; claims and memory are checked too

/// Numbers of files in the order in which they were first named.
struct FileNumbers {
    std::vector<std::size_t> order;
    std::set<std::size_t> seen;
};

/// Collects the files that a node and its children name for this level. parse_json has bounded the depth.
void collect_files(const LevelJson& node, const std::string& level, FileNumbers& files) {
    if (node.contains("lods") && node.at("lods").contains(level)) {
        const std::size_t file =
            whole_number(node.at("lods").at(level).at("file"), LargestSogCount, "file number of a level");
        if (files.seen.insert(file).second) files.order.push_back(file);
    }
    if (!node.contains("children")) return;
    for (const LevelJson& child : node.at("children")) collect_files(child, level, files);
}

/// The name without "." and "..". Files outside of the scene's folder are refused.
std::filesystem::path inner_name(const std::string& text) {
    const auto name = std::filesystem::path(text).lexically_normal();
    if (name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end())
        throw_malformed_sog("names a file outside of its folder");
    return name;
}

/// Files of the parts, each once, however often it is listed.
std::vector<std::filesystem::path> part_files(const LevelJson& json) {
    FileNumbers files;
    collect_files(json.at("tree"), "0", files);
    if (files.order.empty()) throw_malformed_sog("names no file for its finest level");
    std::vector<std::filesystem::path> names;
    std::set<std::filesystem::path> seen;
    for (const std::size_t number : files.order) {
        const auto name = inner_name(json.at("filenames").at(number).get<std::string>());
        if (seen.insert(name).second) names.push_back(name);
    }
    return names;
}

/// A part: a bundle (.sog), or the description of an unpacked one.
Scene read_part(const PartFiles& files, const std::filesystem::path& name) {
    if (lower_case(name.extension().string()) != ".sog")
        return read_sog(*files.below(name.parent_path().generic_string()), name.filename().string());
    return parse_sog(files.read(name.generic_string(), LargestPart));
}

/// Adds the surroundings that belong to every level. A scene is no less whole without them.
void add_environment(const PartFiles& files, const LevelJson& json, JoinedScene& joined) {
    const auto named = json.find("environment");
    if (named == json.end() || named->is_null() || *named == "") return;
    std::string why = "its name is no text";
    if (named->is_string()) {
        const auto name = inner_name(named->get<std::string>());
        try {
            Scene environment = read_part(files, name);
            joined.warn(fmt::format("the environment of {} splats is loaded with the scene",
                                    environment.gaussians.size()));
            return joined.add(std::move(environment));
        } catch (const OutOfMemory&) { throw; } catch (const Error& error) {
            why = error.what();
        }
    }
    joined.warn(fmt::format("the environment of the scene is left out: {}", printable(why)));
}

}  // namespace

Scene read_sog_levels(const PartFiles& files, const std::string& lod_meta) {
    return with_sog_errors([&] {
        const LevelJson json = parse_sog_json(files.read(lod_meta, LargestPart));
        JoinedScene joined;
        for (const auto& name : part_files(json)) joined.add(read_part(files, name));
        add_environment(files, json, joined);
        joined.warn("of the levels of detail, only the finest is loaded");
        return joined.take();
    });
}

}  // namespace gse::io
