// The one place where exceptions of torch become gse::Error.
#pragma once

#include <c10/util/Exception.h>

#include <new>
#include <string>

#include "engine/base/error.h"

namespace gse::neural {

/// First line of a torch message, without its stack trace.
std::string first_line(const std::string& text);

/// Runs `work`; a torch exception becomes Error (Foreign) "`what` failed: ...".
template <class Work>
auto guard_torch(const std::string& what, Work&& work) {
    try {
        return work();
    } catch (const c10::Error& error) {
        throw Error(ErrorCode::Foreign, what + " failed: " + first_line(error.what_without_backtrace()));
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::Foreign, what + " failed: not enough memory");
    }
}

}  // namespace gse::neural
