// One place that turns an Error into a sentence and an exit code.
#include "app/main/program_main.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/printable.h"
#include "engine/base/process.h"

namespace gse::app {
namespace {

int exit_code(ErrorCode code) {
    switch (code) {
        case ErrorCode::InvalidArgument: return 2;
        case ErrorCode::Cancelled: return 130;
        default: return 1;
    }
}

int failed(const Program& program, const Error& error) {
    std::fprintf(stderr, "%s: %s\n", program.name, printable(error.what()).c_str());
    return exit_code(error.code());
}

/// Brings what was printed to its place; false, after a sentence on stderr, when that or an earlier print
/// failed.
bool flush_output(const Program& program) {
    errno = 0;
    std::cout.flush();
    const bool flushed = std::fflush(stdout) == 0 && std::cout.good() && std::ferror(stdout) == 0;
    if (flushed) return true;
    const std::string reason = errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : std::string();
    std::fprintf(stderr, "%s: the output cannot be printed%s; files that were asked for are written\n",
                 program.name, reason.c_str());
    return false;
}

}  // namespace

int program_main(const Program& program, int argc, char** argv) {
    prefer_fast_blas(argv);
    let_writes_fail();
    try {
        const int code = run_command_line(program, argc, argv);
        return flush_output(program) ? code : 1;
    } catch (const Error& error) { return failed(program, error); } catch (const std::bad_alloc&) {
        return failed(program, out_of_memory());
    } catch (const std::filesystem::filesystem_error& error) {  // a name that the system does not take
        return failed(program,
                      Error(ErrorCode::NotFound, error.code().message(), "use another name", error.path1()));
    } catch (const std::exception& error) {
        if (std::ferror(stdout) != 0 && !flush_output(program)) return 1;  // printing failed, not the work
        std::fprintf(stderr, "%s: unexpected failure (%s); please report it\n", program.name,
                     printable(error.what()).c_str());
        return 70;
    }
}

}  // namespace gse::app
