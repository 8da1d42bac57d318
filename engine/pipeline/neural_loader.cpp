// dlopen of the networks' library beside the program, above it (tests) or in ../lib/gseditpro.
#include "engine/pipeline/neural_loader.h"

#include <dlfcn.h>

#include <array>
#include <atomic>

#include "engine/base/error.h"

namespace gse::pipeline {
namespace {

std::atomic<neural::Api*> loaded_api = nullptr;

neural::Api* load() {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const std::array<std::filesystem::path, 3> candidates{program / "libgse_neural.so", program / "../libgse_neural.so",
                                                          program / "../lib/gseditpro/libgse_neural.so"};
    for (const auto& candidate : candidates) {
        if (!std::filesystem::exists(candidate)) continue;
        void* library = dlopen(candidate.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr)
            throw Error(ErrorCode::Foreign, std::string("the networks' library cannot be loaded (") + dlerror() + ")",
                        "install libtorch1.13", candidate);
        auto* entry = reinterpret_cast<neural::Api* (*)()>(dlsym(library, "gse_neural_api"));
        if (entry == nullptr)
            throw Error(ErrorCode::Foreign, "the networks' library has no entry point", "build it again", candidate);
        return entry();
    }
    throw Error(ErrorCode::NotFound, "this build has no networks (libgse_neural.so is missing)",
                "build with -DGSE_NEURAL=ON", candidates[0]);
}

}  // namespace

neural::Api& neural_api() {
    static neural::Api* const api = loaded_api = load();
    return *api;
}

neural::NetworkUse network_use() {
    const neural::Api* api = loaded_api;
    return api != nullptr ? api->use() : neural::NetworkUse{};
}

}  // namespace gse::pipeline
