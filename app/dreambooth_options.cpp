// One flag and the list of fields.
#include "app/dreambooth_options.h"

#include <type_traits>

#include "app/cli.h"

namespace gse::app {

void add_dreambooth_options(CLI::App& command, EditRecipe& recipe) {
    const std::string group = "DreamBooth";
    command.add_flag("--dreambooth,!--no-dreambooth", recipe.use_dreambooth,
                     "Let the model learn the scene from renders of it first")
        ->group(group);
    neural::DreamBoothParameters::visit_fields(
        recipe.dreambooth, [&](const char* name, auto& value, const char* help, auto... range) {
            // Prefixed: steps, seed and others are names of other settings too.
            const std::string option = "--dreambooth-" + option_name(name).substr(2);
            if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, bool>)
                command.add_flag(option + ",!--no-" + option.substr(2), value, help)->group(group);
            else {
                auto* added = command.add_option(option, value, help)->capture_default_str()->group(group);
                if constexpr (sizeof...(range) == 1)
                    (added->check(CLI::Range(static_cast<double>(range.low), static_cast<double>(range.high))), ...);
            }
        });
}

}  // namespace gse::app
