// Values of settings and projects that may be missing or of another kind.
#pragma once

#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/fields.h"

namespace gse::app {

/// The text of a key; empty where there is none.
inline std::string text_of(const nlohmann::json& json, const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
}

/// The texts of a list; entries that are no text are passed over.
inline std::vector<std::string> texts_of(const nlohmann::json& json, const char* key) {
    std::vector<std::string> texts;
    if (json.contains(key) && json[key].is_array())
        for (const auto& entry : json[key])
            if (entry.is_string()) texts.push_back(entry.get<std::string>());
    return texts;
}

/// Settings of the window without those that belong to one scene or one moment.
inline nlohmann::ordered_json lasting(nlohmann::ordered_json fields) {
    for (auto field = fields.begin(); field != fields.end();) {
        const std::string& name = field.key();
        const bool passing = name == "mode" || name == "tint_labels" || name == "wipe" ||
                             name == "visible_only" || name.ends_with("_path");
        field = passing ? fields.erase(field) : std::next(field);
    }
    return fields;
}

/// Settings for another scene: those that belong to one scene or one moment are at their defaults.
template <class Settings> Settings for_another_scene(const Settings& settings) {
    Settings fresh;
    fields_from_json(fresh, lasting(fields_to_json(settings)));
    return fresh;
}

}  // namespace gse::app
