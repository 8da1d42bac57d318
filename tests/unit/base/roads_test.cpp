// The two roads between threads: a queue that loses nothing, and a mailbox in which the newest wins.
#include <doctest/doctest.h>

#include <atomic>
#include <memory>
#include <thread>

#include "engine/base/mailbox.h"
#include "engine/base/shared_queue.h"

namespace roads_test {

using namespace gse;

DOCTEST_TEST_CASE("a queue hands everything over, each thread's values in their order") {
    SharedQueue<int> queue;
    constexpr int Each = 1000;
    std::vector<int> got;
    {
        const std::jthread odd([&] {
            for (int i = 0; i < Each; ++i) queue.push(2 * i + 1);
        });
        const std::jthread even([&] {
            for (int i = 0; i < Each; ++i) queue.push(2 * i);
        });
        while (got.size() < 2 * Each)
            for (const int value : queue.take()) got.push_back(value);
    }
    int last_odd = -1, last_even = -2;
    for (const int value : got) {
        int& last = value % 2 == 1 ? last_odd : last_even;
        DOCTEST_REQUIRE(value == last + 2);
        last = value;
    }
    DOCTEST_CHECK(queue.take().empty());
    DOCTEST_CHECK_FALSE(queue.pop());
}

DOCTEST_TEST_CASE("one value at a time comes out oldest first") {
    SharedQueue<std::unique_ptr<int>> queue;  // values need not be copied
    queue.push(std::make_unique<int>(1));
    queue.push(std::make_unique<int>(2));
    DOCTEST_CHECK(**queue.pop() == 1);
    DOCTEST_CHECK(**queue.wait({}) == 2);
    DOCTEST_CHECK_FALSE(queue.pop());
}

DOCTEST_TEST_CASE("who waits goes on with a value, or when it is stopped") {
    SharedQueue<int> queue;
    Mailbox<int> box;
    int from_queue = 0, from_box = 0;
    std::atomic<bool> got_both = false;
    bool stopped = false;
    std::jthread waits([&](const std::stop_token& stop) {
        from_queue = queue.wait(stop).value_or(-1);
        from_box = box.wait(stop).value_or(-1);
        got_both = true;
        stopped = !queue.wait(stop) && !box.wait(stop);
    });
    queue.push(7);
    box.put(8);
    while (!got_both) std::this_thread::yield();
    waits.request_stop();
    waits.join();
    DOCTEST_CHECK(from_queue == 7);
    DOCTEST_CHECK(from_box == 8);
    DOCTEST_CHECK(stopped);
}

DOCTEST_TEST_CASE("in a mailbox the newest value wins, and is taken once") {
    Mailbox<int> box;
    DOCTEST_CHECK_FALSE(box.take());
    box.put(1);
    box.put(2);
    DOCTEST_CHECK(box.take() == 2);
    DOCTEST_CHECK_FALSE(box.take());
}

}  // namespace roads_test
