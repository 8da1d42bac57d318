// Cache of costly answers in a folder, from one run of the program to the next.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/answer_cache.h"

namespace gse {

/// Keeps one file per answer, named by the hash of its question, which the file holds too. Nothing here is an
/// error: a folder that cannot be read or written keeps nothing. A file that is not whole is removed and
/// counts as not there. Entries appear whole (written beside their place and renamed), so processes may share
/// a folder; threads may share an object.
class DiskCache final : public AnswerCache {
public:
    /// Entries beyond `most_bytes` together are removed, those used least recently first. The folder is made
    /// when something is kept.
    DiskCache(std::filesystem::path folder, std::uint64_t most_bytes);

    /// Finds the answer to this question; the entry counts as used now.
    std::optional<std::string> find(std::string_view question) override;
    /// An answer of more than largest_bytes() is not kept: it would drive out everything else.
    void keep(std::string_view question, std::string_view answer) override;

    const std::filesystem::path& folder() const { return folder_; }
    std::uint64_t largest_bytes() const { return most_ / 4; }
    /// 0 = nothing is found and nothing kept.
    std::uint64_t most_bytes() const { return most_; }
    /// Sets the limit; entries beyond it are removed.
    void resize(std::uint64_t most_bytes);

private:
    const std::filesystem::path folder_;
    std::atomic<std::uint64_t> most_;
    std::mutex mutex_;
    std::optional<std::uint64_t>
        held_;  // bytes in the folder as far as this object knows; empty = not looked yet
};

/// Bytes of all entries in a folder; 0 where there is none.
std::uint64_t cached_bytes(const std::filesystem::path& folder);

/// Removes all entries, and nothing else, from a folder; returns their bytes.
std::uint64_t clear_cache_folder(const std::filesystem::path& folder);

}  // namespace gse
