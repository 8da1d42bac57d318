// One flag and the list of fields.
#include "app/cli/dreambooth_options.h"

#include "app/cli/cli.h"

namespace gse::app {

void add_dreambooth_options(CLI::App& command, EditRecipe& recipe) {
    const std::string group = "DreamBooth";
    command
        .add_flag("--dreambooth,!--no-dreambooth", recipe.use_dreambooth,
                  "Let the model learn the scene from renders of it first")
        ->group(group);
    bind_fields(command, recipe.dreambooth, group, "--dreambooth-");
}

}  // namespace gse::app
