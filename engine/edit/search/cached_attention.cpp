// Answers by the key of the whole question, picture included.
#include "engine/edit/search/cached_attention.h"

namespace gse::edit {

ContentKey key_of(const AttentionQuery& query) {
    ContentHash hash;
    hash.text(query.prompt);
    hash.text(query.view_words);
    hash.texts(query.words);
    hash.numbers(query.absent, query.repeats, query.seed);
    hash.image(query.image);
    return hash.key();
}

CachedAttention::CachedAttention(std::unique_ptr<AttentionSource> source) : source_(std::move(source)) {}

std::vector<Image> CachedAttention::locate(const AttentionQuery& query) {
    return answers_.get(key_of(query), [&] {
        ++asked_;
        return source_->locate(query);
    });
}

void CachedAttention::prepare(std::span<const AttentionQuery> queries) {
    std::vector<AttentionQuery> unknown;
    for (const auto& query : queries)
        if (!answers_.contains(key_of(query))) unknown.push_back(query);
    if (!unknown.empty()) source_->prepare(unknown);
}

}  // namespace gse::edit
