// Scenes, things and tasks of the suite's JSON.
#include "engine/laboratory/eval/real/real_suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/laboratory/eval/real/suite_json.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using Roots = std::map<std::string, std::filesystem::path>;

const std::vector<double> UsualSides{20, 140, 260};
const std::set<std::string> Ups{"x", "y", "z", "-x", "-y", "-z"};
const std::set<std::string> Kinds{"recolour", "material", "add", "replace", "remove", "ground"};

Roots roots_of(const Json& json, const std::vector<std::string>& given, const std::filesystem::path& path) {
    Roots roots;
    for (const auto& [name, folder] : entry_of(json, "roots", path.string()).items()) {
        if (!folder.is_string()) refuse_suite(path.string(), fmt::format("root \"{}\" is no text", name));
        roots[name] = path.parent_path() / folder.get<std::string>();
    }
    for (const auto& text : given) {
        const auto equals = text.find('=');
        const auto name = text.substr(0, equals);
        if (equals == std::string::npos || !roots.contains(name))
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" names no root of the suite and its folder", text),
                        "write NAME=FOLDER", path);
        roots[name] = text.substr(equals + 1);
    }
    return roots;
}

RealThing thing_of(const Json& json, const std::string& where) {
    Json region = json;
    if (region.is_object()) region.erase("either");
    RealThing thing{parse_region(region, where), {}};
    if (has_entry(json, "either"))
        for (const auto& shape : list_entry(json, "either", where))
            thing.either.push_back(parse_region(shape, where + ", either"));
    return thing;
}

RealScene scene_of(const Json& json, const Roots& roots, const std::string& file) {
    RealScene scene;
    scene.name = text_entry(json, "name", file + ", a scene");
    const auto where = fmt::format("{}, scene \"{}\"", file, scene.name);
    const auto root = text_entry(json, "root", where);
    if (!roots.contains(root)) refuse_suite(where, fmt::format("there is no root \"{}\"", root));
    scene.path = roots.at(root) / text_entry(json, "file", where);
    scene.up = text_entry(json, "up", where);
    if (!Ups.contains(scene.up)) refuse_suite(where, "\"up\" is none of x, y, z, -x, -y, -z");
    scene.auto_up_right = bool_entry(json, "auto_up_right", where);
    if (has_entry(json, "front")) scene.front = number_entry(json, "front", where);
    scene.sides = UsualSides;
    if (has_entry(json, "sides")) {
        scene.sides.clear();
        for (const auto& side : list_entry(json, "sides", where))
            scene.sides.push_back(number_of(side, where + ", \"sides\""));
        if (scene.sides.size() != UsualSides.size()) refuse_suite(where, "\"sides\" are not three");
    }
    for (const auto& [name, thing] : entry_of(json, "things", where).items())
        scene.things.emplace(name, thing_of(thing, fmt::format("{}, thing \"{}\"", where, name)));
    return scene;
}

/// Box of the first shape of a union, along the world's axes; none for another shape.
std::optional<Bounds> first_box(const TruthRegion& region) {
    const auto* whole = std::get_if<TruthRegion::Union>(&region.shape());
    if (whole == nullptr || whole->parts.empty()) return std::nullopt;
    const auto* box = std::get_if<TruthRegion::Box>(&whole->parts.front().shape());
    if (box == nullptr) return std::nullopt;
    return Bounds{box->centre - box->half, box->centre + box->half};
}

RealTask task_of(const Json& json, const std::vector<RealScene>& scenes, const std::string& file) {
    RealTask task;
    task.name = text_entry(json, "name", file + ", a task");
    const auto where = fmt::format("{}, task \"{}\"", file, task.name);
    const auto name = text_entry(json, "scene", where);
    const auto scene =
        std::find_if(scenes.begin(), scenes.end(), [&](const auto& one) { return one.name == name; });
    if (scene == scenes.end()) refuse_suite(where, fmt::format("there is no scene \"{}\"", name));
    task.scene = static_cast<std::size_t>(scene - scenes.begin());
    task.source = text_entry(json, "source", where);
    task.prompt = text_entry(json, "prompt", where);
    task.kind = text_entry(json, "kind", where);
    if (!Kinds.contains(task.kind))
        refuse_suite(where, fmt::format("the kind \"{}\" is none of {}", task.kind, fmt::join(Kinds, ", ")));
    task.known_word = bool_entry(json, "known_word", where);
    if (has_entry(json, "accept")) task.accept = text_entry(json, "accept", where);
    if (has_entry(json, "cut_out")) task.cut_out = text_entry(json, "cut_out", where);
    if (has_entry(json, "about")) task.about = text_entry(json, "about", where);
    if (!task.about.empty() && !scene->things.contains(task.about))
        refuse_suite(where, fmt::format("scene \"{}\" has no thing \"{}\"", name, task.about));
    if (has_entry(json, "place")) {
        task.place = parse_region(json["place"], where + ", place");
        task.place_box = first_box(*task.place);
    }
    return task;
}

}  // namespace

RealSuite read_real_suite(const std::filesystem::path& path, const std::vector<std::string>& given) {
    const auto file = path.string();
    const Json json = parse_json<Json>(read_file(path), file);
    RealSuite suite;
    suite.name = text_entry(json, "name", file);
    const auto roots = roots_of(json, given, path);
    for (const auto& scene : list_entry(json, "scenes", file))
        suite.scenes.push_back(scene_of(scene, roots, file));
    for (const auto& task : list_entry(json, "tasks", file))
        suite.tasks.push_back(task_of(task, suite.scenes, file));
    return suite;
}

}  // namespace gse::bench
