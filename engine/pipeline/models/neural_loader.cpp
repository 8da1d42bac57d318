// The networks' library, and what is counted and wanted whether it is loaded or not.
#include "engine/pipeline/models/neural_loader.h"

#include <atomic>

#include "engine/base/plugin.h"

namespace gse::pipeline {
namespace {

std::atomic<neural::Api*> loaded_api = nullptr;
std::atomic<int> wanted_threads = 1;
thread_local std::uint64_t cached_answers = 0;

constexpr PluginName Networks{"libgse_neural.so",           "gse_neural_api",
                              "the networks' library",      "this build has no networks",
                              "build with -DGSE_NEURAL=ON", "install libtorch1.13"};

}  // namespace

neural::Api& neural_api() {
    static neural::Api* const api = loaded_api =
        reinterpret_cast<neural::Api* (*)()>(load_plugin(Networks))();
    return *api;
}

std::filesystem::path neural_library() { return find_plugin(Networks.file); }

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
