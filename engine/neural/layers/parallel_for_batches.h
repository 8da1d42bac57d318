// Work of a small model shared out by pictures: its operations are too short to be shared out themselves.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/neural/api/config.h"

namespace gse::neural {

/// Tells whether the widest level is so narrow that threads would wait longer than they compute.
bool is_small(const UNetConfig& config);

/// Threads that parallel_for_batches() works with: one per core, whatever torch shares an operation out to.
int batch_threads();

/// Calls body(begin, end) for consecutive parts of [0, count), without gradients. With `apart`,
/// batch_threads() threads compute one part each, so that no result depends on their number. Otherwise the
/// caller computes all at once. Network use of the threads counts for the caller. Rethrows the first
/// exception.
void parallel_for_batches(std::int64_t count, bool apart,
                          const std::function<void(std::int64_t begin, std::int64_t end)>& body);

}  // namespace gse::neural
