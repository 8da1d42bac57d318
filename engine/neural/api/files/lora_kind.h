// The model that a LoRA changes, by the names and shapes of its tensors.
#pragma once

#include "engine/neural/api/files/weight_kind.h"

namespace gse::neural {

/// Kind of a file of low-rank changes; role Unknown where it holds none.
WeightKind lora_kind(const WeightHeader& header);

}  // namespace gse::neural
