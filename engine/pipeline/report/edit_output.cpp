// Writes results so that nothing half-done is ever seen.
#include "engine/pipeline/report/edit_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/path_text.h"
#include "engine/base/process_memory.h"
#include "engine/evaluate/metrics.h"
#include "engine/io/image/image_file.h"
#include "engine/io/image/video.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/report/picture_text.h"
#include "engine/pipeline/report/target_sheet.h"

namespace gse::pipeline {
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
        const std::array<float, 3> colour =
            point.positive ? std::array<float, 3>{0.1f, 1, 0.2f} : std::array<float, 3>{1, 0.1f, 0.1f};
        const int x = static_cast<int>(point.x), y = static_cast<int>(point.y);
        for (int k = -arm; k <= arm; ++k)
            for (const auto& [u, v] : {std::pair{x + k, y}, std::pair{x, y + k}})
                if (u >= 0 && v >= 0 && u < picture.width && v < picture.height)
                    std::copy(colour.begin(), colour.end(), &picture.at(u, v, 0));
    }
    return picture;
}

void write_json(const fs::path& path, const nlohmann::ordered_json& json) {
    write_file(path, json_text(json, 2) + "\n");
}

void write_evidence_pictures(const fs::path& folder, const edit::ViewEvidence& evidence, std::size_t view) {
    const std::string stem = fmt::format("view_{:03}", view);
    write_png(folder / (stem + "_render.png"), evidence.render);
    if (!evidence.drawn.data.empty()) write_png(folder / (stem + "_drawn.png"), evidence.drawn);
    write_png(folder / (stem + "_attention.png"), heat_map(evidence.map));
    write_png(folder / (stem + "_points.png"), with_points(evidence.render, evidence.points));
    if (!evidence.mask.data.empty()) write_mask_png(folder / (stem + "_mask.png"), evidence.mask);
}

}  // namespace

Image heat_map(const Image& map) {
    Image picture(map.width, map.height, 3);
    for (std::size_t i = 0; i < map.pixel_count(); ++i) {
        const auto colour = heat(map.data[i]);
        std::copy(colour.begin(), colour.end(), &picture.data[i * 3]);
    }
    return picture;
}

void write_evidence(const fs::path& folder, ThreadPool& threads, const edit::LocateResult& located,
                    const std::vector<View>& views) {
    threads.parallel_for(located.views.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t v = begin; v < end; ++v) write_evidence_pictures(folder, located.views[v], v);
    });
    nlohmann::ordered_json index = nlohmann::ordered_json::array();
    for (std::size_t v = 0; v < located.views.size(); ++v) {
        const auto& evidence = located.views[v];
        nlohmann::ordered_json entry;
        entry["view"] = views[v].name;
        entry["word"] = located.word;
        entry["branch"] = evidence.branch;
        entry["captured_attention"] = evidence.captured;
        entry["failed"] = evidence.failed;
        if (evidence.failed) entry["step"] = edit::step_text(evidence.step);
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

std::uint64_t bytes_of_results(const EditJob& job) {
    const auto& recipe = job.recipe();
    const auto pixels = [](int side) {
        return static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side) * 3;
    };
    return 2 * job.scene().gaussians.byte_size() + job.views().size() * pixels(recipe.request.image_size) +
           static_cast<std::uint64_t>(recipe.job.turntable_frames) * pixels(recipe.job.turntable_size) / 10;
}

void write_before_after(const fs::path& folder, EditJob& job) {
    const int side = job.recipe().job.turntable_size, frames = job.recipe().job.turntable_frames;
    raster::Settings settings = job.plan().settings;
    const OrbitParameters orbit = job.film_orbit();
    const double front = job.film_front();  // what was edited faces the first picture
    const auto pair = [&](double azimuth) {
        const Camera camera = orbit_camera(orbit, front + azimuth, side, side);
        const Image before = job.painter().paint(job.drawn().spans(), camera, settings).colour;
        return side_by_side(before, job.painter().paint(job.drawn_result().spans(), camera, settings).colour);
    };
    if (frames > 0) {
        VideoWriter film(folder / "before_after.mp4", 2 * side + 2, side, 24);
        for (int frame = 0; frame < frames; ++frame) {
            film.add(pair(2 * std::numbers::pi * frame / frames));
            job.control().report("film", frame + 1, frames);
        }
        film.finish();
    }
    // Four directions under each other, before on the left and after on the right.
    constexpr int directions = 4;
    Image sheet(2 * side + 2, directions * side, 3);
    for (int i = 0; i < directions; ++i) {
        const Image row = pair(2 * std::numbers::pi * i / directions + 0.35);
        std::copy(row.data.begin(), row.data.end(),
                  sheet.data.begin() + static_cast<std::ptrdiff_t>(row.data.size()) * i);
    }
    const auto recipe = job.recipe().plain();
    write_png(folder / "before_after.png", sheet, picture_text(recipe, recipe_to_json(recipe)));
}

