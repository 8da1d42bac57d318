// gseditpro locate, edit.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "app/cli.h"
#include "app/dreambooth_options.h"
#include "app/edit_job.h"
#include "app/edit_output.h"
#include "app/gate.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/io/scene_io.h"

namespace gse::app {
namespace {

struct EditOptions {
    EditRecipe recipe;
    std::filesystem::path recipe_file, output;
    bool demo = false;
    bool headless = false;
    bool json = false;
    bool gate = true;
    CLI::App* command = nullptr;
};

void add_options(CLI::App& command, const std::shared_ptr<EditOptions>& options) {
    options->command = &command;
    command.add_option("--out", options->output, "Folder for the results");
    command.add_option("--recipe", options->recipe_file, "Take every setting from this recipe.json; --out is still yours");
    command.add_flag("--demo", options->demo, "The bundled scene and sentence");
    command.add_flag("--headless", options->headless, "Work without a display (this version always does)");
    command.add_flag("--json", options->json, "Print the report as JSON");
    auto& job = options->recipe.job;
    command.add_option("scene", job.scene, "Scene file or folder");
    JobParameters::visit_fields(job, [&](const char* name, auto& value, const char* help, auto... range) {
        if (std::string(name) == "scene") return;
        auto* option = command.add_option(option_name(name), value, help)->capture_default_str()->group("Files and machine");
        if constexpr (sizeof...(range) == 1) (option->check(CLI::Range(range.low, range.high)), ...);
    });
    bind_fields(command, options->recipe.request, "Edit");
    bind_fields(command, options->recipe.guidance, "Guidance (score distillation)");
    add_dreambooth_options(command, options->recipe);
}

nlohmann::ordered_json tuning_to_json(const neural::TuneReport& tuning) {
    nlohmann::ordered_json json;
    json["steps"] = tuning.steps;
    json["skipped"] = tuning.skipped;
    json["class_seconds"] = tuning.class_seconds;
    json["seconds"] = tuning.seconds;
    json["instance_before"] = tuning.instance_before;
    json["instance_after"] = tuning.instance_after;
    json["prior_before"] = tuning.prior_before;
    json["prior_after"] = tuning.prior_after;
    json["instance_losses"] = tuning.instance_losses;
    json["prior_losses"] = tuning.prior_losses;
    return json;
}

/// What is in the folder, and in the report, only when it was asked for.
void add_optional_parts(nlohmann::ordered_json& report, const std::filesystem::path& folder, EditJob& job,
                        const std::optional<Gate>& gate) {
    if (gate) {
        report["gate"] = gate_to_json(*gate);
        write_gate(folder / "evidence", *gate);
    }
    if (!job.tuning()) return;
    report["dreambooth"] = tuning_to_json(*job.tuning());
    if (job.recipe().dreambooth.rank > 0) job.model().save_lora(folder / "lora.safetensors");
}

/// Before another sentence comes in: what follows from the recipe's own one does not hold for it.
void forget_sentence(EditRecipe& recipe) {
    recipe.request.target.clear();
    recipe.request.mode = "auto";
    recipe.guidance.before_prompt.clear();
}

/// Reads the recipe of --recipe or --demo, or checks that a scene was named.
void complete(EditOptions& options) {
    if (options.demo) options.recipe_file = assets_path() / "scenes/demo.recipe.json";
    if (!options.recipe_file.empty()) {
        options.recipe = read_recipe(options.recipe_file);
        if (options.command->get_option("--prompt")->count() > 0) forget_sentence(options.recipe);
        // What stands on the command line wins over the recipe.
        for (auto* option : options.command->get_options())
            if (option->count() > 0) option->run_callback();
    }
    if (options.recipe.job.scene.empty())
        throw Error(ErrorCode::InvalidArgument, "no scene is named", "give a scene file, --recipe or --demo");
    if (options.output.empty())
        options.output = std::filesystem::path("out") / (options.demo ? "demo" : std::filesystem::path(options.recipe.job.scene).stem());
    options.recipe.request = edit::validated(options.recipe.request);
}

void print_summary(const nlohmann::ordered_json& report, const std::filesystem::path& output) {
    const auto text = std::filesystem::absolute(output).lexically_normal().string();
    fmt::print("{} splats, {} labelled, {} added, {} removed; outside the label {} changed (PSNR {:.1f} dB)\n",
               report["splats"].get<std::size_t>(), report["labelled"].get<long>(), report["added"].get<long>(),
               report["removed"].get<long>(), report["changed_outside_label"].get<std::size_t>(),
               report["psnr_outside_db"].get<double>());
    fmt::print("{:.1f} s, {:.0f} MB at most\n", report["seconds"]["total"].get<double>(),
               report["peak_rss_mb"].get<double>());
    fmt::print("edited scene   {}/scene.ply\nbefore, labels {}/source.ply\nfilm           {}/before_after.mp4\n"
               "pictures       {}/before_after.png, {}/evidence/\nreport, recipe {}/report.json, {}/recipe.json\n",
               text, text, text, text, text, text, text);
}

void run_edit_command(EditOptions& options, const CommandContext& context) {
    complete(options);
    StagedFolder folder(options.output);
    EditJob job(options.recipe, context.job());
    job.locate();
    std::optional<Gate> gate;
    if (options.gate) gate = look_through_gate(job);
    job.run();
    job.times().begin("export");
    Scene edited = job.scene();
    edited.gaussians = job.result().set;
    edited.labels = {};
    save_scene(folder.path() / "scene.ply", edited, {.format = "ply"});
    write_labelled_source(folder.path() / "source.ply", job);
    write_evidence(folder.path() / "evidence", job.located(), job.views());
    write_before_after(folder.path(), job);
    job.times().end();
    auto report = make_report(job);
    add_optional_parts(report, folder.path(), job, gate);
    write_file(folder.path() / "report.json", report.dump(1) + "\n");
    write_file(folder.path() / "recipe.json", recipe_to_json(job.recipe()).dump(2) + "\n");
    folder.commit();
    if (options.json) fmt::print("{}\n", report.dump(2));
    else print_summary(report, options.output);
    if (job.result().stopped)
        throw Error(ErrorCode::Cancelled, "the edit was stopped; what it had reached is saved", "", options.output);
}

void run_locate_command(EditOptions& options, const CommandContext& context) {
    complete(options);
    StagedFolder folder(options.output);
    EditJob job(options.recipe, context.job());
    job.locate();
    write_labelled_source(folder.path() / "source.ply", job);
    write_evidence(folder.path() / "evidence", job.located(), job.views());
    nlohmann::ordered_json report;
    report["splats"] = job.scene().gaussians.size();
    report["labelled"] = std::count(job.located().label.bits->begin(), job.located().label.bits->end(), std::uint8_t{1});
    report["new"] = job.located().seeds.size();
    report["mode"] = job.located().mode == edit::EditMode::Add ? "add" : "modify";
    report["mode_reason"] = job.located().reason;
    report["word"] = job.located().word;
    report["views"] = job.views().size();
    report["failed_views"] = job.located().failed_views;
    report["seconds"] = job.times().to_json();
    add_optional_parts(report, folder.path(), job, std::nullopt);
    write_file(folder.path() / "report.json", report.dump(2) + "\n");
    write_file(folder.path() / "recipe.json", recipe_to_json(job.recipe()).dump(2) + "\n");
    folder.commit();
    if (options.json) fmt::print("{}\n", report.dump(2));
    else
        fmt::print("{} of {} splats labelled for \"{}\" ({} mode), {} new\nlabels   {}/source.ply\nevidence {}/evidence/\n",
                   report["labelled"].get<long>(), report["splats"].get<std::size_t>(),
                   report["word"].get<std::string>(), report["mode"].get<std::string>(),
                   report["new"].get<std::size_t>(), options.output.string(), options.output.string());
}

}  // namespace

void add_edit_commands(CLI::App& app, CommandContext& context) {
    auto locate = std::make_shared<EditOptions>();
    auto* locate_command = app.add_subcommand("locate", "Find what a word means in a scene, without changing it");
    add_options(*locate_command, locate);
    locate_command->callback([locate, &context] { run_locate_command(*locate, context); });
    auto edit = std::make_shared<EditOptions>();
    auto* edit_command = app.add_subcommand("edit", "Change a scene by one sentence");
    add_options(*edit_command, edit);
    edit_command->add_flag("--gate,!--no-gate", edit->gate,
                           "First show what the model makes of four views, in evidence/gate_*.png, and warn when they do not "
                           "show the edit");
    edit_command->callback([edit, &context] { run_edit_command(*edit, context); });
}

}  // namespace gse::app
