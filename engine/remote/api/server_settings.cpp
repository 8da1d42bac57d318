// Addresses that may be written down.
#include "engine/remote/api/server_settings.h"

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/printable.h"

namespace gse::remote {

ServerSearch server_search_of(const std::string& name) {
    if (name == "auto") return ServerSearch::Auto;
    if (name == "differences") return ServerSearch::Differences;
    if (name == "none") return ServerSearch::None;
    if (name == "paint") return ServerSearch::Paint;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("\"{}\" is no way to search with a server", printable(name)),
                "name auto, differences, paint or none");
}

std::string without_secrets(std::string_view url) {
    url = url.substr(0, url.find_first_of("?#"));
    const auto scheme = url.find("://");
    const auto first = scheme == std::string_view::npos ? 0 : scheme + 3;
    const auto host = url.substr(first, url.find('/', first) - first);
    const auto user = host.rfind('@');
    if (user == std::string_view::npos) return std::string(url);
    return std::string(url.substr(0, first)) + std::string(url.substr(first + user + 1));
}

}  // namespace gse::remote
