// Content tells the format where a format has a magic number.
#include "engine/io/scene/scene_content.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/scene/wrapped_scene.h"

namespace gse::io {
namespace {

constexpr std::string_view LfsPointer = "version https://git-lfs";

/// Content that is no scene by its first bytes, and what to do about it.
struct Foreign {
    std::size_t offset;
    std::string_view start;
    const char* what;
    const char* hint;
};

constexpr const char* Unpack = "unpack it and open the scene in it";
constexpr Foreign Foreigners[] = {
    {0, {"7z\xbc\xaf\x27\x1c", 6}, "a 7z archive", Unpack},
    {0, {"Rar!\x1a\x07", 6}, "a RAR archive", Unpack},
    {0, {"\xfd\x37zXZ\0", 6}, "a file packed with xz", Unpack},
    {0, {"\x28\xb5\x2f\xfd", 4}, "a file packed with zstd", Unpack},
    {0, "BZh91AY&SY", "a file packed with bzip2", Unpack},
    {257, "ustar", "a tar archive", Unpack},
    {0, "glTF", "a glTF model", "save it as PLY in the program that made it"},
    {0, "<!doctype html", "a web page", "download the file itself, not the page that shows it"},
    {0, "<html", "a web page", "download the file itself, not the page that shows it"},
};

/// Names what the content is, where it is known and no scene.
void refuse_foreigners(std::string_view text) {
    for (const Foreign& foreign : Foreigners)
        if (text.size() >= foreign.offset &&
            lower_case(std::string(text.substr(foreign.offset, foreign.start.size()))) ==
                lower_case(std::string(foreign.start)))
            throw Error(ErrorCode::Unsupported, fmt::format("this is {}, not a scene", foreign.what),
                        foreign.hint);
}

}  // namespace

Scene read_content(Bytes bytes, std::string_view name, const Wrapping& wrapping) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (bytes.empty()) throw Error(ErrorCode::Malformed, "the file is empty");
    if (text.starts_with(LfsPointer))
        throw Error(ErrorCode::Malformed, "this is a Git LFS pointer, not the model itself",
                    "run \"git lfs pull\" where it came from");
    const std::string lower_name = lower_case(std::string(name));
    if (is_zip(bytes)) return read_zip(bytes, lower_name, wrapping);
    for (const SceneFormat& format : scene_formats())
        if (format.detect != nullptr && format.detect(bytes)) return format.read(bytes);
    if (is_gzip(bytes)) return read_gzip(bytes, lower_name, wrapping);
    refuse_foreigners(text);
    for (const SceneFormat& format : scene_formats()) {
        if (!format.readable() || !has_extension_of(format, lower_name)) continue;
        if (format.detect == nullptr) return format.read(bytes);
        throw Error(ErrorCode::Malformed,
                    fmt::format("the name says {}, but the content does not begin like one", format.name),
                    "the file is damaged or misnamed");
    }
    throw Error(ErrorCode::Unsupported, "this is no scene format that can be read", readable_hint());
}

bool has_extension_of(const SceneFormat& format, std::string_view name) {
    return std::any_of(format.extensions.begin(), format.extensions.end(),
                       [&](const std::string& extension) { return name.ends_with(extension); });
}

bool looks_like_scene(std::string_view name, const std::function<std::string()>& start) {
    if (name.starts_with('.')) return false;
    for (const SceneFormat& format : scene_formats())
        if (format.readable() && has_extension_of(format, name))
            return format.may_be_scene == nullptr || format.may_be_scene(start());
    return false;
}

long iteration_of(const std::string& folder_name) {
    const std::string name = lower_case(folder_name);
    constexpr std::string_view prefix = "iteration_";
    if (!name.starts_with(prefix)) return -1;
    long iteration = 0;
    const auto [end, failure] =
        std::from_chars(name.data() + prefix.size(), name.data() + name.size(), iteration);
    return failure == std::errc{} && end == name.data() + name.size() ? iteration : -1;
}

std::string readable_hint() { return "known are " + in_words(readable_names(), "and"); }

std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t MostNamed = 5;
    std::string text;
    for (std::size_t at = 0; at < std::min(names.size(), MostNamed); ++at)
        text += (at > 0 ? ", " : "") + printable(names[at]);
    return names.size() > MostNamed ? text + ", ..." : text;
}

}  // namespace gse::io
