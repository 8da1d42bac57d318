// Translation of the Vulkan binding's exceptions into gse::Error. A lost device has its own type.
#pragma once

#include <utility>

#include "engine/base/error.h"

namespace gse::vulkan {

/// The graphics device is gone (driver reset, unplugged). Everything made on it must be made again.
class DeviceLost : public Error {
public:
    explicit DeviceLost(const std::string& during);
};

/// Turns the exception being handled into gse::Error or DeviceLost. `doing` completes "the graphics device
/// failed while ...".
[[noreturn]] void rethrow_as_error(const char* doing);

/// Calls body(), translating what it throws.
template <class Body> decltype(auto) guarded(const char* doing, Body&& body) {
    try {
        return std::forward<Body>(body)();
    } catch (...) { rethrow_as_error(doing); }
}

}  // namespace gse::vulkan
