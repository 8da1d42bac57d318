// One device with validation for all tests of the preview; says so when there is none.
#pragma once

#include <cstdio>
#include <memory>
#include <optional>

#include "engine/vulkan/device.h"

namespace gse::test {

struct TestDevice {
    std::optional<vulkan::Instance> instance;
    std::optional<vulkan::Device> device;
};

/// Null (with a [skip] line) where there is no Vulkan device.
inline TestDevice* test_device() {
    // Never destroyed: the driver's and the layers' own globals are gone before ours at the end of a program.
    static TestDevice& shared = *new TestDevice;
    static const bool ready = [] {
        try {
            vulkan::InstanceOptions options;
            options.validation = true;
            shared.instance.emplace(options);
            shared.device.emplace(*shared.instance);
            if (!shared.instance->validates())
                std::printf("[skip] no validation layer: messages are not counted\n");
            return true;
        } catch (const Error& error) {
            std::printf("[skip] %s\n", error.what());
            shared.device.reset();
            return false;
        }
    }();
    return ready ? &shared : nullptr;
}

}  // namespace gse::test
