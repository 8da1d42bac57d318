// Free memory of the process, and the errors for too little of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace gse {

/// Memory that the work needs is not free. A long run catches this type to keep its results so far.
class OutOfMemory : public Error {
public:
    explicit OutOfMemory(const std::string& message);
};

/// Bytes this process can still get: the least of what the machine, its control group and its own limits
/// leave.
std::uint64_t free_memory();

/// Throws OutOfMemory when `bytes` are not free. `purpose` begins the sentence ("the scene of 5000000
/// splats"). Small requests are not checked; trying them costs nothing.
void require_memory(std::uint64_t bytes, std::string_view purpose);

/// Size as text of at most three digits: "1.5 GB".
std::string memory_text(std::uint64_t bytes);

/// Error for an allocation of `bytes` that failed; 0 = of unknown size.
OutOfMemory out_of_memory(std::uint64_t bytes);

/// Error for the std::bad_alloc that this thread has just caught, with the size that note_refused() was told.
OutOfMemory out_of_memory();

/// Called by the program's operator new before it throws.
void note_refused(std::size_t bytes) noexcept;

}  // namespace gse
