// Background jobs: one at a time, pause stops progress, cancel ends them, failures become one sentence.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "engine/base/job_thread.h"
#include "engine/base/log.h"

namespace job_thread_test {

namespace {

using namespace gse;
using namespace std::chrono_literals;

/// Runs the main queue until `condition` holds; gives up after ten seconds.
template <class F> bool wait_for(MainQueue& queue, F condition) {
    for (int i = 0; i < 2000; ++i) {
        queue.run();
        if (condition()) return true;
        std::this_thread::sleep_for(5ms);
    }
    return false;
}

struct Quiet {
    Quiet() {
        log::set_sink([](log::Level, std::string_view) {});
    }
    ~Quiet() { log::set_sink({}); }
};

}  // namespace

DOCTEST_TEST_CASE("a job reports, ends and tells the main thread") {
    MainQueue queue;
    JobThread jobs(queue);
    bool done = false;
    DOCTEST_REQUIRE(jobs.start({"count",
                                [](const JobControl& job) {
                                    for (int i = 1; i <= 10; ++i) job.report("counting", i, 10);
                                },
                                [&](const Error* error) { done = error == nullptr; }}));
    DOCTEST_REQUIRE(wait_for(queue, [&] { return done; }));
    const auto status = jobs.status();
    DOCTEST_CHECK_FALSE(status.running);
    DOCTEST_CHECK(status.step == 10);
    DOCTEST_CHECK(status.outcome.substr(0, 4) == "done");
}

DOCTEST_TEST_CASE("parts of a stage that its name counts tell together how long the rest takes") {
    MainQueue queue;
    JobThread jobs(queue);
    std::atomic<int> at{0};
    std::atomic<bool> go_on{false};
    DOCTEST_REQUIRE(jobs.start({"views",
                                [&](const JobControl& job) {
                                    for (const char* stage : {"view 1 of 8", "view 2 of 8", "view 3 of 8"}) {
                                        job.report(stage, at, 8);
                                        std::this_thread::sleep_for(5ms);
                                        ++at;
                                    }
                                    while (!go_on) std::this_thread::sleep_for(1ms);
                                    job.report("fit", 3, 100);
                                    ++at;
                                    while (go_on) std::this_thread::sleep_for(1ms);
                                },
                                {}}));
    DOCTEST_REQUIRE(wait_for(queue, [&] { return at == 3; }));
    DOCTEST_CHECK(jobs.status().stage == "view 3 of 8");
    DOCTEST_CHECK(jobs.status().eta_seconds > 0);
    go_on = true;
    DOCTEST_REQUIRE(wait_for(queue, [&] { return at == 4; }));
    DOCTEST_CHECK(jobs.status().eta_seconds < 0);  // another stage
    go_on = false;
    DOCTEST_REQUIRE(wait_for(queue, [&] { return !jobs.running(); }));
}

DOCTEST_TEST_CASE("no job begins before the main thread has what the last one left") {
    MainQueue queue;
    JobThread jobs(queue);
    std::atomic<bool> posted{false};
    queue.set_wake([&] { posted = true; });
    int left = 0;
    DOCTEST_REQUIRE(jobs.start({"first", [](const JobControl&) {}, [&](const Error*) { left = 1; }}));
    for (int i = 0; i < 2000 && !posted; ++i) std::this_thread::sleep_for(5ms);
    DOCTEST_REQUIRE(posted);
    DOCTEST_CHECK(jobs.running());
    DOCTEST_CHECK(jobs.status().running);
    DOCTEST_CHECK_FALSE(jobs.start({"too early", [](const JobControl&) {}, {}}));
    queue.run();
    DOCTEST_CHECK(left == 1);
    DOCTEST_CHECK_FALSE(jobs.running());
    // What a job leaves may begin the next one.
    bool chained = false;
    DOCTEST_REQUIRE(jobs.start({"second", [](const JobControl&) {},
                                [&](const Error*) {
                                    chained = jobs.start({"third", [](const JobControl&) {}, {}});
                                }}));
    DOCTEST_REQUIRE(wait_for(queue, [&] { return !jobs.running(); }));
    DOCTEST_CHECK(chained);
}

DOCTEST_TEST_CASE("one job at a time; cancel ends it and says stopped") {
    MainQueue queue;
    JobThread jobs(queue);
    bool ended = false;
    const auto endless = [](const JobControl& job) {
        for (int i = 0; !job.stop_requested(); ++i) {
            job.report("running", i, 0);
            std::this_thread::sleep_for(1ms);
        }
        throw Error(ErrorCode::Cancelled, "the work was stopped");
    };
    DOCTEST_REQUIRE(jobs.start({"endless", endless, [&](const Error* error) { ended = error != nullptr; }}));
    DOCTEST_CHECK_FALSE(jobs.start({"second", endless, {}}));
    jobs.cancel();
    DOCTEST_REQUIRE(wait_for(queue, [&] { return ended; }));
    DOCTEST_CHECK(jobs.status().outcome == "stopped");
    DOCTEST_CHECK(jobs.status().error.empty());
}

DOCTEST_TEST_CASE("a job that hands over what it had reached when it was cancelled says stopped") {
    MainQueue queue;
    JobThread jobs(queue);
    bool ended = false, failed = true;
    const auto reaches = [](const JobControl& job) {
        while (!job.stop_requested()) std::this_thread::sleep_for(1ms);
    };
    DOCTEST_REQUIRE(jobs.start({"reaches", reaches, [&](const Error* error) {
                                    ended = true;
                                    failed = error != nullptr;
                                }}));
    jobs.cancel();
    DOCTEST_REQUIRE(wait_for(queue, [&] { return ended; }));
    DOCTEST_CHECK_FALSE(failed);
    DOCTEST_CHECK(jobs.status().outcome == "stopped");
}

DOCTEST_TEST_CASE("a paused job stands still, goes on, and can be cancelled while paused") {
    MainQueue queue;
    JobThread jobs(queue);
    std::atomic<int> steps{0};
    bool ended = false;
    DOCTEST_REQUIRE(jobs.start({"steps",
                                [&](const JobControl& job) {
                                    while (!job.stop_requested()) {
                                        job.report("stepping", ++steps, 0);
                                        std::this_thread::sleep_for(1ms);
                                    }
                                },
                                [&](const Error*) { ended = true; }, true}));
    DOCTEST_REQUIRE(wait_for(queue, [&] { return steps > 3; }));
    jobs.pause(true);
    std::this_thread::sleep_for(20ms);  // the step under way may still end
    const int standing = steps;
    std::this_thread::sleep_for(50ms);
    DOCTEST_CHECK(steps == standing);
    jobs.pause(false);
    DOCTEST_CHECK(wait_for(queue, [&] { return steps > standing + 3; }));
    jobs.pause(true);
    jobs.cancel();
    DOCTEST_CHECK(wait_for(queue, [&] { return ended; }));
}

DOCTEST_TEST_CASE("failures arrive as one error, foreign ones too") {
    const Quiet quiet;
    MainQueue queue;
    JobThread jobs(queue);
    std::string message;
    const auto keep = [&](const Error* error) { message = error != nullptr ? error->message() : "none"; };
    DOCTEST_REQUIRE(jobs.start(
        {"bad", [](const JobControl&) { throw Error(ErrorCode::NotFound, "no such file"); }, keep}));
    DOCTEST_REQUIRE(wait_for(queue, [&] { return !message.empty(); }));
    DOCTEST_CHECK(message == "no such file");
    message.clear();
    DOCTEST_REQUIRE(wait_for(queue, [&] { return !jobs.running(); }));
    DOCTEST_REQUIRE(jobs.start({"worse", [](const JobControl&) { throw std::runtime_error("boom"); }, keep}));
    DOCTEST_REQUIRE(wait_for(queue, [&] { return !message.empty(); }));
    DOCTEST_CHECK(message.find("boom") != std::string::npos);
    DOCTEST_CHECK(jobs.status().error.find("boom") != std::string::npos);
}

DOCTEST_TEST_CASE("patient jobs and the threads they start leave the processor to the others") {
    MainQueue queue;
    const auto nice_of = [&](JobThread::Priority priority) {
        JobThread jobs(queue, priority);
        int own = -1, child = -1;
        bool done = false;
        const auto read = [](int& to) {
            to = getpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)));
        };
        jobs.start({"nice",
                    [&](const JobControl&) {
                        read(own);
                        std::thread([&] { read(child); }).join();
                    },
                    [&](const Error*) { done = true; }});
        DOCTEST_REQUIRE(wait_for(queue, [&] { return done; }));
        DOCTEST_CHECK(own == child);
        return own;
    };
    const int normal = nice_of(JobThread::Priority::Normal);
    DOCTEST_CHECK(normal == getpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid))));
    DOCTEST_CHECK((nice_of(JobThread::Priority::Patient) > normal || normal >= 10));
}

}  // namespace job_thread_test
