// Answers by a 64-bit hash of the whole question, picture included.
#include "engine/edit/search/cached_attention.h"

#include "engine/base/hash.h"

namespace gse::edit {

std::uint64_t question_hash(const AttentionQuery& query) {
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

CachedAttention::CachedAttention(std::unique_ptr<AttentionSource> source) : source_(std::move(source)) {}

std::vector<Image> CachedAttention::locate(const AttentionQuery& query) {
    const auto key = question_hash(query);
    const auto found = answers_.find(key);
    if (found != answers_.end()) return found->second;
    ++asked_;
    return answers_.emplace(key, source_->locate(query)).first->second;
}

void CachedAttention::prepare(std::span<const AttentionQuery> queries) {
    std::vector<AttentionQuery> unknown;
    for (const auto& query : queries)
        if (!answers_.contains(question_hash(query))) unknown.push_back(query);
    if (!unknown.empty()) source_->prepare(unknown);
}

}  // namespace gse::edit
