// One device with validation for all tests of the preview; a machine without one skips, in CI fails.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/vulkan/device.h"
#include "tests/test_paths.h"

namespace gse::test {

struct TestDevice {
    std::optional<vulkan::Instance> instance;
    std::optional<vulkan::Device> device;
};

/// Null where there is no Vulkan device with validation: every case that asks counts as skipped, in CI as
/// failed.
inline TestDevice* test_device() {
    // Never destroyed: the driver's and the layers' own globals are gone before ours at the end of a program.
    static TestDevice& shared = *new TestDevice;
    static const std::string problem = []() -> std::string {
        try {
            vulkan::InstanceOptions options;
            options.validation = true;
            shared.instance.emplace(options);
            shared.device.emplace(*shared.instance);
            return shared.instance->validates() ? "" : "there is no Vulkan validation layer";
        } catch (const Error& error) { return error.what(); }
    }();
    if (problem.empty()) return &shared;
    skip_missing(problem);
    return nullptr;
}

}  // namespace gse::test
