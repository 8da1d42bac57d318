// Recipes as JSON, and what their stages depend on.
#include "engine/pipeline/recipe/recipe.h"

#include <fmt/format.h>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/path_text.h"
#include "engine/io/image/image_file.h"
#include "engine/neural/api/lora_spec.h"

namespace gse::pipeline {
namespace {

constexpr int RecipeVersion = 1;

using Json = nlohmann::ordered_json;

/// Adds what the networks are, and from where the scene is looked at.
void add_surroundings(ContentHash& hash, const JobParameters& job) {
    hash.texts({job.model, job.taesd, job.device, job.precision, job.cameras, job.up, job.front});
    hash.texts(job.lora);
}

/// "FILE:strength" with the file in that folder.
std::string lora_beside(const std::string& text, const std::filesystem::path& folder) {
    auto lora = neural::parse_lora(text);
    if (!lora.file.is_absolute()) lora.file = std::filesystem::weakly_canonical(folder / lora.file);
    return neural::lora_text(lora);
}

/// "VIEW=FILE" with the file in that folder.
std::string target_beside(const std::string& text, const std::filesystem::path& folder) {
    auto target = remote::target_picture_of(text);
    target.file = path_of_text(target.file.string());
    if (!target.file.is_absolute()) target.file = std::filesystem::weakly_canonical(folder / target.file);
    return target.view + "=" + target.file.string();
}

}  // namespace

nlohmann::ordered_json recipe_to_json(const EditRecipe& recipe) {
    nlohmann::ordered_json json;
    json["version"] = RecipeVersion;
    json["job"] = fields_to_json(recipe.job);
    for (auto& value : json["job"]) {
        if (value.is_string()) value = text_of_path(value.get<std::string>());
        if (value.is_array())
            for (auto& entry : value) entry = text_of_path(entry.get<std::string>());
    }
    json["request"] = fields_to_json(recipe.request);
    json["guidance"] = fields_to_json(recipe.guidance);
    const auto attention = fields_to_json(recipe.attention);
    if (attention != fields_to_json(neural::AttentionParameters{})) json["attention"] = attention;
    if (recipe.use_dreambooth) json["dreambooth"] = fields_to_json(recipe.dreambooth);
    if (recipe.server.used()) {
        json["server"] = fields_to_json(recipe.server);
        json["server"]["url"] = remote::without_secrets(recipe.server.url);
        for (auto& url : json["server"]["also"]) url = remote::without_secrets(url.get<std::string>());
        for (const char* file : {"workflow", "ca"})
            json["server"][file] = text_of_path(json["server"][file].get<std::string>());
        for (auto& target : json["server"]["target_picture"])
            target = text_of_path(target.get<std::string>());
    }
    return json;
}

void make_files_absolute(remote::ServerSettings& settings) {
    const auto absolute = [](const std::filesystem::path& file) {
        return std::filesystem::absolute(file).lexically_normal().string();
    };
    for (auto* file : {&settings.workflow, &settings.ca})
        if (!file->empty() && !remote::is_bundled_workflow(*file)) *file = absolute(*file);
    for (auto& text : settings.target_picture) {
        const auto target = remote::target_picture_of(text);
        text = target.view + "=" + absolute(target.file);
    }
}

EditRecipe recipe_from_json(const nlohmann::ordered_json& json, const std::filesystem::path& folder) {
    EditRecipe recipe;
    int version = 0;
    read_field("version", version, json.at("version"));
    if (version != RecipeVersion)
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"version\" is {}, and this program reads {}", version, RecipeVersion));
    const auto read = [&](const char* part, auto& parameters) {
        if (!json.contains(part)) return false;
        if (!json[part].is_object())
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" must be an object of settings", part));
        using Part = std::remove_cvref_t<decltype(parameters)>;
        const auto fields = with_present_names(json[part], renamed_fields<Part>());
        if constexpr (std::is_same_v<Part, edit::EditRequest>) edit::read_request(parameters, fields);
        else fields_from_json(parameters, fields);
        for (const auto& [field, value] : fields.items())
            if (!value.is_null()) recipe.given.insert(part + ("." + field));
        return true;
    };
    read("job", recipe.job);
    read("request", recipe.request);
    read("guidance", recipe.guidance);
    read("attention", recipe.attention);
    recipe.use_dreambooth = read("dreambooth", recipe.dreambooth);
    read("server", recipe.server);
    for (auto& lora : recipe.job.lora) lora = lora_beside(path_of_text(lora), folder);
    for (auto& target : recipe.server.target_picture) target = target_beside(target, folder);
    for (auto* name :
         {&recipe.job.scene, &recipe.job.cameras, &recipe.job.model, &recipe.job.taesd, &recipe.job.segmenter,
          &recipe.job.text_segmenter, &recipe.server.workflow, &recipe.server.ca}) {
        *name = path_of_text(*name);
        const bool bundled = name == &recipe.server.workflow && remote::is_bundled_workflow(*name);
        if (name->empty() || *name == "none" || bundled || std::filesystem::path(*name).is_absolute())
            continue;
        *name = std::filesystem::weakly_canonical(folder / *name).string();
    }
    return recipe;
}

