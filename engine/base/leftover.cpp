// Marks of writers, and the locks that show whether they live.
#include "engine/base/leftover.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fstream>

namespace gse {
namespace {

/// Number that changes with every start of the machine; 0 if the system does not tell.
std::uint32_t boot_number() {
    static const std::uint32_t number = [] {
        std::ifstream stream("/proc/sys/kernel/random/boot_id");
        unsigned value = 0;
        std::string line;
        if (std::getline(stream, line)) std::sscanf(line.c_str(), "%8x", &value);
        return value;
    }();
    return number;
}

struct Mark {
    long process = 0;
    unsigned boot = 0;
};

/// Parses a mark. Marks of earlier versions have no boot number.
bool parse_mark(std::string_view text, Mark& mark) {
    const std::string copy(text);
    long number = 0;
    int used = 0;
    if (std::sscanf(copy.c_str(), "%ld-%ld%n-%8x%n", &mark.process, &number, &used, &mark.boot, &used) < 2)
        return false;
    return static_cast<std::size_t>(used) == copy.size() && mark.process > 0;
}

enum class Holder { Nobody, Somebody, Unknown };

Holder holder_of(const std::filesystem::path& path, double& age_seconds) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    if (descriptor < 0) return Holder::Unknown;
    struct stat status {};
    fstat(descriptor, &status);
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    age_seconds = std::chrono::duration<double>(now).count() - static_cast<double>(status.st_mtim.tv_sec);
    Holder holder = Holder::Nobody;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0)
        holder = errno == EWOULDBLOCK ? Holder::Somebody : Holder::Unknown;
    close(descriptor);
    return holder;
}

}  // namespace

std::string writer_mark() {
    static std::atomic<unsigned> counter{0};
    return fmt::format("{}-{}-{:08x}", getpid(), counter.fetch_add(1), boot_number());
}

void hold(int descriptor) { static_cast<void>(flock(descriptor, LOCK_EX | LOCK_NB)); }

bool is_left_over(const std::filesystem::path& path, std::string_view mark_text, double foreign_age_seconds) {
    Mark mark;
    if (!parse_mark(mark_text, mark)) return false;
    double age_seconds = 0;
    const Holder holder = holder_of(path, age_seconds);
    if (holder == Holder::Somebody) return false;
    const bool process_is_gone = kill(static_cast<pid_t>(mark.process), 0) != 0 && errno == ESRCH;
    if (mark.boot != 0 && mark.boot == boot_number()) return process_is_gone;
    return process_is_gone && age_seconds >= foreign_age_seconds;
}

}  // namespace gse
