// Prints a failed check and aborts.
#include "engine/base/check.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace gse::detail {

void check_failed(const char* file, int line, const char* expression, const std::string& values) {
    std::fprintf(stderr, "%s:%d: check failed: %s %s\n", file, line, expression, values.c_str());
    std::abort();
}

}  // namespace gse::detail
