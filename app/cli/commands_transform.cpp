// gseditpro transform: the labelled thing of a scene moved, turned, resized or copied.
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
#include "engine/edit/placement/rearrangement.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/scene/stack_edits.h"

namespace gse::app {
namespace {

struct TransformOptions {
    std::filesystem::path input, output;
    edit::RearrangeSettings change;
    ReadingOptions reading;
    std::string label, other, up = "auto";
    double front = 0;  // degrees
    bool use_label = false;
};

/// Index of the label of that name; the first for an empty name.
int label_of(const DocumentState& state, const std::string& name, const std::filesystem::path& path) {
    for (std::size_t i = 0; i < state.labels.size(); ++i)
        if (name.empty() || state.labels[i].name == name) return static_cast<int>(i);
    const std::string hint = "leave out --use-label, or save it with a label";
    if (name.empty()) throw Error(ErrorCode::InvalidArgument, "the scene has no label", hint, path);
    throw Error(ErrorCode::InvalidArgument, fmt::format("the scene has no label \"{}\"", printable(name)),
                "name one that it has", path);
}

/// Horizontal direction in which the front looks that is seen from an azimuth.
Vec3 front_direction(const Vec3& up, double degrees) {
    OrbitParameters orbit;
    orbit.up = up;
    orbit.elevation = 0;
    return -orbit_camera(orbit, degrees * Degree, 1, 1).forward();
}

Label written_label(const NamedLabel& label) {
    std::vector<float> weight(label.bits->begin(), label.bits->end());
    constexpr float Middle = 0.5f;
    return make_label(label.name, std::move(weight), Middle);
}

void transform(const TransformOptions& options) {
    refuse_same_file(options.input, options.output);
    Scene scene = load_standing_scene(options.input, options.up, options.reading);
    const Vec3 up = parse_up(options.up, scene.info), front = front_direction(up, options.front);
    DocumentState state = initial_state(scene, {});
    std::vector<std::uint8_t> rows(state.current.size(), 1), of_other;
    if (options.use_label || !options.label.empty()) {
        state.active_label = label_of(state, options.label, options.input);
        rows = *state.labels[static_cast<std::size_t>(state.active_label)].bits;
    }
    const edit::ThingFrame thing = edit::thing_frame(state.current, rows, up, front);
    edit::ThingFrame other;
    if (!options.other.empty()) {
        of_other =
            *state.labels[static_cast<std::size_t>(label_of(state, options.other, options.input))].bits;
        other = edit::thing_frame(state.current, of_other, up, front);
    }
    const auto others = edit::other_points(state.current, rows, thing.frame);
    const edit::Rearrangement places =
        edit::rearrangement(options.change, thing, options.other.empty() ? nullptr : &other, others);
    if (places.leaves_place && !others.empty())
        log::info("what the thing hid at its old place is as it was: nothing is filled in");
    state = with_edit(state, edit::rearrangement_edit(state, rows, of_other, places, next_edit_id(state)),
                      "copies", false);
    scene.gaussians = state.current;
    scene.extra = current_columns(state);
    scene.labels = {};
    SaveOptions save;
    if (state.active_label >= 0 && has_room_for_labels(options.output)) {
        scene.labels.labels.push_back(
            written_label(state.labels[static_cast<std::size_t>(state.active_label)]));
        save.from_label = &scene.labels.labels.front();
    }
    const SavedRows written = save_scene(options.output, scene, save);
    print("{} splats written to {}{}\n", written.written, options.output.string(), left_out_text(written));
}

}  // namespace

void add_transform_command(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<TransformOptions>();
    auto* command = app.add_subcommand(
        "transform", "Write a scene with its thing moved, turned, resized or copied; nothing is filled in");
    command->add_option("input", options->input, "Scene file, folder or project")->required();
    command->add_option("output", options->output, output_help())->required();
    command->add_flag("--use-label", options->use_label,
                      "Move the splats that the scene's own label marks, not all");
    command->add_option("--label", options->label, "Name of the label to move, of a project with several");
    command->add_option("--other", options->other,
                        "Name of the label of the other thing that the change names");
    command->add_option("--up", options->up, "World up: auto, x, y, z, -x, -y or -z")->capture_default_str();
    command->add_option("--front", options->front, "Azimuth from which the scene shows its front, degrees")
        ->check(CLI::Range(-3600.0, 3600.0))
        ->capture_default_str();
    bind_fields(*command, options->change, "Change");
    bind_fields(*command, options->reading, "Reading");
    command->callback([options] { transform(*options); });
}

}  // namespace gse::app
