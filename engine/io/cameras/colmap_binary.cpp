// COLMAP sparse models in binary: intrinsics of cameras, poses of images. Points are not read.
#include <fmt/core.h>

#include <array>

#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/cameras/colmap_views.h"

namespace gse {
namespace {

using io::ByteReader;

constexpr std::uint64_t LeastCameraBytes = 24 + 2 * 8;
constexpr std::uint64_t LeastImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr std::uint64_t PointBytes = 24;

io::ColmapCameras parse_binary_cameras(std::span<const std::byte> bytes) {
    ByteReader reader(bytes, "cameras.bin");
    io::ColmapCameras cameras;
    const std::uint64_t count = reader.read_count(LeastCameraBytes);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto id = reader.read<std::uint32_t>();
        const io::ColmapModel& model = io::colmap_model(reader.read<std::int32_t>());
        const auto width = static_cast<double>(reader.read<std::uint64_t>());
        const auto height = static_cast<double>(reader.read<std::uint64_t>());
        std::array<double, io::MostColmapParams> params{};
        for (std::size_t p = 0; p < model.params; ++p) params[p] = reader.read<double>();
        try {
            cameras.insert_or_assign(
                id, io::colmap_intrinsics(model, width, height, {params.data(), model.params}));
        } catch (const Error& error) {
            cameras.insert_or_assign(
                id, Error(error.code(), fmt::format("camera {} of cameras.bin: {}", id, error.message()),
                          error.hint()));
        }
    }
    return cameras;
}

}  // namespace

CameraList parse_colmap_binary(std::span<const std::byte> camera_bytes,
                               std::span<const std::byte> image_bytes) {
    const io::ColmapCameras cameras = parse_binary_cameras(camera_bytes);
    ByteReader reader(image_bytes, "images.bin");
    io::ColmapViews views(cameras);
    const std::uint64_t count = reader.read_count(LeastImageBytes);
    for (std::uint64_t i = 0; i < count; ++i) {
        reader.skip(4);  // image number
        std::array<double, 7> pose{};
        for (double& value : pose) value = reader.read<double>();
        const auto camera = reader.read<std::uint32_t>();
        const std::string_view name = reader.read_terminated();
        const std::uint64_t points = reader.read_count(PointBytes);
        reader.skip(points * PointBytes);
        views.add(name, pose, camera);
    }
    return views.finish();
}

}  // namespace gse
