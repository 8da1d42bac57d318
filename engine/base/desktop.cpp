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

namespace {

/// Hands a folder or a document to the desktop. `advice`: what to do where there is no desktop.
void hand_over(const std::filesystem::path& place, const char* missing, const char* advice) {
    std::string program = "xdg-open", argument = place.string();
    char* arguments[] = {program.data(), argument.data(), nullptr};
    pid_t child = 0;
    if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0)
        throw Error(ErrorCode::NotFound, missing, advice, place);
    std::thread([child] {  // so that it leaves nothing behind when it ends
        int status = 0;
        waitpid(child, &status, 0);
    })
        .detach();
}

}  // namespace

void show_folder_of(const std::filesystem::path& file) {
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw Error(ErrorCode::NotFound, "the folder is gone", {}, folder);
    hand_over(folder, "no program that shows folders was found (xdg-open)", "open the folder by hand");
}

void open_document(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        throw Error(ErrorCode::NotFound, "the document is not there", {}, file);
    hand_over(std::filesystem::absolute(file), "no program that opens documents was found (xdg-open)",
              "open the document by hand");
}

}  // namespace gse
