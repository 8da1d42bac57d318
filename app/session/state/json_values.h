// Values of settings and projects that may be missing or of another kind.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

}  // namespace gse::app
