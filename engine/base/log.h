// The log of the whole program: ERROR = data lost, WARNING = done but not as asked, INFO = for the user.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string_view>
#include <utility>

namespace gse::log {

enum class Level { Debug, Info, Warning, Error, Off };

/// Receives every message at or above the level; called from any thread, one message at a time.
using Sink = std::function<void(Level, std::string_view)>;

/// Messages below `level` are dropped. Default: Info, written to stderr.
void set_level(Level level);

/// Replaces stderr by `sink` (the window's log panel, a test); an empty sink restores stderr.
void set_sink(Sink sink);

void write(Level level, std::string_view text);

template <class... Args> void debug(fmt::format_string<Args...> format, Args&&... args) {
    write(Level::Debug, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args> void info(fmt::format_string<Args...> format, Args&&... args) {
    write(Level::Info, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args> void warning(fmt::format_string<Args...> format, Args&&... args) {
    write(Level::Warning, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args> void error(fmt::format_string<Args...> format, Args&&... args) {
    write(Level::Error, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace gse::log
