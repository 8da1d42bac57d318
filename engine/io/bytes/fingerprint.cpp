// Fingerprints of scene files and folders.
#include "engine/io/bytes/fingerprint.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

namespace gse::io {
namespace {

constexpr std::size_t EndBytes = std::size_t{1} << 20;
constexpr std::size_t PageBytes = 4096;
constexpr std::size_t Pages = 64;
constexpr std::size_t MostFiles = 4096;  // of a folder; a scene has far fewer

std::uint64_t hash_number(std::uint64_t number, std::uint64_t state) {
    return hash_bytes({reinterpret_cast<const char*>(&number), sizeof number}, state);
}

/// Reads with a stream, not a map, since somebody may be cutting the file off at this moment.
std::optional<Fingerprint> of_file(const std::filesystem::path& path) {
    std::error_code failure;
    const std::uint64_t size = std::filesystem::file_size(path, failure);
    std::ifstream stream(path, std::ios::binary);
    if (failure || !stream) return std::nullopt;
    std::uint64_t value = hash_number(size, hash_bytes(""));
    std::string piece;
    const auto take = [&](std::uint64_t offset, std::size_t bytes) {
        piece.resize(bytes);
        stream.seekg(static_cast<std::streamoff>(offset));
        stream.read(piece.data(), static_cast<std::streamsize>(bytes));
        value = hash_bytes({piece.data(), static_cast<std::size_t>(stream.gcount())}, value);
        stream.clear();
    };
    take(0, static_cast<std::size_t>(std::min<std::uint64_t>(size, EndBytes)));
    if (size > EndBytes) take(size - EndBytes, EndBytes);
    if (size > 2 * EndBytes)
        for (std::size_t page = 1; page <= Pages; ++page) take(size / (Pages + 1) * page, PageBytes);
    return Fingerprint{size, value};
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
        if (std::filesystem::is_directory(path, failure)) return of_folder(path);
        if (!std::filesystem::is_regular_file(path, failure)) return std::nullopt;
        return of_file(path);
    } catch (const std::filesystem::filesystem_error&) { return std::nullopt; }
}

}  // namespace gse::io
