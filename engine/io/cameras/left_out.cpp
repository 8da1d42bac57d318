// Sentences about cameras that are left out.
#include "engine/io/cameras/left_out.h"

#include <fmt/format.h>

#include <algorithm>

namespace gse::io {
namespace {

constexpr std::size_t MostNames = 8;     // more fill a message
constexpr std::size_t MostReasons = 8;   // the last one then stands for all others
constexpr std::size_t LongestName = 80;  // bytes

std::string with_hint(const Error& why) {
    return why.hint().empty() ? why.message() : why.message() + "; " + why.hint();
}

}  // namespace

std::string quoted(std::string_view name) {
    return name.size() <= LongestName ? fmt::format("\"{}\"", name)
                                      : fmt::format("\"{}...\"", name.substr(0, LongestName));
}

void NameList::add(std::string name) {
    if (++size_ <= MostNames) names_.push_back(std::move(name));
}

std::string NameList::text() const {
    if (size_ > names_.size()) {
        const std::size_t others = size_ - names_.size();
        return fmt::format("{} and {} other{}", fmt::join(names_, ", "), others, others == 1 ? "" : "s");
    }
    if (names_.size() < 2) return names_.empty() ? "" : names_.front();
    return fmt::format("{} and {}", fmt::join(names_.begin(), names_.end() - 1, ", "), names_.back());
}

void LeftOut::add(std::string name, const Error& why) {
    ++size_;
    auto found = std::find_if(reasons_.begin(), reasons_.end(),
                              [&](const Reason& reason) { return reason.why.message() == why.message(); });
    if (found == reasons_.end() && reasons_.size() < MostReasons) {
        const bool last = reasons_.size() + 1 == MostReasons;
        reasons_.push_back({last ? Error(why.code(), "for other reasons") : why, {}});
        found = reasons_.end() - 1;
    }
    if (found == reasons_.end()) --found;
    found->names.add(std::move(name));
}

const LeftOut::Reason& LeftOut::commonest() const {
    return *std::max_element(reasons_.begin(), reasons_.end(), [](const Reason& a, const Reason& b) {
        return a.names.size() < b.names.size();
    });
}

CameraList LeftOut::finish(std::vector<View> kept, std::vector<std::string> notes,
                           const Error& nothing) const {
    if (kept.empty()) {
        if (reasons_.empty()) throw nothing;
        const auto& [why, names] = commonest();
        std::string all =
            size_ == 1 ? "the only camera is left out" : fmt::format("all {} cameras are left out", size_);
        if (names.size() < size_) all += fmt::format(", {} of them", names.size());
        throw Error(why.code(), fmt::format("{}, {}: {}", all, names.text(), why.message()), why.hint());
    }
    CameraList list{std::move(kept), {}};
    const std::size_t total = list.views.size() + size_;
    for (const auto& [why, names] : reasons_)
        list.notes.push_back(fmt::format("{} of {} cameras {} left out, {}: {}", names.size(), total,
                                         names.size() == 1 ? "is" : "are", names.text(), with_hint(why)));
    list.notes.insert(list.notes.end(), notes.begin(), notes.end());
    return list;
}

}  // namespace gse::io
