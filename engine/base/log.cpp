// The log on top of spdlog, which no other header needs.
#include "engine/base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "engine/base/log_quiet.h"
#include "engine/base/printable.h"

namespace gse::log {
namespace {

thread_local int quiet_depth = 0;

struct State {
    std::mutex mutex;
    Sink sink;
    std::atomic<Level> level{Level::Info};
    std::shared_ptr<spdlog::logger> console = make_console();

    static std::shared_ptr<spdlog::logger> make_console() {
        auto logger = std::make_shared<spdlog::logger>(
            "gseditpro", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        logger->set_pattern("%^%l%$: %v");
        logger->set_level(spdlog::level::debug);
        return logger;
    }
};

State& state() {
    static State instance;
    return instance;
}

spdlog::level::level_enum to_spdlog(Level level) {
    switch (level) {
        case Level::Debug: return spdlog::level::debug;
        case Level::Info: return spdlog::level::info;
        case Level::Warning: return spdlog::level::warn;
        case Level::Error: return spdlog::level::err;
        case Level::Off: break;
    }
    return spdlog::level::off;
}

}  // namespace

void set_level(Level level) { state().level = level; }

void set_sink(Sink sink) {
    const std::lock_guard lock(state().mutex);
    state().sink = std::move(sink);
}

Quiet::Quiet() { ++quiet_depth; }
Quiet::~Quiet() { --quiet_depth; }

void write(Level level, std::string_view raw) {
    if (level < state().level.load() || (quiet_depth > 0 && level < Level::Error)) return;
    const std::string text = printable(raw, true);  // names and comments of files stand in it
    const std::lock_guard lock(state().mutex);
    if (state().sink) state().sink(level, text);
    else state().console->log(to_spdlog(level), "{}", text);
}

}  // namespace gse::log
