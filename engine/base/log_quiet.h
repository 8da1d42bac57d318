// Work that is measured, and not asked for, says nothing.
#pragma once

namespace gse::log {

/// While one lives, what its thread logs below Level::Error is dropped. They may be nested.
class Quiet {
public:
    Quiet();
    ~Quiet();
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;
};

}  // namespace gse::log
