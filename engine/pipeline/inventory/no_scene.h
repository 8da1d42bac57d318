// Files of weights that are named where a scene is asked for.
#pragma once

#include <filesystem>

namespace gse::pipeline {

/// Throws Error (InvalidArgument) for weights of a network, a model's folder or a LoRA's, in place of a
/// scene: its kind, and what takes it. Does nothing for everything else, and where nothing is.
void refuse_weights(const std::filesystem::path& path);

}  // namespace gse::pipeline
