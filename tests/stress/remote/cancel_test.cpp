// Stops in every phase of an exchange: the caller returns, and only a job of its own is ended at the server.
#include <doctest/doctest.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "engine/remote/protocols/connect.h"
#include "tests/stress/remote/stand_in.h"

namespace gse::remote {
namespace {

using Clock = std::chrono::steady_clock;

/// Stops a redraw `after` it has begun; milliseconds from the stop to its return.
double stop_after(ImageServer& server, const RedrawOrder& order, Milliseconds after) {
    std::stop_source stop;
    Clock::time_point stopped;
    std::thread stopper([&] {
        std::this_thread::sleep_for(after);
        stopped = Clock::now();
        stop.request_stop();
    });
    JobControl job;
    job.stop = stop.get_token();
    const auto error = caught([&] { server.redraw(order, job); });
    const auto returned = Clock::now();
    stopper.join();
    DOCTEST_CHECK(error.is(ErrorCode::Cancelled));
    return std::chrono::duration<double, std::milli>(returned - stopped).count();
}

double middle(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

/// Waits until the server was asked for a path, but not for ever.
bool comes_to_ask(StandIn& stand_in, const std::string& end) {
    for (int i = 0; i < 200; ++i) {
        if (!stand_in.asked(end).empty()) return true;
        std::this_thread::sleep_for(Milliseconds(20));
    }
    return false;
}

DOCTEST_TEST_CASE("a stop returns at once while connecting, sending, waiting, receiving and polling") {
    if (!can_stand_in()) return;
    struct Phase {
        const char *flavour, *fault, *at;
        ServerKind kind;
    };
    for (const auto& phase : {Phase{"forge", "hang", "draw", ServerKind::Webui},
                              Phase{"forge", "drip", "draw", ServerKind::Webui},
                              Phase{"sdserver", "hang", "draw", ServerKind::SdCpp},
                              Phase{"sdserver", "hang", "poll", ServerKind::SdCpp},
                              Phase{"sdserver", "drip", "poll", ServerKind::SdCpp},
                              Phase{"vllm", "hang", "draw", ServerKind::OpenAi},
                              Phase{"comfy", "hang", "view", ServerKind::Comfy}}) {
        auto& stand_in = shared_stand_in(phase.flavour);
        auto address = stand_in.address();
        address.kind = phase.kind;
        const auto server = connect(address, {});
        stand_in.set({{"fault", phase.fault}, {"at", phase.at}});
        const auto order = small_order();
        std::vector<double> times;
        for (int i = 0; i < 30; ++i) times.push_back(stop_after(*server, order, Milliseconds(i % 40)));
        DOCTEST_CAPTURE(phase.fault);
        DOCTEST_CAPTURE(phase.at);
        DOCTEST_CHECK(middle(times) < 100);
    }
}

DOCTEST_TEST_CASE("a stop returns at once while a picture is being sent that the server does not read") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("forge");
    const auto server = connect(stand_in.address(), {});
    auto order = small_order();
    order.picture = Image(2048, 2048, 3);  // noise: more bytes than the system holds for a connection
    order.mask = {};
    std::uint32_t noise = 1;
    for (auto& value : order.picture.data) {
        noise = noise * 1664525u + 1013904223u;
        value = static_cast<float>(noise >> 24) / 255;
    }
    stand_in.set({{"unread", "1"}});
    std::vector<double> times;
    for (int i = 0; i < 3; ++i) times.push_back(stop_after(*server, order, Milliseconds(4'000)));
    DOCTEST_CHECK(middle(times) < 100);
    stand_in.reset();
}

/// Port of this machine that takes no more connections: those who try wait.
class FullPort {
public:
    FullPort() {
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof place;
        sockets_.push_back(socket(AF_INET, SOCK_STREAM, 0));
        bind(sockets_[0], reinterpret_cast<sockaddr*>(&place), size);
        getsockname(sockets_[0], reinterpret_cast<sockaddr*>(&place), &size);
        listen(sockets_[0], 0);
        port = ntohs(place.sin_port);
        for (int i = 0; i < 8; ++i) {
            sockets_.push_back(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
            connect_to(sockets_.back(), place);
        }
    }
    ~FullPort() {
        for (const int descriptor : sockets_) close(descriptor);
    }
    FullPort(const FullPort&) = delete;
    FullPort& operator=(const FullPort&) = delete;

    int port = 0;

private:
    static void connect_to(int descriptor, const sockaddr_in& place) {
        static_cast<void>(::connect(descriptor, reinterpret_cast<const sockaddr*>(&place), sizeof place));
    }

    std::vector<int> sockets_;
};

DOCTEST_TEST_CASE("a connection that does not come about is stopped at once, and given up in time") {
    if (!can_stand_in()) return;
    const FullPort full;
    ServerAddress address;
    address.url = "http://127.0.0.1:" + std::to_string(full.port);
    address.times = patient_times();
    address.times.connect = Milliseconds(200);
    DOCTEST_CHECK(caught([&] { connect(address, {}); }).says("nobody answers at 127.0.0.1:"));
    address.times.connect = Milliseconds(20'000);
    std::vector<double> times;
    for (int i = 0; i < 20; ++i) {
        std::stop_source stop;
        Clock::time_point stopped;
        std::thread stopper([&] {
            std::this_thread::sleep_for(Milliseconds(20));
            stopped = Clock::now();
            stop.request_stop();
        });
        JobControl job;
        job.stop = stop.get_token();
        DOCTEST_CHECK(caught([&] { connect(address, job); }).is(ErrorCode::Cancelled));
        const auto returned = Clock::now();
        stopper.join();
        times.push_back(std::chrono::duration<double, std::milli>(returned - stopped).count());
    }
    DOCTEST_CHECK(middle(times) < 100);
}

DOCTEST_TEST_CASE("a job in the queue is cancelled at the server, also where its number had not come yet") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("sdserver");
    const auto busy = connect(stand_in.address(), {}), other = connect(stand_in.address(), {});
    stand_in.set({{"draw_s", "2"}});
    std::stop_source stop;
    JobControl job;
    job.stop = stop.get_token();
    std::thread first([&] { caught([&] { busy->redraw(small_order(), job); }); });
    DOCTEST_REQUIRE(comes_to_ask(stand_in, "/job-1"));
    stop_after(*other, small_order(), Milliseconds(200));
    DOCTEST_CHECK(comes_to_ask(stand_in, "/job-2/cancel"));
    DOCTEST_CHECK(stand_in.asked("/job-1/cancel").empty());
    stop.request_stop();
    first.join();
    DOCTEST_CHECK(comes_to_ask(stand_in, "/job-1/cancel"));
}

DOCTEST_TEST_CASE("a ComfyUI job is ended while it waits or draws, and nobody else's") {
    if (!can_stand_in()) return;
    for (const char* new_comfy : {"0", "1"}) {
        auto& stand_in = shared_stand_in("comfy");
        stand_in.set({{"new_comfy", new_comfy}});
        const auto busy = connect(stand_in.address(), {}), other = connect(stand_in.address(), {});
        busy->redraw(small_order(), {});  // both know the nodes
        other->redraw(small_order(), {});
        stand_in.set({{"draw_s", "4"}});
        std::stop_source stop;
        JobControl job;
        job.stop = stop.get_token();
        std::thread first([&] { caught([&] { busy->redraw(small_order(), job); }); });
        while (stand_in.asked("/prompt").size() < 3) std::this_thread::sleep_for(Milliseconds(10));
        stop_after(*other, small_order(), Milliseconds(300));
        DOCTEST_CHECK(comes_to_ask(stand_in, "/cancel"));
        std::this_thread::sleep_for(Milliseconds(100));
        DOCTEST_CHECK(stand_in.asked("/interrupt").empty());
        stop.request_stop();
        first.join();
        if (new_comfy[0] == '0') DOCTEST_CHECK(comes_to_ask(stand_in, "/interrupt"));
    }
}

DOCTEST_TEST_CASE("a WebUI is interrupted only while it draws for us") {
    if (!can_stand_in()) return;
    auto& stand_in = shared_stand_in("forge");
    const auto busy = connect(stand_in.address(), {}), other = connect(stand_in.address(), {});
    stand_in.set({{"draw_s", "3"}});
    std::stop_source stop;
    JobControl job;
    job.stop = stop.get_token();
    std::thread first([&] { caught([&] { busy->redraw(small_order(), job); }); });
    DOCTEST_REQUIRE(comes_to_ask(stand_in, "/img2img"));
    stop_after(*other, small_order(), Milliseconds(200));
    DOCTEST_CHECK(comes_to_ask(stand_in, "/internal/progress"));
    std::this_thread::sleep_for(Milliseconds(100));
    DOCTEST_CHECK(stand_in.asked("/interrupt").empty());
    stop.request_stop();
    first.join();
    DOCTEST_CHECK(comes_to_ask(stand_in, "/interrupt"));
}

}  // namespace
}  // namespace gse::remote
