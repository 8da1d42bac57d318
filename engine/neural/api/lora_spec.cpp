// Reads how a run names LoRAs, and what a file says of itself.
#include "engine/neural/api/lora_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/safetensors_header.h"

namespace gse::neural {
namespace fs = std::filesystem;

bool says_word(const std::string& text, std::string_view word) {
    const auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
    std::string plain(text);
    std::transform(plain.begin(), plain.end(), plain.begin(), lower);
    const auto is_letter = [&](std::size_t at) {
        return at < plain.size() && std::isalpha(static_cast<unsigned char>(plain[at]));
    };
    for (auto at = plain.find(word); at != std::string::npos; at = plain.find(word, at + 1))
        if ((at == 0 || !is_letter(at - 1)) && !is_letter(at + word.size())) return true;
    return false;
}

namespace {

LoraMark mark_of(const std::string& text) {
    if (says_word(text, "tcd")) return LoraMark::Tcd;
    return says_word(text, "lcm") ? LoraMark::Lcm : LoraMark::None;
}

/// Strength of "FILE:strength" with the place of the colon; false when what follows is no number.
bool read_strength(const std::string& text, std::size_t& colon, double& strength) {
    colon = text.rfind(':');
    if (colon == std::string::npos || colon + 1 == text.size()) return false;
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + colon + 1, end, strength);
    return read.ec == std::errc() && read.ptr == end;
}

}  // namespace

LoraSpec parse_lora(const std::string& text) {
    LoraSpec lora{text, 1};
    std::size_t colon = 0;
    double strength = 1;
    std::error_code ignored;
    if (!fs::exists(lora.file, ignored) && read_strength(text, colon, strength)) {
        if (!std::isfinite(strength) || std::abs(strength) > MostLoraStrength)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the LoRA's strength {} is outside {}..{}", text.substr(colon + 1),
                                    -MostLoraStrength, MostLoraStrength),
                        "1 is as it was trained, 0 is without it", text.substr(0, colon));
        lora = {text.substr(0, colon), strength};
    }
    if (fs::is_directory(lora.file, ignored))
        for (const char* name : {"pytorch_lora_weights.safetensors", "adapter_model.safetensors"})
            if (fs::exists(lora.file / name, ignored)) return {lora.file / name, lora.strength};
    return lora;
}

std::string lora_text(const LoraSpec& lora) {
    return lora.strength == 1 ? lora.file.string() : fmt::format("{}:{}", lora.file.string(), lora.strength);
}

std::vector<LoraSpec> find_loras(const std::vector<std::string>& texts) {
    std::vector<LoraSpec> loras;
    std::error_code ignored;
    for (const auto& text : texts) {
        const auto lora = parse_lora(text);
        if (!fs::exists(lora.file, ignored))
            throw Error(ErrorCode::NotFound, "there is no LoRA file here", "name it as FILE or FILE:strength",
                        lora.file);
        if (fs::is_directory(lora.file, ignored) || !is_safetensors_name(lora.file))
            throw Error(ErrorCode::Unsupported, "this is not a LoRA file that can be read",
                        "LoRAs are read from .safetensors files; pickled ones can run programs: convert them",
                        lora.file);
        loras.push_back(lora);
    }
    return loras;
}

LoraMark lora_mark(const fs::path& file) {
    const auto header = safetensors_header(file);
    const auto metadata =
        header.is_object() && header.contains("__metadata__") ? header["__metadata__"] : nlohmann::json();
    std::vector<std::string> texts;
    for (const char* title : {"modelspec.title", "ss_output_name"})
        if (metadata.is_object() && metadata.contains(title) && metadata[title].is_string())
            texts.push_back(metadata[title].get<std::string>());
    texts.push_back(file.stem().string());
    texts.push_back(file.parent_path().filename().string());
    for (const auto& text : texts)
        if (const auto mark = mark_of(text); mark != LoraMark::None) return mark;
    return LoraMark::None;
}

}  // namespace gse::neural
