// CLIP's tokenizer for checkpoints that come without one.
#pragma once

#include <filesystem>

namespace gse::neural {

/// Finds the merges beside the checkpoint, or among the program's assets. Throws Error (NotFound).
std::filesystem::path find_tokenizer(const std::filesystem::path& beside);

}  // namespace gse::neural
