// Numbers to text and back.
#include "engine/edit/request/excluded_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "engine/base/error.h"

namespace gse::edit {

std::vector<std::size_t> excluded_views_of(const std::string& text) {
    constexpr const char* Separators = ", ";
    std::vector<std::size_t> views;
    for (auto begin = text.find_first_not_of(Separators); begin != std::string::npos;) {
        const auto end = std::min(text.find_first_of(Separators, begin), text.size());
        std::size_t view = 0;
        const auto read = std::from_chars(text.data() + begin, text.data() + end, view);
        if (read.ec != std::errc() || read.ptr != text.data() + end)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" of excluded_views is no number of a view",
                                    text.substr(begin, end - begin)),
                        "list views by their numbers from 0 (\"3, 17\")");
        views.push_back(view);
        begin = text.find_first_not_of(Separators, end);
    }
    std::sort(views.begin(), views.end());
    views.erase(std::unique(views.begin(), views.end()), views.end());
    return views;
}

std::string with_view(const std::string& text, std::size_t view, bool out) {
    auto views = excluded_views_of(text);
    std::erase(views, view);
    if (out) views.insert(std::upper_bound(views.begin(), views.end(), view), view);
    return fmt::format("{}", fmt::join(views, ", "));
}

}  // namespace gse::edit
