// Names, shapes and number types of a file's tensors, read from its header alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gse::neural {

/// Formats of files of weights, by what a file begins with.
enum class WeightFormat {
    Safetensors,
    Gguf,    // ggml's format, mostly with quantized numbers
    Pickle,  // what torch.save writes: a zip archive or a bare pickle
    Other,
};

/// A tensor as a header states it.
struct HeaderTensor {
    std::string type;                       // as the format names it: "F16", "F8_E4M3", "Q4_K"
    std::vector<std::uint64_t> shape = {};  // slowest dimension first, as torch gives it
};

struct WeightHeader {
    WeightFormat format = WeightFormat::Safetensors;
    std::map<std::string, HeaderTensor> tensors = {};
    std::map<std::string, std::string> metadata = {};  // statements that are text
    std::uint64_t missing_bytes = 0;                   // promised by the header, and not in the file
};

/// Ending of GGUF files, in any case.
bool is_gguf_name(const std::filesystem::path& path);

/// Throws Error (NotFound, Unreadable).
WeightFormat weight_format(const std::filesystem::path& path);

/// The header of a safetensors or GGUF file. Its size is bounded, whatever it states. Throws Error (NotFound,
/// Unreadable, Malformed), and Error (Unsupported) for other formats.
WeightHeader read_weight_header(const std::filesystem::path& path);

}  // namespace gse::neural
