// Derived numbers of a frame, in double until the last moment.
#include "engine/preview/frame_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gse::preview {
namespace {

constexpr double FrustumMargin = 0.3;  // of half the field of view, as in engine/raster/conventions.h
constexpr float BlurPx2 = 0.3f;
constexpr float SmallestNear = 1e-6f;  // where nothing lies before the camera
constexpr std::size_t LongestLoop = 50000;
constexpr std::uint32_t BinRounds = 16;
constexpr std::uint64_t MatrixBudget = 8u << 20;  // entries

float to_float(double value) { return static_cast<float>(value); }

/// Low and high limit of x/z, clamped as in gsplat. It follows the principal point.
std::array<float, 2> ratio_limits(double size, double focal, double centre) {
    const double margin = FrustumMargin * 0.5 * size / focal;
    return {to_float(-(centre / focal + margin)), to_float((size - centre) / focal + margin)};
}

}  // namespace

shaders::FrameData frame_data(const FrameRequest& request, const Division& division,
                              const SceneFacts& facts) {
    const Camera& camera = request.camera;
    const Display& display = request.display;
    shaders::FrameData data{};
    const Vec3 eye = camera.centre();
    const float near_plane = display.near_plane > 0 ? display.near_plane : to_float(facts.near_plane);
    const float eye_high[3] = {to_float(eye.x), to_float(eye.y), to_float(eye.z)};
    for (int row = 0; row < 3; ++row)
        data.rotation[row] = {to_float(camera.rotation(row, 0)), to_float(camera.rotation(row, 1)),
                              to_float(camera.rotation(row, 2)), eye_high[row]};
    data.eye_rest = {to_float(eye.x - eye_high[0]), to_float(eye.y - eye_high[1]),
                     to_float(eye.z - eye_high[2]), near_plane > 0 ? near_plane : SmallestNear};
    data.lens = {to_float(camera.fx), to_float(camera.fy), to_float(camera.cx), to_float(camera.cy)};
    const auto x = ratio_limits(camera.width, camera.fx, camera.cx),
               y = ratio_limits(camera.height, camera.fy, camera.cy);
    data.ratio = {x[0], x[1], y[0], y[1]};
    double scale = display.depth_scale;
    if (!(scale > 0)) scale = std::max(length(facts.middle - eye), 1e-12);
    data.optics = {BlurPx2, std::numeric_limits<float>::max(), std::max(display.centre_radius_px, 0.6f),
                   to_float(scale)};
    data.background = {display.background[0], display.background[1], display.background[2],
                       display.transparent ? 1.0f : 0.0f};
    const bool tints = display.mode <= Mode::Ellipsoids || display.mode == Mode::Labels;
    data.tint = {display.tint[0], display.tint[1], display.tint[2], tints ? display.tint_strength : 0.0f};
    data.size = {static_cast<std::uint32_t>(camera.width), static_cast<std::uint32_t>(camera.height),
                 tiles_across(camera.width, division.tile), tiles_across(camera.height, division.tile)};
    data.counts = {0, 0, display.antialiased ? 1u : 0u, static_cast<std::uint32_t>(display.mode)};
    data.parts = {division.sort_parts, division.bin_parts, division.digit_bits, 0};
    return data;
}

Division divide(const vulkan::DeviceInfo& info, bool few_threads, bool portable, std::size_t rows,
                std::uint64_t pixels) {
    Division division;
    division.tile = portable ? 16 : 8;
    if (few_threads) {  // few threads: long stretches, wide digits
        division.group = std::clamp<std::uint32_t>(info.subgroup_size, 1, 64);
        division.digit_bits = 11;
        // Several groups a thread; loops shorter than llvmpipe's limit.
        division.sort_parts = std::max<std::uint32_t>(32, static_cast<std::uint32_t>(rows / LongestLoop + 1));
        division.bin_parts = 64;
        division.bin_rounds = info.subgroup_arithmetic ? BinRounds : 0;
    } else {
        const std::uint64_t tiles = pixels / (division.tile * division.tile) + 1;
        division.sort_parts = 4096;
        division.bin_parts =
            static_cast<std::uint32_t>(std::clamp<std::uint64_t>(MatrixBudget / tiles, 64, 4096));
    }
    return division;
}

std::uint64_t matrix_entries(const Division& division, int width, int height) {
    const std::uint64_t tiles =
        std::uint64_t{tiles_across(width, division.tile)} * tiles_across(height, division.tile);
    return std::max<std::uint64_t>(tiles * division.bin_parts,
                                   (std::uint64_t{1} << division.digit_bits) * division.sort_parts);
}

}  // namespace gse::preview
