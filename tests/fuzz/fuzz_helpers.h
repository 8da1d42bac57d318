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

#include "engine/base/check.h"
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

/// Writes with every value of every option. An exact format gives the same bits back.
inline void write_every_way(const io::SceneFormat& format, const Scene& scene) {
    if (!format.writable()) return;
    const std::string bytes = written(format, scene, {});
    for (const io::FormatOption& option : format.options)
        for (const auto& value : option.values)
            written(format, scene, {.choices = {{option.name, value.value}}});
    if (!format.exact) return;
    const Scene again = format.read(std::as_bytes(std::span(bytes)));
    GSE_CHECK(same_bits(again.gaussians.position(), scene.gaussians.position()));
    GSE_CHECK(same_bits(again.gaussians.sh(), scene.gaussians.sh()));
}

/// A scene that a reader accepted: statistics work, every writer works, and PLY gives the same bits back.
inline void exercise_scene(const Scene& scene) {
    GSE_CHECK(!scene.gaussians.empty());
    const SceneStatistics statistics = compute_statistics(scene.gaussians);
    GSE_CHECK_EQ(statistics.count, scene.gaussians.size());
    if (scene.gaussians.size() > MostRowsWritten) return;
    for (const io::SceneFormat& format : scene_formats()) {
        const bool textures = format.name == "sog";
        if (textures &&
            (scene.gaussians.size() > MostRowsInTextures || drop_unusable(scene.gaussians).empty()))
            continue;
        write_every_way(format, scene);
    }
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
