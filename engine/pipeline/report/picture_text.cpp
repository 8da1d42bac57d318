// Settings as one line of text.
#include "engine/pipeline/report/picture_text.h"

#include <filesystem>
#include <set>
#include <string_view>

#include "engine/base/json.h"

namespace gse::pipeline {
namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const Json& value) {
    if (!value.is_string()) return json_text(value);
    const auto& text = value.get_ref<const std::string&>();
    const bool plain = !text.empty() && text.find_first_of(",:\"\r\n") == std::string::npos;
    return plain ? text : json_text(value);
}

void append_pair(std::string& line, std::string_view name, const Json& value) {
    if (!line.empty()) line += ", ";
    line.append(name).append(": ").append(value_text(value));
}

/// Settings that differ from the program's own, but for those that are told anyway.
template <class P>
void append_changed(std::string& line, const P& parameters, const std::set<std::string>& told) {
    const Json now = fields_to_json(parameters), usual = fields_to_json(P{});
    for (const auto& [name, value] : now.items())
        if (!told.contains(name) && value != usual.at(name)) append_pair(line, name, value);
}

}  // namespace

std::string parameters_text(const EditRecipe& recipe) {
    const auto& request = recipe.request;
    const std::filesystem::path model(recipe.job.model);
    std::string line;
    append_pair(line, "Source", request.source);
    append_pair(line, "Seed", request.seed);
    append_pair(line, "Model", model.empty() ? std::string("starter") : model.filename().string());
    append_changed(line, request, {"prompt", "source", "seed"});
    append_changed(line, recipe.guidance, {});
    append_changed(line, recipe.attention, {});
    if (!recipe.job.lora.empty()) append_pair(line, "LoRA", recipe.job.lora);
    if (recipe.use_dreambooth) append_pair(line, "Dreambooth", true);
    return request.prompt + "\n" + line;
}

PngText picture_text(const EditRecipe& recipe, const Json& recipe_json) {
    return {{"Recipe", json_text(recipe_json)},
            {"Software", "GSEditPro"},
            {"parameters", parameters_text(recipe)}};
}

}  // namespace gse::pipeline
