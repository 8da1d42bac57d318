// gseditpro plan.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/cli/cli.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/pending_file.h"
#include "engine/base/print.h"
#include "engine/io/project/load_scene.h"
#include "engine/language/plan/plan_sentence.h"
#include "engine/language/plan/plan_text.h"
#include "engine/pipeline/models/model_words.h"
#include "engine/pipeline/models/recipe_model.h"
#include "engine/pipeline/scene/label_names.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/steps/edit_steps.h"

namespace gse::app {
namespace {

using Json = nlohmann::ordered_json;
namespace plan = language::plan;

struct PlanOptions {
    std::filesystem::path scene, sentences, output;
    std::string prompt, source, words;
    std::string model;
    ReadingOptions reading;
    bool json = false;
};

constexpr std::size_t SentenceColumns = 4;  // id, scene, source, sentence; further ones are passed over

std::vector<std::string> columns_of(const std::string& line) {
    std::vector<std::string> columns;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find('\t', begin), line.size());
        columns.push_back(line.substr(begin, end - begin));
        begin = end + 1;
    }
    return columns;
}

void append_utf8(std::string& text, unsigned code) {
    constexpr unsigned OneByte = 0x80, TwoBytes = 0x800, Low = 0x3f;
    if (code < OneByte) {
        text += static_cast<char>(code);
        return;
    }
    if (code < TwoBytes) text += static_cast<char>(0xc0 | code >> 6);
    else text += {static_cast<char>(0xe0 | code >> 12), static_cast<char>(OneByte | (code >> 6 & Low))};
    text += static_cast<char>(OneByte | (code & Low));
}

/// Text without the escapes of a file of sentences: \n \t \r \\, \s (a blank), \uXXXX.
std::string unescaped(const std::string& text) {
    std::string plain;
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (text[at] != '\\' || at + 1 == text.size()) {
            plain += text[at];
            continue;
        }
        const char code = text[++at];
        const auto hex = text.substr(at + 1, 4);
        if (code == 'u' && hex.size() == 4 &&
            hex.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos) {
            append_utf8(plain, static_cast<unsigned>(std::stoul(hex, nullptr, 16)));
            at += hex.size();
        } else
            plain += code == 'n' ? '\n' : code == 't' ? '\t' : code == 'r' ? '\r' : code == 's' ? ' ' : code;
    }
    return plain;
}

void plan_file(const PlanOptions& options) {
    if (options.output.empty())
        throw Error(ErrorCode::InvalidArgument, "--sentences needs --out", "name the file for the plans");
    PendingFile plans(options.output);
    const auto text = read_file(options.sentences);
    std::size_t number = 0, planned = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const auto line = text.substr(begin, end - begin);
        begin = end + 1;
        ++number;
        if (line.empty() || line.starts_with('#')) continue;
        const auto columns = columns_of(line);
        if (columns.size() < SentenceColumns)
            throw Error(ErrorCode::Malformed, fmt::format("line {} has {} columns", number, columns.size()),
                        "a line needs id, scene, source and sentence, with a tab between them",
                        options.sentences);
        const auto made =
            plan::plan_sentence(unescaped(columns[3]), plan::scene_words(columns[1]), columns[2]);
        plans.write(columns[0] + "\t" + to_string(made) + "\n");
        ++planned;
    }
    plans.commit();
    print("{} sentences planned, written to {}\n", planned, options.output.string());
}

/// Names of the scene's labels.
std::vector<std::string> labels_of_scene(const PlanOptions& options) {
    if (options.scene.empty()) return {};
    return pipeline::label_names(load_scene(options.scene, options.reading).labels);
}

edit::EditRequest request_of(const PlanOptions& options) {
    edit::EditRequest request;
    request.source = options.source;
    request.prompt = options.prompt;
    return request;
}

/// Words of the scene: those that were given, else what an edit takes for known.
plan::SceneWords words_of_scene(const PlanOptions& options, const std::vector<std::string>& labels) {
    if (!options.words.empty()) return plan::scene_words(options.words);
    return edit::assumed_scene(request_of(options), labels);
}

/// The plan's steps, each told to the model or with the reason why it cannot be. Refusals have none.
std::vector<edit::PlannedStep> steps_for_model(const plan::Plan& made, const plan::SceneWords& scene,
                                               const std::vector<std::string>& labels,
                                               const PlanOptions& options) {
    pipeline::JobParameters job;
    job.model = options.model;
    if (made.is_refusal()) return {};
    const auto model = pipeline::model_path(job);
    return pipeline::known_to_model(edit::planned_steps(made, scene, pipeline::model_ability(model)),
                                    request_of(options), model, labels);
}

Json step_to_json(const edit::PlannedStep& planned) {
    const auto& step = planned.step;
    Json json{{"operation", std::string(plan::name_of(step.operation))},
              {"text", plan::step_text(step)},
              {"notation", to_string(step)}};
    if (planned.words) json["prompt"] = planned.words->prompt;
    else if (!planned.problem.reason.empty())
        json["reason"] = planned.problem.reason, json["remedy"] = planned.problem.remedy;
    return json;
}

void plan_prompt(const PlanOptions& options) {
    const auto labels = labels_of_scene(options);
    const auto scene = words_of_scene(options, labels);
    const auto made = plan::plan_sentence(options.prompt, scene, options.source);
    auto steps = steps_for_model(made, scene, labels, options);
    if (steps.empty())
        for (const auto& step : made.steps) steps.push_back({step, std::nullopt, {}});
    Json list = Json::array();
    for (std::size_t i = 0; i < steps.size(); ++i) {
        list.push_back(step_to_json(steps[i]));
        if (options.json) continue;
        print("{} {}\n", i + 1, plan::step_text(steps[i].step));
        const auto& [reason, remedy] = steps[i].problem;
        if (!reason.empty()) print("  cannot be done: {}; {}\n", reason, remedy);
    }
    if (options.json)
        print_json(Json{{"sentence", options.prompt}, {"plan", to_string(made)}, {"steps", list}});
}

}  // namespace

void add_plan_command(CLI::App& app, CommandContext&) {
    auto options = std::make_shared<PlanOptions>();
    auto* command =
        app.add_subcommand("plan", "Print what a sentence asks for, step by step; nothing is changed");
    command->add_option("scene", options->scene, "Scene whose labels the sentence may name");
    auto* prompt = command->add_option("--prompt", options->prompt, "Sentence");
    command->add_option("--source", options->source, "Thing that the sentence is about");
    command->add_option("--words", options->words,
                        "Words of the scene, as \"red bear; grass\"; without them its labels and the source");
    command->add_option("--model", options->model,
                        "Model that the steps are held against; empty = as for an edit");
    command->add_flag("--json", options->json, "Print JSON, with the notation of plans");
    auto* sentences =
        command->add_option("--sentences", options->sentences,
                            "File of sentences: id, scene's words, source, sentence, with tabs between");
    command->add_option("--out", options->output, "New file for the plans of --sentences: id, tab, plan")
        ->needs(sentences);
    prompt->excludes(sentences);
    bind_fields(*command, options->reading, "Reading");
    command->callback([options] {
        if (!options->sentences.empty()) return plan_file(*options);
        if (options->prompt.empty())
            throw Error(ErrorCode::InvalidArgument, "there is no sentence", "give --prompt or --sentences");
        plan_prompt(*options);
    });
}

}  // namespace gse::app
