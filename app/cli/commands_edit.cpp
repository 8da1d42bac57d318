// gseditpro locate, edit.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "app/cli/cli.h"
#include "app/cli/dreambooth_options.h"
#include "app/cli/server_options.h"
#include "app/engine_names.h"
#include "app/session/state/edit_project.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"
#include "engine/base/print.h"
#include "engine/base/printable.h"
#include "engine/base/staged_folder.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/edit_method.h"
#include "engine/language/plan/plan_text.h"
#include "engine/language/words.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/models/tuning_json.h"
#include "engine/pipeline/report/edit_output.h"
#include "engine/pipeline/report/views_to_draw.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/pipeline/run/preview_check.h"
#include "engine/pipeline/run/variations.h"
#include "engine/pipeline/steps/edit_steps.h"
#include "engine/pipeline/steps/step_judgement.h"

namespace gse::app {
namespace {

// Exit code: a change was not done, or is judged to have failed.
constexpr int SomeNotDone = 3;

struct EditOptions {
    EditRecipe recipe;
    std::filesystem::path recipe_file, output;
    bool demo = false;
    bool headless = false;
    bool json = false;
    bool gate = true;
    bool no_cache = false;
    bool partly = false;
    bool keep_failed = false;
    bool views_only = false;
    std::string scene_words;
    int variations = 1;
    CLI::App* command = nullptr;
};

void add_options(CLI::App& command, const std::shared_ptr<EditOptions>& options) {
    options->command = &command;
    command.add_option("--out", options->output, "Folder for the results");
    command.add_option("--recipe", options->recipe_file,
                       "Take every setting from this recipe.json, or from a picture that an edit made; --out "
                       "is still yours");
    command.add_flag("--demo", options->demo, "The bundled scene and sentence");
    command.add_flag("--headless", options->headless, "Work without a display (this version always does)");
    command.add_flag("--json", options->json, "Print the report as JSON");
    command.add_flag("--no-cache", options->no_cache,
                     "Ask the networks anew, and keep no answer of theirs on the disk");
    auto& job = options->recipe.job;
    command.add_option("scene", job.scene, "Scene file or folder");
    JobParameters::visit_fields(
        job, [&](const char* name, auto& value, const char* help, const auto&... range) {
            if (std::string(name) == "scene") return;
            add_field_option(command, option_name(name), value, help, range...)->group("Files and machine");
        });
    bind_fields(command, options->recipe.request, "Edit");
    bind_fields(command, options->recipe.guidance, "Guidance (score distillation)");
    bind_fields(command, options->recipe.attention, "Attention", "--attention-");
    add_dreambooth_options(command, options->recipe);
}

/// Output that is in the folder, and in the report, only when it was asked for.
void add_optional_parts(nlohmann::ordered_json& report, const std::filesystem::path& folder, EditJob& job,
                        const std::optional<PreviewCheck>& gate) {
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
    auto& request = recipe.request;
    for (auto* words : {&request.target, &request.description, &request.anchor, &request.change,
                        &recipe.guidance.before_prompt})
        words->clear();
    request.mode = "auto";
    for (const char* name : {"request.target", "request.mode", "request.description", "request.anchor",
                             "request.change", "guidance.before_prompt"})
        recipe.given.erase(name);
}

/// Takes over what the model states and neither the recipe's file nor the command line does.
void apply_model(EditOptions& options) {
    auto& recipe = options.recipe;
    auto given = recipe.given;
    note_given(*options.command, recipe.job, "job", given);
    note_given(*options.command, recipe.request, "request", given);
    note_given(*options.command, recipe.guidance, "guidance", given);
    note_given(*options.command, recipe.attention, "attention", given, "--attention-");
    note_given(*options.command, recipe.dreambooth, "dreambooth", given, "--dreambooth-");
    apply_profile(profile_of(recipe.job), recipe, given);
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
    settle_server(*options.command, options.recipe.server);
    give_loras_to_server(*options.command, options.recipe);
    if (options.recipe.job.scene.empty())
        throw Error(ErrorCode::InvalidArgument, "no scene is named", "give a scene file, --recipe or --demo");
    if (options.output.empty())
        options.output = std::filesystem::path("out") /
                         (options.demo ? "demo" : std::filesystem::path(options.recipe.job.scene).stem());
    apply_model(options);
    if (!take_named_label(options.recipe)) take_known_words(options.recipe);
}

/// Results beside their own scene would replace it, or be taken for it the next time.
void refuse_own_folder(const std::filesystem::path& scene, const std::filesystem::path& output) {
    std::error_code ignored;
    const auto folder = std::filesystem::absolute(scene, ignored).lexically_normal().parent_path();
    const auto real_folder = std::filesystem::canonical(scene, ignored).parent_path();
    for (const auto& place : {scene, folder, real_folder})
        if (std::filesystem::equivalent(place, output, ignored))
            throw Error(ErrorCode::InvalidArgument,
                        "--out is the folder of the scene itself, which the results would replace",
                        "choose another folder", output);
}

void print_summary(const nlohmann::ordered_json& report, const std::filesystem::path& output) {
    const auto text = std::filesystem::absolute(output).lexically_normal().string();
    print("{} splats, {} labelled, {} added, {} removed; outside the label {} changed (PSNR {:.1f} dB)\n",
          report["splats"].get<std::size_t>(), report["labelled"].get<long>(), report["added"].get<long>(),
          report["removed"].get<long>(), report["changed_outside_label"].get<std::size_t>(),
          report["psnr_outside_db"].get<double>());
    print("{}\n", report["confidence_text"].get<std::string>());
    const auto& networks = report["networks"]["total"];
    const auto count = [&](const char* name) { return networks[name].get<std::uint64_t>(); };
    print("{:.1f} s, {:.0f} MB at most; {}\n", report["seconds"]["total"].get<double>(),
          report["peak_rss_mb"].get<double>(),
          use_text({count("unet"), count("encoder"), count("decoder"), networks["tflop"].get<double>() * 1e12,
                    networks.value("cached", std::uint64_t{0})}));
    print("edited scene   {}/scene.ply\nproject        {}/edit.gsep\nbefore, labels {}/source.ply\n", text,
          text, text);
    if (report["files"].contains("before_after.mp4")) print("film           {}/before_after.mp4\n", text);
    print("pictures       {}/before_after.png, {}/evidence/\nreport, recipe {}/report.json, {}/recipe.json\n",
          text, text, text, text);
}

/// Ends an edit whose words were not found. What the search saw goes beside the place of the results, which
/// may hold earlier ones.
void require_search(EditJob& job, const std::filesystem::path& output) {
    if (job.found()) return;
    const std::filesystem::path place =
        std::filesystem::absolute(output).lexically_normal().string() + ".search";
    try {
        StagedFolder folder(place, {"report.json", {"report.json", "evidence"}});
        write_evidence(folder.path() / "evidence", job.painter().pool(), job.located(), job.views());
        auto report = locate_report(job);
        report["files"] = folder.listing();
        write_file(folder.path() / "report.json", json_text(report, 2) + "\n");
        folder.commit();
    } catch (const Error& failure) {  // what was looked for was not found all the same
        log::warning("{}", failure.what());
        throw Error(ErrorCode::NotFound, job.located().message, job.located().remedy);
    }
    throw Error(ErrorCode::NotFound, job.located().message,
                job.located().remedy + "; what the views showed is in", place);
}

/// Throws what ended an edit before its time.
void require_finished(const EditJob& job, const std::filesystem::path& output) {
    const auto ended_by = [&](const Error& reason, ErrorCode code) {
        return Error(
            code,
            fmt::format("{}; the edit ended after {} of {} iterations, and what it had reached is saved",
                        reason.message(), job.result().iterations,
                        edit::loop_steps(job.recipe().request, job.located().mode)),
            reason.hint(), output);
    };
    if (const auto& shortage = job.result().shortage) throw ended_by(*shortage, ErrorCode::Foreign);
    if (const auto& failure = job.result().failure) throw ended_by(*failure, failure->code());
    if (job.result().stopped)
        throw Error(ErrorCode::Cancelled, "the edit was stopped; what it had reached is saved", "", output);
}

std::shared_ptr<DiskCache> answers(const EditOptions& options) {
    return options.no_cache ? nullptr : open_answer_cache(load_cache_settings());
}

/// Results that an edit joins: variations on one sheet, earlier steps in one project.
struct Company {
    VariationSheet* sheet = nullptr;
    ProjectData* project = nullptr;
    bool prints = true;
};

/// Report of an edit, and the verdict on it.
struct EditOutcome {
    nlohmann::ordered_json report;
    StepJudgement judgement;
};

/// Verdict on an edit that came to its end; a pass for another.
StepJudgement judged(EditJob& job, nlohmann::ordered_json& report) {
    const auto& result = job.result();
    if (result.iterations == 0 || result.stopped || result.failure || result.shortage) return {};
    auto judgement = judge_step(job);
    report["judgement"] = judgement_to_json(judgement);
    if (!judgement.passed()) log::warning("{}; {}", judgement.reason, judgement.remedy);
    return judgement;
}

/// One edit, into the folder. What failed joins the company's project where failures are kept.
EditOutcome edit_into(const std::filesystem::path& output, EditJob& job, const EditOptions& options,
                      const Company& company) {
    StagedFolder folder(output, {"report.json",
                                 {"scene.ply", "source.ply", "recipe.json", "report.json", "evidence",
                                  "before_after.mp4", "before_after.png", "edit.gsep", "lora.safetensors"}});
    folder.require_space(bytes_of_results(job));
    job.locate();
    require_search(job, output);
    std::optional<PreviewCheck> gate;
    if (options.gate && !edit::method_of(job.recipe().request).draws_views())
        gate = look_through_gate(job);  // redrawn views are judged anyway
    job.run();
    job.times().begin("export");
    folder.keep_on_failure();
    write_edit(folder.path(), job);
    job.times().end();
    auto report = make_report(job);
    const auto judgement = judged(job, report);
    if (job.result().iterations > 0) {
        ProjectData project = company.project != nullptr ? project_with(*company.project, job, report)
                                                         : project_of(job, report);
        write_file(folder.path() / "edit.gsep",
                   ProjectWriter().pack(std::filesystem::absolute(output) / "edit.gsep", project));
        if (company.project != nullptr && (judgement.passed() || options.keep_failed))
            *company.project = std::move(project);
    }
    add_optional_parts(report, folder.path(), job, gate);
    if (const auto& verdict = job.edited().verdict) report["gate"] = verdict_to_json(*verdict);
    report["files"] = folder.listing();
    write_file(folder.path() / "report.json", json_text(report, 1) + "\n");
    folder.commit();
    if (!options.json) print_summary(report, output);
    else if (company.prints) print_json(report, 2);
    if (company.sheet != nullptr) company.sheet->add(job, output.filename().string());
    require_finished(job, output);
    return {std::move(report), judgement};
}

/// Writes the report of all steps, and what the last one taken came to: its scene, and a project of them.
void write_last(const std::filesystem::path& output, const EditJob* job, const ProjectData& project,
                nlohmann::ordered_json report) {
    StagedFolder folder(output, {"report.json", {"scene.ply", "edit.gsep", "report.json"}});
    if (job != nullptr) {
        write_edited_scene(folder.path() / "scene.ply", *job);
        write_file(folder.path() / "edit.gsep",
                   ProjectWriter().pack(std::filesystem::absolute(output) / "edit.gsep", project));
    }
    report["files"] = folder.listing();
    write_file(folder.path() / "report.json", json_text(report, 1) + "\n");
    folder.commit();
}

/// The edit from several seeds, each in a folder of its own, and one picture of them all. Seeds that cannot
/// be drawn are excluded.
void run_variations(const EditOptions& options, CommandContext& context) {
    VariationSheet sheet;
    bool any_passed = options.keep_failed;
    auto reports = nlohmann::ordered_json::array();
    const auto finish = [&] {
        if (sheet.empty()) return;
        sheet.write(options.output / "variations.png");
        if (options.json) print_json(reports, 2);
        else print("to choose from {}\n", (options.output / "variations.png").string());
    };
    const auto folder = [&](int i) { return options.output / std::to_string(i + 1); };
    for (int i = 0; i < options.variations; ++i)
        refuse_own_folder(options.recipe.job.scene, folder(i));  // before the first is begun
    for (int i = 0; i < options.variations; ++i) try {
            EditJob job(variation_of(options.recipe, i), context.job(), answers(options));
            auto outcome = edit_into(folder(i), job, options, {&sheet, nullptr, false});
            any_passed = any_passed || outcome.judgement.passed();
            reports.push_back(std::move(outcome.report));
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Model && (i + 1 < options.variations || !sheet.empty())) {
                log::warning("variation {}: {}", i + 1, error.what());
                continue;
            }
            finish();
            throw;
        }
    finish();
    if (!any_passed) context.exit_code = SomeNotDone;
}

/// Does one step into a folder, and notes in `entry` what became of it. Throws what ends the whole edit.
void run_step(StepSequence& sequence, std::size_t i, const std::filesystem::path& folder,
              const EditOptions& options, const CommandContext& context, ProjectData& project,
              nlohmann::ordered_json& entry) {
    const auto& step = sequence.step(i);
    const auto leave_out = [&](const std::string& reason) {
        log::warning("step {} was not done ({}): {}", i + 1, language::plan::step_text(step.step), reason);
        entry["reason"] = reason;
        sequence.leave_out(i);
    };
    entry["done"] = false;
    if (!step.words) return leave_out(step.problem.reason);
    entry["prompt"] = step.words->prompt;
    if (!options.json) print("step {} of {}, {}\n", i + 1, sequence.size(), step.words->prompt);
    const auto first = [&](EditRecipe recipe) {
        return std::make_unique<EditJob>(std::move(recipe), context.job(), answers(options));
    };
    try {
        auto job = sequence.job_of(i, first, context.job());
        auto outcome = edit_into(folder, *job, options, {nullptr, &project, false});
        entry["report"] = std::move(outcome.report);
        if (!outcome.judgement.passed() && !options.keep_failed) {
            entry["remedy"] = outcome.judgement.remedy;
            return leave_out(outcome.judgement.reason);
        }
        entry["done"] = true;
        sequence.take(i, std::move(job));
    } catch (const Error& error) {
        const bool goes_on = options.partly || sequence.taken() < i;  // an earlier one was kept out
        if (!goes_on || error.code() == ErrorCode::Cancelled) throw;
        leave_out(error.message());
    }
}

/// The steps of a sentence one after the other, each in a folder of its own, and the last scene beside them.
void run_steps(const EditOptions& options, const EditSteps& steps, CommandContext& context) {
    const auto folder = [&](std::size_t i) { return options.output / std::to_string(i + 1); };
    refuse_own_folder(options.recipe.job.scene, options.output);
    for (std::size_t i = 0; i < steps.steps.size(); ++i)
        refuse_own_folder(options.recipe.job.scene, folder(i));
    StepSequence sequence(options.recipe, steps);
    ProjectData project;
    auto report = plan_to_json(steps);
    for (std::size_t i = 0; i < sequence.size(); ++i)
        run_step(sequence, i, folder(i), options, context, project, report["steps"][i]);
    report["done"] = sequence.taken();
    write_last(options.output, sequence.last(), project, report);
    if (options.json) print_json(report, 2);
    if (sequence.taken() == sequence.size()) return;
    log::warning("{} of {} steps were done; the report says why the others were not: {}", sequence.taken(),
                 sequence.size(), (options.output / "report.json").string());
    context.exit_code = SomeNotDone;
}

/// Writes the views that a server would draw, and ends.
void write_views_only(const EditOptions& options, const CommandContext& context) {
    StagedFolder folder(options.output, {"views.json", {"views.json", "views"}});
    EditJob job(options.recipe, context.job(), answers(options));
    job.locate();
    require_search(job, options.output);
    nlohmann::ordered_json report;
    report["views"] = write_views(folder.path() / "views", views_to_draw(job));
    report["files"] = folder.listing();
    write_file(folder.path() / "views.json", json_text(report, 1) + "\n");
    folder.commit();
    if (options.json) return print_json(report, 2);
    for (const auto& view : report["views"])
        print("{:<24} {}\n", printable(view["view"].get<std::string>()),
              (options.output / view["file"].get<std::string>()).string());
    print("Paint over one, and give it as --target-picture VIEW=FILE.\n");
}

void run_edit_command(EditOptions& options, CommandContext& context) {
    complete(options);
    EditSteps steps;
    if (has_steps(options.recipe)) {
        const auto& recipe = options.recipe;
        const auto labels = names_in_scene(recipe);
        const auto scene =
            words_of_scene(recipe, options.scene_words, labels, context.job(), answers(options));
        steps = steps_of_sentence(recipe, scene, options.partly, labels);
    }
    if (steps.nothing_to_change) {
        if (options.json) print_json(plan_to_json(steps), 2);
        else print("Nothing to change: the sentence asks for nothing that is not there already.\n");
        return;
    }
    if (steps.steps.size() > 1) {
        if (options.views_only)
            throw Error(ErrorCode::InvalidArgument, "views are written for one change, not for several",
                        "make the changes one after another");
        if (options.variations > 1)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the sentence asks for {} changes, and variations are of one",
                                    steps.steps.size()),
                        "make the changes one after another");
        return run_steps(options, steps, context);
    }
    if (!steps.steps.empty()) options.recipe = recipe_of_step(options.recipe, steps.steps.front());
    options.recipe = with_words(std::move(options.recipe));
    if (options.views_only) return write_views_only(options, context);
    if (options.variations > 1) return run_variations(options, context);
    refuse_own_folder(options.recipe.job.scene, options.output);
    EditJob job(options.recipe, context.job(), answers(options));
    const auto outcome = edit_into(options.output, job, options, {});
    if (!outcome.judgement.passed() && !options.keep_failed) context.exit_code = SomeNotDone;
}

