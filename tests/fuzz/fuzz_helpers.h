// Common end of every fuzz target: bytes are read; a scene that is read must be whole, countable and
// writable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/scene/scene_file.h"

namespace gse::fuzz {

inline constexpr std::size_t MostRowsWritten = 2000;   // larger scenes are only counted, to keep runs quick
inline constexpr std::size_t MostRowsInTextures = 16;  // pictures take longer than bytes

inline std::span<const std::byte> as_bytes(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const std::byte*>(data), size};
}

/// Messages of the readers are no news here.
inline void quiet() {
    static const bool done = [] {
        log::set_level(log::Level::Off);
        return true;
    }();
    static_cast<void>(done);
}

inline bool same_bits(std::span<const float> a, std::span<const float> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

inline std::string written(const io::SceneFormat& format, const Scene& scene, const SaveOptions& options) {
    std::string bytes;
    format.write(scene, options, [&](std::string_view piece) { bytes += piece; });
    return bytes;
}

/// Way to write a scene: a format, with one value of one of its options or as it is by itself.
struct Way {
    const io::SceneFormat* format;
    SaveOptions options;
};

inline const std::vector<Way>& ways() {
    static const std::vector<Way> all = [] {
        std::vector<Way> found;
        for (const io::SceneFormat& format : scene_formats()) {
            if (!format.writable()) continue;
            found.push_back({&format, {}});
            for (const io::FormatOption& option : format.options)
                for (const auto& value : option.values)
                    found.push_back({&format, {.choices = {{option.name, value.value}}}});
        }
        return found;
    }();
    return all;
}

/// Way that follows from the scene, so that an input is exercised alike each time.
inline const Way& way_for(const GaussianSet& gaussians) {
    ContentHash hash;
    for (const auto values : {gaussians.position(), gaussians.opacity_logit(), gaussians.sh()})
        hash.bytes(values.data(), values.size_bytes());
    return ways()[hash.key().low % ways().size()];
}

/// Writes the scene. An exact format gives the same bits back.
inline void write_one_way(const Way& way, const Scene& scene) {
    const bool textures = way.format->name == "sog";
    if (textures && (scene.gaussians.size() > MostRowsInTextures || drop_unusable(scene.gaussians).empty()))
        return;
    const std::string bytes = written(*way.format, scene, way.options);
    if (!way.format->exact || !way.options.choices.empty()) return;
    const Scene again = way.format->read(std::as_bytes(std::span(bytes)));
    GSE_CHECK(same_bits(again.gaussians.position(), scene.gaussians.position()));
    GSE_CHECK(same_bits(again.gaussians.sh(), scene.gaussians.sh()));
}

/// A scene that a reader accepted: statistics work, and one of the ways to write it does.
inline void exercise_scene(const Scene& scene) {
    GSE_CHECK(!scene.gaussians.empty());
    const SceneStatistics statistics = compute_statistics(scene.gaussians);
    GSE_CHECK_EQ(statistics.count, scene.gaussians.size());
    if (scene.gaussians.size() <= MostRowsWritten) write_one_way(way_for(scene.gaussians), scene);
}

/// Calls `read`; Error with a message is a fine answer, any other exception is not.
template <class F> int exercise(F&& read) {
    quiet();
    try {
        read();
    } catch (const Error& error) { GSE_CHECK(!error.message().empty()); }
    return 0;
}

}  // namespace gse::fuzz
