// The command line: every subcommand registers itself; a parameter struct's field list becomes its options.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <type_traits>

#include "engine/base/fields.h"
#include "engine/base/progress.h"

namespace gse::app {

/// Parses and runs; returns the exit code. Throws gse::Error for failures of the command itself.
int run_command_line(int argc, char** argv);

/// "guidance_scale" -> "--guidance-scale".
std::string option_name(const std::string& field);

/// One option per field, with the field's help, range and default.
template <class P>
void bind_fields(CLI::App& command, P& parameters, const std::string& group) {
    P::visit_fields(parameters, [&](const char* name, auto& value, const char* help, auto... range) {
        using Value = std::remove_reference_t<decltype(value)>;
        const std::string option = option_name(name);
        CLI::Option* added = nullptr;
        if constexpr (std::is_same_v<Value, bool>)
            added = command.add_flag(option + ",!--no-" + option.substr(2), value, help);
        else
            added = command.add_option(option, value, help)->capture_default_str();
        if constexpr (sizeof...(range) == 1 && std::is_arithmetic_v<Value>)
            (added->check(CLI::Range(static_cast<double>(range.low), static_cast<double>(range.high))), ...);
        added->group(group);
    });
}

/// What the commands share: quiet output, JSON, and the progress bar with its stop token.
struct CommandContext {
    bool json = false;
    bool quiet = false;
    JobControl job() const;
};

using Command = std::function<void()>;

void add_window_command(CLI::App& app, CommandContext& context);     // open (builds with a window)
void run_default_window();                                           // the program without a command
void add_scene_commands(CLI::App& app, CommandContext& context);     // info, convert, render, turntable, synth
void add_edit_commands(CLI::App& app, CommandContext& context);      // locate, edit
void add_project_command(CLI::App& app, CommandContext& context);    // project
void add_training_command(CLI::App& app, CommandContext& context);   // train-starter
void add_bench_command(CLI::App& app, CommandContext& context);      // bench
void add_eval_command(CLI::App& app, CommandContext& context);       // eval

}  // namespace gse::app
