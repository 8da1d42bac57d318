// gseditpro-lab bench: run time against error, as JSON.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#ifdef GSE_WINDOW
#include "app/laboratory/bench_moving.h"
#endif
#include "app/cli/model_options.h"
#include "app/laboratory/eval_settings.h"
#include "app/laboratory/laboratory.h"
#include "app/laboratory/server_table.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/path_text.h"
#include "engine/base/print.h"
#include "engine/base/staged_folder.h"
#include "engine/laboratory/bench/all_bench.h"
#include "engine/laboratory/bench/clip_bench.h"
#include "engine/laboratory/bench/edit_bench.h"
#include "engine/laboratory/bench/heal_bench.h"
#include "engine/laboratory/bench/locate_bench.h"
#ifdef GSE_WINDOW
#include "engine/laboratory/bench/raster/preview_bench.h"
#include "engine/laboratory/bench/raster/preview_sweep.h"
#endif
#include "engine/io/project/load_scene.h"
#include "engine/laboratory/bench/raster/raster_report.h"
#include "engine/laboratory/bench/raster/raster_sweep.h"
#include "engine/laboratory/bench/raster/scene_views.h"
#include "engine/laboratory/bench/raster/speed_bench.h"
#include "engine/laboratory/bench/raster/stability_bench.h"
#include "engine/laboratory/bench/scale_bench.h"
#include "engine/laboratory/bench/search_bench.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/raster/bench.h"

namespace gse::app {
namespace {

/// Prints a report, and writes it where a file is named.
template <class Json> void hand_over(const Json& json, const std::filesystem::path& output) {
    if (!output.empty()) write_file(output, json.dump(2) + "\n");
    print_json(json, 2);
}

/// Every setting of a subject, over generated scenes: figures and a picture in a folder.
struct SweepOutput {
    std::filesystem::path folder;
    void leave(const Subject& subject) const {
        const auto place = folder.empty() ? std::filesystem::path("out/bench_" + subject.name) : folder;
        leave_subject(subject, place);
        fmt::print("{}picture {}/{}.png\n", subject_text(subject),
                   std::filesystem::absolute(place).lexically_normal().string(), subject.name);
    }
};
constexpr const char* SweepHelp = "Folder for the figures and the picture; with a scene, a file for the JSON";
constexpr const char* SceneHelp =
    "Scene file; without one, every setting is measured on generated scenes and drawn";

struct RasterBenchOptions {
    std::filesystem::path scene;
    std::string cameras;
    std::filesystem::path output;
    RasterSweepParameters sweep;
    raster::BenchSettings settings;
    std::vector<double> labelled_shares{0.01, 0.05, 0.25, 1};
    bool skips = true;
};

void add_raster_bench(CLI::App& bench, CommandContext& context) {
    auto options = std::make_shared<RasterBenchOptions>();
    options->settings.floor = true;
    auto* command = bench.add_subcommand("raster", "Forward and backward of the rasterizer, with its error");
    command->add_option("scene", options->scene, SceneHelp);
    command->add_option("--cameras", options->cameras,
                        "Camera file; found beside the scene, \"none\" for an orbit");
    command->add_option("--threads", options->settings.threads, "Threads; 0 = one per core")
        ->capture_default_str()
        ->check(CLI::Range(0, 256));
    command->add_flag("--compare,!--no-compare", options->settings.compare_plain,
                      "Measure the error against the plain version");
    command->add_flag("--floor,!--no-floor", options->settings.floor,
                      "Also measure what this machine could do at best");
    command->add_flag("--skips,!--no-skips", options->skips,
                      "Also time an edit's iterations with and without what may be skipped");
    command
        ->add_option("--labelled-shares", options->labelled_shares,
                     "Shares of the splats that those iterations change")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1.0));
    command->add_option("--out", options->output, SweepHelp);
    bind_fields(*command, options->sweep, "Measurement");
    command->callback([options, &context] {
        if (options->scene.empty())
            return SweepOutput{options->output}.leave(bench_raster_sweep(options->sweep, context.job()));
        options->settings.width = options->sweep.width, options->settings.height = options->sweep.height;
        options->settings.repetitions = options->sweep.repetitions;
        if (options->sweep.kernels != "all") options->settings.kernels = options->sweep.kernels;
        const Scene scene = load_scene(options->scene);
        const auto& sweep = options->sweep;
        const auto cameras =
            spread_cameras(scene, options->scene, options->cameras, sweep.views, sweep.width, sweep.height);
        auto json = raster_report(raster::bench_raster(scene.gaussians.spans(), cameras, options->settings));
        if (options->skips)
            json["skips"] = skip_report(raster::bench_skips(scene.gaussians.spans(), cameras,
                                                            options->settings, options->labelled_shares));
        hand_over(json, options->output);
    });
}

