// A model's profile in a recipe.
#include "engine/pipeline/models/model_settings.h"

#include "engine/neural/api/model_traits.h"
#include "engine/pipeline/models/installed.h"

namespace gse::pipeline {
namespace {

/// The name that a setting of the request has now.
std::string present_name(const std::string& field) {
    for (const auto& renamed : renamed_fields<edit::EditRequest>())
        if (field == renamed.before) return renamed.now;
    return field;
}

}  // namespace

#ifdef GSE_NEURAL
namespace {

std::filesystem::path path_of(const JobParameters& job) {
    return job.model.empty() ? starter_model_path() : std::filesystem::path(job.model);
}

}  // namespace

neural::ModelProfile profile_of(const JobParameters& job) {
    return neural::model_profile(path_of(job), neural::find_loras(job.lora));
}

edit::ModelTraits traits_of(const JobParameters& job) { return neural::model_traits(path_of(job)); }
#else
neural::ModelProfile profile_of(const JobParameters&) { return {}; }

edit::ModelTraits traits_of(const JobParameters&) { return {}; }
#endif

void apply_profile(const neural::ModelProfile& profile, EditRecipe& recipe,
                   const std::set<std::string>& set_by_user) {
    nlohmann::ordered_json stated = nlohmann::ordered_json::object();
    recipe.sources.clear();
    for (const auto& entry : profile.entries) {
        const auto field = entry.part == "request" ? present_name(entry.field) : entry.field;
        const auto name = entry.part + "." + field;
        if (set_by_user.contains(name)) continue;
        stated[entry.part][field] = entry.value;
        recipe.sources[name] = entry.source;
    }
    const auto set = [&](const char* part, auto& parameters) {
        if (stated.contains(part)) fields_from_json(parameters, stated[part]);
    };
    set("job", recipe.job);
    set("request", recipe.request);
    set("guidance", recipe.guidance);
    set("attention", recipe.attention);
    set("dreambooth", recipe.dreambooth);
    for (const auto& name : set_by_user) recipe.sources[name] = "user";
}

std::set<std::string> changed_settings(const EditRecipe& now, const EditRecipe& before) {
    std::set<std::string> names;
    const auto compare = [&](const std::string& part, const auto& value, const auto& other) {
        const auto values = fields_to_json(value), defaults = fields_to_json(other);
        for (const auto& [name, set] : values.items())
            if (set != defaults[name]) names.insert(part + "." + name);
    };
    compare("request", now.request, before.request);
    compare("dreambooth", now.dreambooth, before.dreambooth);
    compare("guidance", now.guidance, before.guidance);
    compare("attention", now.attention, before.attention);
    if (now.job.threads != before.job.threads) names.insert("job.threads");
    return names;
}

nlohmann::ordered_json settings_from(const EditRecipe& recipe) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    const auto parts = recipe_to_json(recipe);
    for (const auto& [part, fields] : parts.items()) {
        if (!fields.is_object()) continue;
        for (const auto& [field, value] : fields.items()) {
            const auto source = recipe.sources.find(part + "." + field);
            if (source != recipe.sources.end() && !value.is_null())
                list.push_back({{"field", source->first}, {"value", value}, {"source", source->second}});
        }
    }
    return list;
}

}  // namespace gse::pipeline
