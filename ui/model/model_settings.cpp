// Model settings in projects.
#include "ui/model/model_settings.h"

#include <utility>

#include "engine/base/json.h"

namespace gse::ui {

nlohmann::ordered_json model_settings_to_json(const ModelSettings& settings) {
    auto json = fields_to_json(settings);
    ModelSettings::visit_parts(
        settings, [&](const char* name, const auto& part) { json[name] = fields_to_json(part); });
    return json;
}

ModelSettings model_settings_from_json(nlohmann::ordered_json json, ModelSettings settings) {
    // The first projects had two fields of the learning beside the others.
    for (const auto& [old, name] : {std::pair{"learn_steps", "steps"}, std::pair{"learn_rank", "rank"}}) {
        if (!json.contains(old)) continue;
        json["learning"][name] = json[old];
        json.erase(old);
    }
    ModelSettings::visit_parts(settings, [&](const char* name, auto& part) {
        if (json.contains(name)) fields_from_json(part, json[name]);
        json.erase(name);
    });
    fields_from_json(settings, json);
    return settings;
}

}  // namespace gse::ui
