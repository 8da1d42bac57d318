// Counts tokens word by word.
#include "engine/neural/api/prompt_reader.h"

#include <algorithm>

#include "engine/neural/api/config.h"
#include "engine/neural/api/tokenizer.h"
#include "engine/neural/api/tokenizer_json.h"

namespace gse::neural {
namespace {

namespace fs = std::filesystem;

/// Tokens that the text encoder has places for.
std::int64_t places(const fs::path& model) {
    const auto path = model / "text_encoder/config.json";
    return fs::exists(path) ? TextEncoderConfig::from_json(read_json_file(path), path).max_position_embeddings
                            : TextEncoderConfig{}.max_position_embeddings;
}

fs::path tokenizer_folder(const fs::path& model) {
    if (fs::is_directory(model)) return model / "tokenizer";
    const auto beside = model.parent_path();
    return has_tokenizer(beside / "tokenizer") ? beside / "tokenizer" : beside;
}

}  // namespace

PromptReader::PromptReader(const fs::path& model)
    : tokenizer_(std::make_unique<const Tokenizer>(tokenizer_folder(model))) {
    const auto length = std::min(tokenizer_->max_length(), places(model));
    tokens_ = static_cast<std::size_t>(std::max<std::int64_t>(0, length - 2));
}

PromptReader::~PromptReader() = default;

std::size_t PromptReader::words_read(const std::vector<std::string>& words) const {
    std::size_t used = 0, read = 0;
    for (const auto& word : words) {
        used += tokenizer_->tokenize(word).size();
        if (used > tokens_) break;
        ++read;
    }
    return read;
}

}  // namespace gse::neural
