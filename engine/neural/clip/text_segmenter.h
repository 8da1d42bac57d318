// CLIPSeg as the text segmenter of the search.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::neural {

/// From a folder in transformers' layout (config.json, model.safetensors or pytorch_model.bin, merges.txt). A
/// mask is where the noun is at least half as probable as where it is most; the score is that largest
/// probability. What the image encoder said is remembered for the pictures asked about last. Threads may ask
/// at the same time. Throws Error (NotFound, Malformed, Unsupported, Model).
std::unique_ptr<edit::TextSegmenter> load_text_segmenter(const std::filesystem::path& folder,
                                                         const std::string& device);

}  // namespace gse::neural
