// Options of an image server, and the consent to ask it.
#include "app/cli/server_options.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/printable.h"

namespace gse::app {

namespace {

/// Names of their own: the address, and what is about views.
std::string server_option_name(const std::string& field) {
    if (field == "url") return "--server";
    if (field == "target_picture" || field == "key_view") return option_name(field);
    return "--server-" + option_name(field).substr(2);
}

}  // namespace

void add_server_options(CLI::App& command, remote::ServerSettings& settings) {
    remote::ServerSettings::visit_fields(
        settings, [&](const char* name, auto& value, const char* help, const auto&... range) {
            const auto option = server_option_name(name);
            add_field_option(command, option, value, help, range...)->group("Image server");
        });
}

void give_loras_to_server(const CLI::App& command, EditRecipe& recipe) {
    if (!recipe.server.used() || command.get_option("--lora")->count() == 0) return;
    auto& loras = recipe.server.lora;
    if (command.get_option("--server-lora")->count() == 0) loras.clear();  // of a recipe
    loras.insert(loras.end(), recipe.job.lora.begin(), recipe.job.lora.end());
    recipe.job.lora.clear();
}

void settle_server(const CLI::App& command, remote::ServerSettings& settings) {
    const auto* option = command.get_option_no_throw("--server");
    const bool of_server = !settings.target_picture.empty() || !settings.key_view.empty() ||
                           !settings.lora.empty() || !settings.option.empty() || !settings.also.empty();
    if (option != nullptr && !settings.used() && of_server)
        throw Error(ErrorCode::InvalidArgument,
                    "options and LoRAs of a server, further servers, pictures of your own and a key view "
                    "count where an image server draws the views",
                    "name a server (--server)");
    if (option == nullptr || settings.url == "none") settings = {};
    if (!settings.used()) return;
    if (option->count() == 0)
        throw Error(
            ErrorCode::InvalidArgument,
            fmt::format(
                "the recipe has its views drawn by an image server ({}), which nobody has allowed here",
                printable(remote::without_secrets(settings.url))),
            "give --server URL to have pictures of the scene sent there, or --server none to draw here");
    if (settings.also.empty() || command.get_option("--server-also")->count() > 0) return;
    settings.also.clear();
    log::warning("the further servers of the recipe are not asked: --server-also URL names them");
}

}  // namespace gse::app
