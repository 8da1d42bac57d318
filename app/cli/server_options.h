// Options of an image server, for commands that may have one draw.
#pragma once

#include "app/cli/cli.h"
#include "app/engine_names.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/remote/api/server_settings.h"

namespace gse::app {

/// Adds --server and the options of its settings, --server-kind and so on.
void add_server_options(CLI::App& command, remote::ServerSettings& settings);

/// LoRAs of the command line are the server's where one draws: the model here is not asked to draw.
void give_loras_to_server(const CLI::App& command, EditRecipe& recipe);

/// Decides whether a server is asked: only one that stands on the command line is. "none" takes back what a
/// recipe names, and so does a command without these options. Throws Error (InvalidArgument) for a recipe
/// that names one where the command line does not.
void settle_server(const CLI::App& command, remote::ServerSettings& settings);

}  // namespace gse::app