void add_stability_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        StabilityParameters parameters;
        SweepOutput output;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(
        "stability", "Error of the rasterizer on scenes that are hard on it, a histogram by cause");
    command->add_option("--out", options->output.folder, "Folder for the figures and the picture");
    bind_fields(*command, options->parameters, "Measurement");
    command->callback(
        [options, &context] { options->output.leave(bench_stability(options->parameters, context.job())); });
}

void add_speed_bench(CLI::App& bench) {
    struct Options {
        SpeedBenchOptions bench;
        std::string raster_size = "512x512", preview_size = "1280x720";
        std::filesystem::path output;
    };
    auto options = std::make_shared<Options>();
    auto* command =
        bench.add_subcommand("speed", "Rasterizer and preview on generated scenes: the README's table");
    command->add_option("--splats", options->bench.splats, "Sizes of the scenes")
        ->capture_default_str()
        ->check(CLI::Range(1, 20000000));
    command->add_option("--seed", options->bench.seed, "Seed of the scenes")->capture_default_str();
    command->add_option("--views", options->bench.views, "Cameras of the circle")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    command->add_option("--repetitions", options->bench.repetitions, "Rounds over them, for the rasterizer")
        ->capture_default_str()
        ->check(CLI::Range(1, 10000));
    command->add_option("--size", options->raster_size, "The rasterizer's picture, WIDTHxHEIGHT")
        ->capture_default_str();
    command->add_option("--preview-size", options->preview_size, "The preview's picture, WIDTHxHEIGHT")
        ->capture_default_str();
    command->add_option("--scenes-out", options->bench.scenes_folder,
                        "Also write the scenes and their cameras into this folder");
    command->add_option("--out", options->output, "Also write the table to this file");
    command->callback([options] {
        parse_picture_size(options->raster_size, options->bench.raster_width, options->bench.raster_height);
        parse_picture_size(options->preview_size, options->bench.preview_width,
                           options->bench.preview_height);
        const auto table = speed_table(options->bench);
        if (!options->output.empty()) write_file(options->output, table);
        fmt::print("{}", table);
    });
}

void add_clip_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        ClipBenchParameters parameters;
        JobParameters job;
        std::filesystem::path output;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand("clip", "A model's image-text encoder on held-out synthetic scenes");
    add_model_options(*command, options->job);
    command->add_option("--out", options->output, "Also write the JSON to this file");
    bind_fields(*command, options->parameters, "Cases");
    command->callback([options, &context] {
        neural_api().set_threads(options->job.threads);
        const auto model = load_recipe_model(options->job);
        const auto score = model->image_text_encoder();
        if (!score)
            throw Error(ErrorCode::NotFound, "the model has no image-text encoder",
                        "its folder needs a folder clip with config.json and model.safetensors");
        const auto json = bench_clip(*score, options->parameters, context.job());
        hand_over(json, options->output);
    });
}

void add_search_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        SearchBenchParameters parameters;
        EditRecipe settings;
        std::filesystem::path output;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(
        "search", "How sure searches are, for words a scene shows and words it does not show");
    add_model_options(*command, options->settings.job);
    command->add_option("--out", options->output, "Also write the JSON to this file");
    bind_fields(*command, options->parameters, "Cases");
    command->add_option("--views", options->settings.request.views, "Viewpoints of a search")
        ->capture_default_str()
        ->check(CLI::Range(3, 512));
    command->add_flag("--plain-ground,!--no-plain-ground", options->settings.guidance.plain_ground,
                      "Show the model a ground where scenes have none");
    command->callback([options, &context] {
        const auto json = bench_search(options->parameters, options->settings, context.job());
        if (!options->output.empty()) write_file(options->output, json.dump(2) + "\n");
        fmt::print("{}\n", json["summary"].dump(2));
    });
}

void add_edit_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        EditBenchParameters parameters;
        EditRecipe settings;
        std::filesystem::path output = "out/bench_edit";
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(
        "edit", "Error of edits against TFLOP and seconds, a curve per method: JSON and a picture");
    command->add_option("--out", options->output, "Folder for edit.json, pareto.png and contact sheets")
        ->capture_default_str();
    bind_fields(*command, options->parameters, "Cases and points");
    add_eval_settings(*command, options->settings);
    command->callback([options, command, &context] {
        apply_eval_model(*command, options->settings);
        StagedFolder folder(options->output, {"edit.json", {"edit.json", "pareto.png"}});
        folder.keep_on_failure();
        auto report = bench_edit(options->parameters, options->settings, folder.path(), context.job());
        report["files"] = folder.listing();
        write_file(folder.path() / "edit.json", json_text(report, 1) + "\n");
        folder.commit();
        fmt::print("{}picture {}/pareto.png\n", subject_text(edit_bench_subject(report)),
                   std::filesystem::absolute(options->output).lexically_normal().string());
        if (report["stopped"].get<bool>())
            throw Error(ErrorCode::Cancelled, "the measurement was stopped; what it had reached is saved", "",
                        options->output);
    });
}

