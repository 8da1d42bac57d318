// dlopen of the networks' library beside the program, above it (tests) or in ../lib/gseditpro.
#include "engine/pipeline/neural_loader.h"

#include <dlfcn.h>

#include <array>
#include <atomic>

#include "engine/base/error.h"

namespace gse::pipeline {
namespace {

std::atomic<neural::Api*> loaded_api = nullptr;
std::atomic<int> wanted_threads = 1;
thread_local std::uint64_t cached_answers = 0;

std::array<std::filesystem::path, 3> candidates() {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    return {program / "libgse_neural.so", program / "../libgse_neural.so", program / "../lib/gseditpro/libgse_neural.so"};
}

neural::Api* load() {
    const auto path = neural_library();
    if (path.empty())
        throw Error(ErrorCode::NotFound, "this build has no networks (libgse_neural.so is missing)",
                    "build with -DGSE_NEURAL=ON", candidates()[0]);
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        throw Error(ErrorCode::Foreign, std::string("the networks' library cannot be loaded (") + dlerror() + ")",
                    "install libtorch1.13", path);
    auto* entry = reinterpret_cast<neural::Api* (*)()>(dlsym(library, "gse_neural_api"));
    if (entry == nullptr)
        throw Error(ErrorCode::Foreign, "the networks' library has no entry point", "build it again", path);
    return entry();
}

}  // namespace

neural::Api& neural_api() {
    static neural::Api* const api = loaded_api = load();
    return *api;
}

std::filesystem::path neural_library() {
    for (const auto& candidate : candidates())
        if (std::filesystem::exists(candidate)) return candidate;
    return {};
}

void set_network_threads(int count) {
    wanted_threads = count;
    if (neural::Api* api = loaded_api) api->set_threads(count);
}

int network_threads() { return wanted_threads; }

neural::NetworkUse network_use() {
    const neural::Api* api = loaded_api;
    auto use = api != nullptr ? api->use() : neural::NetworkUse{};
    use.cached += cached_answers;
    return use;
}

void count_cached_answer() { ++cached_answers; }

}  // namespace gse::pipeline
