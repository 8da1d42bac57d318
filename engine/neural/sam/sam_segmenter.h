// SAM as the segmenter of the search.
#pragma once

#include <filesystem>
#include <memory>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::neural {

/// Cuts out what the clicks are on (method S4c: five inside, three outside, one mask); without clicks what is
/// in the box. What a picture's encoder said is remembered for the pictures asked about last, so that other
/// clicks on them are quick. Threads may ask at the same time. `device`: "cpu" or "cuda". Throws Error
/// (NotFound, Malformed, Unsupported, Model).
std::unique_ptr<edit::Segmenter> load_sam_segmenter(const std::filesystem::path& path,
                                                    const std::string& device);

}  // namespace gse::neural
