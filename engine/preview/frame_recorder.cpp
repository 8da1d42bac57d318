// Order of the passes, and the barriers between them.
#include "engine/preview/frame_recorder.h"

#include <algorithm>
#include <array>

namespace gse::preview {
namespace {

std::uint32_t groups_of(std::uint64_t count, std::uint32_t size) {
    return static_cast<std::uint32_t>((count + size - 1) / size);
}

std::uint32_t word(bool value) { return value ? 1u : 0u; }

std::vector<std::uint32_t> blend_constants(const FramePlan& plan) {
    return {static_cast<std::uint32_t>(plan.mode),
            word(plan.mode == Mode::Depth || plan.store_depth || plan.store_light), word(plan.has_values),
            word(plan.store_depth), word(plan.store_light)};
}

}  // namespace

PassClock::PassClock(vulkan::Device& device) : device_(device) {
    if (device.info().timestamp_ns > 0)
        pool_ = vk::raii::QueryPool(device.handle(), {{}, vk::QueryType::eTimestamp, Most});
}

PassClock::~PassClock() {
    if (*pool_) device_.retire(std::move(pool_));
}

void PassClock::start(vk::CommandBuffer commands) {
    if (!*pool_) return;
    names_.clear();
    commands.resetQueryPool(*pool_, 0, Most);
    commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *pool_, 0);
}

void PassClock::mark(vk::CommandBuffer commands, const char* name) {
    if (!*pool_ || names_.size() + 1 >= Most) return;
    names_.emplace_back(name);
    commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *pool_,
                            static_cast<std::uint32_t>(names_.size()));
}

std::vector<std::pair<std::string, double>> PassClock::read() {
    std::vector<std::pair<std::string, double>> times;
    if (!*pool_ || names_.empty()) return times;
    const std::size_t count = names_.size() + 1;
    const auto [result, stamps] = pool_.getResults<std::uint64_t>(0, static_cast<std::uint32_t>(count),
                                                                  count * 8, 8, vk::QueryResultFlagBits::e64);
    if (result != vk::Result::eSuccess) return times;
    for (std::size_t i = 0; i < names_.size(); ++i)
        times.emplace_back(
            names_[i], static_cast<double>(stamps[i + 1] - stamps[i]) * device_.info().timestamp_ns * 1e-6);
    return times;
}

void FrameRecorder::run(const vulkan::ComputePipeline& pipeline, std::uint32_t groups) {
    const std::array<vk::DescriptorSet, 1> sets{workspace_.set()};
    pipeline.bind(commands_, sets);
    commands_.dispatch(groups, 1, 1);
}

void FrameRecorder::record(vk::CommandBuffer commands, const FramePlan& plan,
                           std::span<const SceneChunk> chunks) {
    commands_ = commands;
    vulkan::full_barrier(commands);  // the last picture's work is over before its memory is used again
    clock_.start(commands);
    commands.updateBuffer<shaders::FrameData>(workspace_.buffer(Workspace::Frame).handle(), 0, plan.data);
    commands.fillBuffer(workspace_.buffer(Workspace::Control).handle(), 0, VK_WHOLE_SIZE, 0);
    vulkan::full_barrier(commands);
    project(plan, chunks);
    clock_.mark(commands, "project");
    sort(plan);
    clock_.mark(commands, "sort");
    bin(plan);
    blend(plan);
    clock_.mark(commands, "blend");
}

vk::raii::DescriptorSet FrameRecorder::chunk_set(const SceneChunk& chunk) {
    auto set = device_.make_set(passes_.chunk_layout());
    const std::array<vk::BufferView, 3> views{chunk.geometry->view(), chunk.harmonics->view(),
                                              chunk.values ? chunk.values->view() : chunk.geometry->view()};
    std::vector<vk::WriteDescriptorSet> writes;
    for (std::uint32_t i = 0; i < views.size(); ++i) {
        vk::WriteDescriptorSet write(*set, i, 0, 1, vk::DescriptorType::eUniformTexelBuffer);
        write.pTexelBufferView = &views[i];
        writes.push_back(write);
    }
    device_.handle().updateDescriptorSets(writes, {});
    return set;
}

void FrameRecorder::project(const FramePlan& plan, std::span<const SceneChunk> chunks) {
    const auto& pipeline =
        passes_.get(Pass::Project, {static_cast<std::uint32_t>(sh_coefficient_count(plan.stored_degree)),
                                    static_cast<std::uint32_t>(sh_coefficient_count(plan.used_degree)),
                                    static_cast<std::uint32_t>(plan.mode)});
    for (const auto& chunk : chunks) {
        auto set = chunk_set(chunk);
        const std::array<vk::DescriptorSet, 2> sets{workspace_.set(), *set};
        pipeline.bind(commands_, sets);
        const std::array<std::uint32_t, 4> push{static_cast<std::uint32_t>(chunk.first),
                                                static_cast<std::uint32_t>(chunk.count),
                                                word(plan.has_values && chunk.values), 0};
        pipeline.push(commands_, push);
        commands_.dispatch(groups_of(chunk.count, shaders::ProjectGroup), 1, 1);
        device_.retire(std::move(set));
    }
}

