// Bundled workflows lie with the program's assets.
#include "engine/remote/workflow/workflow_files.h"

#include "engine/base/assets.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/remote/api/server_settings.h"

namespace gse::remote {

Workflow load_workflow(const std::filesystem::path& name) {
    const auto path = is_bundled_workflow(name.string())
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
