// Answers by a 64-bit hash of the whole question, picture included.
#include "engine/edit/cached_attention.h"

#include "engine/base/hash.h"

namespace gse::edit {
namespace {

std::uint64_t hash_of(const AttentionQuery& query) {
    Hash hash;
    hash.text(query.prompt);
    hash.text(query.view_words);
    for (const auto& word : query.words) hash.text(word);
    hash.add(query.absent ? 1 : 0);
    hash.add(static_cast<std::uint64_t>(query.repeats));
    hash.add(query.seed);
    hash.image(query.image);
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
