// The driver's library, its functions by name, and the Device made of them.
#include "engine/raster/cuda/driver.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/printable.h"
#include "engine/raster/cuda/driver_functions.h"

namespace gse::raster::cuda {
namespace {

constexpr const char* UseCpu = "use the rasterizer \"cpu\"";
constexpr int LeastCapability = 6;  // of the PTX text
constexpr std::size_t LogBytes = 8192;

/// The opened library and its functions.
class Driver {
public:
    explicit Driver(const std::string& library) : handle_(dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL)) {
        if (handle_ == nullptr)
            throw Error(ErrorCode::NotFound,
                        fmt::format("there is no CUDA driver ({}) on this machine", library),
                        fmt::format("install NVIDIA's driver, or {}", UseCpu));
        try {
#define GSE_LOAD(member, name, parameters) find(name, member);
            GSE_DRIVER_FUNCTIONS(GSE_LOAD)
#undef GSE_LOAD
        } catch (...) {
            dlclose(handle_);
            throw;
        }
    }
    ~Driver() { dlclose(handle_); }
    Driver(const Driver&) = delete;
    Driver& operator=(const Driver&) = delete;

#define GSE_MEMBER_OF(member, name, parameters) DriverResult(*member) parameters = nullptr;
    GSE_DRIVER_FUNCTIONS(GSE_MEMBER_OF)
#undef GSE_MEMBER_OF

    /// Throws where `result` is an error; `what` completes "the CUDA driver cannot".
    void check(DriverResult result, const std::string& what) const {
        if (result == DriverSuccess) return;
        const char *name = nullptr, *text = nullptr;
        error_name(result, &name);
        error_text(result, &text);
        throw Error(
            ErrorCode::Foreign,
            fmt::format("the CUDA driver cannot {}: {} ({})", what, text != nullptr ? text : "unknown error",
                        name != nullptr ? name : std::to_string(result)),
            UseCpu);
    }

private:
    template <class Function> void find(const char* name, Function& to) {
        void* symbol = dlsym(handle_, name);
        if (symbol == nullptr)
            throw Error(ErrorCode::Unsupported, fmt::format("the CUDA driver is too old: it has no {}", name),
                        fmt::format("install a newer one, or {}", UseCpu));
        std::memcpy(&to, &symbol, sizeof to);
    }

    void* handle_;
};

/// Resources that are given back in this order, also when the constructor of the whole device fails half way.
class Context {
public:
    explicit Context(const std::string& library) : driver(library) {
        const DriverResult started = driver.init(0);
        int count = 0;
        if (started == DriverSuccess) driver.check(driver.device_count(&count), "count devices");
        else if (started != DriverNoDevice) driver.check(started, "start");
        if (count == 0)
            throw Error(ErrorCode::NotFound, "the CUDA driver finds no device on this machine", UseCpu);
        driver.check(driver.device(&device_, 0), "open its first device");
        std::array<char, 256> text{};
        driver.check(driver.device_name(text.data(), static_cast<int>(text.size()) - 1, device_),
                     "name its first device");
        name = printable(text.data());
        int major = 0, minor = 0;
        driver.check(driver.attribute(&major, DriverCapabilityMajor, device_), "describe its first device");
        driver.check(driver.attribute(&minor, DriverCapabilityMinor, device_), "describe its first device");
        if (major < LeastCapability)
            throw Error(ErrorCode::Unsupported,
                        fmt::format("{} has compute capability {}.{}, but the kernels need {}.0", name, major,
                                    minor, LeastCapability),
                        UseCpu);
        driver.check(driver.retain(&context_, device_), "open a context on " + name);
    }
    ~Context() {
        if (module_ != nullptr && driver.make_current(context_) == DriverSuccess) driver.unload(module_);
        driver.release(device_);
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Makes the device's context current. A rasterizer may be used on another thread than the one that made
    /// it.
    void enter() const { driver.check(driver.make_current(context_), "use " + name); }

    void load(const std::string& text) {
        enter();
        std::vector<char> log(LogBytes);
        int options[] = {DriverJitErrorLog, DriverJitErrorLogBytes};
        void* values[] = {log.data(), reinterpret_cast<void*>(static_cast<std::uintptr_t>(log.size() - 1))};
        const DriverResult result = driver.load(&module_, text.c_str(), 2, options, values);
        const std::string said = printable(std::string(log.data()).substr(0, 500));
        driver.check(result, "translate the kernels for " + name + (said.empty() ? "" : " (" + said + ")"));
        for (int i = 0; i < kernel_index::count; ++i)
            driver.check(driver.function(&functions[static_cast<std::size_t>(i)], module_, KernelNames[i]),
                         std::string("find the kernel ") + KernelNames[i]);
    }

    Driver driver;
    std::string name;
    std::array<DriverFunction*, kernel_index::count> functions{};

private:
    DriverDevice device_ = 0;
    DriverContext* context_ = nullptr;
    DriverModule* module_ = nullptr;
};

class DriverBackedDevice final : public Device {
public:
    explicit DriverBackedDevice(const std::string& library) : context_(library) {
        context_.load(kernel_text());
    }

    void* allocate(std::size_t bytes) override {
        context_.enter();
        DriverAddress address = 0;
        const DriverResult result = driver().allocate(&address, bytes);
        if (result == DriverOutOfMemory)
            throw Error(ErrorCode::Unsupported,
                        fmt::format("{} has no {} MiB of memory left", context_.name, (bytes >> 20) + 1),
                        "render smaller pictures, prune the scene, or use the rasterizer \"cpu\"");
        driver().check(result, "allocate memory");
        return reinterpret_cast<void*>(static_cast<std::uintptr_t>(address));
    }
    void release(void* memory) noexcept override {
        try {
            context_.enter();
        } catch (const Error&) {
            return;  // the context is gone, and the memory with it
        }
        driver().free(address_of(memory));
    }
    void upload(void* to, const void* from, std::size_t bytes) override {
        context_.enter();
        driver().check(driver().upload(address_of(to), from, bytes), "copy to " + context_.name);
    }
    void download(void* to, const void* from, std::size_t bytes) override {
        context_.enter();
        driver().check(driver().download(to, address_of(from), bytes), "copy from " + context_.name);
    }
    void fill(void* to, std::uint32_t word, std::size_t words) override {
        context_.enter();
        driver().check(driver().fill(address_of(to), word, words), "fill memory of " + context_.name);
    }
    std::string name() const override { return context_.name; }

protected:
    void run(int kernel, std::uint32_t blocks, const void* arguments, std::size_t) override {
        context_.enter();
        void* parameters[] = {const_cast<void*>(arguments)};  // it is only read
        driver().check(driver().launch(context_.functions[static_cast<std::size_t>(kernel)], blocks, 1, 1,
                                       BlockThreads, 1, 1, 0, nullptr, parameters, nullptr),
                       std::string("launch ") + KernelNames[kernel]);
    }

private:
    const Driver& driver() const { return context_.driver; }
    static DriverAddress address_of(const void* memory) { return reinterpret_cast<std::uintptr_t>(memory); }

    Context context_;
};

}  // namespace

std::unique_ptr<Device> open_cuda_device(const std::string& library) {
    if (kernel_text().empty())
        throw Error(ErrorCode::Unsupported, "this build has no CUDA kernels",
                    fmt::format("build it where clang is installed, or {}", UseCpu));
    return std::make_unique<DriverBackedDevice>(library);
}

}  // namespace gse::raster::cuda
