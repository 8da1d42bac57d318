// Sentences on files of weights, by their kind and use.
#include "engine/pipeline/inventory/no_scene.h"

#include <fmt/format.h>

#include <string>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"
#include "engine/neural/api/files/weight_header.h"
#include "engine/pipeline/inventory/model_inventory.h"

namespace gse::pipeline {
namespace {

namespace fs = std::filesystem;
using neural::WeightFormat;
using neural::WeightPlace;

/// Format of weights that the content or the name of a file says; Other for files of other kinds.
WeightFormat format_in_place_of_scene(const fs::path& path) {
    if (is_safetensors_name(path)) return WeightFormat::Safetensors;
    if (neural::is_gguf_name(path)) return WeightFormat::Gguf;
    if (is_pickle_name(path) && neural::weight_format(path) == WeightFormat::Pickle)
        return WeightFormat::Pickle;
    return WeightFormat::Other;
}

[[noreturn]] void refuse(const std::string& message, const std::string& hint, const fs::path& path) {
    throw Error(ErrorCode::InvalidArgument, message, hint, path);
}

/// Way to use weights that are loaded here.
std::string option_hint(const std::string& option) {
    const bool window = option == "--model" || option == "--lora";
    if (!option.starts_with("--"))
        return "put it beside the checkpoint that it belongs to, as NAME.vae.safetensors";
    return fmt::format("edit SCENE takes it with {}{}", option,
                       window ? ", and the window in its panel Models, or dropped on it"
                       : option == "--text-segmenter" ? ", as the folder that it lies in"
                                                      : "");
}

[[noreturn]] void refuse_described(const ModelFile& file, const fs::path& path) {
    if (file.broken)
        refuse(fmt::format("by its name this is a file of weights, not a scene, and {}",
                           file.use.why.empty() ? "it cannot be read" : file.use.why),
               "download it again", path);
    const auto message = fmt::format("this holds weights, not a scene: {}", file.kind);
    switch (file.use.place) {
        case WeightPlace::Here: refuse(message, option_hint(file.use.how), path);
        case WeightPlace::Server:
            refuse(fmt::format("{}, which is not loaded here ({})", message, file.use.why),
                   "edit SCENE can draw with it through an image server that has it (--server URL)", path);
        case WeightPlace::Nowhere: break;
    }
    refuse(fmt::format("{}, which cannot be used ({})", message, file.use.why),
           "\"gseditpro models\" lists what can be used here", path);
}

}  // namespace

void refuse_weights(const fs::path& path) {
    std::error_code ignored;
    const auto adapter = path / "adapter_model.safetensors";
    if (fs::is_directory(path, ignored)) {
        if (fs::is_regular_file(adapter, ignored)) refuse_described(describe_model_file(adapter), path);
        if (fs::is_regular_file(path / "model_index.json", ignored))
            refuse_described(describe_model_file(path), path);
        return;
    }
    if (!fs::is_regular_file(path, ignored)) return;
    const auto format = format_in_place_of_scene(path);
    if (format == WeightFormat::Pickle)
        refuse("this holds pickled data of torch, which can run programs and is not opened",
               "export splats as PLY where they were trained, convert a model to .safetensors, or name a SAM "
               "with --segmenter",
               path);
    if (format != WeightFormat::Other) refuse_described(describe_model_file(path), path);
}

}  // namespace gse::pipeline
