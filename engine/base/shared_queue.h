// A queue between threads: values come out in the order in which they went in.
#pragma once

#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

namespace gse {

/// Any number of threads may push and take. Nothing is lost and nothing is dropped.
template <class T> class SharedQueue {
public:
    void push(T value) {
        {
            const std::lock_guard lock(mutex_);
            values_.push_back(std::move(value));
        }
        arrived_.notify_one();
    }
    /// Everything so far; empty where there is nothing.
    std::vector<T> take() {
        const std::lock_guard lock(mutex_);
        std::vector<T> values(std::make_move_iterator(values_.begin()),
                              std::make_move_iterator(values_.end()));
        values_.clear();
        return values;
    }
    /// The oldest value, or none.
    std::optional<T> pop() {
        const std::lock_guard lock(mutex_);
        return front();
    }
    /// Waits for a value; none = stopped.
    std::optional<T> wait(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        if (!arrived_.wait(lock, stop, [this] { return !values_.empty(); })) return std::nullopt;
        return front();
    }

private:
    std::optional<T> front() {
        if (values_.empty()) return std::nullopt;
        std::optional<T> value(std::move(values_.front()));
        values_.pop_front();
        return value;
    }

    std::mutex mutex_;
    std::condition_variable_any arrived_;
    std::deque<T> values_;
};

}  // namespace gse
