// Tables of a tokenizer.json as transformers' fast tokenizers write it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

namespace gse::neural {

struct TokenizerTables {
    std::unordered_map<std::string, std::int64_t> vocabulary;
    std::vector<std::string> merges;            // "left right", in their order
    std::map<std::string, std::int64_t> added;  // tokens that are matched as they stand
    std::string unknown, padding;               // tokens; empty = nothing is stated
    std::int64_t max_length = 0;                // of the truncation; 0 = nothing is stated
};

/// Reads the tables of a byte-pair tokenizer like CLIP's. Merges may be texts or pairs. Throws Error
/// (NotFound, Malformed), and (Unsupported) for a tokenizer of another kind.
TokenizerTables read_tokenizer_json(const std::filesystem::path& path);

/// Tells whether the folder has a tokenizer: merges.txt or tokenizer.json.
bool has_tokenizer(const std::filesystem::path& folder);

}  // namespace gse::neural
