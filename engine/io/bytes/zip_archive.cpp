// Archives in memory through libzip.
#include "engine/io/bytes/zip_archive.h"

#include <fmt/core.h>
#include <zip.h>

#include <algorithm>

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::io {
namespace {

constexpr std::size_t PieceBytes = std::size_t{1} << 20;
constexpr zip_int64_t FixedTime = 946684800;  // 2000-01-01: the same content gives the same bytes

struct ErrorText {
    zip_error_t error;
    ErrorText() { zip_error_init(&error); }
    ~ErrorText() { zip_error_fini(&error); }
    ErrorText(const ErrorText&) = delete;
    ErrorText& operator=(const ErrorText&) = delete;
};

[[noreturn]] void throw_unwritable(const char* reason) {
    throw Error(ErrorCode::Foreign, fmt::format("the zip archive cannot be made ({})", reason));
}

}  // namespace

std::string write_zip(std::span<const ZipMember> members) {
    ErrorText failure;
    const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> target(
        zip_source_buffer_create(nullptr, 0, 0, &failure.error), zip_source_free);
    if (target == nullptr) throw_unwritable(zip_error_strerror(&failure.error));
    zip_source_keep(target.get());
    std::unique_ptr<zip_t, void (*)(zip_t*)> zip(
        zip_open_from_source(target.get(), ZIP_TRUNCATE, &failure.error), zip_discard);
    if (zip == nullptr) {
        zip_source_free(target.get());
        throw_unwritable(zip_error_strerror(&failure.error));
    }
    for (const ZipMember& member : members) {
        zip_source_t* source = zip_source_buffer(zip.get(), member.bytes.data(), member.bytes.size(), 0);
        const zip_int64_t index =
            source == nullptr ? -1 : zip_file_add(zip.get(), member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
        if (index < 0) {
            if (source != nullptr) zip_source_free(source);
            throw_unwritable(zip_strerror(zip.get()));
        }
        const auto entry = static_cast<zip_uint64_t>(index);
        zip_set_file_compression(zip.get(), entry, member.deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
        zip_file_set_mtime(zip.get(), entry, FixedTime, 0);
    }
    if (zip_close(zip.get()) != 0) throw_unwritable(zip_strerror(zip.get()));
    static_cast<void>(zip.release());
    zip_stat_t status;
    if (zip_source_stat(target.get(), &status) != 0 || zip_source_open(target.get()) != 0)
        throw_unwritable("its bytes are lost");
    std::string bytes(static_cast<std::size_t>(status.size), '\0');
    const zip_int64_t got = zip_source_read(target.get(), bytes.data(), bytes.size());
    zip_source_close(target.get());
    if (got != static_cast<zip_int64_t>(bytes.size())) throw_unwritable("its bytes are lost");
    return bytes;
}

struct ZipReader::State {
    std::string what, hint;
    std::unique_ptr<zip_t, void (*)(zip_t*)> zip{nullptr, zip_discard};
};

ZipReader::ZipReader(std::span<const std::byte> bytes, std::string what, std::string hint)
    : state_(std::make_unique<State>()) {
    state_->what = std::move(what);
    state_->hint = std::move(hint);
    ErrorText failure;
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &failure.error);
    zip_t* zip = source != nullptr ? zip_open_from_source(source, ZIP_RDONLY, &failure.error) : nullptr;
    if (zip == nullptr) {
        if (source != nullptr) zip_source_free(source);
        throw Error(ErrorCode::Malformed, state_->what + " is not a readable zip archive", state_->hint);
    }
    state_->zip.reset(zip);
}

ZipReader::~ZipReader() = default;
ZipReader::ZipReader(ZipReader&&) noexcept = default;

bool ZipReader::has(const std::string& name) const {
    return zip_name_locate(state_->zip.get(), name.c_str(), 0) >= 0;
}

std::vector<std::byte> ZipReader::read(const std::string& name, std::uint64_t most) const {
    const zip_int64_t index = zip_name_locate(state_->zip.get(), name.c_str(), 0);
    if (index < 0)
        throw Error(ErrorCode::Malformed, fmt::format("{} lacks its part \"{}\"", state_->what, name),
                    state_->hint);
    return read_entry({.name = name, .index = static_cast<std::uint64_t>(index)}, most);
}

std::vector<ZipEntry> ZipReader::entries() const {
    std::vector<ZipEntry> entries;
    const zip_int64_t count = zip_get_num_entries(state_->zip.get(), 0);
    for (zip_int64_t index = 0; index < count; ++index) {
        zip_stat_t status;
        zip_stat_init(&status);
        if (zip_stat_index(state_->zip.get(), static_cast<zip_uint64_t>(index), 0, &status) != 0 ||
            (status.valid & ZIP_STAT_NAME) == 0 || (status.valid & ZIP_STAT_SIZE) == 0)
            continue;
        ZipEntry entry{status.name, status.size, static_cast<std::uint64_t>(index), false};
        std::replace(entry.name.begin(), entry.name.end(), '\\', '/');
        entry.locked =
            (status.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && status.encryption_method != ZIP_EM_NONE;
        if (!entry.name.empty() && !entry.name.ends_with('/')) entries.push_back(std::move(entry));
    }
    return entries;
}

std::string ZipReader::read_start(const ZipEntry& entry, std::size_t most) const {
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
        zip_fopen_index(state_->zip.get(), static_cast<zip_uint64_t>(entry.index), 0), zip_fclose);
    std::string start(most, '\0');
    std::size_t filled = 0;
    while (file != nullptr && filled < most) {
        const zip_int64_t got = zip_fread(file.get(), start.data() + filled, most - filled);
        if (got <= 0) break;
        filled += static_cast<std::size_t>(got);
    }
    start.resize(filled);
    return start;
}

std::vector<std::byte> ZipReader::read_entry(const ZipEntry& entry, std::uint64_t most) const {
    const auto index = static_cast<zip_uint64_t>(entry.index);
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(state_->zip.get(), index, 0),
                                                                 zip_fclose);
    zip_stat_t status;
    zip_stat_init(&status);
    zip_stat_index(state_->zip.get(), index, 0, &status);
    const bool sized = (status.valid & ZIP_STAT_SIZE) != 0;  // said by the file: a hint, not trusted
    std::size_t piece =
        sized ? static_cast<std::size_t>(std::min<zip_uint64_t>(status.size + 1, PieceBytes)) : PieceBytes;
    std::vector<std::byte> content;
    while (file != nullptr) {
        const std::size_t filled = content.size();
        content.resize(filled + std::max(piece, filled / 2));
        piece = PieceBytes;
        const zip_int64_t got = zip_fread(file.get(), content.data() + filled, content.size() - filled);
        content.resize(filled + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
        if (got == 0) return content;
        if (got < 0 || content.size() > most) break;
    }
    throw Error(ErrorCode::Malformed,
                fmt::format("the part \"{}\" of {} cannot be unpacked", entry.name, state_->what),
                state_->hint);
}

}  // namespace gse::io
