// gseditpro merge: one scene put into another.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/cli/cli.h"
#include "app/cli/label_columns.h"
#include "app/cli/scene_output.h"
#include "app/engine_names.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/print.h"
#include "engine/base/printable.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/pipeline/scene/shown_surface.h"
#include "engine/scene/transform/merge.h"
#include "engine/scene/transform/merge_place.h"
#include "engine/scene/transform/transformed.h"

namespace gse::app {
namespace {

constexpr int ViewWidth = 1280, ViewHeight = 720;  // of the first view of the scene

struct MergeOptions {
    std::filesystem::path host, guest, output;
    std::vector<double> at;
    double turn = 0, scale = 0;
    std::string up_host = "auto", up_guest = "auto", name;
    ReadingOptions reading;
};

Scene load_upright(const std::filesystem::path& path, const std::string& up, const ReadingOptions& reading) {
    Scene scene = load_standing_scene(path, up, reading);
    scene.info.up = parse_up(up, scene.info);
    return scene;
}

void merge(const MergeOptions& options) {
    refuse_same_file(options.host, options.output);
    refuse_same_file(options.guest, options.output);
    const Scene host = load_upright(options.host, options.up_host, options.reading);
    const Scene guest = load_upright(options.guest, options.up_guest, options.reading);
    MergeWishes wishes;
    if (!options.at.empty()) wishes.at = Vec3{options.at[0], options.at[1], options.at[2]} - host.info.offset;
    wishes.turn = options.turn;
    if (options.scale > 0) wishes.scale = options.scale;
    MergePlace place = merge_place(host, guest, wishes);
    if (!wishes.at && !is_seen_from_around(host, transformed(guest.gaussians, place.placement))) {
        wishes.seen =
            shown_surface(host.gaussians, first_view(host, ViewWidth, ViewHeight), host.info.antialiased);
        place = merge_place(host, guest, wishes);
    }
    const std::string name = options.name.empty() ? pipeline::name_of_thing(options.guest) : options.name;
    for (const std::string& note : place.notes) log::info("{}: {}", printable(name), note);
    if (host.info.antialiased != guest.info.antialiased)
        log::warning(
            "one scene was trained with opacity compensation, the other was not: {} may look "
            "thinner or thicker than before",
            printable(name));
    const Scene scene = merged(host, guest, place.placement, name);
    SaveOptions save;
    if (has_room_for_labels(options.output)) {
        save.from_label = &scene.labels.labels.back();
        if (scene.labels.labels.size() > 1)
            log::warning("the labels of {} are not written: the file has room for one, which marks {}",
                         printable(options.host.filename().string()), printable(name));
    }
    const SavedRows rows = save_scene(options.output, scene, save);
    print("{} splats written to {}{}\n", rows.written, options.output.string(), left_out_text(rows));
}

}  // namespace

void add_merge_command(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<MergeOptions>();
    auto* command = app.add_subcommand("merge", "Put one scene into another and write both as one");
    command->add_option("scene", options->host, "Scene file, folder or project that takes the other")
        ->required();
    command->add_option("other", options->guest, "Scene file, folder or project that is put into it")
        ->required();
    command->add_option("--out", options->output, output_help())->required();
    command
        ->add_option("--at", options->at,
                     "Place of its foot: x,y,z in the first file's coordinates; on the ground where left out")
        ->delimiter(',')
        ->expected(3)
        ->type_name("FLOAT,FLOAT,FLOAT");
    command
        ->add_option("--turn", options->turn,
                     "Turn about the upright axis, degrees, counter-clockwise as seen from above")
        ->check(CLI::Range(-3600.0, 3600.0));
    command
        ->add_option("--scale", options->scale,
                     "Factor of its size. Left out, it keeps its size, or gets a third of the scene's where "
                     "that is more than four times off")
        ->check(CLI::Range(1e-6, 1e6));
    command->add_option("--up", options->up_host, "Up of the first scene: auto, x, y, z, -x, -y or -z")
        ->capture_default_str();
    command->add_option("--up-b", options->up_guest, "Up of the second scene, as --up")
        ->capture_default_str();
    command->add_option("--name", options->name, "Name of its label; from its file when left out");
    bind_fields(*command, options->reading, "Reading");
    command->callback([options] { merge(*options); });
}

}  // namespace gse::app