void add_heal_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        HealBenchParameters parameters;
        heal::HealSettings settings;
        SweepOutput output;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(
        "heal", "Things removed from generated scenes, against deletion and the true scenes without them");
    command->add_option("--out", options->output.folder, "Folder for the figures and the picture");
    bind_fields(*command, options->parameters, "Cases");
    command->callback([options, &context] {
        options->output.leave(bench_heal(options->parameters, options->settings, context.job()));
    });
}

void add_server_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        ServerBenchParameters parameters;
        std::filesystem::path output;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(
        "server", "Ways to make a server's views agree, with a server here that contradicts itself");
    command->add_option("--out", options->output, "File for the figures as JSON");
    bind_fields(*command, options->parameters, "Server");
    command->callback(
        [options, &context] { write_server_table(options->parameters, options->output, context.job()); });
}

/// A subject that asks the model: its fields and the model's options.
template <class Parameters>
void add_model_subject(CLI::App& bench, CommandContext& context, const char* name, const char* help,
                       Subject (*measure)(const Parameters&, const EditRecipe&, const JobControl&)) {
    struct Options {
        Parameters parameters;
        EditRecipe settings;
        SweepOutput output;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(name, help);
    add_model_options(*command, options->settings.job);
    command->add_option("--out", options->output.folder, "Folder for the figures and the picture");
    bind_fields(*command, options->parameters, "Measurement");
    command->callback([options, command, measure, &context] {
        apply_eval_model(*command, options->settings);
        options->output.leave(measure(options->parameters, options->settings, context.job()));
    });
}

void add_all_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        AllBenchParameters parameters;
        EditRecipe settings;
        std::filesystem::path output = "out/bench";
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand("all", "Every subject on one page with its pictures: index.html");
    add_model_options(*command, options->settings.job);
    command->add_option("--out", options->output, "Folder for index.html, all.json and the pictures")
        ->capture_default_str();
    bind_fields(*command, options->parameters, "Measurement");
    command->callback([options, command, &context] {
        apply_eval_model(*command, options->settings);
        StagedFolder folder(options->output, {"all.json", all_bench_files()});
        auto report = bench_all(options->parameters, options->settings, folder.path(), context.job());
        report["files"] = folder.listing();
        write_file(folder.path() / "all.json", json_text(report, 1) + "\n");
        folder.commit();
        fmt::print("{}/index.html\n", std::filesystem::absolute(options->output).lexically_normal().string());
    });
}

#ifdef GSE_WINDOW
void add_preview_bench(CLI::App& bench, CommandContext& context) {
    struct Options {
        std::filesystem::path scene, output;
        PreviewBenchOptions bench;
        PreviewSweepParameters sweep;
    };
    auto options = std::make_shared<Options>();
    auto* command = bench.add_subcommand(
        "preview", "A turn around the scene with the preview's renderers, with their error");
    command->add_option("scene", options->scene, SceneHelp);
    command->add_flag("--compare,!--no-compare", options->bench.compare_plain,
                      "Measure the error against the double version");
    command->add_flag("--validation", options->bench.validation,
                      "With Vulkan's validation layers (slow); counts messages");
    command->add_option("--out", options->output, SweepHelp);
    bind_fields(*command, options->sweep, "Measurement");
    command->get_option("--backend")->check(CLI::IsMember({"vulkan", "native", "both"}));
    command->callback([options, &context] {
        if (options->scene.empty())
            return SweepOutput{options->output}.leave(bench_preview_sweep(options->sweep, context.job()));
        options->bench.backend = options->sweep.backend, options->bench.frames = options->sweep.frames;
        parse_picture_size(options->sweep.size, options->bench.width, options->bench.height);
        const Scene scene = load_scene(options->scene);
        auto json = bench_preview(scene, options->bench);
        if (json.contains("native"))
            json["native"]["moving"] = bench_moving(scene, options->bench.width, options->bench.height);
        hand_over(json, options->output);
    });
}
#endif

}  // namespace

void add_bench_command(CLI::App& app, CommandContext& context) {
    auto* bench = app.add_subcommand("bench", "Measure run time against error");
    bench->require_subcommand(1);
    add_raster_bench(*bench, context);
    add_stability_bench(*bench, context);
    add_speed_bench(*bench);
#ifdef GSE_WINDOW
    add_preview_bench(*bench, context);
#endif
    add_clip_bench(*bench, context);
    add_search_bench(*bench, context);
    add_model_subject<LocateBenchParameters>(
        *bench, context, "locate", "Error of searches against passes and seconds, a point per setting",
        bench_locate);
    add_edit_bench(*bench, context);
    add_heal_bench(*bench, context);
    add_server_bench(*bench, context);
    add_model_subject<ScaleBenchParameters>(*bench, context, "scale",
                                            "How time and memory grow with splats, pixels, views and labels",
                                            bench_scale);
    add_all_bench(*bench, context);
}

}  // namespace gse::app
