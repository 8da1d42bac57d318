// Reader of prompts: counts the words that a model's text encoder has tokens for, without loading a network.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace gse::neural {

class Tokenizer;

class PromptReader {
public:
    /// Reads the tokenizer of a model folder, or the one beside a single-file checkpoint. Throws Error when
    /// there is none.
    explicit PromptReader(const std::filesystem::path& model);
    ~PromptReader();
    PromptReader(const PromptReader&) = delete;
    PromptReader& operator=(const PromptReader&) = delete;

    /// Counts the words that fit the text encoder to their end.
    std::size_t words_read(const std::vector<std::string>& words) const;

private:
    std::unique_ptr<const Tokenizer> tokenizer_;
    std::size_t tokens_ = 0;  // between start and end token
};

}  // namespace gse::neural
