// Choice and creation of the device, submission, deferred destruction.
#include "engine/vulkan/device.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>

#include "engine/base/log.h"

namespace gse::vulkan {
namespace {

constexpr std::uint32_t SetsPerPool = 256;

int rank(vk::PhysicalDeviceType type) {
    switch (type) {
        case vk::PhysicalDeviceType::eDiscreteGpu: return 0;
        case vk::PhysicalDeviceType::eIntegratedGpu: return 1;
        case vk::PhysicalDeviceType::eVirtualGpu: return 2;
        case vk::PhysicalDeviceType::eCpu: return 4;
        default: return 3;
    }
}

std::string lower(std::string text) {
    for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

bool is_chosen(const std::string& choice, std::size_t index, const std::string& name) {
    std::size_t number = 0;
    const auto [end, failure] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
    if (failure == std::errc() && end == choice.data() + choice.size()) return number == index;
    return lower(name).find(lower(choice)) != std::string::npos;
}

bool modern(const vk::raii::PhysicalDevice& candidate) {
    if (candidate.getProperties().apiVersion < VK_API_VERSION_1_2) return false;
    const auto features =
        candidate.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
    return features.get<vk::PhysicalDeviceVulkan12Features>().timelineSemaphore == VK_TRUE;
}

}  // namespace

Device::Device(Instance& instance, const DeviceOptions& options) : instance_(instance) {
    guarded("choosing a graphics device", [&] { choose(options); });
    guarded("opening the graphics device", [&] { create(); });
}

Device::~Device() {
    try {
        device_->waitIdle();
    } catch (const std::exception&) {  // lost: everything is destroyed all the same
    }
    shared_.clear();
    retired_.clear();
    recycled_.clear();
}

std::optional<std::uint32_t> Device::presenting_family(const vk::raii::PhysicalDevice& candidate,
                                                       VkSurfaceKHR surface) const {
    const auto families = candidate.getQueueFamilyProperties();
    const auto needed = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
    for (std::uint32_t family = 0; family < families.size(); ++family) {
        if ((families[family].queueFlags & needed) != needed) continue;
        if (surface == VK_NULL_HANDLE || candidate.getSurfaceSupportKHR(family, surface)) return family;
    }
    return std::nullopt;
}

void Device::choose(const DeviceOptions& options) {
    const char* environment = std::getenv("GSE_VULKAN_DEVICE");
    const std::string choice = !options.choice.empty() ? options.choice : environment ? environment : "";
    has_surface_ = options.surface != VK_NULL_HANDLE;
    int best = 100;
    std::string seen;
    auto candidates = instance_.handle().enumeratePhysicalDevices();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const auto properties = candidates[i].getProperties();
        const std::string name = properties.deviceName;
        seen += (seen.empty() ? "" : ", ") + std::to_string(i) + " " + name;
        if (!modern(candidates[i])) continue;
        const auto family = presenting_family(candidates[i], options.surface);
        if (!family) continue;
        const bool chosen = !choice.empty() && is_chosen(choice, i, name);
        if (!choice.empty() && !chosen) continue;
        if (rank(properties.deviceType) >= best) continue;
        best = rank(properties.deviceType);
        physical_.emplace(instance_.handle(), *candidates[i]);
        queue_family_ = *family;
    }
    if (physical_) return;
    if (!choice.empty())
        throw Error(ErrorCode::NotFound, "no usable Vulkan device matches \"" + choice + "\"",
                    "there are: " + (seen.empty() ? "none" : seen));
    throw Error(ErrorCode::NotFound, "there is no usable Vulkan 1.2 device",
                "install a graphics driver; mesa-vulkan-drivers has one that needs no graphics card");
}

void Device::read_info() {
    const auto all =
        physical_->getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>();
    const auto& properties = all.get<vk::PhysicalDeviceProperties2>().properties;
    const auto& subgroup = all.get<vk::PhysicalDeviceSubgroupProperties>();
    info_.name = properties.deviceName.data();
    info_.is_cpu = properties.deviceType == vk::PhysicalDeviceType::eCpu;
    info_.subgroup_size = subgroup.subgroupSize;
    const auto needed = vk::SubgroupFeatureFlagBits::eVote | vk::SubgroupFeatureFlagBits::eBallot;
    info_.subgroup_vote_and_broadcast = (subgroup.supportedStages & vk::ShaderStageFlagBits::eCompute) &&
                                        (subgroup.supportedOperations & needed) == needed;
    info_.subgroup_arithmetic = (subgroup.supportedStages & vk::ShaderStageFlagBits::eCompute) &&
                                (subgroup.supportedOperations & vk::SubgroupFeatureFlagBits::eArithmetic);
    info_.storage_range = properties.limits.maxStorageBufferRange;
    info_.texel_elements = properties.limits.maxTexelBufferElements;
    info_.image_size = properties.limits.maxImageDimension2D;
    info_.timestamp_ns =
        properties.limits.timestampComputeAndGraphics ? properties.limits.timestampPeriod : 0.0;
}

void Device::create() {
    read_info();
    memory_ = physical_->getMemoryProperties();
    const float priority = 1.0f;
    const vk::DeviceQueueCreateInfo queue({}, queue_family_, 1, &priority);
    std::vector<const char*> extensions;
    if (has_surface_) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    vk::PhysicalDeviceVulkan12Features features;
    features.timelineSemaphore = VK_TRUE;
    device_.emplace(*physical_, vk::DeviceCreateInfo({}, queue, {}, extensions, nullptr, &features));
    queue_.emplace(*device_, queue_family_, 0);
    pipeline_cache_.emplace(*device_, vk::PipelineCacheCreateInfo());
    const auto pool_flags =
        vk::CommandPoolCreateFlagBits::eResetCommandBuffer | vk::CommandPoolCreateFlagBits::eTransient;
    command_pool_.emplace(*device_, vk::CommandPoolCreateInfo(pool_flags, queue_family_));
    const vk::SemaphoreTypeCreateInfo timeline(vk::SemaphoreType::eTimeline, 0);
    timeline_.emplace(*device_, vk::SemaphoreCreateInfo({}, &timeline));
    name(vk::ObjectType::eQueue, reinterpret_cast<std::uint64_t>(static_cast<VkQueue>(**queue_)),
         "main queue");
}

std::uint64_t Device::submit(const Submission& work) {
    return guarded("handing it work", [&] {
        if (pretend_lost_) throw vk::DeviceLostError("as a test asked for");
        const std::uint64_t serial = submitted_ + 1;
        const vk::Semaphore signals[2] = {**timeline_, work.signal};
        const std::uint64_t signal_values[2] = {serial, 0}, wait_value = 0;
        const std::uint32_t signal_count = work.signal ? 2u : 1u, wait_count = work.wait ? 1u : 0u;
        const vk::TimelineSemaphoreSubmitInfo values(wait_count, &wait_value, signal_count, signal_values);
        const vk::SubmitInfo info(wait_count, &work.wait, &work.wait_stage, 1, &work.commands, signal_count,
                                  signals, &values);
        queue_->submit(info);
        submitted_ = serial;
        close_recording();
        collect();
        return serial;
    });
}

Device::Ticket Device::ticket() {
    if (open_recordings_ == 0) return std::make_shared<std::uint64_t>(std::max<std::uint64_t>(submitted_, 1));
    if (!open_ticket_) open_ticket_ = std::make_shared<std::uint64_t>(0);
    return open_ticket_;
}

void Device::close_recording() {
    if (--open_recordings_ > 0 || !open_ticket_) return;
    *open_ticket_ = std::max<std::uint64_t>(submitted_, 1);
    open_ticket_.reset();
}

void Device::discard(vk::raii::CommandBuffer) { close_recording(); }

bool Device::finished(std::uint64_t serial) {
    if (serial > completed_) completed_ = guarded("working", [&] { return timeline_->getCounterValue(); });
    return serial <= completed_;
}

void Device::wait(std::uint64_t serial) {
    if (finished(serial)) return;
    guarded("working", [&] {
        const vk::Semaphore semaphore = **timeline_;
        const vk::SemaphoreWaitInfo info({}, semaphore, serial);
        while (device_->waitSemaphores(info, 5'000'000'000ull) == vk::Result::eTimeout) {}
        completed_ = std::max(completed_, serial);
    });
    collect();
}

void Device::wait_idle() { wait(submitted_); }

vk::raii::CommandBuffer Device::begin_commands() {
    return guarded("recording commands", [&] {
        const auto free = std::find_if(recycled_.begin(), recycled_.end(),
                                       [&](const auto& entry) { return finished(entry.first); });
        std::optional<vk::raii::CommandBuffer> commands;
        if (free != recycled_.end()) {
            commands.emplace(std::move(free->second));
            recycled_.erase(free);
            commands->reset();
        } else {
            const vk::CommandBufferAllocateInfo info(**command_pool_, vk::CommandBufferLevel::ePrimary, 1);
            commands.emplace(std::move(device_->allocateCommandBuffers(info).front()));
        }
        commands->begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        ++open_recordings_;
        return std::move(*commands);
    });
}

void Device::recycle(vk::raii::CommandBuffer commands, std::uint64_t serial) {
    recycled_.emplace_back(serial, std::move(commands));
}

void Device::collect() {
    while (!retired_.empty()) {
        std::size_t kept = 0;
        std::vector<Retired> dying;  // destructors may retire more
        for (auto& entry : retired_) {
            if (finished(entry.last_use)) dying.push_back(std::move(entry));
            else retired_[kept++] = std::move(entry);
        }
        retired_.resize(kept);
        if (dying.empty()) return;
    }
}

vk::raii::DescriptorSet Device::make_set(vk::DescriptorSetLayout layout) {
    return guarded("binding resources", [&] {
        for (int attempt = 0;; ++attempt) {
            if (descriptor_pool_) {
                try {
                    const vk::DescriptorSetAllocateInfo info(**descriptor_pool_, layout);
                    return std::move(vk::raii::DescriptorSets(*device_, info).front());
                } catch (const vk::OutOfPoolMemoryError&) {
                    if (attempt > 0) throw;
                } catch (const vk::FragmentedPoolError&) {
                    if (attempt > 0) throw;
                }
                full_pools_.push_back(std::move(*descriptor_pool_));
            }
            const vk::DescriptorPoolSize sizes[] = {
                {vk::DescriptorType::eStorageBuffer, SetsPerPool * 8},
                {vk::DescriptorType::eUniformTexelBuffer, SetsPerPool * 4},
                {vk::DescriptorType::eUniformBuffer, SetsPerPool},
                {vk::DescriptorType::eStorageImage, SetsPerPool},
                {vk::DescriptorType::eCombinedImageSampler, SetsPerPool}};
            descriptor_pool_.emplace(
                *device_, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                       SetsPerPool, sizes));
        }
    });
}

std::uint32_t Device::memory_type(std::uint32_t allowed, vk::MemoryPropertyFlags wanted,
                                  vk::MemoryPropertyFlags required) const {
    for (const auto flags : {wanted | required, required})
        for (std::uint32_t type = 0; type < memory_.memoryTypeCount; ++type)
            if ((allowed >> type & 1u) != 0 && (memory_.memoryTypes[type].propertyFlags & flags) == flags)
                return type;
    throw Error(ErrorCode::Unsupported, "the graphics device has no memory of the kind needed",
                "try another device with GSE_VULKAN_DEVICE");
}

void Device::name(vk::ObjectType type, std::uint64_t handle, const char* text) {
    if (!instance_.validates() || handle == 0) return;
    device_->setDebugUtilsObjectNameEXT({type, handle, text});
}

}  // namespace gse::vulkan
