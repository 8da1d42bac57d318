// Memory and time that the running process uses.
#pragma once

namespace gse {

/// Largest resident memory so far, in MiB.
double peak_rss_mb();

/// Seconds since the process started (to a hundredth). Restarts by exec are included.
double process_seconds();

/// Current memory of this process, in MB.
double current_rss_mb();

/// Highest memory since this object was made. Since the start of the process if the kernel does not reset its
/// mark.
class PeakMemory {
public:
    PeakMemory();
    double mb() const;  // MiB
};

}  // namespace gse
