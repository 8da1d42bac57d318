// The thread, its clock and its one error boundary.
#include "engine/base/job_thread.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/log.h"
#include "engine/base/memory.h"

namespace gse {

void MainQueue::set_wake(std::function<void()> wake) {
    const std::lock_guard lock(mutex_);
    wake_ = std::move(wake);
}

void MainQueue::post(std::function<void()> closure) {
    closures_.push(std::move(closure));
    std::function<void()> wake;
    {
        const std::lock_guard lock(mutex_);
        wake = wake_;
    }
    if (wake) wake();
}

std::size_t MainQueue::run() {
    const auto ready = closures_.take();
    for (const auto& closure : ready) closure();
    return ready.size();
}

namespace {

/// True for "view 2 of 8" and "view 3 of 8": one stage, whose parts are counted.
bool same_but_for_numbers(std::string_view a, std::string_view b) {
    const auto without = [](std::string_view text) {
        std::string kept(text);
        std::erase_if(kept, [](char c) { return c >= '0' && c <= '9'; });
        return kept;
    };
    return without(a) == without(b);
}

/// Lowers the priority of the calling thread. Linux gives every thread its own nice value, and threads
/// inherit it from their creator. Ten leaves a tenth of a contended processor.
void yield_to_others() {
    constexpr int patience = 10;
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), patience);
}

}  // namespace

JobThread::JobThread(MainQueue& queue, Priority priority)
    : queue_(queue), priority_(priority), thread_([this](const std::stop_token& end) { loop(end); }) {}

JobThread::~JobThread() {
    cancel();
    thread_.request_stop();
    changed_.notify_all();
}

bool JobThread::start(Job job) {
    const std::lock_guard lock(mutex_);
    if (status_.running || has_next_ || *handing_over_) return false;
    status_ = {};
    status_.running = true;
    status_.title = job.title;
    status_.can_pause = job.can_pause;
    stop_ = std::stop_source();
    start_ = stage_start_ = Clock::now();
    paused_time_ = stage_paused_ = {};
    next_ = std::move(job);
    has_next_ = true;
    changed_.notify_all();
    return true;
}

void JobThread::pause(bool paused) {
    const std::lock_guard lock(mutex_);
    if (!status_.running || !status_.can_pause || status_.paused == paused) return;
    status_.paused = paused;
    if (paused) {
        pause_start_ = Clock::now();
    } else {
        paused_time_ += Clock::now() - pause_start_;
        stage_paused_ += Clock::now() - pause_start_;
    }
    changed_.notify_all();
}

void JobThread::cancel() {
    pause(false);
    const std::lock_guard lock(mutex_);
    stop_.request_stop();
    changed_.notify_all();
}

bool JobThread::running() const {
    const std::lock_guard lock(mutex_);
    return status_.running || *handing_over_;
}

JobStatus JobThread::status() const {
    const std::lock_guard lock(mutex_);
    JobStatus status = status_;
    if (!status.running) {
        status.running = *handing_over_;
        return status;
    }
    const auto now = status.paused ? pause_start_ : Clock::now();
    status.seconds = std::chrono::duration<double>(now - start_ - paused_time_).count();
    const int done = status.step - stage_first_step_;
    if (status.total > 0 && done > 0) {
        const double stage = std::chrono::duration<double>(now - stage_start_ - stage_paused_).count();
        status.eta_seconds = stage / done * (status.total - status.step);
    }
    return status;
}

void JobThread::forget() {
    const std::lock_guard lock(mutex_);
    if (!status_.running && !*handing_over_) status_ = {};
}

void JobThread::report(std::string_view stage, int step, int total) {
    std::unique_lock lock(mutex_);
    const bool begins = step < status_.step || !same_but_for_numbers(stage, status_.stage);
    status_.stage = stage;
    if (begins) {
        stage_start_ = Clock::now();
        stage_paused_ = {};
        stage_first_step_ = step;
    }
    status_.step = step;
    status_.total = total;
    changed_.wait(lock, [this] { return !status_.paused; });  // a paused job waits here, between two steps
}

void JobThread::loop(const std::stop_token& end) {
    if (priority_ == Priority::Patient) yield_to_others();
    while (!end.stop_requested()) {
        Job job;
        std::stop_token stop;
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, end, [this] { return has_next_; })) return;
            job = std::move(next_);
            next_ = {};
            has_next_ = false;
            stop = stop_.get_token();
        }
        run(std::move(job), stop);
    }
}

void JobThread::run(Job job, const std::stop_token& stop) {
    std::optional<Error> failure;
    try {
        JobControl control;
        control.stop = stop;
        control.progress = [this](std::string_view stage, int step, int total) {
            report(stage, step, total);
        };
        job.work(control);
    } catch (const Error& error) { failure = error; } catch (const std::bad_alloc&) {
        failure = out_of_memory();
    } catch (const std::exception& error) {
        failure = Error(ErrorCode::Foreign, std::string("unexpected failure (") + error.what() + ")",
                        "please report it");
    }
    job.work = nullptr;  // what it held is released on this thread
    if (failure && failure->code() != ErrorCode::Cancelled) log::error("{}: {}", job.title, failure->what());
    auto shared = std::make_shared<std::optional<Error>>(failure);
    {
        const std::lock_guard lock(mutex_);
        const double seconds = std::chrono::duration<double>(Clock::now() - start_ - paused_time_).count();
        status_.running = status_.paused = false;
        status_.seconds = seconds;
        // A stopped job may hand over what it had reached.
        if (!failure) status_.outcome = stop.stop_requested() ? "stopped" : "done";
        else if (failure->code() == ErrorCode::Cancelled) status_.outcome = "stopped";
        else status_.outcome = "failed", status_.error = failure->what();
        *handing_over_ = true;
        queue_.post([done = std::move(job.done), shared, waits = handing_over_] {
            *waits = false;  // the next job may begin with what this one leaves
            if (done) done(shared->has_value() ? &**shared : nullptr);
        });
    }
}

}  // namespace gse
