// Output of the commands. Text from files is escaped, so that no name or comment reaches a terminal as an
// order.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "engine/base/json.h"
#include "engine/base/printable.h"

namespace gse {

/// Text as printable() gives it. Every other value stays as it is.
template <class T> auto shown(const T& value) {
    if constexpr (std::is_same_v<T, std::filesystem::path>) return printable(value.string());
    else if constexpr (std::is_convertible_v<const T&, std::string_view>)
        return printable(std::string_view(value));
    else return value;
}

/// fmt::print with every argument as shown().
template <class... Args>
void print(fmt::format_string<decltype(shown(std::declval<const Args&>()))...> format, const Args&... args) {
    fmt::print(format, shown(args)...);
}

/// Prints the value in ASCII and a line end.
template <class Json> void print_json(const Json& json, int indent = 2) {
    fmt::print("{}\n", json_text(json, indent, true));
}

}  // namespace gse
