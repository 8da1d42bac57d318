// Composes the one-line text of an Error.
#include "engine/base/error.h"

#include <utility>

namespace gse {
namespace {

/// A message may quote a file; a zero byte in it would end what() there.
std::string compose(const std::string& message, const std::string& hint, const std::filesystem::path& path) {
    std::string text = message;
    if (!hint.empty()) text += "; " + hint;
    if (!path.empty()) text += ": " + path.string();
    for (auto zero = text.find('\0'); zero != std::string::npos; zero = text.find('\0', zero))
        text.replace(zero, 1, "\\x00");
    return text;
}

}  // namespace

Error::Error(ErrorCode code, std::string message, std::string hint, std::filesystem::path path)
    : std::runtime_error(compose(message, hint, path)), code_(code), message_(std::move(message)),
      hint_(std::move(hint)), path_(std::move(path)) {}

}  // namespace gse
