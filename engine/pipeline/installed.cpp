// The one file of the program that depends on where the checkout is.
#include "engine/pipeline/installed.h"

namespace gse::pipeline {

std::filesystem::path assets_path() {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const auto installed = program / "../share/gseditpro";
    return std::filesystem::exists(installed) ? installed : std::filesystem::path(GSE_ASSETS);
}

std::filesystem::path starter_model_path() { return assets_path() / "models/starter"; }

}  // namespace gse::pipeline
