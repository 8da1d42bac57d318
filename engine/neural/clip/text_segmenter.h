// CLIPSeg as the text segmenter of the search.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::neural {

/// Loads CLIPSeg from a folder in transformers' layout (config.json, model.safetensors or pytorch_model.bin,
/// merges.txt or tokenizer.json). A mask holds the pixels where the noun is at least half as probable as at
/// its most probable pixel. The score is that largest probability. Features of the last pictures are cached.
/// Threads may ask at one time. Throws Error (NotFound, Malformed, Unsupported, Model).
std::unique_ptr<edit::TextSegmenter> load_text_segmenter(const std::filesystem::path& folder,
                                                         const std::string& device);

}  // namespace gse::neural
