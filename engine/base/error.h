// The one exception type for mistakes of the world and the user. It says what failed, what to do, and the
// path last.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace gse {

/// Kind of failure. The program's exit code follows from it (app/); the window shows the message.
enum class ErrorCode {
    InvalidArgument,  // the user asked for something that cannot be done
    NotFound,         // a file, folder or word is not there
    Unreadable,       // the file is there but cannot be read
    Unwritable,       // the output cannot be written
    Malformed,        // the content breaks its format
    Unsupported,      // valid, but not handled here
    Model,            // a network's weights or configuration do not fit
    Cancelled,        // the user stopped the work
    Foreign,          // another library threw
};

/// World or user error. `message` says what failed, `hint` what to do (may be empty), `path` names the file
/// (may be empty). what() is "message; hint: path" on one line.
class Error : public std::runtime_error {
public:
    Error(ErrorCode code, std::string message, std::string hint = {}, std::filesystem::path path = {});

    ErrorCode code() const { return code_; }
    const std::string& message() const { return message_; }
    const std::string& hint() const { return hint_; }
    const std::filesystem::path& path() const { return path_; }

private:
    ErrorCode code_;
    std::string message_;
    std::string hint_;
    std::filesystem::path path_;
};

/// Adds the path to errors of `body` that name none. Readers know only bytes.
template <class F> auto with_path(const std::filesystem::path& path, F&& body) {
    try {
        return body();
    } catch (const Error& error) {
        if (!error.path().empty()) throw;
        throw Error(error.code(), error.message(), error.hint(), path);
    }
}

}  // namespace gse
