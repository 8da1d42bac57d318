// Reader of the pickle in files of torch.save. A pickle is a program. This reader knows only the few steps
// that build plain tensors and refuses every other, so that nothing in the file can run. No torch in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gse::neural {

enum class StoredType { Float32, Float16, BFloat16, Float64, Int64, Int32, Int16, Int8, UInt8, Bool };

/// A tensor as the pickle describes it: where its numbers lie in which storage. Everything lies inside of it.
struct StoredTensor {
    StoredType type = StoredType::Float32;
    std::string storage;        // name of its entry in the archive, without the folders
    std::int64_t elements = 0;  // of the storage
    std::int64_t offset = 0;    // elements
    std::vector<std::int64_t> shape, strides;
};

using StoredTensors = std::map<std::string, StoredTensor>;

/// The tensors of a dictionary, or of the one inside under "state_dict" or "model"; values that are no
/// tensors are passed over. Throws Error (Unsupported) for steps that could do more than that, (Malformed)
/// for a damaged pickle; `path` is for the message.
StoredTensors read_tensor_pickle(const std::string& pickle, const std::filesystem::path& path);

}  // namespace gse::neural
