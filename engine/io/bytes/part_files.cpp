// Names are looked up exactly first, then without regard to capitals.
#include "engine/io/bytes/part_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <unordered_map>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/claims.h"

namespace gse::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* AgainHint = "the file is cut off or damaged; get it again";

/// The entry of `folder` with that name, whatever its capitals; else the name as it is.
fs::path entry_of(const fs::path& folder, const fs::path& name) {
    std::error_code failure;
    if (fs::exists(folder / name, failure)) return folder / name;
    const std::string wanted = lower_case(name.string());
    fs::directory_iterator entry(folder.empty() ? "." : folder, failure);
    for (; !failure && entry != fs::directory_iterator(); entry.increment(failure))
        if (const fs::path each = entry->path().filename(); lower_case(each.string()) == wanted)
            return folder / each;
    return folder / name;
}

class Folder final : public PartFiles {
public:
    Folder(fs::path folder, std::string what) : folder_(std::move(folder)), what_(std::move(what)) {}

    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const override {
        const fs::path path = path_of(name);
        const InputFile file(path);
        if (file.size() > most)
            throw Error(ErrorCode::Malformed,
                        fmt::format("the file is larger than its place in {} allows", what_), "", path);
        require_memory(file.size(), fmt::format("the file \"{}\" of {}", name,
                                                what_));  // a sparse file may have any size
        std::vector<std::byte> content(static_cast<std::size_t>(file.size()));
        file.read(0, content);
        return content;
    }

    std::uint64_t stored_bytes() const override {
        std::uint64_t bytes = 0;
        std::error_code failure;
        fs::directory_iterator entry(folder_.empty() ? "." : folder_, failure);
        for (; !failure && entry != fs::directory_iterator(); entry.increment(failure))
            if (std::error_code ignored; entry->is_regular_file(ignored)) bytes += entry->file_size(ignored);
        return bytes;
    }

    std::unique_ptr<PartFiles> below(const std::string& folder) const override {
        return std::make_unique<Folder>(path_of(folder), what_);
    }

private:
    fs::path path_of(const std::string& name) const {
        const fs::path relative = fs::path(name).lexically_normal();
        if (relative.is_absolute() || std::find(relative.begin(), relative.end(), "..") != relative.end())
            throw Error(ErrorCode::Malformed, fmt::format("{} names a file outside of its folder", what_), "",
                        folder_);
        fs::path path = folder_;
        for (const fs::path& part : relative)
            if (!part.empty() && part != ".") path = entry_of(path, part);
        return path;
    }

    fs::path folder_;
    std::string what_;
};

/// Archive that several views of it share.
struct Opened {
    ZipReader zip;
    std::string what;
    std::uint64_t stored = 0;  // bytes of the file on the disk
    std::vector<ZipEntry> entries;
    std::unordered_map<std::string, std::size_t> by_name;  // the first of several
};

std::string_view name_without_folder(std::string_view name) { return name.substr(name.rfind('/') + 1); }

class Archive final : public PartArchive {
public:
    Archive(std::shared_ptr<const Opened> opened, std::string place)
        : opened_(std::move(opened)), place_(std::move(place)) {}

    std::vector<std::byte> read(const std::string& name, std::uint64_t most) const override {
        const ZipEntry* entry = find(fs::path(name).lexically_normal().generic_string());
        if (entry == nullptr)
            throw Error(ErrorCode::Malformed, fmt::format("{} holds no file \"{}\"", opened_->what, name),
                        "the file is damaged or of another kind");
        if (entry->locked)
            throw Error(ErrorCode::Unsupported,
                        fmt::format("the file \"{}\" of {} is locked with a password", name, opened_->what),
                        "unpack the archive and open the scene itself");
        if (entry->size > most)
            throw Error(ErrorCode::Malformed,
                        fmt::format("the file \"{}\" of {} has no size, or more than its place allows", name,
                                    opened_->what),
                        "the file is damaged or made to do harm");
        check_claim({entry->size, opened_->stored},
                    fmt::format("the file \"{}\" of {}", name, opened_->what));
        auto content = opened_->zip.read_entry(*entry, entry->size);
        if (content.size() == entry->size) return content;
        throw Error(ErrorCode::Malformed,
                    fmt::format("the file \"{}\" of {} cannot be unpacked", name, opened_->what), AgainHint);
    }

    std::uint64_t stored_bytes() const override { return opened_->stored; }
    std::span<const ZipEntry> entries() const override { return opened_->entries; }
    std::string start_of(const ZipEntry& entry, std::size_t most) const override {
        return opened_->zip.read_start(entry, most);
    }

    std::unique_ptr<PartFiles> below(const std::string& folder) const override {
        const std::string normal = (fs::path(folder) / "").lexically_normal().generic_string();
        return std::make_unique<Archive>(opened_, place_ + (normal == "./" ? "" : normal));
    }

private:
    const ZipEntry* find(const std::string& name) const {
        const std::string whole = place_ + name, lower_whole = lower_case(whole);
        const auto first = [&](const auto& fits) -> const ZipEntry* {
            const auto found = std::find_if(opened_->entries.begin(), opened_->entries.end(), fits);
            return found == opened_->entries.end() ? nullptr : &*found;
        };
        if (const auto exact = opened_->by_name.find(whole); exact != opened_->by_name.end())
            return &opened_->entries[exact->second];
        const ZipEntry* entry =
            first([&](const ZipEntry& each) { return lower_case(each.name) == lower_whole; });
        if (entry != nullptr || !place_.empty()) return entry;
        entry = first([&](const ZipEntry& each) { return name_without_folder(each.name) == name; });
        return entry != nullptr ? entry : first([&](const ZipEntry& each) {
            return lower_case(std::string(name_without_folder(each.name))) == lower_whole;
        });
    }

    std::shared_ptr<const Opened> opened_;
    std::string place_;  // "" or a folder that ends in "/"
};

}  // namespace

std::unique_ptr<PartFiles> open_folder(const fs::path& folder, const std::string& what) {
    return std::make_unique<Folder>(folder, what);
}

std::unique_ptr<PartArchive> open_archive(std::span<const std::byte> bytes, const std::string& what,
                                          std::uint64_t file_bytes) {
    auto opened = std::make_shared<Opened>(
        Opened{ZipReader(bytes, what, AgainHint), what, file_bytes > 0 ? file_bytes : bytes.size(), {}, {}});
    opened->entries = opened->zip.entries();
    for (std::size_t i = 0; i < opened->entries.size(); ++i)
        opened->by_name.emplace(opened->entries[i].name, i);
    return std::make_unique<Archive>(std::move(opened), "");
}

bool is_zip(std::span<const std::byte> bytes) {
    constexpr const char *Usual = "PK\x03\x04", *Empty = "PK\x05\x06";
    return bytes.size() >= 4 &&
           (std::memcmp(bytes.data(), Usual, 4) == 0 || std::memcmp(bytes.data(), Empty, 4) == 0);
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char letter) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    });
    return text;
}

}  // namespace gse::io
