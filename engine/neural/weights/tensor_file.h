// A file of named tensors, whatever its format.
#pragma once

#include <torch/torch.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gse::neural {

/// Names and shapes of all tensors of a file.
using KeyShapes = std::map<std::string, std::vector<std::int64_t>>;

/// Tensors are read on request, each into memory of its own, so the object may go before them. Threads may
/// read at the same time.
class TensorFile {
public:
    virtual ~TensorFile() = default;
    virtual const std::filesystem::path& path() const = 0;
    virtual KeyShapes shapes() const = 0;
    /// The tensor in the type of the file. Throws Error (Model) when it is not there, (Unreadable) when the
    /// file was cut off since it was opened.
    virtual torch::Tensor tensor(const std::string& name) const = 0;
    /// Copies the tensor into `target` (same number of elements), converting to its type and device. Throws
    /// Error as tensor().
    virtual void copy_to(const std::string& name, torch::Tensor target) const;
};

/// By what the file begins with: safetensors, or what torch.save writes (TorchFile). Throws Error (NotFound,
/// Unreadable, Malformed, Unsupported).
std::unique_ptr<TensorFile> open_tensor_file(const std::filesystem::path& path);

}  // namespace gse::neural
