// Entries as files: magic, hash of all that follows, length of the question, question, answer.
#include "engine/base/disk_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/leftover.h"
#include "engine/base/log.h"

namespace gse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view Magic = "GSECACH2";  // the last letter is the version of the layout
constexpr std::string_view Ending = ".answer", PendingEnding = ".pending";
// A file being written that is older was left by a killed writer.
constexpr auto PendingAge = std::chrono::hours(1);

struct Header {
    char magic[8] = {};
    std::uint64_t digest[2] = {};
    std::uint64_t question_bytes = 0;
};

struct Entry {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t bytes = 0;
};

fs::path entry_path(const fs::path& folder, std::string_view question) {
    ContentHash hash;
    hash.text(question);
    return folder / (hash.key().hex() + std::string(Ending));
}

void seal(Header& header, std::string_view question, std::string_view answer) {
    std::copy(Magic.begin(), Magic.end(), header.magic);
    header.question_bytes = question.size();
    ContentHash hash;
    hash.text(question);
    hash.text(answer);
    const auto key = hash.key();
    header.digest[0] = key.low, header.digest[1] = key.high;
}

/// The answer in the bytes of an entry, where they are whole and answer this question.
std::optional<std::string> answer_in(std::string_view bytes, std::string_view question) {
    Header header;
    if (bytes.size() < sizeof header + question.size()) return std::nullopt;
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.question_bytes != question.size() || bytes.substr(sizeof header, question.size()) != question)
        return std::nullopt;
    const auto answer = bytes.substr(sizeof header + question.size());
    Header wanted;
    seal(wanted, question, answer);
    if (std::memcmp(&header, &wanted, sizeof header) != 0) return std::nullopt;
    return std::string(answer);
}

/// Tells whether a file of this name is the cache's own.
bool is_named_so(const fs::path& path, std::string_view ending) {
    const std::string name = path.filename().string();
    return name.size() > ending.size() && name.ends_with(ending);
}

std::vector<Entry> entries_of(const fs::path& folder) {
    std::vector<Entry> entries;
    std::error_code failure;
    for (fs::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure)) {
        std::error_code gone;  // another process may be clearing the folder
        const auto used = at->last_write_time(gone);
        const auto bytes = gone || !at->is_regular_file(gone) ? 0 : at->file_size(gone);
        if (gone) continue;
        if (is_named_so(at->path(), Ending)) entries.push_back({at->path(), used, bytes});
        else if (is_named_so(at->path(), PendingEnding) &&
                 fs::file_time_type::clock::now() - used > PendingAge)
            fs::remove(at->path(), gone);
    }
    return entries;
}

bool write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const auto count = ::write(descriptor, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
}

/// Not brought to the disk before it is renamed: an entry that a power failure cuts off is recognised.
bool write_entry(const fs::path& path, std::string_view question, std::string_view answer) {
    Header header;
    seal(header, question, answer);
    fs::path pending = path;
    pending += "." + writer_mark() + std::string(PendingEnding);
    const int descriptor = open(pending.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor < 0) return false;
    bool whole = write_all(descriptor, {reinterpret_cast<const char*>(&header), sizeof header}) &&
                 write_all(descriptor, question) && write_all(descriptor, answer);
    whole = close(descriptor) == 0 && whole;
    if (whole && rename(pending.c_str(), path.c_str()) == 0) return true;
    unlink(pending.c_str());
    return false;
}

/// Keeps what was used last, as long as it fits; returns the bytes that stay.
std::uint64_t shrink(const fs::path& folder, std::uint64_t most) {
    auto entries = entries_of(folder);
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used > b.used; });
    std::uint64_t held = 0;
    bool full = false;
    for (const auto& entry : entries) {
        full = full || held + entry.bytes > most;
        std::error_code ignored;
        if (full) fs::remove(entry.path, ignored);
        else held += entry.bytes;
    }
    return held;
}

}  // namespace

DiskCache::DiskCache(fs::path folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_(most_bytes) {}

std::optional<std::string> DiskCache::find(std::string_view question) {
    if (most_ == 0) return std::nullopt;
    const auto path = entry_path(folder_, question);
    try {
        const FileBytes file(path);
        auto answer = answer_in(file.text(), question);
        if (answer) {
            utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // used now; a read-only folder keeps its order
        } else {
            log::debug("{} is damaged and was removed", path.string());
            std::error_code ignored;
            fs::remove(path, ignored);
        }
        return answer;
    } catch (const Error&) { return std::nullopt; }
}

void DiskCache::keep(std::string_view question, std::string_view answer) {
    const std::uint64_t bytes = sizeof(Header) + question.size() + answer.size();
    if (bytes > largest_bytes()) return;
    std::error_code failure;
    fs::create_directories(folder_, failure);
    if (failure || !write_entry(entry_path(folder_, question), question, answer)) {
        log::debug("nothing can be kept in {}", folder_.string());
        return;
    }
    const std::lock_guard lock(mutex_);
    held_ = held_ ? *held_ + bytes : cached_bytes(folder_);
    if (*held_ > most_) held_ = shrink(folder_, most_);
}

void DiskCache::resize(std::uint64_t most_bytes) {
    const std::lock_guard lock(mutex_);
    most_ = most_bytes;
    held_ = shrink(folder_, most_bytes);
}

std::uint64_t cached_bytes(const fs::path& folder) {
    std::uint64_t bytes = 0;
    for (const auto& entry : entries_of(folder)) bytes += entry.bytes;
    return bytes;
}

std::uint64_t clear_cache_folder(const fs::path& folder) {
    std::uint64_t bytes = 0;
    for (const auto& entry : entries_of(folder)) {
        std::error_code failure;
        if (fs::remove(entry.path, failure)) bytes += entry.bytes;
    }
    return bytes;
}

}  // namespace gse
