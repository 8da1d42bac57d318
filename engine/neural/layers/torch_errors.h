// The one place where exceptions of torch become gse::Error.
#pragma once

#include <c10/util/Exception.h>

#include <cstdint>
#include <new>
#include <string>

#include "engine/base/error.h"
#include "engine/base/memory.h"

namespace gse::neural {

/// First line of a torch message, without its stack trace.
std::string first_line(const std::string& text);

/// Bytes that a torch message about a failed allocation names ("you tried to allocate 1024 bytes", "Tried to
/// allocate 2.00 GiB"). Returns 0 for other messages.
std::uint64_t refused_bytes(const std::string& text);

/// Runs `work`; a torch exception becomes Error (Foreign) "`what` failed: ...", or OutOfMemory.
template <class Work> auto guard_torch(const std::string& what, Work&& work) {
    try {
        return work();
    } catch (const c10::Error& error) {
        if (const auto bytes = refused_bytes(error.what_without_backtrace())) throw out_of_memory(bytes);
        throw Error(ErrorCode::Foreign, what + " failed: " + first_line(error.what_without_backtrace()));
    } catch (const std::bad_alloc&) { throw out_of_memory(); }
}

}  // namespace gse::neural
