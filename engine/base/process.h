// What the program does with its own process: interrupts, writes that fail, the right BLAS kernels.
#pragma once

#include <stop_token>

namespace gse {

/// A token that Ctrl-C (SIGINT) or SIGTERM turns on; a second Ctrl-C ends the program at once.
std::stop_token interrupt_token();

/// Writes to a closed pipe or beyond the limit for file sizes give an error instead of ending the program;
/// closed standard streams are stood in for.
void let_writes_fail();

/// OpenBLAS before 0.3.26 does not know AMD's AVX-512 processors and falls back to half-width kernels; the
/// core type can only be chosen before the library is loaded, so the program restarts itself once with
/// OPENBLAS_CORETYPE set.
void prefer_fast_blas(char** argv);

}  // namespace gse
