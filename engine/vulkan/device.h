// Vulkan instance and device: choice of the device, one queue, submission by serial number. Objects are
// destroyed once the device no longer uses them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <typeindex>
#include <unordered_map>
#include <utility>
#include <vector>

#include <vulkan/vulkan_raii.hpp>

#include "engine/vulkan/error.h"

namespace gse::vulkan {

struct InstanceOptions {
    std::vector<std::string> extensions;  // of the window system
    bool validation = false;  // also switched on by GSE_VULKAN_VALIDATION=1; ignored if not installed
};

/// Connection to the Vulkan library. Throws Error{NotFound} if there is none.
class Instance {
public:
    explicit Instance(const InstanceOptions& options = {});

    vk::raii::Instance& handle() { return *instance_; }
    bool validates() const { return validates_; }
    /// Messages of the validation layers (warnings and errors) so far.
    std::size_t message_count() const { return message_count_; }
    std::string first_message() const;

private:
    static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                         VkDebugUtilsMessageTypeFlagsEXT types,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user);
    void create(const InstanceOptions& options);

    std::atomic<std::size_t> message_count_{0};
    mutable std::mutex message_lock_;
    std::string first_message_;
    bool validates_ = false;
    std::optional<vk::raii::Context> context_;
    std::optional<vk::raii::Instance> instance_;
    std::optional<vk::raii::DebugUtilsMessengerEXT> messenger_;
};

struct DeviceOptions {
    std::string choice;                     // index or part of the name; GSE_VULKAN_DEVICE if empty
    VkSurfaceKHR surface = VK_NULL_HANDLE;  // what it must be able to present to
};

/// Properties of a device for the rest of the program.
struct DeviceInfo {
    std::string name;
    bool is_cpu = false;
    std::uint32_t subgroup_size = 1;
    bool subgroup_vote_and_broadcast = false;  // in compute shaders
    bool subgroup_arithmetic = false;          // in compute shaders
    std::uint64_t storage_range = 0;           // bytes of one storage-buffer binding
    std::uint32_t texel_elements = 0;          // of one texel buffer
    std::uint32_t image_size = 0;              // pixels a side
    double timestamp_ns = 0;                   // 0 = no timestamps
};

class Device {
public:
    /// Opens the chosen device. Without a choice: discrete GPU before integrated before others before CPU.
    Device(Instance& instance, const DeviceOptions& options = {});
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    Instance& instance() { return instance_; }
    vk::raii::Device& handle() { return *device_; }
    vk::raii::PhysicalDevice& physical() { return *physical_; }
    vk::raii::Queue& queue() { return *queue_; }
    std::uint32_t queue_family() const { return queue_family_; }
    vk::raii::PipelineCache& pipeline_cache() { return *pipeline_cache_; }
    const DeviceInfo& info() const { return info_; }

    struct Submission {
        vk::CommandBuffer commands;
        vk::Semaphore wait{};  // waited for at `wait_stage`
        vk::PipelineStageFlags wait_stage{};
        vk::Semaphore signal{};
    };
    /// Hands work recorded after begin_commands() to the queue and returns its serial number.
    std::uint64_t submit(const Submission& work);
    bool finished(std::uint64_t serial);
    /// Serial number of everything submitted or being recorded now. 0 while commands are still being
    /// recorded.
    using Ticket = std::shared_ptr<std::uint64_t>;
    Ticket ticket();
    bool finished(const Ticket& ticket) { return ticket && *ticket != 0 && finished(*ticket); }
    void wait(std::uint64_t serial);
    void wait_idle();

    /// Command buffer ready for recording (one-time submit). Give it back after submit() with recycle() and
    /// its serial, or unsubmitted with discard().
    vk::raii::CommandBuffer begin_commands();
    void recycle(vk::raii::CommandBuffer commands, std::uint64_t serial);
    void discard(vk::raii::CommandBuffer commands);
    /// Records body(commands), submits it and waits.
    template <class Body> void run(Body&& body);

    /// Destroys `object` once all commands submitted or being recorded now have been executed.
    template <class Object> void retire(Object object);
    /// Destroys objects that are no longer used. Called by submit().
    void collect();

    /// Descriptor set of a layout, freed with retire().
    vk::raii::DescriptorSet make_set(vk::DescriptorSetLayout layout);
    std::uint32_t memory_type(std::uint32_t allowed, vk::MemoryPropertyFlags wanted,
                              vk::MemoryPropertyFlags required) const;
    void name(vk::ObjectType type, std::uint64_t handle, const char* text);

    /// The one T of this device (pipelines that several users share). Made on demand; lives as long as the
    /// device.
    template <class T> T& shared() {
        auto& slot = shared_[std::type_index(typeid(T))];
        if (!slot) slot = std::make_shared<T>(*this);
        return *static_cast<T*>(slot.get());
    }

    /// Makes the next submission report a lost device, for tests of recovery.
    void pretend_lost() { pretend_lost_ = true; }

private:
    struct Retired {
        Ticket last_use;
        std::shared_ptr<void> object;
    };
    void close_recording();
    void choose(const DeviceOptions& options);
    void create();
    void read_info();
    std::optional<std::uint32_t> presenting_family(const vk::raii::PhysicalDevice& candidate,
                                                   VkSurfaceKHR surface) const;

    Instance& instance_;
    DeviceInfo info_;
    std::optional<vk::raii::PhysicalDevice> physical_;
    std::uint32_t queue_family_ = 0;
    bool has_surface_ = false, pretend_lost_ = false;
    vk::PhysicalDeviceMemoryProperties memory_;
    std::optional<vk::raii::Device> device_;
    std::optional<vk::raii::Queue> queue_;
    std::optional<vk::raii::PipelineCache> pipeline_cache_;
    std::optional<vk::raii::CommandPool> command_pool_;
    std::optional<vk::raii::DescriptorPool> descriptor_pool_;
    std::vector<vk::raii::DescriptorPool> full_pools_;
    std::optional<vk::raii::Semaphore> timeline_;
    std::uint64_t submitted_ = 0, completed_ = 0;
    std::size_t open_recordings_ = 0;
    Ticket open_ticket_;  // of everything that ends when no recording is open any more
    std::vector<std::pair<std::uint64_t, vk::raii::CommandBuffer>> recycled_;
    std::unordered_map<std::type_index, std::shared_ptr<void>> shared_;
    std::vector<Retired> retired_;  // dies first of all
};

template <class Body> void Device::run(Body&& body) {
    guarded("running commands", [&] {
        vk::raii::CommandBuffer commands = begin_commands();
        std::uint64_t serial = 0;
        try {
            body(commands);
            commands.end();
            serial = submit({.commands = *commands});
        } catch (...) {
            discard(std::move(commands));
            throw;
        }
        recycle(std::move(commands), serial);
        wait(serial);
    });
}

template <class Object> void Device::retire(Object object) {
    retired_.push_back({ticket(), std::make_shared<Object>(std::move(object))});
}

}  // namespace gse::vulkan
