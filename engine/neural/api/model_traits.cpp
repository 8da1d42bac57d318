// Reads and checks the traits of gseditpro.json.
#include "engine/neural/api/model_traits.h"

#include "engine/base/error.h"
#include "engine/neural/api/config.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

edit::ModelTraits::Colour read_colour(const std::string& name, const Json& json) {
    edit::ModelTraits::Colour colour{};
    if (!json.is_array() || json.size() != colour.size())
        throw Error(ErrorCode::InvalidArgument, "\"" + name + "\" must be a list of red, green and blue");
    const Range display{0, 1};
    for (std::size_t i = 0; i < colour.size(); ++i) read_field(name.c_str(), colour[i], json[i], &display);
    return colour;
}

/// Takes an object of the traits, if it is there, out of `json`.
Json take_object(Json& json, const char* name) {
    Json object = json.value(name, Json::object());
    if (!object.is_object())
        throw Error(ErrorCode::InvalidArgument, std::string("\"") + name + "\" must be an object");
    json.erase(name);
    return object;
}

edit::ModelTraits read_traits(Json json) {
    if (!json.is_object()) throw Error(ErrorCode::InvalidArgument, "it must be an object");
    edit::ModelTraits traits;
    if (json.contains("sky")) traits.sky = read_colour("sky", json["sky"]);
    json.erase("sky");
    if (json.contains("ground_colours")) traits.ground_colours.clear();
    const Json grounds = take_object(json, "ground_colours");
    for (const auto& [word, colour] : grounds.items())
        traits.ground_colours[word] = read_colour(word, colour);
    if (json.contains("usual_colours")) traits.usual_colours.clear();
    const Json things = take_object(json, "usual_colours");
    for (const auto& [thing, colour] : things.items())
        read_field(thing.c_str(), traits.usual_colours[thing], colour);
    fields_from_json(traits, json);
    for (const auto& ground : traits.plain_grounds)
        if (!traits.ground_colours.contains(ground))
            throw Error(ErrorCode::InvalidArgument, "the plain ground \"" + ground + "\" has no colour");
    if (traits.plain_grounds.empty())
        throw Error(ErrorCode::InvalidArgument, "\"plain_grounds\" names no ground");
    return traits;
}

}  // namespace

edit::ModelTraits model_traits(const fs::path& model) {
    const auto file = (fs::is_directory(model) ? model : model.parent_path()) / "gseditpro.json";
    if (!fs::exists(file)) return {};
    const auto json = read_json_file(file);
    if (!json.is_object() || !json.contains("traits")) return {};
    try {
        return read_traits(json["traits"]);
    } catch (const Error& error) {
        throw Error(ErrorCode::Malformed, "in the model's traits: " + error.message(), "correct or remove it",
                    file);
    }
}

}  // namespace gse::neural
