// Memory limits from Linux: the machine's, the control groups' (both versions) and the process's own.
#include "engine/base/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <utility>

namespace gse {
namespace {

constexpr std::uint64_t Unlimited = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t SmallRequest = std::uint64_t{64} << 20;
constexpr const char* Hint = "close other programs, or use fewer and smaller pictures or a smaller scene";

thread_local std::size_t refused_bytes = 0;

/// Number behind `key` in a file of "key number" lines, or `missing`.
std::uint64_t number_of(const std::filesystem::path& file, std::string_view key, std::uint64_t missing) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with(key)) continue;
        std::uint64_t number = 0;
        if (std::istringstream(line.substr(key.size())) >> number) return number;
    }
    return missing;
}

std::uint64_t difference(std::uint64_t limit, std::uint64_t used) {
    return limit == Unlimited ? Unlimited : limit - std::min(limit, used);
}

std::uint64_t machine_memory() {
    const char* file = "/proc/meminfo";
    const std::uint64_t available = number_of(file, "MemAvailable:", Unlimited);
    if (available == Unlimited) return Unlimited;
    return (available + number_of(file, "SwapFree:", 0)) * 1024;
}

/// Names of a control group's files.
struct GroupFiles {
    const char* limit;
    const char* usage;
    const char* cache;  // in memory.stat: files that can be dropped
};
constexpr GroupFiles Version1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "};
constexpr GroupFiles Version2{"memory.max", "memory.current", "inactive_file "};

/// The least that a group and those above it leave. "max" is no number and counts as no limit.
std::uint64_t group_memory(const std::filesystem::path& root, std::filesystem::path group,
                           const GroupFiles& files) {
    std::uint64_t least = Unlimited;
    group = group.relative_path();
    while (true) {
        const auto folder = root / group;
        const std::uint64_t usage = number_of(folder / files.usage, "", 0);
        const std::uint64_t cache = number_of(folder / "memory.stat", files.cache, 0);
        least = std::min(least, difference(number_of(folder / files.limit, "", Unlimited),
                                           usage - std::min(usage, cache)));
        if (group.empty()) return least;
        group = group.parent_path();
    }
}

std::uint64_t control_groups() {
    std::uint64_t least = Unlimited;
    std::ifstream stream("/proc/self/cgroup");
    for (std::string line; std::getline(stream, line);) {  // "4:memory:/path" or "0::/path"
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1),
                          path = line.substr(second + 1);
        if (controllers.empty()) least = std::min(least, group_memory("/sys/fs/cgroup", path, Version2));
        if (controllers == "memory")
            least = std::min(least, group_memory("/sys/fs/cgroup/memory", path, Version1));
    }
    return least;
}

/// Bytes left by the limits of `ulimit -v` and `ulimit -d`.
std::uint64_t process_limits() {
    std::uint64_t least = Unlimited;
    const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    std::array<std::uint64_t, 7> pages{};  // size resident shared text library data dirty
    std::ifstream stream("/proc/self/statm");
    for (auto& count : pages) stream >> count;
    for (const auto& [resource, used] : {std::pair{RLIMIT_AS, pages[0]}, std::pair{RLIMIT_DATA, pages[5]}}) {
        rlimit limit{};
        if (getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
            least = std::min(least, difference(limit.rlim_cur, used * page));
    }
    return least;
}

}  // namespace

OutOfMemory::OutOfMemory(const std::string& message) : Error(ErrorCode::Foreign, message, Hint) {}

std::uint64_t free_memory() { return std::min({machine_memory(), control_groups(), process_limits()}); }

void require_memory(std::uint64_t bytes, std::string_view purpose) {
    if (bytes <= SmallRequest) return;
    const std::uint64_t free = free_memory();
    if (bytes <= free) return;
    throw OutOfMemory(fmt::format("{} needs {} of memory, and {} are free", purpose, memory_text(bytes),
                                  memory_text(free)));
}

std::string memory_text(std::uint64_t bytes) {
    const double megabytes = static_cast<double>(bytes) / 1e6;
    return megabytes < 999.5 ? fmt::format("{:.0f} MB", megabytes)
                             : fmt::format("{:.3g} GB", std::round(megabytes) / 1e3);
}

OutOfMemory out_of_memory(std::uint64_t bytes) {
    const std::string free = memory_text(free_memory());
    if (bytes == 0) return OutOfMemory(fmt::format("there is not enough memory; {} are free", free));
    return OutOfMemory(fmt::format("there is not enough memory: {} more were needed, and {} are free",
                                   memory_text(bytes), free));
}

OutOfMemory out_of_memory() { return out_of_memory(std::exchange(refused_bytes, 0)); }

void note_refused(std::size_t bytes) noexcept { refused_bytes = bytes; }

}  // namespace gse
