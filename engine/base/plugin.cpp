// Plug-ins through dlopen.
#include "engine/base/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>

#include "engine/base/error.h"

namespace gse {
namespace {

std::array<std::filesystem::path, 4> candidates(const char* file) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    return {program / file, program / ".." / file, program / "../.." / file,
            program / "../lib/gseditpro" / file};
}

}  // namespace

std::filesystem::path find_plugin(const char* file) {
    for (const auto& candidate : candidates(file))
        if (std::filesystem::exists(candidate)) return candidate;
    return {};
}

void* load_plugin(const PluginName& name) {
    const auto path = find_plugin(name.file);
    if (path.empty())
        throw Error(ErrorCode::NotFound, fmt::format("{} ({} is missing)", name.missing, name.file),
                    name.built_by, candidates(name.file)[0]);
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        throw Error(ErrorCode::Foreign, fmt::format("{} cannot be loaded ({})", name.what, dlerror()),
                    name.needs, path);
    if (void* entry = dlsym(library, name.entry)) return entry;
    throw Error(ErrorCode::Foreign, fmt::format("{} has no entry point", name.what), "build it again", path);
}

}  // namespace gse
