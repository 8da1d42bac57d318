// Files that torch.save writes (.pth, .pt): a zip archive of raw numbers and a pickle that says what they
// are.
#pragma once

#include <mutex>
#include <string>

#include "engine/neural/weights/tensor_file.h"
#include "engine/neural/weights/torch_pickle.h"

struct zip;

namespace gse::neural {

/// A state dictionary (segment-anything's sam_vit_*.pth, mobile_sam.pt).
class TorchFile final : public TensorFile {
public:
    /// Throws Error (NotFound, Unreadable, Malformed, Unsupported).
    explicit TorchFile(const std::filesystem::path& path);
    ~TorchFile() override;
    const std::filesystem::path& path() const override { return path_; }
    KeyShapes shapes() const override;
    torch::Tensor tensor(const std::string& name) const override;

private:
    /// A whole entry of `bytes` bytes. Throws Error (Malformed, Unreadable).
    void read_entry(const std::string& name, void* target, std::uint64_t bytes) const;
    std::uint64_t entry_size(const std::string& name) const;
    void check_storages() const;

    std::filesystem::path path_;
    zip* archive_ = nullptr;
    std::string folder_;  // of its entries, with "/" behind it
    StoredTensors tensors_;
    mutable std::mutex mutex_;  // libzip's handle serves one thread at a time
};

}  // namespace gse::neural
