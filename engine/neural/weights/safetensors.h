// Safetensors files: reading tensor by tensor with every malformed file refused, and atomic writing.
#pragma once

#include <torch/torch.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/file.h"
#include "engine/neural/weights/tensor_file.h"

namespace gse::neural {

/// One open file.
class SafetensorsFile final : public TensorFile {
public:
    struct Entry {
        torch::Dtype dtype = torch::kFloat32;
        std::vector<std::int64_t> shape;
        std::size_t begin = 0, end = 0;  // bytes in the data part
    };

    /// Throws Error (NotFound, Unreadable, Malformed).
    explicit SafetensorsFile(const std::filesystem::path& path);

    const std::filesystem::path& path() const override { return path_; }
    KeyShapes shapes() const override;
    const std::map<std::string, Entry>& entries() const { return entries_; }
    const std::map<std::string, std::string>& metadata() const { return metadata_; }
    bool contains(const std::string& name) const { return entries_.contains(name); }
    /// Bytes of all tensors as they are stored.
    std::uint64_t data_bytes() const { return file_.size() - data_begin_; }

    torch::Tensor tensor(const std::string& name) const override;
    /// A quantized tensor (QuantizationScale) becomes the numbers that it stands for. Throws Error as the
    /// others, and (Malformed) when its scales do not fit.
    void copy_to(const std::string& name, torch::Tensor target) const override;

private:
    torch::Tensor read(const Entry& entry) const;

    std::filesystem::path path_;
    InputFile file_;
    std::size_t data_begin_ = 0;
    std::map<std::string, Entry> entries_;
    std::map<std::string, std::string> metadata_;
};

using NamedTensors = std::vector<std::pair<std::string, torch::Tensor>>;

/// Ending of the name of a quantized tensor's scales. Quantized matrices and kernels hold whole numbers of
/// -127 to 127. The scales have one factor per row (first dimension).
inline constexpr const char* QuantizationScale = "_scale";

/// Writes the tensors in the given order, atomically. Throws Error (Unwritable).
void write_safetensors(const std::filesystem::path& path, const NamedTensors& tensors,
                       const std::map<std::string, std::string>& metadata = {});

}  // namespace gse::neural