void FrameRecorder::scan(std::uint32_t entries, std::uint32_t total_place, const Division& division) {
    const std::uint32_t block_groups = groups_of(groups_of(entries, shaders::ScanBlock), division.group);
    const std::array<std::uint32_t, 4> push{entries, total_place, 0, 0};
    const auto step = [&](Pass pass, std::uint32_t groups) {
        const auto& pipeline = passes_.get(
            pass, pass == Pass::ScanSpine ? std::vector<std::uint32_t>{} : std::vector{division.group});
        vulkan::compute_barrier(commands_);
        pipeline.push(commands_, push);
        run(pipeline, groups);
    };
    step(Pass::ScanBlocks, block_groups);
    step(Pass::ScanSpine, 1);
    step(Pass::ScanApply, block_groups);
    vulkan::compute_barrier(commands_);
}

void FrameRecorder::sort(const FramePlan& plan) {
    const Division& division = plan.division;
    const auto matrix = workspace_.buffer(Workspace::Matrix).handle();
    const std::uint32_t entries = division.sort_parts << division.digit_bits;
    const std::uint32_t groups = groups_of(division.sort_parts, division.group);
    for (std::uint32_t pass = 0; pass < division.sort_passes(); ++pass) {
        vulkan::compute_barrier(commands_);
        commands_.fillBuffer(matrix, 0, std::uint64_t{entries} * 4, 0);
        vulkan::compute_barrier(commands_);
        const std::vector<std::uint32_t> constants{division.group, pass, division.digit_bits};
        run(passes_.get(Pass::SortCount, constants), groups);
        // Only the first total is wanted: how many are drawn.
        scan(entries, pass == 0 ? shaders::ControlVisible : shaders::ControlWords - 1, division);
        run(passes_.get(Pass::SortScatter, constants), groups);
    }
}

void FrameRecorder::bin_rounds(const Division& division, const vulkan::ComputePipeline& pipeline) {
    const std::uint32_t rounds = std::max(division.bin_rounds, 1u);
    for (std::uint32_t round = 0; round < rounds; ++round) {
        if (round > 0) vulkan::compute_barrier(commands_);
        const std::array<std::uint32_t, 4> push{round, rounds, 0, 0};
        pipeline.push(commands_, push);
        run(pipeline, groups_of(division.bin_parts, division.group));
    }
}

void FrameRecorder::bin(const FramePlan& plan) {
    const Division& division = plan.division;
    const std::uint32_t entries = plan.data.size.z * plan.data.size.w * division.bin_parts;
    const std::vector<std::uint32_t> constants{division.group, division.tile, division.sort_passes() % 2,
                                               static_cast<std::uint32_t>(plan.mode)};
    vulkan::compute_barrier(commands_);
    commands_.fillBuffer(workspace_.buffer(Workspace::Matrix).handle(), 0, std::uint64_t{entries} * 4, 0);
    vulkan::compute_barrier(commands_);
    bin_rounds(division,
               passes_.get(division.bin_rounds > 0 ? Pass::BinCountLimited : Pass::BinCount, constants));
    clock_.mark(commands_, "bin count");
    scan(entries, shaders::ControlPairs, division);
    clock_.mark(commands_, "bin scan");
    bin_rounds(division,
               passes_.get(division.bin_rounds > 0 ? Pass::BinPlaceLimited : Pass::BinPlace, constants));
    vulkan::compute_barrier(commands_);
    clock_.mark(commands_, "bin place");
}

void FrameRecorder::blend(const FramePlan& plan) {
    workspace_.picture().transition(commands_, vk::ImageLayout::eGeneral);
    const auto& pipeline =
        passes_.get(plan.portable ? Pass::BlendPortable : Pass::Blend, blend_constants(plan));
    const std::array<vk::DescriptorSet, 1> sets{workspace_.set()};
    pipeline.bind(commands_, sets);
    commands_.dispatch(plan.data.size.z, plan.data.size.w, 1);
    workspace_.picture().transition(commands_, vk::ImageLayout::eShaderReadOnlyOptimal);
}

void FrameRecorder::record_pick(vk::CommandBuffer commands, const FramePlan& plan, std::uint32_t x,
                                std::uint32_t y) {
    commands_ = commands;
    const auto& pipeline =
        passes_.get(Pass::Pick, {static_cast<std::uint32_t>(plan.mode), plan.division.tile});
    vulkan::full_barrier(commands);
    const std::array<std::uint32_t, 4> push{x, y, 0, 0};
    pipeline.push(commands, push);
    run(pipeline, 1);
    vulkan::full_barrier(commands);
}

}  // namespace gse::preview
