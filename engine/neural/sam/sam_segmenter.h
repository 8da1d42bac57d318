// SAM as the segmenter of the search.
#pragma once

#include <filesystem>
#include <memory>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::neural {

/// Loads SAM or MobileSAM. Clicks (five inside, three outside) or a box give one mask. Embeddings of the last
/// pictures are cached, so that other clicks on them are quick. Threads may ask at one time. `device`: "cpu"
/// or "cuda". Throws Error (NotFound, Malformed, Unsupported, Model).
std::unique_ptr<edit::Segmenter> load_sam_segmenter(const std::filesystem::path& path,
                                                    const std::string& device);

}  // namespace gse::neural
