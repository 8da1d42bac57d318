// Preloaded into the program by tests: calls that write, sync or rename files fail, or kill the program.
// GSE_FAULT="CALL:NUMBER:WHAT": CALL is write, fsync or rename; from call NUMBER on (1 = the first) WHAT
// happens: an errno, or "kill". Only files count, not pipes or terminals.
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

struct Fault {
    char call[16] = "";
    long number = 0;
    char what[16] = "";
};

const Fault& wanted() {
    static const Fault fault = [] {
        Fault read;
        if (const char* text = std::getenv("GSE_FAULT"))
            std::sscanf(text, "%15[^:]:%ld:%15s", read.call, &read.number, read.what);
        return read;
    }();
    return fault;
}

std::atomic<long> calls{0};

/// True when this call is to fail; errno is set.
bool fails(const char* call) {
    const Fault& fault = wanted();
    if (std::strcmp(fault.call, call) != 0 || ++calls < fault.number) return false;
    if (std::strcmp(fault.what, "kill") == 0) kill(getpid(), SIGKILL);
    errno = std::atoi(fault.what);
    return true;
}

bool is_file(int descriptor) {
    struct stat status {};
    return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

template <class Function> Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t count) {
    static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
    if (is_file(descriptor) && fails("write")) return -1;
    return real(descriptor, bytes, count);
}

ssize_t writev(int descriptor, const struct iovec* parts, int count) {
    static const auto real = next<ssize_t (*)(int, const struct iovec*, int)>("writev");
    if (is_file(descriptor) && fails("write")) return -1;
    return real(descriptor, parts, count);
}

int fsync(int descriptor) {
    static const auto real = next<int (*)(int)>("fsync");
    if (is_file(descriptor) && fails("fsync")) return -1;
    return real(descriptor);
}

int rename(const char* from, const char* to) noexcept {
    if (fails("rename")) return -1;
    return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
    if (fails("rename")) return -1;
    return static_cast<int>(syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

}  // extern "C"
