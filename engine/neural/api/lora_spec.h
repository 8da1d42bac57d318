// A LoRA as a run names it: a file and how strongly it counts. Without any torch type.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gse::neural {

/// Mark of a distilled LoRA, which needs a sampler of its own.
enum class LoraMark { None, Lcm, Tcd };

struct LoraSpec {
    std::filesystem::path file;
    double strength = 1;
};

/// "FILE" or "FILE:strength"; a colon that no number follows belongs to the name. A folder means the file in
/// it that diffusers or PEFT writes. Throws Error (InvalidArgument) for a strength that is not within
/// +-MostLoraStrength.
LoraSpec parse_lora(const std::string& text);
constexpr double MostLoraStrength = 10;
/// The text that parse_lora() reads.
std::string lora_text(const LoraSpec& lora);

/// All of them, in order. Throws Error as parse_lora() does, and (NotFound, Unsupported) for a file that is
/// not there or is pickled.
std::vector<LoraSpec> find_loras(const std::vector<std::string>& texts);

/// Finds `word` (lower case) between characters that are no letters, in either case.
bool says_word(const std::string& text, std::string_view word);

/// Mark by the file's metadata, its name or the name of its folder: "lcm" or "tcd" as a word of its own.
LoraMark lora_mark(const std::filesystem::path& file);

}  // namespace gse::neural
