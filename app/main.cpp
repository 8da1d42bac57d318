// Entry point: one place that turns an Error into a sentence and an exit code.
#include <cstdio>
#include <exception>

#include "app/cli.h"
#include "app/process.h"
#include "engine/base/error.h"

namespace {

int exit_code(gse::ErrorCode code) {
    switch (code) {
        case gse::ErrorCode::InvalidArgument: return 2;
        case gse::ErrorCode::Cancelled: return 130;
        default: return 1;
    }
}

}  // namespace

int main(int argc, char** argv) {
    gse::app::prefer_fast_blas(argv);
    try {
        return gse::app::run_command_line(argc, argv);
    } catch (const gse::Error& error) {
        std::fprintf(stderr, "gseditpro: %s\n", error.what());
        return exit_code(error.code());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "gseditpro: unexpected failure (%s); please report it\n", error.what());
        return 70;
    }
}
