// Addresses that may be written down.
#include "engine/remote/api/server_settings.h"

namespace gse::remote {

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
