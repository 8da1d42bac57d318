// project.json, written and read field by field, every value checked.
#include "engine/io/project/project_description.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/base/path_text.h"
#include "engine/io/cameras/camera_checks.h"
#include "engine/scene/origin/world_offset.h"
#include "engine/scene/strength.h"

namespace gse::io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t MostEntries = 100000;  // edits, labels, views
constexpr std::uint64_t MostEdits = std::uint64_t{1} << 32;
constexpr std::array<const char*, 3> BaseNames{"file", "kept", "whole"};
constexpr std::array<const char*, 15> KnownFields{
    "format", "version", "program", "scene", "info",      "stack",   "labels",    "active_label",
    "views",  "ui",      "jobs",    "rows",  "thumbnail", "columns", "variations"};

constexpr const char* DamagedProject = "the file is damaged; open an older copy or an autosave";

constexpr std::string_view NatureNames[] = {"other", "figure", "vessel", "plant"};  // in ThingNature's order

[[noreturn]] void throw_field(const std::string& name, const char* how) {
    throw Error(ErrorCode::Malformed, fmt::format("the field \"{}\" of the project {}", name, how),
                DamagedProject);
}

/// JSON object that is read field by field. Absent fields keep their default.
class Fields {
public:
    Fields(const Json& json, std::string name) : json_(json), name_(std::move(name)) {
        if (!json.is_object()) throw_field(name_, "is not an object");
    }

    void text(const char* key, std::string& value) const {
        if (const Json* found = find(key)) {
            if (!found->is_string()) throw_field(full(key), "is not text");
            value = found->get<std::string>();
        }
    }
    void flag(const char* key, bool& value) const {
        if (const Json* found = find(key)) {
            if (!found->is_boolean()) throw_field(full(key), "is neither true nor false");
            value = found->get<bool>();
        }
    }
    /// Reads a number, finite unless `any`. Values that JSON has no number for are written as text.
    void number(const char* key, double& value, bool any = false) const {
        const Json* found = find(key);
        if (found == nullptr) return;
        if (any && found->is_string()) {
            const auto word = found->get<std::string>();
            value = word == "inf"    ? std::numeric_limits<double>::infinity()
                    : word == "-inf" ? -std::numeric_limits<double>::infinity()
                                     : std::numeric_limits<double>::quiet_NaN();
            return;
        }
        if (!found->is_number() || !std::isfinite(found->get<double>()))
            throw_field(full(key), "is not a number");
        value = found->get<double>();
    }
    template <class T> void whole(const char* key, T& value, std::int64_t low, std::uint64_t high) const {
        const Json* found = find(key);
        if (found == nullptr) return;
        const bool fits = found->is_number_unsigned()  ? found->get<std::uint64_t>() <= high
                          : found->is_number_integer() ? found->get<std::int64_t>() >= low
                                                       : false;
        if (!fits) throw_field(full(key), "is not a number of its range");
        value = found->is_number_unsigned() ? static_cast<T>(found->get<std::uint64_t>())
                                            : static_cast<T>(found->get<std::int64_t>());
    }
    /// Reads exactly `out.size()` finite numbers.
    void numbers(const char* key, std::span<double> out) const {
        const Json* found = find(key);
        if (found == nullptr) return;
        if (!found->is_array() || found->size() != out.size()) throw_field(full(key), "has the wrong length");
        for (std::size_t i = 0; i < out.size(); ++i) {
            if (!(*found)[i].is_number() || !std::isfinite((*found)[i].get<double>()))
                throw_field(full(key), "holds something that is not a number");
            out[i] = (*found)[i].get<double>();
        }
    }
    const Json* list(const char* key) const {
        const Json* found = find(key);
        if (found != nullptr && (!found->is_array() || found->size() > MostEntries))
            throw_field(full(key), "is not a list");
        return found;
    }
    const Json* object(const char* key) const {
        const Json* found = find(key);
        if (found != nullptr && !found->is_object()) throw_field(full(key), "is not an object");
        return found;
    }
    std::string full(const char* key) const {
        return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
    }

private:
    const Json* find(const char* key) const {
        const auto found = json_.find(key);
        return found == json_.end() || found->is_null() ? nullptr : &*found;
    }
    const Json& json_;
    std::string name_;
};

