// A place for one value between threads: the newest wins.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace gse {

/// Any number of threads may put and take. A value that nobody took is replaced by the next one.
template <class T> class Mailbox {
public:
    void put(T value) {
        {
            const std::lock_guard lock(mutex_);
            value_ = std::move(value);
        }
        arrived_.notify_one();
    }
    /// The value, or none.
    std::optional<T> take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(value_, std::nullopt);
    }
    /// Waits for a value; none = stopped.
    std::optional<T> wait(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        if (!arrived_.wait(lock, stop, [this] { return value_.has_value(); })) return std::nullopt;
        return std::exchange(value_, std::nullopt);
    }

private:
    std::mutex mutex_;
    std::condition_variable_any arrived_;
    std::optional<T> value_;
};

}  // namespace gse
