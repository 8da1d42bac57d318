// Writes results so that nothing half-done is ever seen.
#include "app/edit_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <numbers>

#include "app/process.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/evaluate/metrics.h"
#include "engine/io/image_file.h"
#include "engine/io/scene_io.h"
#include "engine/io/video.h"

namespace gse::app {
namespace {

namespace fs = std::filesystem;

/// Black, red, yellow, white: readable as a heat map and in grey.
std::array<float, 3> heat(float value) {
    const float v = std::clamp(value, 0.0f, 1.0f) * 3;
    return {std::clamp(v, 0.0f, 1.0f), std::clamp(v - 1, 0.0f, 1.0f), std::clamp(v - 2, 0.0f, 1.0f)};
}

/// The render with the clicks: green crosses inside, red outside.
Image with_points(const Image& render, const std::vector<edit::PointPrompt>& points) {
    Image picture = render;
    const int arm = std::max(1, render.width / 48);
    for (const auto& point : points) {
        const std::array<float, 3> colour = point.positive ? std::array<float, 3>{0.1f, 1, 0.2f}
                                                           : std::array<float, 3>{1, 0.1f, 0.1f};
        const int x = static_cast<int>(point.x), y = static_cast<int>(point.y);
        for (int k = -arm; k <= arm; ++k)
            for (const auto& [u, v] : {std::pair{x + k, y}, std::pair{x, y + k}})
                if (u >= 0 && v >= 0 && u < picture.width && v < picture.height)
                    std::copy(colour.begin(), colour.end(), &picture.at(u, v, 0));
    }
    return picture;
}

void write_json(const fs::path& path, const nlohmann::ordered_json& json) { write_file(path, json.dump(2) + "\n"); }

}  // namespace

Image heat_map(const Image& map) {
    Image picture(map.width, map.height, 3);
    for (std::size_t i = 0; i < map.pixel_count(); ++i) {
        const auto colour = heat(map.data[i]);
        std::copy(colour.begin(), colour.end(), &picture.data[i * 3]);
    }
    return picture;
}

StagedFolder::StagedFolder(fs::path target) : target_(fs::absolute(target).lexically_normal()) {
    if (!target_.has_filename()) target_ = target_.parent_path();
    std::error_code failure;
    const auto refuse = [&](const std::string& reason) {
        throw Error(ErrorCode::Unwritable, "the output folder cannot be written (" + reason + ")",
                    "choose another place with --out", target_);
    };
    if (fs::exists(target_, failure) && !fs::is_directory(target_, failure)) refuse("it is a file");
    fs::create_directories(target_.parent_path(), failure);
    if (failure) refuse(failure.message());
    staging_ = target_.parent_path() / fmt::format(".{}.partial-{}", target_.filename().string(), getpid());
    fs::create_directory(staging_, failure);
    if (failure) refuse(failure.message());
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    fs::remove_all(staging_, ignored);
}

void StagedFolder::commit() {
    std::error_code failure;
    if (!fs::exists(target_)) {
        fs::rename(staging_, target_, failure);
        if (!failure) return;
    }
    for (const auto& entry : fs::recursive_directory_iterator(staging_)) {
        const auto place = target_ / fs::relative(entry.path(), staging_);
        if (entry.is_directory()) fs::create_directories(place, failure);
        else fs::rename(entry.path(), place, failure);
        if (failure)
            throw Error(ErrorCode::Unwritable, "a result cannot be moved to its place (" + failure.message() + ")", "",
                        place);
    }
}

void write_evidence(const fs::path& folder, const edit::LocateResult& located, const std::vector<View>& views) {
    nlohmann::ordered_json index = nlohmann::ordered_json::array();
    for (std::size_t v = 0; v < located.views.size(); ++v) {
        const auto& evidence = located.views[v];
        const std::string stem = fmt::format("view_{:03}", v);
        write_png(folder / (stem + "_render.png"), evidence.render);
        write_png(folder / (stem + "_attention.png"), heat_map(evidence.map));
        write_png(folder / (stem + "_points.png"), with_points(evidence.render, evidence.points));
        if (!evidence.mask.data.empty()) write_mask_png(folder / (stem + "_mask.png"), evidence.mask);
        nlohmann::ordered_json entry;
        entry["view"] = views[v].name;
        entry["word"] = located.word;
        entry["branch"] = evidence.branch;
        entry["captured_attention"] = evidence.captured;
        entry["failed"] = evidence.failed;
        entry["mask_pixels"] = evidence.mask.count();
        entry["points"] = nlohmann::ordered_json::array();
        for (const auto& point : evidence.points)
            entry["points"].push_back({{"x", point.x}, {"y", point.y}, {"positive", point.positive}});
        index.push_back(std::move(entry));
    }
    write_json(folder / "index.json", index);
}

void write_labelled_source(const fs::path& path, const EditJob& job) {
    const auto& label = job.located().label;
    const std::vector<float> bits(label.bits->begin(), label.bits->end());
    SaveOptions save;
    save.format = "ply";
    save.label = bits;
    save.label_weight = *label.weight;
    save_scene(path, job.scene(), save);
}

void write_before_after(const fs::path& folder, EditJob& job) {
    const int side = job.recipe().job.turntable_size, frames = job.recipe().job.turntable_frames;
    raster::Settings settings = job.plan().settings;
    const OrbitParameters orbit = job.film_orbit();
    const auto pair = [&](double azimuth) {
        const Camera camera = orbit_camera(orbit, azimuth, side, side);
        const Image before = job.painter().paint(job.scene().gaussians.spans(), camera, settings).colour;
        return side_by_side(before, job.painter().paint(job.result().set.spans(), camera, settings).colour);
    };
    VideoWriter film(folder / "before_after.mp4", 2 * side + 2, side, 24);
    for (int frame = 0; frame < frames; ++frame) {
        film.add(pair(2 * std::numbers::pi * frame / frames));
        job.control().report("film", frame + 1, frames);
    }
    film.finish();
    // Four directions under each other, before on the left and after on the right.
    constexpr int directions = 4;
    Image sheet(2 * side + 2, directions * side, 3);
    for (int i = 0; i < directions; ++i) {
        const Image row = pair(2 * std::numbers::pi * i / directions + 0.35);
        std::copy(row.data.begin(), row.data.end(),
                  sheet.data.begin() + static_cast<std::ptrdiff_t>(row.data.size()) * i);
    }
    write_png(folder / "before_after.png", sheet, {{"Recipe", recipe_to_json(job.recipe()).dump()}});
}

namespace {

/// PSNR between the scene before and after, outside the dilated masks, pooled over all views.
double psnr_outside(EditJob& job) {
    double error = 0;
    for (std::size_t v = 0; v < job.views().size(); ++v) {
        const auto& camera = job.views()[v].camera;
        const Image before =
            job.painter().paint(job.scene().gaussians.spans(), camera, job.plan().settings).colour;
        const Image& after = job.painter().paint(job.result().set.spans(), camera, job.plan().settings).colour;
        const evaluate::Region outside{&job.plan().masks[v], false};
        error += std::pow(10, -evaluate::psnr_db(before, after, outside) / 10);
    }
    return -10 * std::log10(error / static_cast<double>(job.views().size()));
}

nlohmann::ordered_json history_json(const edit::EditResult& result) {
    nlohmann::ordered_json lines = nlohmann::ordered_json::array();
    for (const auto& record : result.history) {
        nlohmann::ordered_json line{{"iteration", record.iteration},
                                    {"view", record.view},
                                    {"preservation", record.preservation},
                                    {"anchor", record.anchor},
                                    {"guidance_norm", record.guidance_norm},
                                    {"preservation_norm", record.preservation_norm}};
        for (const auto& [name, value] : record.guidance) line["guidance_" + name] = value;
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace

nlohmann::ordered_json make_report(EditJob& job) {
    const auto& result = job.result();
    nlohmann::ordered_json report;
    report["splats"] = result.set.size();
    report["splats_before"] = job.scene().gaussians.size();
    report["labelled"] = std::count(job.located().label.bits->begin(), job.located().label.bits->end(), std::uint8_t{1});
    report["added"] = std::count_if(result.label.begin(), result.label.end(), [](auto bit) { return bit != 0; }) -
                      std::count_if(result.base_to_new.begin(), result.base_to_new.end(),
                                    [&](std::int64_t row) { return row >= 0 && result.label[static_cast<std::size_t>(row)] != 0; });
    report["removed"] = std::count(result.base_to_new.begin(), result.base_to_new.end(), std::int64_t{-1});
    report["changed_outside_label"] = result.changed_outside_label;
    report["nonfinite"] = result.nonfinite;
    report["psnr_outside_db"] = psnr_outside(job);
    report["mode"] = job.located().mode == edit::EditMode::Add ? "add" : "modify";
    report["mode_reason"] = job.located().reason;
    report["word"] = job.located().word;
    report["views"] = job.views().size();
    report["failed_views"] = job.located().failed_views;
    report["iterations"] = result.iterations;
    report["stopped"] = result.stopped;
    report["came_to_rest"] = result.came_to_rest;
    report["masks_refreshed"] = result.masks_refreshed;
    report["skipped_steps"] = result.skipped_steps;
    report["skipped_rows"] = result.skipped_rows;
    report["cloned"] = result.cloned;
    report["split"] = result.split;
    report["pruned"] = result.pruned;
    report["model"] = job.model().name();
    report["seconds"] = job.times().to_json();
    report["peak_rss_mb"] = peak_rss_mb();
    report["losses"] = history_json(result);
    return report;
}

}  // namespace gse::app