/// A double as JSON. Infinities and NaN become words.
Json any_number(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

Json to_json(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Json to_json(const View& view) {
    const Camera& camera = view.camera;
    return {{"name", view.name},
            {"distorted", view.distorted},
            {"size", {camera.width, camera.height}},
            {"lens", {camera.fx, camera.fy, camera.cx, camera.cy}},
            {"rotation", camera.rotation.rows()},
            {"translation", to_json(camera.translation)}};
}

View read_view(const Json& json, const std::string& name) {
    const Fields fields(json, name);
    View view;
    fields.text("name", view.name);
    fields.flag("distorted", view.distorted);
    std::array<double, 2> size{};
    std::array<double, 4> lens{};
    std::array<double, 3> translation{};
    std::array<double, 9> rotation = Mat3::identity().rows();
    fields.numbers("size", size);
    fields.numbers("lens", lens);
    fields.numbers("translation", translation);
    fields.numbers("rotation", rotation);
    for (const double side : size)
        if (side < 0 || side > LargestImageSide) throw_field(fields.full("size"), "is not a picture's size");
    Camera& camera = view.camera;
    camera.width = static_cast<int>(size[0]);
    camera.height = static_cast<int>(size[1]);
    camera.fx = lens[0], camera.fy = lens[1], camera.cx = lens[2], camera.cy = lens[3];
    camera.rotation = Mat3::from_rows(rotation);
    camera.translation = {translation[0], translation[1], translation[2]};
    check_intrinsics(camera, fmt::format("\"{}\" of the project", name), DamagedProject);
    check_pose(camera, name, DamagedProject);
    return view;
}

Json to_json(const SceneInfo& info) {
    Json json{{"format", info.format},       {"up", to_json(info.up)},          {"up_known", info.up_known},
              {"up_unsure", info.up_unsure}, {"antialiased", info.antialiased}, {"warnings", info.warnings}};
    if (has_offset(info.offset)) json["offset"] = to_json(info.offset);
    if (info.activated) json["activated"] = true;
    return json;
}

SceneInfo read_info(const Json& json) {
    const Fields fields(json, "info");
    SceneInfo info;
    fields.text("format", info.format);
    std::array<double, 3> up{info.up.x, info.up.y, info.up.z};
    fields.numbers("up", up);
    info.up = {up[0], up[1], up[2]};
    fields.flag("up_known", info.up_known);
    fields.flag("up_unsure", info.up_unsure);
    fields.flag("antialiased", info.antialiased);
    std::array<double, 3> offset{};
    fields.numbers("offset", offset);
    info.offset = {offset[0], offset[1], offset[2]};
    fields.flag("activated", info.activated);
    if (const Json* warnings = fields.list("warnings"))
        for (const Json& warning : *warnings) {
            if (!warning.is_string()) throw_field("info.warnings", "holds something that is not text");
            info.warnings.push_back(warning.get<std::string>());
        }
    return info;
}

Json to_json(const ProjectDescription::ExtraEntry& entry) {
    return {{"name", entry.name}, {"type", static_cast<int>(entry.type)}, {"member", entry.member}};
}

ProjectDescription::ExtraEntry read_extra(const Json& json, const std::string& name) {
    const Fields fields(json, name);
    ProjectDescription::ExtraEntry entry;
    fields.text("name", entry.name);
    const bool one_word =
        !entry.name.empty() && std::none_of(entry.name.begin(), entry.name.end(), [](char c) {
            return std::isspace(static_cast<unsigned char>(c)) != 0;
        });
    if (!one_word) throw_field(fields.full("name"), "is no name of a column");
    std::uint64_t type = 0;
    fields.whole("type", type, 0, static_cast<std::uint64_t>(ColumnType::Float64));
    entry.type = static_cast<ColumnType>(type);
    fields.text("member", entry.member);
    return entry;
}

Json to_json(const ProjectDescription::Edit& edit) {
    const EditNode& node = edit.node;
    return {{"id", node.id},
            {"name", node.name},
            {"recipe", node.recipe},
            {"enabled", node.enabled},
            {"strength", node.strength},
            {"seconds", any_number(node.seconds)},
            {"psnr_outside_db", any_number(node.psnr_outside_db)},
            {"changed_outside_label", node.changed_outside_label},
            {"delta", edit.delta},
            {"thumbnail", edit.thumbnail}};
}

ProjectDescription::Edit read_edit(const Json& json, const std::string& name) {
    const Fields fields(json, name);
    ProjectDescription::Edit edit;
    EditNode& node = edit.node;
    fields.whole("id", node.id, 0, MostEdits - 1);
    if (node.id == 0) throw_field(fields.full("id"), "is missing or zero");
    fields.text("name", node.name);
    fields.text("recipe", node.recipe);
    fields.flag("enabled", node.enabled);
    fields.number("strength", node.strength);
    if (node.strength < 0 || node.strength > MostStrength)
        throw_field(fields.full("strength"), "is out of range");
    fields.number("seconds", node.seconds, true);
    fields.number("psnr_outside_db", node.psnr_outside_db, true);
    fields.whole("changed_outside_label", node.changed_outside_label, 0, ~std::uint64_t{0});
    fields.text("delta", edit.delta);
    fields.text("thumbnail", edit.thumbnail);
    return edit;
}

Json to_json(const ProjectDescription::VariationsEntry& entry) {
    Json json{{"edit", entry.edit}, {"results", Json::array()}};
    for (std::size_t i = 0; i < entry.results.size(); ++i) {
        json["results"].push_back(to_json(entry.results[i]));
        json["results"].back()["seed"] = entry.seeds[i];
    }
    return json;
}

ProjectDescription::VariationsEntry read_variations(const Json& json, const std::string& name) {
    const Fields fields(json, name);
    ProjectDescription::VariationsEntry entry;
    fields.whole("edit", entry.edit, 1, MostEdits - 1);
    const Json* results = fields.list("results");
    for (std::size_t i = 0; results != nullptr && i < results->size(); ++i) {
        const auto of = fmt::format("{}.results[{}]", name, i);
        entry.results.push_back(read_edit((*results)[i], of));
        if (entry.results.back().node.id != entry.edit) throw_field(of, "is of another edit");
        entry.seeds.push_back(0);
        Fields((*results)[i], of).whole("seed", entry.seeds.back(), 0, ~std::uint64_t{0});
    }
    return entry;
}

Json to_json(const ProjectDescription::LabelEntry& entry) {
    Json json{{"name", entry.label.name},
              {"threshold", any_number(static_cast<double>(entry.label.threshold))},
              {"attention_threshold", any_number(entry.label.attention_threshold)},
              {"found_for", entry.label.found_for},
              {"excluded_views", entry.label.excluded_views},
              {"looked_from", entry.label.looked_from},
              {"weight", entry.weight},
              {"manual", entry.manual},
              {"absent", entry.absent}};
    if (!entry.probability.empty())
        json["views"] = {{"probability", entry.probability},
                         {"coverage", entry.coverage},
                         {"least_coverage", entry.rule.least_coverage},
                         {"smoothness", entry.rule.smoothness},
                         {"island_share", entry.rule.island_share},
                         {"up", to_json(entry.rule.up)},
                         {"front", to_json(entry.rule.front)},
                         {"nature", NatureNames[static_cast<std::size_t>(entry.rule.nature)]}};
    return json;
}

/// Nature of a labelled thing. Older projects say only that it is a figure; one of a newer version is Other.
ThingNature read_nature(const Fields& fields) {
    bool is_figure = false;
    std::string name;
    fields.flag("figure", is_figure);
    fields.text("nature", name);
    const auto* const found = std::find(std::begin(NatureNames), std::end(NatureNames), name);
    if (found != std::end(NatureNames)) return static_cast<ThingNature>(found - std::begin(NatureNames));
    return is_figure ? ThingNature::Figure : ThingNature::Other;
}

/// Reads the field of a label's search. Older projects do not have it.
void read_views(const Json& json, const std::string& name, ProjectDescription::LabelEntry& entry) {
    const Fields fields(json, name);
    fields.text("probability", entry.probability);
    fields.text("coverage", entry.coverage);
    if (entry.probability.empty() != entry.coverage.empty())
        throw_field(fields.full("coverage"), "is there without the other");
    fields.number("least_coverage", entry.rule.least_coverage);
    fields.number("smoothness", entry.rule.smoothness);
    fields.number("island_share", entry.rule.island_share);
    entry.rule.nature = read_nature(fields);
    for (const auto& [key, axis] : {std::pair{"up", &entry.rule.up}, std::pair{"front", &entry.rule.front}}) {
        std::array<double, 3> values{axis->x, axis->y, axis->z};
        fields.numbers(key, values);
        *axis = {values[0], values[1], values[2]};
        if (!(length(*axis) > 0)) throw_field(fields.full(key), "is no direction");
    }
}

ProjectDescription::LabelEntry read_label(const Json& json, const std::string& name) {
    const Fields fields(json, name);
    ProjectDescription::LabelEntry entry;
    fields.text("name", entry.label.name);
    fields.text("found_for", entry.label.found_for);
    fields.text("left_out", entry.label.excluded_views);  // its name before
    fields.text("excluded_views", entry.label.excluded_views);
    fields.text("looked_from", entry.label.looked_from);
    double threshold = static_cast<double>(entry.label.threshold);
    fields.number("threshold", threshold, true);
    if (std::isnan(threshold)) throw_field(fields.full("threshold"), "is not a number");
    constexpr double most = 1e30;  // fits a float
    entry.label.threshold = static_cast<float>(std::clamp(threshold, -most, most));
    fields.number("attention_threshold", entry.label.attention_threshold, true);
    if (!std::isfinite(entry.label.attention_threshold))
        entry.label.attention_threshold = NamedLabel().attention_threshold;
    fields.text("weight", entry.weight);
    fields.text("manual", entry.manual);
    fields.text("absent", entry.absent);
    if (const Json* views = fields.object("views")) read_views(*views, fields.full("views"), entry);
    return entry;
}

Json scene_json(const ProjectDescription& description) {
    return {{"path", text_of_path(description.scene_path)},
            {"relative", text_of_path(description.scene_relative)},
            {"bytes", description.scene_bytes},
            {"fingerprint", fmt::format("{:016x}", description.scene_fingerprint)},
            {"splats", description.file_rows},
            {"base", BaseNames[static_cast<std::size_t>(description.base)]},
            {"base_member", description.base_member},
            {"base_splats", description.base_rows}};
}

void read_scene(const Json& json, ProjectDescription& description) {
    const Fields fields(json, "scene");
    fields.text("path", description.scene_path);
    fields.text("relative", description.scene_relative);
    description.scene_path = path_of_text(description.scene_path);
    description.scene_relative = path_of_text(description.scene_relative);
    fields.whole("bytes", description.scene_bytes, 0, ~std::uint64_t{0});
    std::string fingerprint = "0", base = BaseNames[0];
    fields.text("fingerprint", fingerprint);
    const char* end = fingerprint.data() + fingerprint.size();
    const auto parsed = std::from_chars(fingerprint.data(), end, description.scene_fingerprint, 16);
    if (parsed.ec != std::errc() || parsed.ptr != end)
        throw_field("scene.fingerprint", "is not a hexadecimal number");
    fields.whole("splats", description.file_rows, 0, ~std::uint32_t{0});
    fields.text("base", base);
    const auto found = std::find(BaseNames.begin(), BaseNames.end(), base);
    if (found == BaseNames.end()) throw_field("scene.base", "is none that this version knows");
    description.base = static_cast<BaseKind>(found - BaseNames.begin());
    fields.text("base_member", description.base_member);
    fields.whole("base_splats", description.base_rows, 0, ~std::uint32_t{0});
}

void check_header(const Fields& fields, ProjectDescription& description) {
    std::string format;
    fields.text("format", format);
    if (format != ProjectFormat)
        throw Error(ErrorCode::Malformed, "this is not a project of GSEditPro",
                    "open a .gsep file or a scene");
    description.version = 0;
    fields.whole("version", description.version, 0, 1000000);
    fields.text("program", description.program);
    if (description.version < 1) throw_field("version", "is missing");
    if (description.version > ProjectVersion)
        throw Error(ErrorCode::Unsupported,
                    fmt::format("the project has format {}, this program reads up to {}", description.version,
                                ProjectVersion),
                    "open it with a newer GSEditPro");
}

void read_work(const Fields& fields, ProjectDescription& description) {
    if (const Json* stack = fields.list("stack")) {
        std::set<std::uint64_t> ids;
        for (std::size_t i = 0; i < stack->size(); ++i) {
            description.stack.push_back(read_edit((*stack)[i], fmt::format("stack[{}]", i)));
            if (!ids.insert(description.stack.back().node.id).second)
                throw_field("stack", "names an edit twice");
        }
    }
    if (const Json* variations = fields.list("variations"))
        for (std::size_t i = 0; i < variations->size(); ++i)
            description.variations.push_back(
                read_variations((*variations)[i], fmt::format("variations[{}]", i)));
    if (const Json* labels = fields.list("labels"))
        for (std::size_t i = 0; i < labels->size(); ++i)
            description.labels.push_back(read_label((*labels)[i], fmt::format("labels[{}]", i)));
    fields.whole("active_label", description.active_label, -1,
                 std::max<std::size_t>(description.labels.size(), 1) - 1);
    if (description.labels.empty()) description.active_label = -1;
    if (const Json* views = fields.list("views"))
        for (std::size_t i = 0; i < views->size(); ++i)
            description.views.push_back(read_view((*views)[i], fmt::format("views[{}]", i)));
}

}  // namespace

std::string write_description(const ProjectDescription& description) {
    Json json = description.unknown.is_object() ? description.unknown : Json::object();
    json["format"] = ProjectFormat;
    json["version"] = ProjectVersion;
    json["program"] = description.program;
    json["scene"] = scene_json(description);
    json["info"] = to_json(description.info);
    json["rows"] = description.current_rows;
    const auto list = [&](const char* key, const auto& entries) {
        json[key] = Json::array();
        for (const auto& entry : entries) json[key].push_back(to_json(entry));
    };
    if (!description.extra.empty()) list("columns", description.extra);
    list("stack", description.stack);
    if (!description.variations.empty()) list("variations", description.variations);
    list("labels", description.labels);
    list("views", description.views);
    json["active_label"] = description.active_label;
    json["thumbnail"] = description.thumbnail;
    json["ui"] = description.ui;
    json["jobs"] = description.jobs;
    return json_text(json, 1);
}

ProjectDescription parse_description(std::string_view text) {
    const Json json = parse_json(text, "the project's description", DamagedProject);
    if (!json.is_object())
        throw Error(ErrorCode::Malformed, "this is not a project of GSEditPro",
                    "open a .gsep file or a scene");
    const Fields fields(json, "");
    ProjectDescription description;
    check_header(fields, description);
    const Json* scene = fields.object("scene");
    if (scene == nullptr) throw_field("scene", "is missing");
    read_scene(*scene, description);
    if (const Json* info = fields.object("info")) description.info = read_info(*info);
    fields.whole("rows", description.current_rows, 0, ~std::uint32_t{0});
    if (const Json* columns = fields.list("columns"))
        for (std::size_t i = 0; i < columns->size(); ++i)
            description.extra.push_back(read_extra((*columns)[i], fmt::format("columns[{}]", i)));
    read_work(fields, description);
    fields.text("thumbnail", description.thumbnail);
    if (const Json* ui = fields.object("ui")) description.ui = *ui;
    if (const Json* jobs = fields.object("jobs")) description.jobs = *jobs;
    for (const auto& [key, value] : json.items())
        if (std::find(KnownFields.begin(), KnownFields.end(), key) == KnownFields.end())
            description.unknown[key] = value;
    return description;
}

}  // namespace gse::io