namespace {

constexpr const char* RecipeHint = "use the recipe.json of an edit, or a picture that this program made";

}  // namespace

nlohmann::ordered_json read_recipe_json(const std::filesystem::path& path) {
    std::string text;
    if (names_png(path)) {
        const auto chunks = read_png_text(path);
        const auto found = chunks.find("Recipe");
        if (found == chunks.end())
            throw Error(ErrorCode::InvalidArgument, "this picture carries no recipe", RecipeHint, path);
        text = found->second;
    } else {
        text = read_file(path);
    }
    auto json = try_parse_json<nlohmann::ordered_json>(text);
    if (!json.is_object() || !json.contains("version"))
        throw Error(ErrorCode::Malformed, "this is not a recipe", RecipeHint, path);
    return json;
}

EditRecipe read_recipe(const std::filesystem::path& path) {
    const auto json = read_recipe_json(path);
    try {
        return recipe_from_json(json, path.parent_path());
    } catch (const Error& error) {
        throw Error(ErrorCode::InvalidArgument, "in the recipe, " + error.message(), RecipeHint, path);
    }
}

CheckedRecipe check(EditRecipe recipe, const edit::News& news) {
    auto request = edit::check(std::move(recipe.request), news);
    return {std::move(recipe), std::move(request)};
}

std::string search_key(const CheckedRecipe& recipe) {
    const auto& job = recipe.job;
    ContentHash hash;
    hash.fields(recipe.request.words());
    hash.fields(static_cast<const edit::SearchSettings&>(recipe.request));
    hash.fields(recipe.attention);
    add_surroundings(hash, job);
    hash.texts({job.cut_out, job.at, job.looked_from, job.segmenter, job.text_segmenter});
    hash.numbers(job.use_label, job.the_thing, recipe.use_dreambooth, recipe.guidance.plain_ground,
                 job.rasterizer == "cuda");  // other last digits
    if (recipe.use_dreambooth) hash.fields(recipe.dreambooth);
    if (recipe.server.used()) hash.fields(recipe.server);  // it is told other words, and draws places
    return hash.key().hex();
}

std::string valid_search_key(EditRecipe recipe) {
    try {
        return search_key(check(std::move(recipe)));
    } catch (const Error&) { return {}; }
}

std::string tuning_key(const EditRecipe& recipe) {
    const auto& request = recipe.request;
    ContentHash hash;
    hash.fields(recipe.dreambooth);
    hash.texts({request.source, request.prompt, request.background});
    hash.numbers(request.views, request.image_size, request.elevation);
    add_surroundings(hash, recipe.job);
    return hash.key().hex();
}

}  // namespace gse::pipeline