void run_locate_command(EditOptions& options, const CommandContext& context) {
    complete(options);
    options.recipe = with_words(std::move(options.recipe));
    refuse_own_folder(options.recipe.job.scene, options.output);
    if (std::filesystem::exists(options.output / "scene.ply"))
        throw Error(ErrorCode::Unwritable,
                    "the folder holds an edited scene, which what is found now would not belong to",
                    "choose another place with --out", options.output);
    StagedFolder folder(options.output,
                        {"report.json", {"source.ply", "recipe.json", "report.json", "evidence"}});
    EditJob job(options.recipe, context.job(), answers(options));
    job.locate();
    write_labelled_source(folder.path() / "source.ply", job);
    write_evidence(folder.path() / "evidence", job.painter().pool(), job.located(), job.views());
    auto report = locate_report(job);
    report["nonfinite_before"] = job.unusable();
    add_optional_parts(report, folder.path(), job, std::nullopt);
    write_file(folder.path() / "recipe.json", json_text(recipe_to_json(job.recipe().plain()), 2) + "\n");
    report["files"] = folder.listing();
    write_file(folder.path() / "report.json", json_text(report, 2) + "\n");
    folder.commit();
    if (options.json) print_json(report, 2);
    else
        print(
            "{}\n{} of {} splats labelled for \"{}\" ({} mode), {} new\nlabels   {}/source.ply\nevidence "
            "{}/evidence/\n",
            edit::confidence_text(job.located().confidence), report["labelled"].get<long>(),
            report["splats"].get<std::size_t>(), report["word"].get<std::string>(),
            report["mode"].get<std::string>(), report["new"].get<std::size_t>(), options.output.string(),
            options.output.string());
    edit::require_found(job.located());
}

}  // namespace

