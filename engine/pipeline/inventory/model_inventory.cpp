// Walks through folders of models and identifies each file by its header.
#include "engine/pipeline/inventory/model_inventory.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <tuple>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/models/model_places.h"
#include "engine/remote/views/family.h"

namespace gse::pipeline {
namespace {

namespace fs = std::filesystem;
using neural::WeightPlace;
using neural::WeightRole;

constexpr int DeepestFolder = 8;
constexpr std::size_t MostEntries = 200'000;  // of folders that are looked at

bool is_weights_name(const fs::path& path) {
    return is_safetensors_name(path) || neural::is_gguf_name(path) || is_pickle_name(path);
}

bool is_model_folder(const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path / "model_index.json", ignored);
}

/// Families of servers' models that have the structure of weights; the first where the name tells nothing.
struct ServerFamilies {
    std::string_view weights;
    std::array<std::string_view, 3> families;
};
constexpr std::array<ServerFamilies, 8> KnownFamilies{
    {{"Stable Diffusion 1.x", {"sd15", "sd15-inpainting", "ip2p"}},
     {"Stable Diffusion 2.x", {"sd15", "sd15-inpainting"}},
     {"SDXL", {"sdxl", "sdxl-inpainting", "sdxl-distilled"}},
     {"FLUX.1", {"flux1", "flux1-fill", "kontext"}},
     {"FLUX.2", {"flux2", "flux2-klein", "flux2-klein-base"}},
     {"Qwen-Image", {"", "qwen-edit", "qwen-edit-plus"}},  // the plain one is no edit model
     {"Z-Image", {"z-image"}},
     {"Z-Image or Lumina 2", {"", "z-image"}}}};

/// Way in which a server's model of this kind and name is driven; empty = not known.
std::string server_family(const neural::WeightKind& kind, const fs::path& path) {
    if (kind.role != WeightRole::Checkpoint && kind.role != WeightRole::DiffusionModel) return {};
    const auto known = std::find_if(KnownFamilies.begin(), KnownFamilies.end(),
                                    [&](const auto& each) { return each.weights == kind.family; });
    if (known == KnownFamilies.end()) return {};
    const auto& families = known->families;
    if (kind.variant == "Fill") return "flux1-fill";
    if (kind.variant == "inpainting") return std::string(families[1]);
    const auto named = remote::family_of(path.stem().string()).name;
    const auto fitting = std::find(families.begin(), families.end(), named);
    return std::string(fitting != families.end() ? *fitting : families[0]);
}

void describe_weights(const fs::path& path, ModelFile& file) {
    const auto header = neural::read_weight_header(path);
    const auto kind = neural::weight_kind(header);
    file.kind = neural::kind_text(kind);
    file.use = neural::weight_use(kind);
    if (file.use.place == WeightPlace::Server) file.server_family = server_family(kind, path);
    if (header.missing_bytes > 0) {
        file.broken = true;
        file.use = {WeightPlace::Nowhere, "", "the file is cut off; download it again"};
    } else if (file.use.how == "--model") {
        const auto model = describe_model(path);  // looks for what it needs beside it
        if (!model.usable) file.use = {WeightPlace::Nowhere, "", model.problem};
    }
}

void describe_diffusers(const fs::path& path, ModelFile& file) {
    const auto model = describe_model(path);
    file.kind = model.structure + " folder";
    file.bytes = model.bytes;
    if (model.usable) file.use = {WeightPlace::Here, "--model"};
    else file.use = {WeightPlace::Nowhere, "", model.problem};
}

/// State of a walk through folders.
struct Walk {
    ModelInventory& inventory;
    const JobControl& job;
    std::set<fs::path> seen = {};  // canonical paths of files and folders
    std::size_t entries = 0;
};

bool first_time(const fs::path& path, Walk& walk) {
    std::error_code failure;
    const auto real = fs::canonical(path, failure);
    return !failure && walk.seen.insert(real).second;
}

void add_file(const fs::path& path, Walk& walk) {
    if (walk.inventory.files.size() >= MostListedFiles) {
        walk.inventory.cut_short = true;
        return;
    }
    if (first_time(path, walk)) walk.inventory.files.push_back(describe_model_file(path));
}

void walk_folder(const fs::path& folder, int depth, Walk& walk) {
    if (walk.job.stop_requested()) throw Error(ErrorCode::Cancelled, "the list of models was stopped");
    if (is_model_folder(folder)) return add_file(folder, walk);
    if (!first_time(folder, walk)) return;
    if (depth > DeepestFolder) {
        walk.inventory.cut_short = true;
        return;
    }
    std::error_code failure;
    for (fs::directory_iterator at(folder, fs::directory_options::skip_permission_denied, failure), end;
         !failure && at != end; at.increment(failure)) {
        if (++walk.entries > MostEntries) walk.inventory.cut_short = true;
        if (walk.entries > MostEntries) return;
        std::error_code ignored;
        const auto& path = at->path();
        if (path.filename().string().starts_with('.')) continue;
        if (at->is_directory(ignored)) walk_folder(path, depth + 1, walk);
        else if (is_weights_name(path) && at->is_regular_file(ignored)) add_file(path, walk);
    }
}

std::vector<ModelPlace> places_of(const std::vector<fs::path>& named) {
    if (named.empty()) return model_places();
    std::vector<ModelPlace> places;
    for (const auto& path : named) {
        std::error_code ignored;
        if (!fs::exists(path, ignored))
            throw Error(ErrorCode::NotFound, "there is no folder of models here", "name another folder",
                        path);
        for (auto& place : places_below(path)) places.push_back(std::move(place));
    }
    return places;
}

}  // namespace

ModelFile describe_model_file(const fs::path& path) {
    ModelFile file{path};
    std::error_code failure;
    try {
        if (fs::is_directory(path, failure)) {
            describe_diffusers(path, file);
            return file;
        }
        const auto bytes = fs::file_size(path, failure);
        if (!failure) file.bytes = bytes;
        if (neural::weight_format(path) == neural::WeightFormat::Pickle) {
            file.kind = "pickled weights";
            file.use.why = "pickled files are not opened; convert it to .safetensors";
            return file;
        }
        describe_weights(path, file);
    } catch (const Error& error) {
        file.broken = true;
        file.kind = "cannot be read";
        file.use = {WeightPlace::Nowhere, "", error.message()};
    } catch (const std::exception& error) {
        file.broken = true;
        file.kind = "cannot be read";
        file.use = {WeightPlace::Nowhere, "", error.what()};
    }
    return file;
}

ModelInventory list_models(const std::vector<fs::path>& named, const JobControl& job) {
    ModelInventory inventory;
    Walk walk{inventory, job};
    for (const auto& place : places_of(named)) {
        std::error_code ignored;
        const bool folder = fs::is_directory(place.folder, ignored);
        inventory.folders.push_back(
            {place.folder, place.program, folder || fs::exists(place.folder, ignored)});
        if (folder) walk_folder(place.folder, 0, walk);
        else if (fs::is_regular_file(place.folder, ignored)) add_file(place.folder, walk);
    }
    std::sort(inventory.files.begin(), inventory.files.end(),
              [](const ModelFile& one, const ModelFile& other) {
                  return std::tuple(one.path.parent_path(), one.path.filename()) <
                         std::tuple(other.path.parent_path(), other.path.filename());
              });
    return inventory;
}

}  // namespace gse::pipeline
