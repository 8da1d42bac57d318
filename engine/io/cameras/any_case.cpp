// Listings of folders by names in lower case.
#include "engine/io/cameras/any_case.h"

#include <algorithm>

#include "engine/io/bytes/letter_case.h"

namespace gse::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t MostNumbered = 16;  // COLMAP's components; thousands are pictures or frames
constexpr std::size_t MostDigits = 6;     // longer names of digits are dates and the like

bool is_number(const std::string& name) {
    return !name.empty() && name.size() <= MostDigits &&
           std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

const AnyCase::Names& AnyCase::names_in(const fs::path& folder) {
    const auto [entry, fresh] = listings_.try_emplace(folder);
    if (!fresh) return entry->second;
    std::vector<fs::path> names;
    std::error_code failure;
    for (fs::directory_iterator at(folder.empty() ? "." : folder, failure), end; !failure && at != end;
         at.increment(failure))
        names.push_back(at->path().filename());
    std::sort(names.begin(), names.end());
    for (const auto& name : names) entry->second.try_emplace(lower_case(name.string()), name);
    return entry->second;
}

std::optional<fs::path> AnyCase::find(const fs::path& folder, const fs::path& relative) {
    std::error_code ignored;
    if (fs::exists(folder / relative, ignored)) return folder / relative;
    fs::path place = folder;
    for (const fs::path& part : relative) {
        if (part == "." || part.empty()) continue;
        if (part == ".." || fs::exists(place / part, ignored)) {
            place /= part;
            continue;
        }
        const Names& names = names_in(place);
        const auto found = names.find(lower_case(part.string()));
        if (found == names.end()) return std::nullopt;
        place /= found->second;
    }
    return place;
}

std::vector<fs::path> AnyCase::numbered(const fs::path& folder) {
    std::vector<fs::path> folders;
    std::error_code ignored;
    for (const auto& [lower, name] : names_in(folder))
        if (is_number(lower) && fs::is_directory(folder / name, ignored)) folders.push_back(folder / name);
    std::sort(folders.begin(), folders.end(), [](const fs::path& a, const fs::path& b) {
        return std::stoi(a.filename().string()) < std::stoi(b.filename().string());
    });
    folders.resize(std::min(folders.size(), MostNumbered));
    return folders;
}

}  // namespace gse::io
