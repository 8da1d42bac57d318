// The one file of the program that depends on where the checkout is.
#include "engine/pipeline/models/installed.h"

#include "engine/base/assets.h"

namespace gse::pipeline {

std::filesystem::path assets_path() { return assets_folder(GSE_ASSETS); }

std::filesystem::path starter_model_path() { return assets_path() / "models/starter"; }

std::filesystem::path guide_path() {
    const auto installed = assets_path() / "guide/index.html";
    std::error_code ignored;
    return std::filesystem::exists(installed, ignored) ? installed : GSE_BUILD "/guide/index.html";
}

}  // namespace gse::pipeline
