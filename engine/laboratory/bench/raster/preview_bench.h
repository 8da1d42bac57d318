// gseditpro-lab bench preview: time of a full frame, per renderer, beside its error.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::bench {

struct PreviewBenchOptions {
    std::string backend = "both";  // "vulkan", "native", "both"
    int width = 1280, height = 720;
    int frames = 16;            // one turn
    bool compare_plain = true;  // the first frame against the double version; takes seconds on large scenes
    bool validation = false;
    std::vector<Camera> cameras;  // at this size; an orbit fitted to the scene when empty
};

/// Draws an orbit frame by frame, each from nothing (no frame is skipped), after one frame to warm up. Times
/// are wall milliseconds until the picture is on the device, and CPU milliseconds of all threads (a software
/// device's too).
nlohmann::ordered_json bench_preview(const Scene& scene, const PreviewBenchOptions& options);

}  // namespace gse::bench
