// Answers by a 64-bit hash of the whole question, picture included.
#include "engine/edit/cached_attention.h"

#include <cstring>
#include <string_view>

namespace gse::edit {
namespace {

/// FNV-1a over 8-byte words with a final mix: a question has a few hundred kilobytes, and chance collisions over the few
/// hundred questions of a session are below 1e-14.
class Hash {
public:
    void bytes(const void* data, std::size_t size) {
        const auto* at = static_cast<const unsigned char*>(data);
        for (; size >= sizeof(std::uint64_t); size -= sizeof(std::uint64_t), at += sizeof(std::uint64_t)) {
            std::uint64_t word = 0;
            std::memcpy(&word, at, sizeof word);
            add(word);
        }
        for (; size > 0; --size) add(*at++);
    }
    void text(std::string_view text) {
        add(text.size());
        bytes(text.data(), text.size());
    }
    void add(std::uint64_t word) {
        value_ = (value_ ^ word) * 0x100000001b3ULL;
        value_ ^= value_ >> 29;
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

std::uint64_t hash_of(const AttentionQuery& query) {
    Hash hash;
    hash.text(query.prompt);
    hash.text(query.view_words);
    for (const auto& word : query.words) hash.text(word);
    hash.add(query.absent ? 1 : 0);
    hash.add(static_cast<std::uint64_t>(query.repeats));
    hash.add(query.seed);
    hash.add(static_cast<std::uint64_t>(query.image.width));
    hash.add(static_cast<std::uint64_t>(query.image.height));
    hash.bytes(query.image.data.data(), query.image.data.size() * sizeof(float));
    return hash.value();
}

}  // namespace

CachedAttention::CachedAttention(std::unique_ptr<AttentionSource> source) : source_(std::move(source)) {}

std::vector<Image> CachedAttention::locate(const AttentionQuery& query) {
    const auto key = hash_of(query);
    const auto found = answers_.find(key);
    if (found != answers_.end()) return found->second;
    ++asked_;
    return answers_.emplace(key, source_->locate(query)).first->second;
}

}  // namespace gse::edit
