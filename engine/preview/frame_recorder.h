// Records the passes of one picture, with timestamps between them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/preview/frame_data.h"
#include "engine/preview/passes.h"
#include "engine/preview/scene_store.h"
#include "engine/preview/workspace.h"

namespace gse::preview {

/// All inputs of a recording.
struct FramePlan {
    shaders::FrameData data;
    Division division;
    Mode mode = Mode::Beauty;
    int stored_degree = 0, used_degree = 0;
    bool portable = false, has_values = false, store_depth = false, store_light = false;
};

/// Device time of the passes.
class PassClock {
public:
    explicit PassClock(vulkan::Device& device);
    ~PassClock();
    PassClock(const PassClock&) = delete;
    PassClock& operator=(const PassClock&) = delete;
    void start(vk::CommandBuffer commands);
    void mark(vk::CommandBuffer commands, const char* name);
    /// Times of the last picture recorded. Call it after its execution; it does not wait.
    std::vector<std::pair<std::string, double>> read();

private:
    static constexpr std::uint32_t Most = 16;
    vulkan::Device& device_;
    vk::raii::QueryPool pool_{nullptr};
    std::vector<std::string> names_;
};

class FrameRecorder {
public:
    FrameRecorder(vulkan::Device& device, Passes& passes, Workspace& workspace, PassClock& clock)
        : device_(device), passes_(passes), workspace_(workspace), clock_(clock) {}

    void record(vk::CommandBuffer commands, const FramePlan& plan, std::span<const SceneChunk> chunks);
    void record_pick(vk::CommandBuffer commands, const FramePlan& plan, std::uint32_t x, std::uint32_t y);

private:
    void project(const FramePlan& plan, std::span<const SceneChunk> chunks);
    void sort(const FramePlan& plan);
    void bin(const FramePlan& plan);
    void bin_rounds(const Division& division, const vulkan::ComputePipeline& pipeline);
    void blend(const FramePlan& plan);
    void scan(std::uint32_t entries, std::uint32_t total_place, const Division& division);
    void run(const vulkan::ComputePipeline& pipeline, std::uint32_t groups);
    vk::raii::DescriptorSet chunk_set(const SceneChunk& chunk);

    vulkan::Device& device_;
    Passes& passes_;
    Workspace& workspace_;
    PassClock& clock_;
    vk::CommandBuffer commands_;
};

}  // namespace gse::preview
