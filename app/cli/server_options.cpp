// Options of an image server, and the consent to ask it.
#include "app/cli/server_options.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::app {

void add_server_options(CLI::App& command, remote::ServerSettings& settings) {
    remote::ServerSettings::visit_fields(
        settings, [&](const char* name, auto& value, const char* help, const auto&... range) {
            const bool address = std::string(name) == "url";
            const auto option = address ? std::string("--server") : "--server-" + option_name(name).substr(2);
            add_field_option(command, option, value, help, range...)->group("Image server");
        });
}

void settle_server(const CLI::App& command, remote::ServerSettings& settings) {
    const auto* option = command.get_option_no_throw("--server");
    if (option == nullptr || settings.url == "none") settings = {};
    if (!settings.used() || option->count() > 0) return;
    throw Error(
        ErrorCode::InvalidArgument,
        fmt::format("the recipe has its views drawn by an image server ({}), which nobody has allowed here",
                    printable(remote::without_secrets(settings.url))),
        "give --server URL to have pictures of the scene sent there, or --server none to draw here");
}

}  // namespace gse::app
