// Addresses that may be written down.
#include "engine/remote/api/server_settings.h"

#include <algorithm>
#include <array>

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

bool is_bundled_workflow(std::string_view name) {
    constexpr std::array<std::string_view, 4> bundled{"img2img", "inpainting", "edit", "edit_reference"};
    return std::find(bundled.begin(), bundled.end(), name) != bundled.end();
}

TargetPicture target_picture_of(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("\"{}\" names no picture of a view", printable(text)),
                    "write it as VIEW=FILE; --views-only lists the views");
    return {text.substr(0, equals), text.substr(equals + 1)};
}

std::string file_name_of_view(const std::string& view) {
    std::string name = view;
    for (char& c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (!plain && c != '.' && c != '-' && c != '_') c = '_';
    }
    return name;
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
