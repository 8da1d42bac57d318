// gseditpro-lab synth: scenes of the synthetic world.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <numbers>

#include "app/cli/label_columns.h"
#include "app/laboratory/laboratory.h"
#include "engine/base/error.h"
#include "engine/base/path_text.h"
#include "engine/base/print.h"
#include "engine/io/cameras/cameras.h"
#include "engine/io/scene/scene_file.h"
#include "engine/laboratory/synth/synth.h"

namespace gse::app {
namespace {

void check_word(const std::string& word, const std::vector<std::string>& words, const char* kind,
                bool may_be_empty) {
    if (word.empty() && may_be_empty) return;
    if (std::find(words.begin(), words.end(), word) != words.end()) return;
    std::string list;
    for (const auto& known : words) list += (list.empty() ? "" : ", ") + known;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("\"{}\" is not {} of the synthetic world", word, kind), "choose from " + list);
}

/// Cameras that frame the object, alternately low and high.
std::vector<View> synth_ring(const synth::SynthScene& scene) {
    constexpr int count = 24, side = 512;
    std::vector<View> views;
    for (int i = 0; i < count; ++i)
        views.push_back(
            {fmt::format("ring_{:02}", i), synth::scene_camera(scene, 2 * std::numbers::pi * i / count,
                                                               i % 2 == 0 ? 0.2 : 0.5, 1, side, side)});
    return views;
}

}  // namespace

void add_synth_command(CLI::App& app, CommandContext&) {
    struct SynthOptions {
        synth::SceneSpec spec;
        std::filesystem::path output;
        std::filesystem::path cameras;
        std::string edit;
    };
    auto options = std::make_shared<SynthOptions>();
    auto& spec = options->spec;
    auto* command = app.add_subcommand("synth", "Generate a scene of the synthetic world, parts labelled");
    command->add_option("output", options->output, "Scene file to write")->required();
    command->add_option("--object", spec.object, "Main object")->capture_default_str();
    command->add_option("--material", spec.material, "Colour or material of the object")
        ->capture_default_str();
    command->add_option("--accessory", spec.accessory, "Accessory of the object; empty = none");
    command->add_option("--accessory-colour", spec.accessory_colour,
                        "Colour of the accessory; empty = its own");
    command->add_option("--ground", spec.ground, "Ground below the object")->capture_default_str();
    command->add_option("--seed", spec.seed, "Shape, pose, texture and light")->capture_default_str();
    command->add_option("--splats", spec.gaussian_budget, "About this many splats")
        ->capture_default_str()
        ->check(CLI::Range(500, 5000000));
    command->add_option("--edit", options->edit, "Sentence of an edit: writes the true edited scene instead");
    command->add_option("--cameras", options->cameras,
                        "Also write a ring of 24 cameras to this cameras.json");
    command->callback([options] {
        auto& wanted = options->spec;
        check_word(wanted.object, synth::object_words(), "an object", false);
        check_word(wanted.material, synth::material_words(), "a material", false);
        check_word(wanted.accessory, synth::accessory_words(), "an accessory", true);
        check_word(wanted.ground, synth::ground_words(), "a ground", false);
        const auto final_spec = options->edit.empty() ? wanted : synth::apply_edit(wanted, options->edit);
        synth::SynthScene result = synth::generate(final_spec);
        std::vector<float> parts(result.parts.size());
        std::transform(result.parts.begin(), result.parts.end(), parts.begin(),
                       [](synth::Part part) { return part == synth::Part::Ground ? 0.0f : 1.0f; });
        SaveOptions save;
        if (has_room_for_labels(options->output)) {
            result.scene.labels.labels.push_back(make_label("part", std::move(parts), 0.5f));
            save.from_label = &result.scene.labels.labels.front();
        }
        save_scene(options->output, result.scene, save);
        if (!options->cameras.empty()) save_cameras_json(options->cameras, synth_ring(result));
        print("{}: {}\n", options->output.string(), synth::full_caption(final_spec).text);
    });
}

}  // namespace gse::app
