// What every fuzz target does with its bytes: read them; what is read must be whole, countable and writable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/formats/formats.h"
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

/// A scene that a reader accepted: statistics work, every writer works, and PLY gives the same bits back.
inline void exercise_scene(const Scene& scene) {
    GSE_CHECK(!scene.gaussians.empty());
    const SceneStatistics statistics = compute_statistics(scene.gaussians);
    GSE_CHECK_EQ(statistics.count, scene.gaussians.size());
    if (scene.gaussians.size() > MostRowsWritten) return;
    const std::string ply = io::write_gaussian_ply(scene, {});
    const Scene again = io::parse_gaussian_ply({reinterpret_cast<const std::byte*>(ply.data()), ply.size()});
    GSE_CHECK(same_bits(again.gaussians.position(), scene.gaussians.position()));
    GSE_CHECK(same_bits(again.gaussians.sh(), scene.gaussians.sh()));
    io::write_compressed_ply(scene);
    io::write_splat(scene);
    io::write_spz(scene);
    io::write_spz(scene, 4);
    if (scene.gaussians.size() <= MostRowsInTextures && !drop_unusable(scene.gaussians).empty())
        io::write_sog(scene);
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
