// Figures of the running process, from the kernel.
#include "engine/base/process_memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

namespace gse {

double peak_rss_mb() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double process_seconds() {
    // Start of the process in clock ticks since boot: field 22 of /proc/self/stat, counted after the name in
    // parentheses.
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    const auto close = text.rfind(')');
    if (close == std::string::npos) return 0;
    std::istringstream fields(text.substr(close + 2));
    std::string field;
    constexpr int start_field = 20;
    for (int i = 0; i < start_field && fields >> field; ++i) {}
    struct timespec now {};
    clock_gettime(CLOCK_BOOTTIME, &now);
    const double ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
           std::atof(field.c_str()) / ticks;
}

double current_rss_mb() {
    std::ifstream file("/proc/self/statm");
    double pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

PeakMemory::PeakMemory() {
    std::ofstream file("/proc/self/clear_refs");
    file << "5" << std::flush;  // proc(5): the peak becomes what is resident now
}

double PeakMemory::mb() const {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("VmHWM:")) return std::atof(line.c_str() + 6) / 1024.0;
    return peak_rss_mb();
}

}  // namespace gse