void add_edit_commands(CLI::App& app, CommandContext& context) {
    auto locate = std::make_shared<EditOptions>();
    auto* locate_command =
        app.add_subcommand("locate", "Find what a word means in a scene, without changing it");
    add_options(*locate_command, locate);
    locate_command->callback([locate, &context] { run_locate_command(*locate, context); });
    auto edit = std::make_shared<EditOptions>();
    auto* edit_command = app.add_subcommand("edit", "Change a scene by one sentence");
    add_options(*edit_command, edit);
    add_server_options(*edit_command, edit->recipe.server);
    edit_command
        ->add_flag(
            "--views-only", edit->views_only,
            "Write the views that the server would draw to the folder views of --out, to paint over, and "
            "end; no picture is sent")
        ->group("Image server");
    edit_command->add_flag(
        "--gate,!--no-gate", edit->gate,
        "Method sds: first show what the model makes of four views, in evidence/gate_*.png, and warn when "
        "they do not show the edit; redrawn views are judged as they are");
    edit_command
        ->add_option("--variations", edit->variations,
                     "Make so many, each from the next seed, in folders 1, 2, ... of --out, and "
                     "variations.png to choose from")
        ->check(CLI::Range(1, MostVariations));
    edit_command->add_flag("--partly", edit->partly,
                           "Make the changes that can be made of a sentence with several; exit code 3 tells "
                           "that some were not");
    edit_command->add_flag(
        "--keep-failed", edit->keep_failed,
        "Take a change that is judged to have failed all the same. Without it, a failed step of several is "
        "kept out of the scene, and exit code 3 tells of a failed change");
    edit_command->add_option(
        "--words", edit->scene_words,
        "Things that the scene shows, with their colours, as \"red bear; grass\"; empty = "
        "the source, and what pictures of the scene tell");
    edit_command->callback([edit, &context] { run_edit_command(*edit, context); });
}

}  // namespace gse::app
