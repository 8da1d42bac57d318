// Sums a scene up.
#include "engine/pipeline/report/scene_report.h"

#include <fmt/format.h>

#include <sstream>

#include "engine/base/error.h"
#include "engine/base/path_text.h"
#include "engine/base/print.h"
#include "engine/base/safetensors_header.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/image/image_file.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/project/project_file.h"
#include "engine/neural/api/files/weight_header.h"
#include "engine/pipeline/inventory/model_inventory.h"
#include "engine/pipeline/inventory/no_scene.h"
#include "engine/pipeline/models/model_catalogue.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/scene/origin/world_offset.h"

namespace gse::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

/// Cameras of a project, or beside a scene. Those that cannot be used do not hide the scene: a note says so.
CameraList cameras_of(const std::filesystem::path& path) {
    CameraList cameras;
    try {
        if (is_project_file(path)) cameras.views = read_project_summary(path).views;
        else if (const auto found = find_cameras(path)) cameras = read_cameras(*found, path);
    } catch (const Error& error) {
        if (is_project_file(path)) throw;
        cameras.notes.push_back(fmt::format("the cameras beside the scene cannot be used: {}", error.what()));
    }
    return cameras;
}

/// Likelihood of each axis as up, where neither the file nor cameras say it.
Json guess_report(const UpGuess& guess) {
    Json json{
        {"sure", guess.sure()}, {"axis", direction_name(guess.best)}, {"confidence", guess.confidence()}};
    for (std::size_t i = 0; i < Directions; ++i) json["likelihood"][direction_name(i)] = guess.likelihood[i];
    return json;
}

Json report_of(const Scene& scene, const std::filesystem::path& path, const CameraList& cameras) {
    const SceneStatistics statistics = compute_statistics(scene.gaussians);
    Json json;
    json["file"] = text_of_path(path.string());
    json["format"] = scene.info.format;
    json["splats"] = scene.gaussians.size();
    json["sh_degree"] = scene.gaussians.sh_degree();
    json["attribute_mb"] = static_cast<double>(scene.gaussians.byte_size()) / 1e6;
    json["cameras"] = cameras.views.size();
    json["up"] = list_of(scene.info.up);
    json["up_known"] = scene.info.up_known;
    json["antialiased"] = scene.info.antialiased;
    json["mean_opacity"] = statistics.mean_opacity;
    const Vec3& offset = scene.info.offset;
    const auto in_world = [&](const Vec3& at) { return list_of(has_offset(offset) ? at + offset : at); };
    const auto bounds = [&](const Vec3& low, const Vec3& high) {
        return Json{{"low", in_world(low)}, {"high", in_world(high)}};
    };
    json["bounds"] = bounds(statistics.bounds_low, statistics.bounds_high);
    json["robust_bounds"] = bounds(statistics.robust_low, statistics.robust_high);
    if (has_offset(offset)) json["offset"] = list_of(offset);
    json["lint"] = {{"nan", statistics.nan_rows},
                    {"infinite", statistics.infinite_rows},
                    {"giant", statistics.giant_rows},
                    {"invisible", statistics.invisible_rows},
                    {"haze", statistics.haze_rows},
                    {"sky", statistics.sky_rows},
                    {"zero_quaternion", statistics.zero_quaternion_rows}};
    json["labels"] = Json::array();
    for (const auto& label : scene.labels.labels) json["labels"].push_back(label.name);
    if (!scene.extra.empty()) json["columns"] = names_of(scene.extra);
    if (scene.info.looks_activated) json["looks_activated"] = true;
    json["warnings"] = scene.info.warnings;
    for (const std::string& note : cameras.notes) json["warnings"].push_back(note);
    return json;
}

/// How a picture was made.
Json picture_report(const std::filesystem::path& path) {
    const auto size = read_image_size(path);
    if (!size)
        throw Error(ErrorCode::Malformed, "the picture does not begin like a PNG",
                    "the file is damaged or misnamed", path);
    Json json;
    json["file"] = text_of_path(path.string());
    json["width"] = size->width;
    json["height"] = size->height;
    json["text"] = Json::object();
    for (const auto& [keyword, text] : read_png_text(path)) json["text"][keyword] = text;
    return json;
}

/// The recipe is for programs, and fills a screen.
std::string for_people(const std::string& keyword, const std::string& text) {
    return keyword == "Recipe"
               ? "all settings: edit --recipe takes them from this picture, --json prints them"
               : text;
}

/// A line for every line of a text.
std::string picture_report_text(const Json& json) {
    std::string text =
        fmt::format("{}\n  size          {} x {}\n", printable(json["file"].get<std::string>()),
                    json["width"].get<int>(), json["height"].get<int>());
    if (json["text"].empty()) text += "  text          none\n";
    for (const auto& [keyword, value] : json["text"].items()) {
        std::istringstream lines(for_people(keyword, value.get<std::string>()));
        std::string name = printable(keyword);
        for (std::string line; std::getline(lines, line); name.clear())
            text += fmt::format("  {:<13} {}\n", name, printable(line));
    }
    return text;
}

