// Runs the job of `gseditpro edit`, and measures it.
#include "engine/laboratory/eval/eval_scenes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/process_memory.h"
#include "engine/evaluate/consistency.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/eval/eval_figures.h"
#include "engine/localize/clusters.h"
#include "engine/pipeline/report/edit_output.h"
#include "engine/pipeline/scene/scene_loading.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int PathViews = 24;            // cameras around what was edited, 15 degrees apart
constexpr double TellingAzimuth = 0.35;  // a little from the side shows a shape better

/// Everything on a turn around the edit: pictures of both scenes and where either's labelled rows show.
struct Turn {
    std::vector<Image> before, after;
    std::vector<Mask> masks;
};

Mask traces(pipeline::EditJob& job, const Camera& camera) {
    const auto& result = job.result();
    Image seen;
    Mask mask(camera.width, camera.height);
    const auto mark = [&](const GaussianSet& set, const std::vector<std::uint8_t>& bits) {
        const std::vector<float> values(bits.begin(), bits.end());
        job.painter().rasterizer().forward_values(set.spans(), camera, job.plan().settings, values, seen);
        for (std::size_t p = 0; p < mask.data.size(); ++p)
            if (seen.data[p] > TraceShare) mask.data[p] = 1;
    };
    mark(job.scene().gaussians, *job.located().label.bits);
    mark(result.set, result.label);
    const double grow = job.recipe().request.dilate_px * camera.width / edit::ReferenceSide;
    return localize::dilate(mask, grow);
}

Image paint(pipeline::EditJob& job, const GaussianSet& set, const Camera& camera) {
    Image image = job.painter().paint(set.spans(), camera, job.plan().settings).colour;
    for (auto& value : image.data) value = std::clamp(value, 0.0f, 1.0f);
    return image;
}

Turn turn_around(pipeline::EditJob& job) {
    Turn turn;
    const OrbitParameters orbit = job.film_orbit();
    const int side = job.recipe().request.image_size;
    for (int i = 0; i < PathViews; ++i) {
        const Camera camera = orbit_camera(orbit, 2 * std::numbers::pi * (i + 0.5) / PathViews, side, side);
        turn.before.push_back(paint(job, job.scene().gaussians, camera));
        turn.after.push_back(paint(job, job.result().set, camera));
        turn.masks.push_back(traces(job, camera));
    }
    return turn;
}

void add_preservation(pipeline::EditJob& job, Json& entry) {
    OutsideFigures held_out, own;
    const Turn turn = turn_around(job);
    for (std::size_t v = 0; v < turn.before.size(); ++v)
        held_out.add(turn.before[v], turn.after[v], turn.masks[v]);
    for (std::size_t v = 0; v < job.plan().views.size(); ++v) {
        const Camera& camera = job.plan().views[v].camera;
        own.add(paint(job, job.scene().gaussians, camera), paint(job, job.result().set, camera),
                job.plan().masks[v]);
    }
    entry["psnr_outside_db"] = held_out.psnr_db();
    entry["ssim_outside"] = held_out.ssim();
    entry["leak_rate"] = held_out.leak_rate();
    entry["own_psnr_outside_db"] = own.psnr_db();
    entry["own_leak_rate"] = own.leak_rate();
    entry["inconsistency"] = evaluate::path_inconsistency({turn.before, turn.after, turn.masks, true});
    entry["drift"] = evaluate::drifted_rows(job.scene().gaussians, job.result().set, job.result().base_to_new,
                                            *job.located().label.bits);
}

/// Before, attention and label in the edit's first view that found something; before and after from near.
std::vector<Image> row_of(pipeline::EditJob& job, const edit::LocateResult& located) {
    std::size_t view = 0;
    while (view + 1 < located.views.size() && located.views[view].failed) ++view;
    const Camera& camera = job.plan().views[view].camera;
    const int side = 2 * job.recipe().request.image_size;
    const Camera near = orbit_camera(job.film_orbit(), TellingAzimuth, side, side);
    return {located.views[view].render, pipeline::heat_map(located.views[view].map),
            with_mask(located.views[view].render,
                      located.mode == edit::EditMode::Add ? located.views[view].mask : traces(job, camera)),
            paint(job, job.scene().gaussians, near), paint(job, job.result().set, near)};
}

std::string known_word_in(const std::string& text, const std::vector<std::string>& known) {
    std::string best;
    for (const auto& word : known)
        if (word.size() > 2 && text.find(word) != std::string::npos && word.size() > best.size()) best = word;
    return best;
}

}  // namespace

RealEdit parse_real_edit(const std::string& text, const std::vector<std::string>& known_words) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ':');) parts.push_back(part);
    if (parts.empty() || parts.size() > 4 || parts[0].empty())
        throw Error(ErrorCode::InvalidArgument, "the scene \"" + text + "\" is not understood",
                    "write PATH or PATH:source:sentence:target");
    parts.resize(4);
    RealEdit edit{parts[0], parts[1], parts[2], parts[3]};
    if (!std::filesystem::exists(edit.path))
        throw Error(ErrorCode::NotFound, "there is no such scene", "check the path", edit.path);
    if (edit.source.empty())
        edit.source = known_word_in(std::filesystem::path(edit.path).stem().string(), known_words);
    if (edit.source.empty()) edit.source = "statue";
    if (edit.prompt.empty()) {
        edit.prompt = "a golden " + edit.source;
        edit.target = "golden";
    }
    return edit;
}

Json run_real_edit(const RealEdit& edit, pipeline::EditRecipe recipe,
                   const std::shared_ptr<neural::TextToImage>& model, ContactSheets& sheets,
                   const JobControl& job_control) {
    Json entry{
        {"scene", edit.path}, {"source", edit.source}, {"prompt", edit.prompt}, {"target", edit.target}};
    recipe.job.scene = edit.path;
    recipe.request.source = edit.source;
    recipe.request.prompt = edit.prompt;
    recipe.request.target = edit.target;
    recipe.request.mode = "auto";
    try {
        auto [scene, cameras, notes, up] = pipeline::load_scene_with_cameras(edit.path, recipe.job.cameras);
        if (!up.empty()) notes.push_back(up);
        for (const auto& note : notes) log::warning("{}: {}", edit.path, note);
        pipeline::EditJobInput input{std::move(scene), std::move(cameras), model};
        pipeline::EditJob job(recipe, std::move(input), job_control);
        job.locate();
        edit::require_found(job.located());
        job.run();
        if (job.result().stopped) throw Error(ErrorCode::Cancelled, "the evaluation was stopped");
        if (job.result().failure) throw *job.result().failure;
        entry["splats"] = job.scene().gaussians.size();
        entry["labelled"] =
            std::count(job.located().label.bits->begin(), job.located().label.bits->end(), std::uint8_t{1});
        entry["mode"] = edit::mode_name(job.located().mode);
        entry["failed_views"] = job.located().failed_views;
        add_preservation(job, entry);
        entry["nonfinite"] = job.result().nonfinite;
        entry["seconds"] = job.times().to_json();
        sheets.add(row_of(job, job.located()), edit.path + ": " + edit.prompt);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Cancelled) throw;
        entry["error"] = error.message();
        sheets.add({}, edit.path + ": " + edit.prompt + " (failed)");
    }
    entry["peak_rss_mb"] = peak_rss_mb();
    return entry;
}

}  // namespace gse::bench
