// CLIP's byte-pair tokenizer, as the Stable Diffusion pipelines run it (transformers' CLIPTokenizer without
// ftfy).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gse::neural {

/// One token of a text.
struct Token {
    std::int64_t id = 0;
    int word = 0;  // number of the word (or punctuation run, digit, special token) it belongs to
};

/// A text ready for the text encoder.
struct Encoding {
    std::vector<std::int64_t> ids;  // [max_length]: start, tokens, end, padding
    std::vector<Token> tokens;  // all tokens of the text, also those cut off; token i stands in column i + 1
    bool truncated = false;
};

class Tokenizer {
public:
    /// Reads vocab.json and merges.txt, or where there is no merges.txt tokenizer.json. Where present, reads
    /// tokenizer_config.json, special_tokens_map.json and added_tokens.json too. Without vocab.json the
    /// vocabulary follows from the merges, as in openai/CLIP.
    /// `pad_token` overrides the padding (SD 2.x pads with "!").
    explicit Tokenizer(const std::filesystem::path& folder, const std::string& pad_token = {});

    std::vector<Token> tokenize(std::string_view text) const;
    /// Start token, at most max_length - 2 tokens, end token, padding. max_length 0 = the tokenizer's own.
    Encoding encode(std::string_view text, std::int64_t max_length = 0) const;

    /// Columns of the encoding (0 = start token) that hold `word`, which may be several words; all its
    /// occurrences. Throws Error (NotFound) when the prompt does not contain it as whole words or it lies
    /// beyond the last column.
    std::vector<std::int64_t> find_word(std::string_view prompt, std::string_view word,
                                        std::int64_t max_length = 0) const;

    std::int64_t bos() const { return bos_; }
    std::int64_t eos() const { return eos_; }
    std::int64_t pad() const { return pad_; }
    std::int64_t max_length() const { return max_length_; }
    std::int64_t vocabulary_size() const { return vocabulary_size_; }

private:
    void read_vocabulary(const std::filesystem::path& folder);
    void read_merges(const std::filesystem::path& path);
    void add_merge(std::string line, const std::filesystem::path& path);
    void read_single_file(const std::filesystem::path& path);
    void read_special_tokens(const std::filesystem::path& folder);
    void set_special_token(const std::string& token, std::int64_t& target);
    void read_added_tokens(const std::filesystem::path& folder);
    std::int64_t id_of(const std::string& token) const;
    void append_plain(std::string_view text, std::vector<Token>& tokens, int& words) const;
    void append_word(const std::string& word, std::vector<Token>& tokens, int& words) const;

    std::filesystem::path folder_;
    std::unordered_map<std::string, std::int64_t> vocabulary_;
    std::unordered_map<std::string, int> ranks_;  // "left right" -> order of the merge
    std::vector<std::string> merge_lines_;
    std::map<std::string, std::int64_t> added_;  // matched anywhere, before normalisation
    std::int64_t bos_ = 0, eos_ = 0;
    std::int64_t pad_ = -1, unknown_ = -1;  // -1 = not known yet
    std::int64_t max_length_ = 77;
    std::int64_t vocabulary_size_ = 0;
};

}  // namespace gse::neural
