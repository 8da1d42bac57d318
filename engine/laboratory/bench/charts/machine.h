// The machine that figures were measured on.
#pragma once

#include <nlohmann/json.hpp>

namespace gse::bench {

/// {"processor", "cores", "memory_mb", "instruction_sets", "kernels", "vulkan_device"}; what cannot be told
/// is "unknown" or "none".
nlohmann::ordered_json machine_json();

}  // namespace gse::bench
