// The command line: every subcommand registers itself; a parameter struct's field list becomes its options.
#pragma once

#include <CLI/CLI.hpp>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/progress.h"

namespace gse::app {

/// State shared by the commands: quiet output, and the progress bar with its stop token.
struct CommandContext {
    bool quiet = false;
    int exit_code = 0;  // of a command that came to an end; 3 = a change was not done, or failed
    JobControl job() const;
};

/// Adds commands to a program's command line.
using AddCommands = void (*)(CLI::App& app, CommandContext& context);

/// A program as its command line sees it.
struct Program {
    const char* name;
    const char* about;
    std::vector<AddCommands> commands;
    /// Runs where no command is given; null = the help is printed.
    void (*without_command)() = nullptr;
    /// Command for a file that is named without one; null = there is none.
    const char* command_of_files = nullptr;
};

/// Parses and runs; returns the exit code. Throws gse::Error for failures of the command itself.
int run_command_line(const Program& program, int argc, char** argv);

/// Group of options that are read and not shown in helps. (CLI11's own hidden group leaves an option without
/// a name in error messages.)
constexpr const char* EarlierNames = "Earlier names";

/// "guidance_scale" -> "--guidance-scale".
std::string option_name(const std::string& field);

/// Gives every option of the command that takes a number with a fraction the check that it is finite: a range
/// alone lets NaN pass. Called once for all commands.
void require_finite_numbers(CLI::App& command);

/// The option of one field: its help, default and range; a flag gets its opposite too.
template <class Value, class... Ranges>
CLI::Option* add_field_option(CLI::App& command, const std::string& option, Value& value, const char* help,
                              const Ranges&... range) {
    if constexpr (std::is_same_v<Value, bool>)
        return command.add_flag(option + ",!--no-" + option.substr(2), value, help);
    if constexpr (std::is_same_v<Value, Overridable>) {
        const auto set = [&value](const double& number) { value = number; };
        CLI::Option* added = command.add_option_function<double>(option, set, help);
        (added->check(CLI::Range(range.low, range.high)), ...);
        return added->default_str(CLI::detail::to_string(static_cast<double>(value)));
    } else {
        CLI::Option* added = command.add_option(option, value, help)->capture_default_str();
        if constexpr (std::is_same_v<Value, std::vector<std::string>>)
            added->allow_extra_args(false);  // one text each time it is given
        if constexpr (std::is_arithmetic_v<Value>) (added->check(CLI::Range(range.low, range.high)), ...);
        return added;
    }
}

/// A hidden option for each field that is no longer there: its value is ignored.
template <class P> void bind_retired_fields(CLI::App& command) {
    if constexpr (requires { P::RetiredFields; })
        for (const auto& field : P::RetiredFields)
            command
                .add_option_function<std::string>(
                    option_name(std::string(field.name)),
                    [&field](const std::string&) { note_retired_field(field.name); })
                ->group(EarlierNames);
}

/// One option per field, and a hidden one for every name that it had before; a prefix ("--dreambooth-") where
/// the names are those of other settings too.
template <class P>
void bind_fields(CLI::App& command, P& parameters, const std::string& group,
                 const std::string& prefix = "--") {
    P::visit_fields(parameters, [&](const char* name, auto& value, const char* help, const auto&... range) {
        add_field_option(command, prefix + option_name(name).substr(2), value, help, range...)->group(group);
        for (const auto& renamed : renamed_fields<P>())
            if (std::string(name) == renamed.now)
                add_field_option(command, prefix + option_name(renamed.before).substr(2), value, help,
                                 range...)
                    ->group(EarlierNames);
    });
    bind_retired_fields<P>(command);
}

/// Adds the fields whose options stand on the command line, as "request.image_size".
template <class P>
void note_given(const CLI::App& command, const P& parameters, const std::string& part,
                std::set<std::string>& given, const std::string& prefix = "--") {
    P::visit_fields(parameters, [&](const char* name, const auto&, const char*, const auto&...) {
        const auto stands = [&](const char* field) {
            const auto* option = command.get_option_no_throw(prefix + option_name(field).substr(2));
            return option != nullptr && option->count() > 0;
        };
        bool found = stands(name);
        for (const auto& renamed : renamed_fields<P>())
            found = found || (std::string(name) == renamed.now && stands(renamed.before));
        if (found) given.insert(part + "." + name);
    });
}

void add_window_command(CLI::App& app, CommandContext& context);       // open (builds with a window)
void run_default_window();                                             // the program without a command
void add_scene_commands(CLI::App& app, CommandContext& context);       // info, convert, render, turntable
void add_edit_commands(CLI::App& app, CommandContext& context);        // locate, edit
void add_merge_command(CLI::App& app, CommandContext& context);        // merge
void add_transform_command(CLI::App& app, CommandContext& context);    // transform
void add_plan_command(CLI::App& app, CommandContext& context);         // plan
void add_project_command(CLI::App& app, CommandContext& context);      // project
void add_server_command(CLI::App& app, CommandContext& context);       // server
void add_models_command(CLI::App& app, CommandContext& context);       // models
void add_laboratory_pointers(CLI::App& app, CommandContext& context);  // commands that gseditpro-lab has

}  // namespace gse::app
