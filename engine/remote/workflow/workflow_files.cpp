// Bundled workflows lie with the program's assets.
#include "engine/remote/workflow/workflow_files.h"

#include <algorithm>
#include <array>

#include "engine/base/assets.h"
#include "engine/base/error.h"
#include "engine/base/file.h"

namespace gse::remote {
namespace {

constexpr std::array<const char*, 4> Bundled{"img2img", "inpainting", "edit", "edit_reference"};

}  // namespace

bool is_bundled_workflow(const std::filesystem::path& name) {
    return std::find(Bundled.begin(), Bundled.end(), name.string()) != Bundled.end();
}

Workflow load_workflow(const std::filesystem::path& name) {
    const auto path = is_bundled_workflow(name)
                          ? assets_folder(GSE_ASSETS) / "workflows" / (name.string() + ".json")
                          : name;
    return with_path(path, [&] { return read_workflow(FileBytes(path).text()); });
}

std::string bundled_workflow_for(const RedrawOrder& order, const std::string& wanted) {
    if (!order.references.empty()) return "edit_reference";
    if (wanted == "edit" || wanted == "edit_reference") return "edit";
    return order.mask.data.empty() ? "img2img" : "inpainting";
}

}  // namespace gse::remote
