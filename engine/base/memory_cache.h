// Answers kept in memory by the key of what they follow from.
#pragma once

#include <cstddef>
#include <iterator>
#include <list>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>

#include "engine/base/content_hash.h"

namespace gse {

/// Keeps at most `most` answers; the one used least recently goes first. Threads may share it.
template <class Answer> class MemoryCache {
public:
    explicit MemoryCache(std::size_t most) : most_(most) {}

    std::optional<Answer> find(const ContentKey& key) {
        const std::lock_guard lock(mutex_);
        const auto found = places_.find(key);
        if (found == places_.end()) return std::nullopt;
        answers_.splice(answers_.begin(), answers_, found->second);
        return found->second->second;
    }
    bool contains(const ContentKey& key) const {
        const std::lock_guard lock(mutex_);
        return places_.contains(key);
    }
    void keep(const ContentKey& key, Answer answer) {
        const std::lock_guard lock(mutex_);
        if (const auto found = places_.find(key); found != places_.end()) {
            found->second->second = std::move(answer);
            return answers_.splice(answers_.begin(), answers_, found->second);
        }
        answers_.emplace_front(key, std::move(answer));
        places_[key] = answers_.begin();
        if (answers_.size() <= most_) return;
        places_.erase(answers_.back().first);
        answers_.pop_back();
    }
    /// The answer, worked out by work_out() where it is not kept; two threads that miss one key both work it
    /// out.
    template <class WorkOut> Answer get(const ContentKey& key, WorkOut&& work_out) {
        if (auto known = find(key)) return std::move(*known);
        Answer answer = work_out();
        keep(key, answer);
        return answer;
    }

private:
    const std::size_t most_;
    mutable std::mutex mutex_;
    std::list<std::pair<ContentKey, Answer>> answers_;  // used last first
    std::unordered_map<ContentKey, typename std::list<std::pair<ContentKey, Answer>>::iterator> places_;
};

}  // namespace gse
