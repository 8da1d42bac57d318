// Library that speaks to image servers, loaded on demand.
#include "engine/pipeline/models/remote_loader.h"

#include "engine/base/plugin.h"

namespace gse::pipeline {
namespace {

constexpr PluginName Servers{"libgse_remote.so",
                             "gse_remote_api",
                             "the library for image servers",
                             "this build asks no image servers",
                             "build with -DGSE_REMOTE=ON",
                             "install libcurl4"};

}  // namespace

remote::RemoteApi& remote_api() {
    static remote::RemoteApi* const api = reinterpret_cast<remote::RemoteApi* (*)()>(load_plugin(Servers))();
    return *api;
}

std::filesystem::path remote_library() { return find_plugin(Servers.file); }

}  // namespace gse::pipeline