namespace {

/// PSNR between the scene before and after, outside the dilated masks, pooled over all views.
double psnr_outside(EditJob& job) {
    double error = 0;
    for (std::size_t v = 0; v < job.views().size(); ++v) {
        const auto& camera = job.views()[v].camera;
        const Image before = job.painter().paint(job.drawn().spans(), camera, job.plan().settings).colour;
        const Image& after =
            job.painter().paint(job.drawn_result().spans(), camera, job.plan().settings).colour;
        const evaluate::Region outside{&job.changed_masks()[v], false};
        error += std::pow(10, -evaluate::psnr_db(before, after, outside) / 10);
    }
    return -10 * std::log10(error / static_cast<double>(job.views().size()));
}

nlohmann::ordered_json history_json(const edit::EditResult& result) {
    nlohmann::ordered_json lines = nlohmann::ordered_json::array();
    for (const auto& record : result.history) {
        nlohmann::ordered_json line{
            {"iteration", record.iteration},         {"view", record.view},
            {"preservation", record.preservation},   {"anchor", record.anchor},
            {"guidance_norm", record.guidance_norm}, {"preservation_norm", record.preservation_norm}};
        for (const auto& [name, value] : record.guidance) line["guidance_" + name] = value;
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace

void add_search(nlohmann::ordered_json& report, const EditJob& job) {
    const auto& located = job.located();
    const auto& confidence = located.confidence;
    report["mode"] = edit::mode_name(located.mode);
    report["mode_reason"] = located.reason;
    report["word"] = located.word;
    if (job.found_by_differences()) report["found_by"] = "differences of the server's pictures";
    report["segmenter"] = job.segmenter_name();
    report["views"] = job.views().size();
    if (job.front_read()) report["front_read"] = *job.front_read() / Degree;
    if (located.on_ground) report["plain_ground"] = true;  // that the networks saw below the scene
    report["failed_views"] = located.failed_views;
    if (located.broken_attention > 0) report["broken_attention"] = located.broken_attention;
    report["confidence"] = nullptr;  // nothing was looked for
    if (confidence.value >= 0) {
        report["confidence"] = confidence.value;
        for (const auto& part : confidence.parts) report["confidence_of"][part.key] = part.value;
    }
    report["confidence_text"] = edit::confidence_text(confidence);
    if (!job.label_doubt().empty()) report["label_doubt"] = job.label_doubt();
    if (located.problem != edit::SearchProblem::None) {
        report["problem"] = located.message;
        report["remedy"] = located.remedy;
    }
}

nlohmann::ordered_json locate_report(EditJob& job) {
    nlohmann::ordered_json report;
    report["splats"] = job.scene().gaussians.size();
    report["labelled"] =
        std::count(job.located().label.bits->begin(), job.located().label.bits->end(), std::uint8_t{1});
    report["new"] = job.located().seeds.size();
    add_search(report, job);
    report["seconds"] = job.times().to_json();
    report["networks"] = job.times().networks_json();
    return report;
}

void write_edited_scene(const fs::path& path, const EditJob& job) {
    Scene edited = job.scene();
    edited.gaussians = job.result().set;
    edited.extra = gathered(edited.extra, sources_of(job.result().base_to_new, edited.gaussians.size()));
    edited.labels = {};
    save_scene(path, edited, {.format = "ply"});
}

void write_edit(const fs::path& folder, EditJob& job) {
    write_edited_scene(folder / "scene.ply", job);
    write_file(folder / "recipe.json", json_text(recipe_to_json(job.recipe().plain()), 2) + "\n");
    write_labelled_source(folder / "source.ply", job);
    write_evidence(folder / "evidence", job.painter().pool(), job.located(), job.views());
    write_targets(folder / "evidence", job.painter().pool(), job.targets(), job.views());
    write_before_after(folder, job);
}

nlohmann::ordered_json make_report(EditJob& job) {
    const auto& result = job.result();
    nlohmann::ordered_json report;
    report["splats"] = result.set.size();
    report["splats_before"] = job.scene().gaussians.size();
    report["labelled"] =
        std::count(job.located().label.bits->begin(), job.located().label.bits->end(), std::uint8_t{1});
    report["added"] =
        std::count_if(result.label.begin(), result.label.end(), [](auto bit) { return bit != 0; }) -
        std::count_if(result.base_to_new.begin(), result.base_to_new.end(), [&](std::int64_t row) {
            return row >= 0 && result.label[static_cast<std::size_t>(row)] != 0;
        });
    report["removed"] = std::count(result.base_to_new.begin(), result.base_to_new.end(), std::int64_t{-1});
    report["changed_outside_label"] = result.changed_outside_label;
    report["nonfinite_before"] = result.unusable_before;
    report["nonfinite"] = result.unusable;
    report["nonfinite_labelled"] = result.nonfinite;
    report["psnr_outside_db"] = psnr_outside(job);
    add_search(report, job);
    report["iterations"] = result.iterations;
    report["stopped"] = result.stopped;
    if (result.shortage) report["out_of_memory"] = result.shortage->message();
    if (result.failure) report["guidance_failed"] = result.failure->message();
    report["came_to_rest"] = result.converged;
    report["masks_refreshed"] = result.masks_refreshed;
    report["skipped_steps"] = result.skipped_steps;
    report["skipped_rows"] = result.skipped_rows;
    if (result.kept_chroma >= 0) report["kept_chroma"] = result.kept_chroma;
    report["cloned"] = result.cloned;
    report["split"] = result.split;
    report["pruned"] = result.pruned;
    if (!job.targets().empty()) report["targets"] = targets_to_json(job.targets(), job.views());
    report["model"] = job.model().name();
    report["model_kind"] = neural::kind_name(job.model().kind());
    if (const auto* server = job.server()) report["server"] = server->to_json();
    if (const auto missing = missing_views(job.targets(), job.views()); !missing.empty())
        report["missing_views"] = missing;
    report["settings_from"] = settings_from(job.recipe().plain());
    report["seconds"] = job.times().to_json();
    report["networks"] = job.times().networks_json();
    report["peak_rss_mb"] = peak_rss_mb();
    report["losses"] = history_json(result);
    return report;
}

}  // namespace gse::pipeline
