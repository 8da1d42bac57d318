// Memory before it is asked for: what this process can still get, and the sentences for when that is not
// enough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace gse {

/// What the work needs is not free. A type of its own, so that a long run can tell it and keep what it has
/// reached.
class OutOfMemory : public Error {
public:
    explicit OutOfMemory(const std::string& message);
};

/// Bytes this process can still get: the least of what the machine, its control group and its own limits
/// leave.
std::uint64_t free_memory();

/// Throws OutOfMemory when `bytes` are not free; `purpose` begins the sentence ("the scene of 5000000
/// splats"). Small requests are not looked at: they cost nothing to try.
void require_memory(std::uint64_t bytes, std::string_view purpose);

/// "1.5 GB"; three digits at most.
std::string memory_text(std::uint64_t bytes);

/// The error for an allocation of `bytes` that failed; 0 = of unknown size.
OutOfMemory out_of_memory(std::uint64_t bytes);

/// The error for the std::bad_alloc that this thread has just caught, with the size that note_refused() was
/// told.
OutOfMemory out_of_memory();

/// Called by the program's operator new before it throws.
void note_refused(std::size_t bytes) noexcept;

}  // namespace gse
