// What the program does with its own process: interrupts, memory figures, the right BLAS kernels.
#pragma once

#include <stop_token>

namespace gse::app {

/// A token that Ctrl-C (SIGINT) or SIGTERM turns on; a second Ctrl-C ends the program at once.
std::stop_token interrupt_token();

/// Largest resident memory so far, in MiB.
double peak_rss_mb();

/// Seconds since the process started (to a hundredth), restarts by exec included.
double process_seconds();

/// Memory of this process now, in MB.
double current_rss_mb();

/// OpenBLAS before 0.3.26 does not know AMD's AVX-512 processors and falls back to half-width kernels; the core type can
/// only be chosen before the library is loaded, so the program restarts itself once with OPENBLAS_CORETYPE set.
void prefer_fast_blas(char** argv);

}  // namespace gse::app
