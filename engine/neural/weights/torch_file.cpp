// The archive around the pickle, read with libzip.
#include "engine/neural/weights/torch_file.h"

#include <fmt/format.h>
#include <zip.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/memory.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {
namespace {

constexpr std::uint64_t MostPickleBytes = 64 << 20;  // a state dictionary's has some hundred thousand
constexpr const char* PickleName = "data.pkl";

torch::Dtype dtype_of(StoredType type) {
    switch (type) {
        case StoredType::Float32: return torch::kFloat32;
        case StoredType::Float16: return torch::kHalf;
        case StoredType::BFloat16: return torch::kBFloat16;
        case StoredType::Float64: return torch::kFloat64;
        case StoredType::Int64: return torch::kInt64;
        case StoredType::Int32: return torch::kInt32;
        case StoredType::Int16: return torch::kInt16;
        case StoredType::Int8: return torch::kInt8;
        case StoredType::UInt8: return torch::kUInt8;
        case StoredType::Bool: break;
    }
    return torch::kBool;
}

[[noreturn]] void damaged(const std::filesystem::path& path, const std::string& what) {
    throw Error(ErrorCode::Malformed, "the weights file is damaged: " + what, "download it again", path);
}

}  // namespace

void TensorFile::copy_to(const std::string& name, torch::Tensor target) const {
    const torch::NoGradGuard no_grad;
    target.copy_(tensor(name).view(target.sizes()));
}

std::unique_ptr<TensorFile> open_tensor_file(const std::filesystem::path& path) {
    constexpr std::size_t magic_bytes = 4;
    const auto start = read_start(path, magic_bytes);
    if (start == "PK\x03\x04") return std::make_unique<TorchFile>(path);
    if (start.starts_with('\x80'))
        throw Error(ErrorCode::Unsupported,
                    "this is a pickle of the format before PyTorch 1.6, which is not read",
                    "save it again with a newer PyTorch, or convert it to .safetensors", path);
    return std::make_unique<SafetensorsFile>(path);
}

TorchFile::TorchFile(const std::filesystem::path& path) : path_(path) {
    const InputFile readable(path_);  // says what is wrong where it cannot be opened
    int error = 0;
    archive_ = zip_open(path_.c_str(), ZIP_RDONLY, &error);
    if (archive_ == nullptr) damaged(path_, "it is no zip archive");
    try {
        const auto count = zip_get_num_entries(archive_, 0);
        std::string pickle;
        for (zip_int64_t i = 0; i < count && folder_.empty(); ++i) {
            const char* name = zip_get_name(archive_, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW);
            const std::string text = name != nullptr ? name : "";
            if (text.ends_with("/data.pkl")) folder_ = text.substr(0, text.rfind('/') + 1);
        }
        if (folder_.empty())
            throw Error(ErrorCode::Unsupported, "this archive was not written by torch.save",
                        "use .safetensors, .pth or .pt weights", path_);
        const auto bytes = entry_size(PickleName);
        if (bytes > MostPickleBytes) damaged(path_, "its description is impossibly large");
        pickle.resize(static_cast<std::size_t>(bytes));
        read_entry(PickleName, pickle.data(), bytes);
        tensors_ = read_tensor_pickle(pickle, path_);
        check_storages();
    } catch (...) {
        zip_discard(archive_);
        throw;
    }
}

TorchFile::~TorchFile() { zip_discard(archive_); }

/// Every storage is there and as long as was said.
void TorchFile::check_storages() const {
    for (const auto& [name, tensor] : tensors_) {
        std::uint64_t bytes = 0;
        if (__builtin_mul_overflow(static_cast<std::uint64_t>(tensor.elements),
                                   torch::elementSize(dtype_of(tensor.type)), &bytes) ||
            entry_size("data/" + tensor.storage) != bytes)
            damaged(path_, fmt::format("the numbers of tensor \"{}\" have another size than was said", name));
    }
}

std::uint64_t TorchFile::entry_size(const std::string& name) const {
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_stat(archive_, (folder_ + name).c_str(), ZIP_FL_ENC_RAW, &stat) != 0 ||
        (stat.valid & ZIP_STAT_SIZE) == 0)
        damaged(path_, fmt::format("it has no entry \"{}\"", name));
    return stat.size;
}

void TorchFile::read_entry(const std::string& name, void* target, std::uint64_t bytes) const {
    const std::lock_guard lock(mutex_);
    zip_file_t* file = zip_fopen(archive_, (folder_ + name).c_str(), ZIP_FL_ENC_RAW);
    if (file == nullptr) damaged(path_, fmt::format("its entry \"{}\" cannot be opened", name));
    auto* to = static_cast<char*>(target);
    std::uint64_t done = 0;
    while (done < bytes) {
        const auto got = zip_fread(file, to + done, bytes - done);
        if (got <= 0) break;
        done += static_cast<std::uint64_t>(got);
    }
    // The checksum is compared when the end has been seen.
    char beyond = 0;
    const bool whole = done == bytes && zip_fread(file, &beyond, 1) == 0;
    zip_fclose(file);
    if (!whole)
        throw Error(ErrorCode::Unreadable, fmt::format("the entry \"{}\" cannot be read", name),
                    "download the file again", path_);
}

KeyShapes TorchFile::shapes() const {
    KeyShapes shapes;
    for (const auto& [name, tensor] : tensors_) shapes.emplace(name, tensor.shape);
    return shapes;
}

torch::Tensor TorchFile::tensor(const std::string& name) const {
    const auto found = tensors_.find(name);
    if (found == tensors_.end())
        throw Error(ErrorCode::Model, fmt::format("the weights file has no tensor \"{}\"", name), {}, path_);
    const auto& stored = found->second;
    require_memory(static_cast<std::uint64_t>(stored.elements) * torch::elementSize(dtype_of(stored.type)),
                   fmt::format("the tensor \"{}\"", name));
    auto storage = torch::empty({stored.elements}, torch::TensorOptions().dtype(dtype_of(stored.type)));
    read_entry("data/" + stored.storage, storage.data_ptr(), storage.nbytes());
    return storage.as_strided(stored.shape, stored.strides, stored.offset).contiguous();
}

}  // namespace gse::neural
