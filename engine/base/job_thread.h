// One background job at a time, with progress, pause and cancel. Its result is handed to the main thread.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/job_status.h"
#include "engine/base/progress.h"
#include "engine/base/shared_queue.h"

namespace gse {

/// Closures from other threads for the main thread, which runs them between frames. `wake` is called after
/// each post.
class MainQueue {
public:
    void set_wake(std::function<void()> wake);
    void post(std::function<void()> closure);
    /// Runs everything posted so far. Main thread only. Returns how many closures ran.
    std::size_t run();

private:
    SharedQueue<std::function<void()>> closures_;
    std::mutex mutex_;  // of wake_
    std::function<void()> wake_;
};

/// Thread of its own for jobs of one kind.
class JobThread {
public:
    using Work = std::function<void(const JobControl&)>;
    /// Called on the main thread when the work is over. `error` is null after success.
    using Done = std::function<void(const Error* error)>;

    struct Job {
        std::string title;
        Work work;
        Done done;  // may be empty
        bool can_pause = false;
    };

    /// Priority of jobs. Patient ones, and the threads they start, leave the processor to the window and to
    /// urgent work.
    enum class Priority { Normal, Patient };
    explicit JobThread(MainQueue& queue, Priority priority = Priority::Normal);
    ~JobThread();
    JobThread(const JobThread&) = delete;
    JobThread& operator=(const JobThread&) = delete;

    /// Starts a job. Returns false when one is running, or when the last one's result was not handed over
    /// yet.
    bool start(Job job);
    void pause(bool paused);
    void cancel();
    /// True until the job's result has been handed to the main thread, which ends in MainQueue::run().
    bool running() const;
    JobStatus status() const;
    /// Empties the status of the last job, unless one is running.
    void forget();

private:
    using Clock = std::chrono::steady_clock;
    void loop(const std::stop_token& end);
    void run(Job job, const std::stop_token& stop);
    void report(std::string_view stage, int step, int total);

    MainQueue& queue_;
    Priority priority_;
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    JobStatus status_;
    Job next_;
    bool has_next_ = false;
    std::shared_ptr<std::atomic<bool>> handing_over_ = std::make_shared<std::atomic<bool>>(false);
    std::stop_source stop_;
    Clock::time_point start_{}, stage_start_{}, pause_start_{};
    Clock::duration paused_time_{}, stage_paused_{};
    int stage_first_step_ = 0;
    std::jthread thread_;
};

}  // namespace gse
