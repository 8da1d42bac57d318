// Commands that gseditpro-lab has: not listed, and answered with one sentence.
#include "app/cli/cli.h"
#include "engine/base/error.h"

namespace gse::app {

void add_laboratory_pointers(CLI::App& app, CommandContext&) {
    for (const std::string name : {"eval", "bench", "synth", "train-starter"}) {
        auto* command = app.add_subcommand(name, "")->group("")->prefix_command();
        command->set_help_flag();
        command->callback([name] {
            throw Error(ErrorCode::InvalidArgument, name + " is a command of gseditpro-lab",
                        "run gseditpro-lab " + name + ", which is built with the tests");
        });
    }
}

}  // namespace gse::app
