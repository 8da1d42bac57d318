// Pictures that came are kept: over a server that dies, a disk that is full, and a clock that is set.
#include <doctest/doctest.h>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <thread>

#include "engine/base/disk_cache.h"
#include "engine/remote/protocols/connect.h"
#include "engine/remote/views/picture_source.h"
#include "tests/stress/remote/stand_in.h"
#include "tests/test_paths.h"

namespace {

std::atomic<long> clock_offset{0};  // s that the clock of the day is off

}  // namespace

// The clock of the day, for everything in this program. Clocks of elapsed time are as they are.
extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
    const auto result = static_cast<int>(syscall(SYS_clock_gettime, clock, time));
    if (result == 0 && clock == CLOCK_REALTIME) time->tv_sec += clock_offset.load();
    return result;
}
extern "C" int gettimeofday(timeval* time, void*) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    *time = {now.tv_sec, now.tv_nsec / 1000};
    return 0;
}
extern "C" time_t time(time_t* into) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (into != nullptr) *into = now.tv_sec;
    return now.tv_sec;
}

namespace gse::remote {
namespace {

constexpr std::uint64_t CacheBytes = 64 << 20;

RedrawOrder order_with_seed(std::uint32_t seed) {
    auto order = small_order();
    order.seed = seed;
    return order;
}

/// No file of this process grows, as on a full disk.
class FullDisk {
public:
    FullDisk() : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{0, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

private:
    rlimit before_{};
    void (*signal_)(int);
};

DOCTEST_TEST_CASE("a WebUI that dies in the middle is named, and asked only for what is missing afterwards") {
    if (!can_stand_in()) return;
    test::ScratchFolder folder;
    DiskCache cache(folder.path(), CacheBytes);
    StandIn stand_in("forge");
    auto address = stand_in.address();
    address.times.away = Milliseconds(300);
    {
        const auto server = connect(address, {});
        PictureSource source(*server, server->probe({}), "", &cache);
        source.ask(order_with_seed(1), {});
        stand_in.set({{"draw_s", "30"}});
        Caught error;
        std::thread drawing([&] { error = caught([&] { source.ask(order_with_seed(2), {}); }); });
        while (stand_in.asked("/img2img").size() < 2) std::this_thread::sleep_for(Milliseconds(10));
        stand_in.kill();
        drawing.join();
        DOCTEST_CHECK(error.says("closed the connection before its answer was whole"));
        const auto gone = caught([&] { source.ask(order_with_seed(3), {}); });
        DOCTEST_CHECK(gone.says("nobody answers at 127.0.0.1:"));
    }
    stand_in.restart();
    const auto server = connect(address, {});
    PictureSource source(*server, server->probe({}), "", &cache);
    for (const std::uint32_t seed : {1u, 2u, 3u}) source.ask(order_with_seed(seed), {});
    DOCTEST_CHECK(source.use().cached == 1);
    DOCTEST_CHECK(stand_in.asked("/img2img").size() == 2);
}

DOCTEST_TEST_CASE(
    "a disk that is full costs no picture and is counted; what was kept before is still there") {
    if (!can_stand_in()) return;
    test::ScratchFolder folder;
    DiskCache cache(folder.path(), CacheBytes);
    auto& stand_in = shared_stand_in("sdserver");
    const auto server = connect(stand_in.address(), {});
    PictureSource source(*server, server->probe({}), "", &cache);
    const auto first = source.ask(order_with_seed(1), {});
    {
        const FullDisk full;
        DOCTEST_CHECK(source.ask(order_with_seed(2), {}).width == 64);
        DOCTEST_CHECK(source.ask(order_with_seed(3), {}).width == 64);
        DOCTEST_CHECK(source.ask(order_with_seed(1), {}).data == first.data);
    }
    DOCTEST_CHECK(source.use().not_kept == 2);
    DOCTEST_CHECK(source.use().cached == 1);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
        DOCTEST_CHECK(entry.path().extension() != ".pending");
    source.ask(order_with_seed(2), {});  // asked again, and kept now
    source.ask(order_with_seed(2), {});
    DOCTEST_CHECK(stand_in.asked("/img_gen").size() == 4);
}

DOCTEST_TEST_CASE("a clock that is set back or forward while a server draws changes nothing") {
    if (!can_stand_in()) return;
    struct Spoken {
        const char* flavour;
        ServerKind kind;
    };
    for (const auto& [flavour, kind] :
         {Spoken{"forge", ServerKind::Webui}, Spoken{"vllm", ServerKind::OpenAi},
          Spoken{"sdserver", ServerKind::SdCpp}, Spoken{"comfy", ServerKind::Comfy}})
        for (const long offset : {-86'400L, 86'400L}) {
            DOCTEST_CAPTURE(flavour);
            DOCTEST_CAPTURE(offset);
            test::ScratchFolder folder;
            DiskCache cache(folder.path(), CacheBytes);
            auto& stand_in = shared_stand_in(flavour);
            auto address = stand_in.address();
            address.kind = kind;
            const auto server = connect(address, {});
            PictureSource source(*server, server->probe({}), "", &cache);
            const auto first = source.ask(order_with_seed(1), {});
            stand_in.set({{"draw_s", "0.3"}});
            std::thread setter([offset] {
                std::this_thread::sleep_for(Milliseconds(150));
                clock_offset = offset;
            });
            const auto second = source.ask(order_with_seed(2), {});
            setter.join();
            DOCTEST_CHECK(second.width == 64);
            DOCTEST_CHECK(source.ask(order_with_seed(1), {}).data == first.data);
            DOCTEST_CHECK(source.use().cached == 1);
            DOCTEST_CHECK(source.use().seconds > 0);
            DOCTEST_CHECK(source.use().seconds < 60);
            clock_offset = 0;
            DOCTEST_CHECK(source.ask(order_with_seed(2), {}).data == second.data);
            DOCTEST_CHECK(source.use().cached == 2);
        }
}

}  // namespace
}  // namespace gse::remote
