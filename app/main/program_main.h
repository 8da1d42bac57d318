// main() of both programs: runs a command line, and turns its end into an exit code.
#pragma once

#include "app/cli/cli.h"

namespace gse::app {

/// Runs the program's command line. Returns its exit code: 0, 1 (failed), 2 (a wrong argument), 70 (a fault
/// of the program) or 130 (stopped). An error is one sentence on stderr that begins with the program's name.
int program_main(const Program& program, int argc, char** argv);

}  // namespace gse::app