bool is_model(const std::filesystem::path& path) {
    std::error_code ignored;
    return is_checkpoint_name(path) || neural::is_gguf_name(path) ||
           std::filesystem::exists(path / "model_index.json", ignored);
}

/// Facts of a model by its headers.
Json model_report(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw Error(ErrorCode::NotFound, "there is no model here", "name a folder or a checkpoint", path);
    const auto model = describe_model(path);
    if (model.structure.empty()) refuse_weights(path);
    if (model.structure.empty())
        throw Error(is_safetensors_name(path) ? ErrorCode::Malformed : ErrorCode::Unsupported, model.problem,
                    "name a folder in diffusers layout or a whole checkpoint", path);
    Json json;
    json["file"] = text_of_path(path.string());
    json["structure"] = model.structure;
    json["name"] = model.name;
    json["prediction"] = model.prediction;
    json["mb"] = static_cast<double>(model.bytes) / 1e6;
    json["usable"] = model.usable;
    json["use"] = describe_model_file(path).use.how;
    const bool other = json["use"] != "" && json["use"] != "--model";  // no whole model, and none is wanted
    json["problem"] = other ? std::string() : model.problem;
    return json;
}

std::string model_report_text(const Json& json) {
    std::string text = fmt::format("{}\n", printable(json["file"].get<std::string>()));
    for (const auto& [name, key] :
         {std::pair{"model", "structure"}, std::pair{"name", "name"}, std::pair{"prediction", "prediction"},
          std::pair{"use", "use"}, std::pair{"problem", "problem"}})
        if (const auto value = json[key].get<std::string>(); !value.empty())
            text += fmt::format("  {:<13} {}\n", name, printable(value));
    return text + fmt::format("  {:<13} {:.1f} MB\n", "size", json["mb"].get<double>());
}

/// Remark behind the up direction.
std::string up_remark(const Json& json) {
    if (json["up_known"].get<bool>()) return {};
    if (!json.contains("up_guess")) return " (assumed)";
    const Json& guess = json["up_guess"];
    const double percent = 100 * guess["confidence"].get<double>();
    return guess["sure"].get<bool>() ? fmt::format(" (guessed from the splats, {:.0f} %)", percent)
                                     : fmt::format(" (unsure: {} is likeliest, {:.0f} %; --up decides)",
                                                   guess["axis"].get<std::string>(), percent);
}

}  // namespace

Json scene_report(const std::filesystem::path& path, const ReadingOptions& options) {
    if (is_model(path)) return model_report(path);
    if (names_png(path)) return picture_report(path);
    refuse_weights(path);
    Scene scene = load_scene(path, options);
    const CameraList cameras = cameras_of(path);
    const bool project = is_project_file(path);
    const auto guess =
        project || !cameras.views.empty() ? std::nullopt : guess_up(scene.info, scene.gaussians);
    Json report = report_of(scene, path, cameras);
    if (guess) report["up_guess"] = guess_report(*guess);
    if (project)
        for (const auto& edit : read_project_summary(path).stack)
            report["edits"].push_back(edit.name + (edit.enabled ? "" : " (off)"));
    return report;
}

std::string report_text(const Json& json) {
    if (json.contains("text")) return picture_report_text(json);
    if (json.contains("structure")) return model_report_text(json);
    std::string text;
    const auto line = [&](auto format, const auto&... values) {
        text += fmt::format(fmt::runtime(format), shown(values)...);
    };
    const auto number = [&](const char* key) { return json["lint"][key].get<std::size_t>(); };
    line("{}\n", json["file"].get<std::string>());
    line("  format        {}, SH degree {}\n", json["format"].get<std::string>(),
         json["sh_degree"].get<int>());
    line("  splats        {} ({:.1f} MB of attributes)\n", json["splats"].get<std::size_t>(),
         json["attribute_mb"].get<double>());
    line("  cameras       {}\n", json["cameras"].get<std::size_t>());
    line("  bounds        {} to {}\n", json["bounds"]["low"].dump(), json["bounds"]["high"].dump());
    line("  robust bounds {} to {}\n", json["robust_bounds"]["low"].dump(),
         json["robust_bounds"]["high"].dump());
    if (json.contains("offset"))
        line("  offset        {} taken off here, added in files\n", json["offset"].dump());
    line("  up            {}{}\n", json["up"].dump(), up_remark(json));
    line("  lint          {} NaN, {} infinite, {} giant, {} invisible, {} zero quaternions\n", number("nan"),
         number("infinite"), number("giant"), number("invisible"), number("zero_quaternion"));
    if (number("haze") + number("sky") > 0)
        line("  around        {} splats of haze, {} of sky: framed without them\n", number("haze"),
             number("sky"));
    if (json.contains("edits"))
        for (const auto& edit : json["edits"]) line("  edit          {}\n", edit.get<std::string>());
    for (const auto& label : json["labels"]) line("  label         {}\n", label.get<std::string>());
    if (json.contains("columns"))
        line("  columns       {}\n", in_words(json["columns"].get<std::vector<std::string>>(), "and"));
    for (const auto& warning : json["warnings"]) line("  warning       {}\n", warning.get<std::string>());
    return text;
}

}  // namespace gse::pipeline
