// Signals, closed streams and the restart for OpenBLAS.
#include "engine/base/process.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace gse {
namespace {

std::atomic<int> interrupts{0};

extern "C" void on_interrupt(int) {
    if (interrupts.fetch_add(1) > 0) _exit(130);
}

/// Turns the signal's counter into a stop request. A handler itself may not lock.
class InterruptWatch {
public:
    InterruptWatch() {
        struct sigaction action {};
        action.sa_handler = on_interrupt;
        sigaction(SIGINT, &action, nullptr);
        sigaction(SIGTERM, &action, nullptr);
        thread_ = std::jthread([this](const std::stop_token& done) {
            while (!done.stop_requested()) {
                if (interrupts.load() > 0) source_.request_stop();
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            }
        });
    }
    std::stop_token token() const { return source_.get_token(); }

private:
    std::stop_source source_;
    std::jthread thread_;
};

}  // namespace

std::stop_token interrupt_token() {
    static InterruptWatch watch;
    return watch.token();
}

void let_writes_fail() {
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    // A file opened while stdout is closed would get its number, and what is printed with it. What is opened
    // here cannot be used in the direction that counts, so the failure is seen.
    for (int standard = STDIN_FILENO; standard <= STDERR_FILENO; ++standard)
        if (fcntl(standard, F_GETFD) < 0)
            static_cast<void>(open("/dev/null", standard == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

void prefer_fast_blas(char** argv) {
    // Threads of the networks sleep when they wait: spinning halves the speed as soon as anything else runs.
    setenv("OMP_WAIT_POLICY", "passive", 0);
#if defined(__x86_64__) && !defined(GSE_SANITIZED)
    __builtin_cpu_init();
    if (!__builtin_cpu_is("amd") || !__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512vl"))
        return;
    if (std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
    setenv("OPENBLAS_CORETYPE", "SkylakeX", 1);
    execv("/proc/self/exe", argv);  // on failure the program just goes on with the slower kernels
#else
    (void)argv;
#endif
}

}  // namespace gse
