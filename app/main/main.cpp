// Entry point: one place that turns an Error into a sentence and an exit code.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>

#include "app/cli/cli.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/printable.h"
#include "engine/base/process.h"

namespace {

int exit_code(gse::ErrorCode code) {
    switch (code) {
        case gse::ErrorCode::InvalidArgument: return 2;
        case gse::ErrorCode::Cancelled: return 130;
        default: return 1;
    }
}

int failed(const gse::Error& error) {
    std::fprintf(stderr, "gseditpro: %s\n", gse::printable(error.what()).c_str());
    return exit_code(error.code());
}

/// Brings what was printed to its place; false, after a sentence on stderr, when that or an earlier print
/// failed.
bool flush_output() {
    errno = 0;
    std::cout.flush();
    const bool flushed = std::fflush(stdout) == 0 && std::cout.good() && std::ferror(stdout) == 0;
    if (flushed) return true;
    const std::string reason = errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : std::string();
    std::fprintf(stderr, "gseditpro: the output cannot be printed%s; files that were asked for are written\n",
                 reason.c_str());
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    gse::prefer_fast_blas(argv);
    gse::let_writes_fail();
    try {
        const int code = gse::app::run_command_line(argc, argv);
        return flush_output() ? code : 1;
    } catch (const gse::Error& error) { return failed(error); } catch (const std::bad_alloc&) {
        return failed(gse::out_of_memory());
    } catch (const std::filesystem::filesystem_error& error) {  // a name that the system does not take
        return failed(
            gse::Error(gse::ErrorCode::NotFound, error.code().message(), "use another name", error.path1()));
    } catch (const std::exception& error) {
        if (std::ferror(stdout) != 0 && !flush_output()) return 1;  // printing failed, not the work
        std::fprintf(stderr, "gseditpro: unexpected failure (%s); please report it\n",
                     gse::printable(error.what()).c_str());
        return 70;
    }
}
