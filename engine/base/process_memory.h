// What the running process uses: memory and time.
#pragma once

namespace gse {

/// Largest resident memory so far, in MiB.
double peak_rss_mb();

/// Seconds since the process started (to a hundredth), restarts by exec included.
double process_seconds();

/// Memory of this process now, in MB.
double current_rss_mb();

/// The most memory since it was made. Where the kernel lets nobody set its mark back, since the process
/// began.
class PeakMemory {
public:
    PeakMemory();
    double mb() const;  // MiB
};

}  // namespace gse
