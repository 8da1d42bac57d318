// Starts a program beside this one.
#include "engine/base/desktop.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "engine/base/error.h"

extern char** environ;

namespace gse {

void show_folder_of(const std::filesystem::path& file) {
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw Error(ErrorCode::NotFound, "the folder is gone", {}, folder);
    std::string program = "xdg-open", argument = folder.string();
    char* arguments[] = {program.data(), argument.data(), nullptr};
    pid_t child = 0;
    if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0)
        throw Error(ErrorCode::NotFound, "no program that shows folders was found (xdg-open)",
                    "open the folder by hand", folder);
    std::thread([child] {  // so that it leaves nothing behind when it ends
        int status = 0;
        waitpid(child, &status, 0);
    })
        .detach();
}

}  // namespace gse
