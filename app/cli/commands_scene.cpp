// gseditpro info, convert, adjust, cameras, render, turntable.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/cli/cli.h"
#include "app/cli/label_columns.h"
#include "app/cli/scene_output.h"
#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"
#include "engine/base/print.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/image/image_file.h"
#include "engine/io/project/load_scene.h"
#include "engine/io/scene/scene_file.h"
#include "engine/pipeline/inventory/no_scene.h"
#include "engine/pipeline/report/film.h"
#include "engine/pipeline/report/scene_report.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/colour_adjustment.h"
#include "engine/scene/origin/world_offset.h"

namespace gse::app {
namespace {

using Json = nlohmann::ordered_json;

struct SceneOptions {
    std::filesystem::path input, output;
    RenderParameters render;
    TurntableParameters turn;
    ReadingOptions reading;
    SaveOptions save;
    bool labels = false;
    bool drop = false;
    bool json = false;
};

/// One broken file of several does not hide the others.
void print_infos(const std::vector<std::filesystem::path>& paths, const ReadingOptions& open, bool as_json) {
    std::size_t failed = 0;
    Json list = Json::array();
    for (const auto& path : paths) {
        try {
            const Json json = scene_report(path, open);
            if (as_json) list.push_back(json);
            else fmt::print("{}", report_text(json));
        } catch (const Error& error) {
            log::error("{}", error.what());
            ++failed;
        }
    }
    if (as_json) print_json(list);
    if (failed > 0)
        throw Error(ErrorCode::Unreadable,
                    fmt::format("{} of {} scenes cannot be read", failed, paths.size()));
}

void add_info(CLI::App& app, CommandContext&) {
    struct InfoOptions {
        std::vector<std::filesystem::path> scenes;
        ReadingOptions reading;
        bool json = false;
    };
    auto options = std::make_shared<InfoOptions>();
    auto* command = app.add_subcommand(
        "info",
        "Print what scenes and models hold and what may be wrong with them, or how pictures were made");
    command->add_option("scene", options->scenes, "Scene files or folders, pictures (.png), or models")
        ->required();
    command->add_flag("--json", options->json, "Print JSON; a list for several scenes");
    bind_fields(*command, options->reading, "Reading");
    command->callback([options] {
        if (options->scenes.size() > 1) return print_infos(options->scenes, options->reading, options->json);
        const Json json = scene_report(options->scenes.front(), options->reading);
        if (options->json) print_json(json);
        else fmt::print("{}", report_text(json));
    });
}

/// Endings of the formats that have room for labels.
std::string labelled_formats() {
    return in_words(extensions_that_keep(&io::SceneFormat::keeps_labels), "or");
}

/// One command line option per option of a scene format.
void add_format_options(CLI::App& command, SaveOptions& save) {
    save.choices = standard_choices();
    for (const io::FormatOption* option : format_options())
        command.add_option(option_name(option->name), save.choices[option->name], option->help)
            ->capture_default_str()
            ->check(CLI::Range(option->values.front().value, option->values.back().value));
}

void add_convert(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<SceneOptions>();
    auto* command = app.add_subcommand("convert", "Write a scene in another format");
    command->add_option("input", options->input, "Scene file or folder")->required();
    command->add_option("output", options->output, output_help())->required();
    command->add_option("--format", options->save.format,
                        in_words(writable_formats(), "or") + "; from the name when left out");
    add_format_options(*command, options->save);
    command->add_flag("--labels", options->labels,
                      fmt::format("Keep label columns ({} only)", labelled_formats()));
    command->add_flag("--drop-unusable", options->drop, "Leave out splats with NaN or illegal infinities");
    bind_fields(*command, options->reading, "Reading");
    command->callback([options] {
        refuse_weights(options->input);
        Scene scene = load_scene(options->input, options->reading);
        if (options->drop) {
            const std::size_t before = scene.gaussians.size();
            scene.extra = filtered(scene.extra, usable_rows(scene.gaussians));
            scene.gaussians = drop_unusable(scene.gaussians);
            if (scene.gaussians.size() != before) scene.labels = {};
            log::info("{} unusable splats were dropped", before - scene.gaussians.size());
        }
        SaveOptions save = options->save;
        if (options->labels && !scene.labels.labels.empty()) save.from_label = &scene.labels.labels.front();
        else if (!scene.labels.labels.empty())
            log::warning("the labels of the scene are not written; --labels keeps them in a {}",
                         labelled_formats());
        refuse_same_file(options->input, options->output);
        const SavedRows rows = save_scene(options->output, scene, save);
        print("{} splats written to {}{}\n", rows.written, options->output.string(), left_out_text(rows));
    });
}

void add_adjust(CLI::App& app, CommandContext&) {
    struct AdjustOptions {
        std::filesystem::path input, output;
        ColourAdjustment colours;
        ReadingOptions reading;
        bool use_label = false;
    };
    auto options = std::make_shared<AdjustOptions>();
    auto* command = app.add_subcommand("adjust", "Write a scene with its colours adjusted");
    command->add_option("input", options->input, "Scene file or folder")->required();
    command->add_option("output", options->output, output_help())->required();
    command->add_flag("--use-label", options->use_label,
                      "Adjust the splats that the scene's own label marks, not all");
    bind_fields(*command, options->colours, "Colours");
    bind_fields(*command, options->reading, "Reading");
    command->callback([options] {
        refuse_weights(options->input);
        Scene scene = load_scene(options->input, options->reading);
        const auto& labels = scene.labels.labels;
        if (options->use_label && labels.empty())
            throw Error(ErrorCode::InvalidArgument, "the scene has no label",
                        "leave out --use-label, or save it with a label", options->input);
        refuse_same_file(options->input, options->output);
        scene.gaussians = adjusted(
            scene.gaussians,
            options->use_label ? *labels.front().bits : std::vector<std::uint8_t>(scene.gaussians.size(), 1),
            options->colours);
        SaveOptions save;
        if (!labels.empty() && has_room_for_labels(options->output)) save.from_label = &labels.front();
        const SavedRows rows = save_scene(options->output, scene, save);
        print("{} splats written to {}{}\n", rows.written, options->output.string(), left_out_text(rows));
    });
}

void add_cameras(CLI::App& app, CommandContext&) {
    struct CameraOptions {
        std::filesystem::path input, output;
        int orbit = 0;
    };
    auto options = std::make_shared<CameraOptions>();
    auto* command = app.add_subcommand(
        "cameras", "Write viewpoints as cameras.json (3DGS) or transforms.json (nerfstudio)");
    command
        ->add_option("input", options->input,
                     "Project (.gsep), camera file or folder, or a scene with cameras beside it")
        ->required();
    command
        ->add_option("output", options->output,
                     "New file; a name that begins with transforms is nerfstudio's form")
        ->required();
    command->add_option("--orbit", options->orbit, "This many viewpoints around the scene instead of its own")
        ->check(CLI::Range(1, 100000));
    command->callback([options] {
        const auto views = viewpoints_of(options->input, options->orbit);
        save_cameras(options->output, views);
        print("{} viewpoints written to {}\n", views.size(), options->output.string());
    });
}

void add_render(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<SceneOptions>();
    auto* command = app.add_subcommand("render", "Take a picture of a scene");
    command->add_option("scene", options->input, "Scene file or folder")->required();
    command->add_option("output", options->output, "PNG to write")->required();
    auto transparent = std::make_shared<bool>(false);
    command->add_flag("--transparent", *transparent,
                      "Transparent where the scene does not cover the picture");
    bind_fields(*command, options->render, "Picture");
    bind_fields(*command, options->reading, "Reading");
    command->callback([options, transparent] {
        const Scene scene = load_standing_scene(options->input, options->render.up, options->reading);
        Painter painter;
        const Camera camera = choose_camera(scene, options->input, options->render);
        auto settings = raster_settings(options->render, scene.info);
        if (*transparent) settings.background = {0, 0, 0};
        const auto& output = painter.paint(scene.gaussians.spans(), camera, settings);
        write_png(options->output, *transparent ? transparent_picture(output) : output.colour,
                  {{"Software", "GSEditPro"}, {"Recipe", fields_to_json(options->render).dump()}});
        print("{}\n", options->output.string());
    });
}

/// Subject of `turntable`.
struct FilmOptions {
    SceneOptions scene;
    std::filesystem::path before, path;
    bool transparent = false;
};

FilmRequest film_request(const FilmOptions& options) {
    const auto& render = options.scene.render;
    const auto& turn = options.scene.turn;
    const Scene scene = load_standing_scene(options.scene.input, render.up, options.scene.reading);
    const Vec3& offset = scene.info.offset;
    FilmRequest film;
    film.first = scene.gaussians;
    if (!options.before.empty()) {
        film.second = std::make_shared<const GaussianSet>(scene.gaussians);
        refuse_weights(options.before);
        const Scene before = load_scene(options.before);
        film.first = moved(before.gaussians, before.info.offset - offset);
    }
    film.settings = raster_settings(render, scene.info);
    film.transparent = options.transparent;
    film.fps = turn.fps;
    film.cameras =
        options.path.empty()
            ? turn_cameras(whole_orbit(scene, render), turn, render.azimuth, render.width, render.height)
            : path_cameras(moved(load_camera_path(options.path, render.width, render.height), -offset),
                           turn.fps, render.width, render.height);
    return film;
}

void add_turntable(CLI::App& app, CommandContext& context) {
    auto options = std::make_shared<FilmOptions>();
    auto* command = app.add_subcommand("turntable", "Film a turn around a scene, or a camera path");
    command->add_option("scene", options->scene.input, "Scene file or folder")->required();
    command->add_option("output", options->scene.output, "Film (.mp4 or .webm), or a folder for PNG frames")
        ->required();
    command->add_option("--before", options->before, "Another scene to show in the left half");
    command->add_option("--path", options->path,
                        "Camera path (JSON of the editor) to follow instead of a turn");
    command->add_flag("--transparent", options->transparent, "Transparent background (PNG frames)");
    bind_fields(*command, options->scene.render, "Picture");
    bind_fields(*command, options->scene.turn, "Turn");
    bind_fields(*command, options->scene.reading, "Reading");
    command->callback([options, &context] {
        write_film(options->scene.output, film_request(*options), context.job());
        print("{}\n", options->scene.output.string());
    });
}

}  // namespace

void add_scene_commands(CLI::App& app, CommandContext& context) {
    add_info(app, context);
    add_convert(app, context);
    add_adjust(app, context);
    add_cameras(app, context);
    add_render(app, context);
    add_turntable(app, context);
}

}  // namespace gse::app
