// Fingerprints of scene files and folders.
#include "engine/io/fingerprint.h"

#include <algorithm>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace gse::io {
namespace {

constexpr std::size_t EndBytes = std::size_t{1} << 20;
constexpr std::size_t PageBytes = 4096;
constexpr std::size_t Pages = 64;
constexpr std::size_t MostFiles = 4096;  // of a folder; a scene has far fewer

std::uint64_t hash_number(std::uint64_t number, std::uint64_t state) {
    return hash_bytes({reinterpret_cast<const char*>(&number), sizeof number}, state);
}

Fingerprint of_file(const std::filesystem::path& path) {
    const MappedFile file(path);
    const std::string_view text = file.text();
    std::uint64_t value = hash_number(text.size(), hash_bytes(""));
    value = hash_bytes(text.substr(0, EndBytes), value);
    if (text.size() > EndBytes) value = hash_bytes(text.substr(text.size() - EndBytes), value);
    if (text.size() > 2 * EndBytes)
        for (std::size_t page = 1; page <= Pages; ++page)
            value = hash_bytes(text.substr(text.size() / (Pages + 1) * page, PageBytes), value);
    return {text.size(), value};
}

Fingerprint of_folder(const std::filesystem::path& path) {
    std::vector<std::pair<std::string, std::uint64_t>> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
        if (!entry.is_regular_file()) continue;
        files.emplace_back(entry.path().lexically_relative(path).generic_string(), entry.file_size());
        if (files.size() == MostFiles) break;
    }
    std::sort(files.begin(), files.end());
    Fingerprint result{0, hash_bytes("folder")};
    for (const auto& [name, bytes] : files) {
        result.value = hash_number(bytes, hash_bytes(name, result.value));
        result.bytes += bytes;
    }
    return result;
}

}  // namespace

std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t state) {
    for (const char letter : bytes) state = (state ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
    return state;
}

std::optional<Fingerprint> fingerprint(const std::filesystem::path& path) {
    try {
        std::error_code failure;
        return std::filesystem::is_directory(path, failure) ? of_folder(path) : of_file(path);
    } catch (const Error&) {
        return std::nullopt;
    } catch (const std::filesystem::filesystem_error&) {
        return std::nullopt;
    }
}

}  // namespace gse::io
