// Entry point: one place that turns an Error into a sentence and an exit code.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>

#include "app/cli.h"
#include "app/process.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/printable.h"

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

}  // namespace

int main(int argc, char** argv) {
    gse::app::prefer_fast_blas(argv);
    gse::app::let_writes_fail();
    try {
        const int code = gse::app::run_command_line(argc, argv);
        return gse::app::flush_output() ? code : 1;
    } catch (const gse::Error& error) {
        return failed(error);
    } catch (const std::bad_alloc&) {
        return failed(gse::out_of_memory());
    } catch (const std::filesystem::filesystem_error& error) {   // a name that the system does not take
        return failed(gse::Error(gse::ErrorCode::NotFound, error.code().message(), "use another name", error.path1()));
    } catch (const std::exception& error) {
        if (std::ferror(stdout) != 0 && !gse::app::flush_output()) return 1;  // printing failed, not the work
        std::fprintf(stderr, "gseditpro: unexpected failure (%s); please report it\n", gse::printable(error.what()).c_str());
        return 70;
    }
}
