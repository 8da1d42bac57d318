// Translation of Vulkan's exceptions.
#include "engine/vulkan/error.h"

#include <fmt/format.h>

#include <vulkan/vulkan_raii.hpp>

namespace gse::vulkan {

DeviceLost::DeviceLost(const std::string& during)
    : Error(ErrorCode::Foreign, fmt::format("the graphics device was lost while {}", during),
            "the view is being rebuilt; if it keeps happening, update the graphics driver or use --preview "
            "native") {}

void rethrow_as_error(const char* doing) {
    try {
        throw;
    } catch (const Error&) { throw; } catch (const vk::DeviceLostError&) {
        throw DeviceLost(doing);
    } catch (const vk::OutOfDeviceMemoryError&) {
        throw Error(ErrorCode::Foreign, fmt::format("the graphics device has no memory left while {}", doing),
                    "close other programs that use it, or open a smaller scene");
    } catch (const vk::OutOfHostMemoryError&) {
        throw Error(ErrorCode::Foreign, fmt::format("there is no memory left while {}", doing),
                    "close other programs, or open a smaller scene");
    } catch (const std::exception& failure) {
        throw Error(ErrorCode::Foreign,
                    fmt::format("the graphics device failed while {} ({})", doing, failure.what()),
                    "update the graphics driver, or install mesa-vulkan-drivers for a software device");
    }
}

}  // namespace gse::vulkan
