// Strength of a LoRA's layers as its files state it beside the tensors, without torch.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gse::neural {

/// A layer of a LoRA that has no alpha among its tensors.
struct LoraLayer {
    bool text = false;      // of the text encoder
    std::string name;       // "down_blocks.0.attentions.0....to_q", or with "_" for "." as kohya writes it
    std::int64_t rank = 1;  // of its matrices
    bool peft = false;      // its matrices are called lora_A and lora_B
    bool kernel = false;    // a convolution of more than one pixel
};

struct StatedAlphas {
    std::vector<double> alphas;  // one per layer
    std::string note;            // sentence about a statement that is not used; empty = there is none
};

/// Alphas of the layers, such that alpha / rank is the strength. The first source that states one counts:
/// "alpha_pattern", then "lora_alpha" of PEFT's adapter_config.json beside `file` (layers of PEFT only) and
/// of diffusers' "lora_adapter_metadata" in the file's metadata; then "lora_alpha" and kohya's
/// "ss_network_alpha" there. The rank is the alpha of a layer of which nothing is stated. "use_rslora" is
/// counted in. Throws Error (Malformed) for a statement that cannot be read.
StatedAlphas stated_alphas(const std::filesystem::path& file,
                           const std::map<std::string, std::string>& metadata,
                           const std::vector<LoraLayer>& layers);

}  // namespace gse::neural
