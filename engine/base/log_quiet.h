// Silence for measured work that the user did not ask for.
#pragma once

namespace gse::log {

/// Drops messages below Level::Error of its thread while it lives. May be nested.
class Quiet {
public:
    Quiet();
    ~Quiet();
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;
};

}  // namespace gse::log
