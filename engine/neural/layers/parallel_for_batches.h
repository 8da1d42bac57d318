// Work of a small model shared out by pictures: its operations are too short to be shared out themselves.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/neural/api/config.h"

namespace gse::neural {

/// Whether the widest level is so narrow that threads spend more time on waiting for each other than on an
/// operation.
bool is_small(const UNetConfig& config);

/// Threads that for_parts() works with: one per core, whatever torch shares an operation out to.
int part_threads();

/// Calls body(begin, end) for consecutive parts of [0, count), without gradients: with `apart` on
/// part_threads() threads, each of which computes its part alone (so that no result depends on their number),
/// else once, on the caller. What the threads ask of the networks counts for the caller. The first exception
/// is rethrown here.
void for_parts(std::int64_t count, bool apart,
               const std::function<void(std::int64_t begin, std::int64_t end)>& body);

}  // namespace gse::neural
