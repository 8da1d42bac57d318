// Builds the command line and dispatches.
#include "app/cli/cli.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "engine/base/log.h"
#include "engine/base/printable.h"
#include "engine/base/process.h"
#include "engine/base/progress_bar.h"

#ifndef GSE_VERSION
#define GSE_VERSION "unknown"
#endif

namespace gse::app {
namespace {

/// Help without the options of EarlierNames.
class HelpFormatter final : public CLI::Formatter {
public:
    std::string make_group(std::string group, bool is_positional,
                           std::vector<const CLI::Option*> options) const override {
        if (group == EarlierNames) return {};
        return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
    }
};

/// The arguments, with the command for files where the first one is a file or folder and no command.
std::vector<const char*> with_command(const Program& program, const CLI::App& app, int argc, char** argv) {
    std::vector<const char*> arguments(argv, argv + argc);
    if (program.command_of_files == nullptr || argc < 2 || argv[1][0] == '-') return arguments;
    const auto commands =
        app.get_subcommands([&](const CLI::App* command) { return command->check_name(argv[1]); });
    std::error_code ignored;
    if (commands.empty() && std::filesystem::exists(argv[1], ignored))
        arguments.insert(arguments.begin() + 1, program.command_of_files);
    return arguments;
}

}  // namespace

std::string option_name(const std::string& field) {
    std::string name = "--" + field;
    std::replace(name.begin(), name.end(), '_', '-');
    std::replace(name.begin(), name.end(), '.', '-');
    return name;
}

void require_finite_numbers(CLI::App& command) {
    const CLI::Validator finite(
        [](std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            return std::isfinite(value) ? std::string() : printable(text) + " is not a finite number";
        },
        "");
    for (auto* option : command.get_options(
             [](const CLI::Option* candidate) { return candidate->get_type_name().starts_with("FLOAT"); }))
        option->check(finite);
    for (auto* below : command.get_subcommands({})) require_finite_numbers(*below);
}

JobControl CommandContext::job() const {
    JobControl control;
    control.stop = interrupt_token();
    if (!quiet) {
        auto bar = std::make_shared<ProgressBar>();
        control.progress = [bar](std::string_view stage, int step, int total) {
            bar->update(stage, step, total);
        };
    }
    return control;
}

int run_command_line(const Program& program, int argc, char** argv) {
    CLI::App app{program.about};
    app.formatter(std::make_shared<HelpFormatter>());
    app.set_version_flag("--version", fmt::format("{} {}", program.name, GSE_VERSION));
    app.require_subcommand(0, 1);
    CommandContext context;
    app.add_flag("-q,--quiet", context.quiet, "No progress bar, only warnings");
    for (const AddCommands add : program.commands) add(app, context);
    for (auto* command : app.get_subcommands({})) {
        if (!command->get_prefix_command()) command->fallthrough();
        require_finite_numbers(*command);
    }
    app.parse_complete_callback([&] {
        if (context.quiet) log::set_level(log::Level::Warning);
    });
    const auto arguments = with_command(program, app, argc, argv);
    try {
        app.parse(static_cast<int>(arguments.size()), arguments.data());
    } catch (const CLI::ParseError& error) {
        const int code = app.exit(error);
        return code == 0 ? 0 : 2;
    }
    if (!app.get_subcommands().empty()) return context.exit_code;
    if (program.without_command != nullptr) {
        program.without_command();
        return 0;
    }
    fmt::print("{}", app.help());
    return 2;
}

}  // namespace gse::app
