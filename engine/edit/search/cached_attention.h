// An attention source that remembers: the same question about the same picture is answered without the
// networks, so that a threshold can be moved freely.
#pragma once

#include <limits>
#include <memory>

#include "engine/base/memory_cache.h"
#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// Key of everything that a query asks, picture included.
ContentKey key_of(const AttentionQuery& query);

class CachedAttention : public AttentionSource {
public:
    explicit CachedAttention(std::unique_ptr<AttentionSource> source);
    std::vector<Image> locate(const AttentionQuery& query) override;
    void prepare(std::span<const AttentionQuery> queries) override;
    std::size_t at_once() const override { return source_->at_once(); }
    double threshold() const override { return source_->threshold(); }
    int image_size() const override { return source_->image_size(); }
    std::size_t asked() const { return asked_; }  // questions the source had to answer

private:
    std::unique_ptr<AttentionSource> source_;
    MemoryCache<std::vector<Image>> answers_{std::numeric_limits<std::size_t>::max()};
    std::size_t asked_ = 0;
};

}  // namespace gse::edit
