// Sleeping workers woken by a generation counter. Chunks are claimed from an atomic cursor.
#include "engine/base/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace gse {

struct ThreadPool::Shared {
    std::mutex mutex;
    std::condition_variable wake;
    std::condition_variable finished;
    std::vector<std::thread> threads;
    std::uint64_t generation = 0;
    unsigned running = 0;
    bool stopping = false;

    // The loop under way; written under the mutex before the generation is raised.
    const std::function<void(std::size_t, std::size_t, unsigned)>* body = nullptr;
    std::size_t count = 0;
    std::size_t chunk = 1;
    std::atomic<std::size_t> cursor{0};
    std::exception_ptr failure;

    void work(unsigned worker) {
        for (;;) {
            const std::size_t begin = cursor.fetch_add(chunk, std::memory_order_relaxed);
            if (begin >= count) return;
            try {
                (*body)(begin, std::min(begin + chunk, count), worker);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
                cursor.store(count, std::memory_order_relaxed);
            }
        }
    }

    void serve(unsigned worker) {
        std::uint64_t seen = 0;
        for (;;) {
            {
                std::unique_lock lock(mutex);
                wake.wait(lock, [&] { return stopping || generation != seen; });
                if (stopping) return;
                seen = generation;
            }
            work(worker);
            const std::lock_guard lock(mutex);
            if (--running == 0) finished.notify_one();
        }
    }
};

ThreadPool::ThreadPool(unsigned thread_count) : shared_(std::make_unique<Shared>()) {
    constexpr unsigned thread_limit = 64;
    if (thread_count == 0) thread_count = std::max(1u, std::thread::hardware_concurrency());
    thread_count = std::min(thread_count, thread_limit);
    for (unsigned worker = 1; worker < thread_count; ++worker)
        shared_->threads.emplace_back([this, worker] { shared_->serve(worker); });
}

ThreadPool::~ThreadPool() {
    {
        const std::lock_guard lock(shared_->mutex);
        shared_->stopping = true;
    }
    shared_->wake.notify_all();
    for (auto& thread : shared_->threads) thread.join();
}

unsigned ThreadPool::thread_count() const { return static_cast<unsigned>(shared_->threads.size()) + 1; }

void ThreadPool::parallel_for(std::size_t count, std::size_t chunk,
                              const std::function<void(std::size_t, std::size_t, unsigned)>& body) {
    if (count == 0) return;
    chunk = std::max<std::size_t>(1, chunk);
    Shared& shared = *shared_;
    if (count <= chunk || shared.threads.empty()) {  // one chunk: not worth waking anybody
        for (std::size_t begin = 0; begin < count; begin += chunk)
            body(begin, std::min(begin + chunk, count), 0);
        return;
    }
    {
        const std::lock_guard lock(shared.mutex);
        shared.body = &body;
        shared.count = count;
        shared.chunk = chunk;
        shared.cursor.store(0, std::memory_order_relaxed);
        shared.failure = nullptr;
        shared.running = static_cast<unsigned>(shared.threads.size());
        ++shared.generation;
    }
    shared.wake.notify_all();
    shared.work(0);
    std::unique_lock lock(shared.mutex);
    shared.finished.wait(lock, [&] { return shared.running == 0; });
    if (shared.failure) std::rethrow_exception(shared.failure);
}

}  // namespace gse
