// Device choice, buffers, deferred destruction, errors; and that the validation counter counts.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstring>

#include "engine/base/log.h"
#include "engine/vulkan/resources.h"
#include "tests/agree/preview/device.h"

namespace device_test {

using namespace gse;

DOCTEST_TEST_CASE("bytes go to the device and come back") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    auto& device = *shared->device;
    const auto transfer = vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst;
    const vulkan::Buffer up(device, {.size = 1024, .usage = transfer, .home = vulkan::BufferHome::Upload});
    const vulkan::Buffer middle(device, {.size = 1024, .usage = transfer});
    const vulkan::Buffer back(device,
                              {.size = 1024, .usage = transfer, .home = vulkan::BufferHome::Readback});
    for (std::size_t i = 0; i < 256; ++i) up.as<std::uint32_t>()[i] = static_cast<std::uint32_t>(i * i);
    device.run([&](vk::raii::CommandBuffer& commands) {
        commands.copyBuffer(up.handle(), middle.handle(), vk::BufferCopy(0, 0, 1024));
        vulkan::full_barrier(*commands);
        commands.copyBuffer(middle.handle(), back.handle(), vk::BufferCopy(0, 0, 1024));
        vulkan::full_barrier(*commands);
    });
    DOCTEST_CHECK(std::memcmp(up.mapped(), back.mapped(), 1024) == 0);
    DOCTEST_CHECK(shared->instance->message_count() == 0);
}

DOCTEST_TEST_CASE("what is retired lives until the recordings that may use it are executed") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    auto& device = *shared->device;
    auto alive = std::make_shared<int>(1);
    const std::weak_ptr<int> watch = alive;
    auto outer = device.begin_commands();
    const auto ticket = device.ticket();
    device.retire(std::move(alive));
    device.run([](vk::raii::CommandBuffer&) {});  // another submission comes and goes
    device.collect();
    DOCTEST_CHECK(!watch.expired());
    DOCTEST_CHECK(!device.finished(ticket));
    outer.end();
    const auto serial = device.submit({.commands = *outer});
    device.recycle(std::move(outer), serial);
    device.wait(serial);
    device.collect();
    DOCTEST_CHECK(watch.expired());
    DOCTEST_CHECK(device.finished(ticket));
}

DOCTEST_TEST_CASE("a device that does not exist is named in the error") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    try {
        vulkan::Device none(*shared->instance, {.choice = "no such device"});
        DOCTEST_FAIL("found a device that is not there");
    } catch (const Error& error) {
        DOCTEST_CHECK(error.code() == ErrorCode::NotFound);
        DOCTEST_CHECK(error.message().find("no such device") != std::string::npos);
    }
    const vulkan::Device by_index(*shared->instance, {.choice = "0"});
    DOCTEST_CHECK(!by_index.info().name.empty());
}

DOCTEST_TEST_CASE("a lost device has its own error, and work can be recorded again afterwards") {
    auto* shared = test::test_device();
    if (shared == nullptr) return;
    vulkan::Device device(*shared->instance);
    device.pretend_lost();
    DOCTEST_CHECK_THROWS_AS(device.run([](vk::raii::CommandBuffer&) {}), vulkan::DeviceLost);
}

DOCTEST_TEST_CASE("the validation layers are listened to") {
    if (test::test_device() == nullptr) return;
    vulkan::InstanceOptions options;
    options.validation = true;
    vulkan::Instance instance(options);  // its own: the shared one's messages are counted elsewhere
    vulkan::Device device(instance);
    log::set_level(log::Level::Off);
    const vulkan::Buffer useless(device, {.size = 16, .usage = {}});  // a buffer without any usage
    log::set_level(log::Level::Info);
    DOCTEST_CHECK(instance.message_count() > 0);
    DOCTEST_CHECK(!instance.first_message().empty());
}

}  // namespace device_test
