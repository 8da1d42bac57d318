// Numbers that the shaders read, from camera and display.
#pragma once

#include "engine/preview/splat_renderer.h"
#include "engine/preview/workspace.h"
#include "shared.h"

namespace gse::preview {

/// Properties of the scene that a frame depends on.
struct SceneFacts {
    Vec3 middle;            // for the scale of the depth colours
    double near_plane = 0;  // where the display leaves it open
};

shaders::FrameData frame_data(const FrameRequest& request, const Division& division, const SceneFacts& facts);

/// Division of the work for a scene and a picture's size. `few_threads`: the device is a CPU.
Division divide(const vulkan::DeviceInfo& info, bool few_threads, bool portable, std::size_t rows,
                std::uint64_t pixels);

/// Entries of the largest matrix of counts the passes need.
std::uint64_t matrix_entries(const Division& division, int width, int height);

inline std::uint32_t tiles_across(int pixels, std::uint32_t tile) {
    return (static_cast<std::uint32_t>(pixels) + tile - 1) / tile;
}

}  // namespace gse::preview
