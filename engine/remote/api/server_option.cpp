// Names and values of a server's own settings.
#include "engine/remote/api/server_option.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/base/printable.h"

namespace gse::remote {
namespace {

constexpr std::size_t MostBytes = 4096;
constexpr std::string_view ForceMark = "force:";
constexpr std::array<std::string_view, 6> SecretWords{"token",         "password", "passwd",
                                                      "authorization", "secret",   "api_key"};

bool names_secret(std::string name) {
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::any_of(SecretWords.begin(), SecretWords.end(),
                       [&](auto word) { return name.find(word) != std::string::npos; });
}

/// True for one name, and for the name of a field in the other's object.
bool holds(const std::string& name, const std::string& other) {
    return other == name || other.starts_with(name + ".");
}

}  // namespace

ServerOption parse_server_option(std::string_view text) {
    const auto equals = text.find('=');
    const bool forced = text.starts_with(ForceMark);
    const std::size_t first = forced ? ForceMark.size() : 0;
    if (text.size() > MostBytes || equals == std::string_view::npos || equals <= first)
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"{}\" is no option of a server", printable(text.substr(0, 80))),
                    "write it as NAME=VALUE, such as scheduler=karras");
    ServerOption option{std::string(text.substr(first, equals - first)), std::string(text.substr(equals + 1)),
                        forced};
    if (names_secret(option.name))
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"{}\" is a secret, which no option holds", printable(option.name)),
                    "set GSEDITPRO_SERVER_TOKEN");
    return option;
}

std::vector<ServerOption> parse_server_options(const std::vector<std::string>& texts) {
    std::vector<ServerOption> options;
    for (const auto& text : texts) {
        auto option = parse_server_option(text);
        if (std::any_of(options.begin(), options.end(), [&](const auto& other) {
                return holds(other.name, option.name) || holds(option.name, other.name);
            }))
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the server's option \"{}\" is given twice", printable(option.name)),
                        "leave one of them out");
        options.push_back(std::move(option));
    }
    return options;
}

nlohmann::json json_value(const ServerOption& option) {
    auto value = try_parse_json(option.value);
    if (value.is_discarded()) return option.value;
    return value;
}

}  // namespace gse::remote
