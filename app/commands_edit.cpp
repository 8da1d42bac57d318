// gseditpro locate, edit.
#include "app/cli.h"

namespace gse::app {

void add_edit_commands(CLI::App&, CommandContext&) {}

}  // namespace gse::app
