// Libraries of the program that are loaded when they are needed. Loading them takes longer than most
// commands.
#pragma once

#include <filesystem>

namespace gse {

struct PluginName {
    const char* file;      // "libgse_neural.so"
    const char* entry;     // of the function that is called first
    const char* what;      // "the networks' library"
    const char* missing;   // said where it is not there: what this build cannot do
    const char* built_by;  // and how to build what can
    const char* needs;     // said where it cannot be loaded: what it needs
};

/// Path of a library beside the program, above it (tests: up to two folders) or in ../lib/gseditpro. Empty if
/// there is none.
std::filesystem::path find_plugin(const char* file);

/// Loads the library and finds its entry point. Throws Error (NotFound, Foreign).
void* load_plugin(const PluginName& name);

}  // namespace gse
