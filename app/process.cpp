// Signals, rusage and the restart for OpenBLAS.
#include "app/process.h"

#include <signal.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace gse::app {
namespace {

std::atomic<int> interrupts{0};

extern "C" void on_interrupt(int) {
    if (interrupts.fetch_add(1) > 0) _exit(130);
}

/// Turns the signal's counter into a stop request (a handler itself may not lock).
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

double peak_rss_mb() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double process_seconds() {
    // Start of the process in clock ticks since boot: field 22 of /proc/self/stat, counted after the name in parentheses.
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    const auto close = text.rfind(')');
    if (close == std::string::npos) return 0;
    std::istringstream fields(text.substr(close + 2));
    std::string field;
    constexpr int start_field = 20;
    for (int i = 0; i < start_field && fields >> field; ++i) {
    }
    struct timespec now {};
    clock_gettime(CLOCK_BOOTTIME, &now);
    const double ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - std::atof(field.c_str()) / ticks;
}

double current_rss_mb() {
    std::ifstream file("/proc/self/statm");
    double pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

void prefer_fast_blas(char** argv) {
    // Threads of the networks sleep when they wait: spinning halves the speed as soon as anything else runs.
    setenv("OMP_WAIT_POLICY", "passive", 0);
#if defined(__x86_64__) && !defined(GSE_SANITIZED)
    __builtin_cpu_init();
    if (!__builtin_cpu_is("amd") || !__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512vl")) return;
    if (std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
    setenv("OPENBLAS_CORETYPE", "SkylakeX", 1);
    execv("/proc/self/exe", argv);   // on failure the program just goes on with the slower kernels
#else
    (void)argv;
#endif
}

}  // namespace gse::app
