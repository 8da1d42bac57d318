// Fixed team of threads for data-parallel loops. The caller takes part, so one thread means no hand-over.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace gse {

/// Runs loops over [0, count) in chunks handed out dynamically. Results must not depend on the thread of a
/// chunk: write to disjoint places and reduce in a fixed order afterwards.
class ThreadPool {
public:
    /// thread_count 0 = one per hardware thread (at most 64); 1 = everything on the caller.
    explicit ThreadPool(unsigned thread_count = 0);
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    unsigned thread_count() const;

    /// Calls body(begin, end, worker) for consecutive chunks of at most `chunk` items. `worker` is in [0,
    /// thread_count()). Returns when all are done. Rethrows the first exception of a body.
    void parallel_for(std::size_t count, std::size_t chunk,
                      const std::function<void(std::size_t begin, std::size_t end, unsigned worker)>& body);

private:
    struct Shared;
    std::unique_ptr<Shared> shared_;
};

}  // namespace gse
