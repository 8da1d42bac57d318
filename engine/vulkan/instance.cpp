// Creates the Vulkan instance and counts the messages of the validation layers.
#include <cstdlib>
#include <cstring>

#include "engine/base/log.h"
#include "engine/vulkan/device.h"

// Functions for the handles without RAII (command buffers, mostly); found at run time.
VULKAN_HPP_DEFAULT_DISPATCH_LOADER_DYNAMIC_STORAGE

namespace gse::vulkan {
namespace {

constexpr const char* ValidationLayer = "VK_LAYER_KHRONOS_validation";

bool environment_asks() {
    const char* value = std::getenv("GSE_VULKAN_VALIDATION");
    return value != nullptr && *value != 0 && std::strcmp(value, "0") != 0;
}

bool has_layer(const vk::raii::Context& context) {
    for (const auto& layer : context.enumerateInstanceLayerProperties())
        if (std::strcmp(layer.layerName, ValidationLayer) == 0) return true;
    return false;
}

}  // namespace

Instance::Instance(const InstanceOptions& options) {
    try {
        context_.emplace();
    } catch (const std::exception&) {
        throw Error(
            ErrorCode::NotFound, "there is no Vulkan library on this machine",
            "install libvulkan1 and a driver (mesa-vulkan-drivers has one that needs no graphics card)");
    }
    guarded("connecting to Vulkan", [&] { create(options); });
}

void Instance::create(const InstanceOptions& options) {
    std::vector<const char*> extensions, layers;
    for (const auto& extension : options.extensions) extensions.push_back(extension.c_str());
    const bool wanted = options.validation || environment_asks();
    validates_ = wanted && has_layer(*context_);
    if (wanted && !validates_)
        log::warning("Vulkan's validation layer is not installed (package vulkan-validationlayers)");
    if (validates_) {
        layers.push_back(ValidationLayer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    const vk::ApplicationInfo application("GSEditPro", 1, "GSEditPro", 1, VK_API_VERSION_1_2);
    vk::InstanceCreateInfo info({}, &application, layers, extensions);
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    const vk::DebugUtilsMessengerCreateInfoEXT messenger(
        {}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, &on_message, this);
    if (validates_) info.pNext = &messenger;
    instance_.emplace(*context_, info);
    VULKAN_HPP_DEFAULT_DISPATCHER.init(static_cast<VkInstance>(**instance_),
                                       context_->getDispatcher()->vkGetInstanceProcAddr);
    if (validates_) messenger_.emplace(*instance_, messenger);
}

VkBool32 VKAPI_PTR Instance::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                        VkDebugUtilsMessageTypeFlagsEXT,
                                        const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& self = *static_cast<Instance*>(user);
    ++self.message_count_;
    {
        const std::lock_guard lock(self.message_lock_);
        if (self.first_message_.empty()) self.first_message_ = data->pMessage;
    }
    log::warning("Vulkan validation: {}", data->pMessage);
    return VK_FALSE;
}

std::string Instance::first_message() const {
    const std::lock_guard lock(message_lock_);
    return first_message_;
}

}  // namespace gse::vulkan
