// Fills a network from named tensors with exact accounting: every key used once, none missing, every shape
// right.
#pragma once

#include <set>

#include "engine/base/memory.h"
#include "engine/neural/layers/layers.h"
#include "engine/neural/weights/tensor_file.h"

namespace gse::neural {

/// Place of one parameter in a file.
struct WeightSource {
    std::string key;        // name in the file
    std::int64_t row = -1;  // part number `row` of `rows` stacked blocks along the first dimension (q, k, v)
    std::int64_t rows = 1;
    bool transpose = false;  // the file holds the 2D transpose
};

/// Maps a parameter's name in our network to its place in the file.
using WeightMap = std::function<WeightSource(const std::string& parameter)>;

/// Matching of a file to a network.
struct LoadPlan {
    WeightMap map;  // empty = same names
    std::function<bool(const std::string& key)>
        ignore;                    // keys of the file that may be left over; empty = none
    std::string what = "network";  // for messages: "UNet"
};

/// Copies all parameters of `module` from `file`. Throws Error (Model) that names the missing, the left-over
/// or the mis-shaped key (the first, and how many more). Returns the keys of the file that were used.
std::set<std::string> load_weights(torch::nn::Module& module, const TensorFile& file, const LoadPlan& plan);

/// Checks names and shapes as load_weights() does, without values: `module` on torch::kMeta, `shapes` the
/// keys of the file.
std::set<std::string> check_weights(const torch::nn::Module& module, const KeyShapes& shapes,
                                    const LoadPlan& plan, const std::filesystem::path& path);

/// Bytes of all parameters in 32-bit floats; the module may be on torch::kMeta.
std::uint64_t weight_bytes(const torch::nn::Module& module);

/// A network of `config` with the weights of `file`. Both are compared, and the memory is looked for, before
/// any of it is taken: sizes come from files. Throws Error as load_weights, and OutOfMemory.
template <class Network, class Config>
Network loaded_network(const Config& config, const TensorFile& file, const LoadPlan& plan,
                       const torch::Device& device = torch::kCPU) {
    const Network described(config, WeightOptions{torch::kMeta, torch::kFloat32, false});
    check_weights(*described, file.shapes(), plan, file.path());
    if (device.is_cpu()) require_memory(weight_bytes(*described), "the " + plan.what);
    Network network(config, WeightOptions{device, torch::kFloat32, false});
    load_weights(*network, file, plan);
    return network;
}

}  // namespace gse::neural
