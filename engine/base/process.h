// Setup of the program's own process: interrupts, failing writes, BLAS kernels.
#pragma once

#include <stop_token>

namespace gse {

/// Token that Ctrl-C (SIGINT) or SIGTERM turns on. A second Ctrl-C ends the program at once.
std::stop_token interrupt_token();

/// Makes writes to a closed pipe or beyond the limit for file sizes return an error instead of ending the
/// program. Stands in for closed standard streams.
void let_writes_fail();

/// Restarts the program once with OPENBLAS_CORETYPE set, for AMD's AVX-512 processors. OpenBLAS before 0.3.26
/// does not know them and uses half-width kernels. The core type must be chosen before the library is loaded.
void prefer_fast_blas(char** argv);

}  // namespace gse
