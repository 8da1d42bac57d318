// Family of a denoiser (UNet or transformer) by the names of its tensors.
#pragma once

#include "engine/neural/api/files/tensor_names.h"
#include "engine/neural/api/files/weight_kind.h"

namespace gse::neural {

/// Family and variant of the denoiser under one of the usual prefixes; an empty family where there is none.
/// The role tells whether a text encoder is in the file, too.
WeightKind denoiser_kind(const WeightHeader& header);

}  // namespace gse::neural
