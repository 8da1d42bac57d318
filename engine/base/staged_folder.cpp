// Staging, checks before the work, and the ways in which a folder of results gets its name.
#include "engine/base/staged_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/leftover.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"
#include "engine/base/pending_file.h"

namespace gse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* PartialMark = ".partial-";  // ".NAME.partial-MARK"
constexpr double ForeignRunSeconds = 24 * 3600;  // an edit on another machine may take hours before it writes
constexpr std::size_t LongestName = 180;
constexpr mode_t FolderModeBits = 07777;

std::string hidden_prefix(const fs::path& target) {
    std::string name = target.filename().string();
    name.resize(std::min(name.size(), LongestName));
    return "." + name + PartialMark;
}

void remove_left_overs(const fs::path& folder, const std::string& prefix) {
    std::error_code failure;
    fs::directory_iterator entry(folder, failure);
    for (; !failure && entry != fs::directory_iterator(); entry.increment(failure)) {
        const std::string name = entry->path().filename().string();
        std::error_code ignored;
        if (name.starts_with(prefix) &&
            is_left_over(entry->path(), std::string_view(name).substr(prefix.size()), ForeignRunSeconds))
            fs::remove_all(entry->path(), ignored);
    }
}

/// Lists regular files below `folder`, relative and sorted, without hidden partial folders. Returns false
/// when there is anything but files and folders.
bool list_files(const fs::path& folder, const std::string& hidden, std::vector<std::string>& files) {
    std::error_code failure;
    bool plain = true;
    fs::recursive_directory_iterator entry(folder, failure);
    for (; !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure)) {
        const bool is_hidden = entry.depth() == 0 && entry->path().filename().string().starts_with(hidden);
        const auto type = entry->symlink_status(failure).type();
        if (type == fs::file_type::directory) {
            if (is_hidden) entry.disable_recursion_pending();
        } else if (type == fs::file_type::regular) {
            files.push_back(entry->path().lexically_relative(folder).string());
        } else {
            plain = false;
        }
    }
    std::sort(files.begin(), files.end());
    return plain && !failure;
}

/// 64-bit FNV-1a hash of the whole file.
std::string fingerprint_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string piece(std::size_t{1} << 20, '\0');
    std::uint64_t value = 0xcbf29ce484222325ULL;
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0)
        for (std::streamsize i = 0; i < stream.gcount(); ++i)
            value =
                (value ^ static_cast<unsigned char>(piece[static_cast<std::size_t>(i)])) * 0x100000001b3ULL;
    return fmt::format("{:016x}", value);
}

Json read_report(const fs::path& path) {
    std::error_code failure;
    if (!fs::is_regular_file(path, failure)) return {};
    return try_parse_json<Json>(read_file(path));
}

bool same_place(const fs::path& a, const fs::path& b) {
    std::error_code failure;
    return fs::equivalent(a, b, failure);
}

void sync_tree(const fs::path& folder) {
    std::error_code failure;
    for (fs::recursive_directory_iterator entry(folder, failure);
         !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure))
        if (entry->is_directory(failure)) sync_folder(entry->path());
    sync_folder(folder);
}

/// The folder itself when it is missing, or the topmost of its missing parents. Empty when it is there.
fs::path first_missing(const fs::path& folder) {
    std::error_code failure;
    fs::path missing;
    for (fs::path path = folder; !fs::exists(path, failure) && path.has_relative_path();
         path = path.parent_path())
        missing = path;
    return missing;
}

/// True for names below the folder. A report's names are a stranger's.
bool is_below(const fs::path& name) {
    return !name.empty() && name.is_relative() && name == name.lexically_normal() && *name.begin() != "..";
}

void take_over_mode(const fs::path& from, const fs::path& to) {
    struct stat status {};
    if (stat(from.c_str(), &status) != 0) return;
    static_cast<void>(chown(to.c_str(), status.st_uid, status.st_gid));  // where that is allowed
    static_cast<void>(chmod(to.c_str(), status.st_mode & FolderModeBits));
}

/// A file moved to its place. With `exchanged`, the old file lies at the place of the new one.
struct Move {
    fs::path from, to;
    bool exchanged = false;
};

/// Swaps the new file with the old one, if the system can. Returns 0 or errno.
int move_into_place(Move& move) {
    std::error_code failure;
    fs::create_directories(move.to.parent_path(), failure);
    if (failure) return failure.value();
    move.exchanged = renameat2(AT_FDCWD, move.from.c_str(), AT_FDCWD, move.to.c_str(), RENAME_EXCHANGE) == 0;
    if (move.exchanged) return 0;
    return std::rename(move.from.c_str(), move.to.c_str()) == 0 ? 0 : errno;
}

/// Undoes the moves. Returns true when everything is as it was.
bool move_back(const std::vector<Move>& moves) {
    bool all = true;
    for (auto move = moves.rbegin(); move != moves.rend(); ++move) {
        const int code = move->exchanged ? renameat2(AT_FDCWD, move->from.c_str(), AT_FDCWD, move->to.c_str(),
                                                     RENAME_EXCHANGE)
                                         : std::rename(move->to.c_str(), move->from.c_str());
        all &= code == 0;
    }
    return all;
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& target, FolderContents contents) : contents_(std::move(contents)) {
    std::error_code failure;
    target_ =
        fs::absolute(end_of_links(target.has_filename() ? target : target.parent_path())).lexically_normal();
    if (fs::exists(target_, failure)) target_ = fs::canonical(target_, failure);
    if (!target_.has_filename() && target_.has_relative_path()) target_ = target_.parent_path();
    const auto refuse = [&](const std::string& reason) {
        throw Error(ErrorCode::Unwritable, "the output folder cannot be written (" + reason + ")",
                    "choose another place with --out", target);
    };
    const bool there = fs::exists(target_, failure);
    if (there && !fs::is_directory(target_, failure)) refuse("it is a file");
    if (there) check_contents();
    const fs::path place = there ? target_ : target_.parent_path();
    made_ = first_missing(place);
    fs::create_directories(place, failure);
    if (failure) refuse(failure.message());
    for (const fs::path& folder : {target_, target_.parent_path()})
        remove_left_overs(folder, hidden_prefix(target_));
    remove_stale_temporaries(target_);
    staging_ = place / (hidden_prefix(target_) + writer_mark());
    fs::create_directory(staging_, failure);
    if (failure) refuse(failure.message());
    lock_ = open(staging_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ >= 0) hold(lock_);
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    if (keep_ && kept_.empty() && !fs::is_empty(staging_, ignored) && !ignored) {
        keep_results();
        log::warning("what was written before the failure is kept in {}", kept_.string());
    }
    if (lock_ >= 0) close(lock_);
    if (kept_.empty()) fs::remove_all(staging_, ignored);
    for (fs::path path = target_.parent_path(); !made_.empty() && rmdir(path.c_str()) == 0 && path != made_;)
        path = path.parent_path();  // what was made for nothing
}

void StagedFolder::check_contents() const {
    std::error_code failure;
    const bool earlier_run = fs::exists(target_ / contents_.report, failure);
    const auto check = [&](const fs::path& path) {
        const auto status = fs::symlink_status(path, failure);
        const auto refuse = [&](const char* message, const char* hint) {
            throw Error(ErrorCode::Unwritable, message, hint, path);
        };
        if (fs::is_symlink(status))
            refuse("a link is where a result goes, and would be replaced",
                   "remove it or choose another folder");
        if (fs::is_regular_file(status)) check_replaceable(path);
        if (fs::is_regular_file(status) && !earlier_run)
            refuse("the folder holds a file of this name that no earlier run wrote",
                   "choose another folder, or move it away");
    };
    for (const std::string& name : contents_.names) {
        check(target_ / name);
        if (!fs::is_directory(target_ / name, failure)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(target_ / name, failure))
            check(entry.path());
    }
}

void StagedFolder::require_space(std::uint64_t bytes) const {
    struct statvfs status {};
    if (statvfs(staging_.c_str(), &status) != 0 || status.f_blocks == 0) return;
    const std::uint64_t free = std::uint64_t{status.f_bavail} * status.f_frsize;
    constexpr double mega = 1e6;
    if (free < bytes)
        throw Error(ErrorCode::Unwritable,
                    fmt::format("the disk has {:.1f} MB free, the results need about {:.1f} MB",
                                static_cast<double>(free) / mega, static_cast<double>(bytes) / mega),
                    "free some space or choose another place with --out", target_);
}

Json StagedFolder::listing() const {
    std::vector<std::string> files;
    list_files(staging_, PartialMark, files);
    Json json = Json::object();
    for (const std::string& name : files)
        json[name] = {{"bytes", fs::file_size(staging_ / name)}, {"fnv1a", fingerprint_of(staging_ / name)}};
    return json;
}

std::set<std::string> StagedFolder::earlier_files() const {
    std::set<std::string> names;
    const Json report = read_report(target_ / contents_.report);
    const auto files = report.is_object() ? report.find("files") : report.end();
    if (files == report.end() || !files->is_object()) return names;
    for (const auto& [name, ignored] : files->items())
        if (is_below(name)) names.insert(name);
    names.insert(contents_.report);
    return names;
}

void StagedFolder::commit() {
    std::vector<std::string> files;
    list_files(staging_, PartialMark, files);
    sync_tree(staging_);
    try {
        for (const std::string& name : files) {
            const fs::path place = target_ / name;
            std::error_code failure;
            if (fs::is_symlink(place, failure))
                throw Error(ErrorCode::Unwritable, "a link is where a result goes", "remove it", place);
            check_replaceable(place);
            if (fs::exists(place, failure)) take_over_mode(place, staging_ / name);
        }
        if (!take_free_name() && !swap_with_target(files)) move_file_by_file(files);
    } catch (const Error& error) {
        keep_results();
        throw Error(error.code(), error.message() + "; the results are whole in " + kept_.string(),
                    error.hint(), error.path());
    } catch (const fs::filesystem_error& error) {
        keep_results();
        throw Error(ErrorCode::Unwritable,
                    "the results cannot be put in place (" + error.code().message() +
                        "); they are whole in " + kept_.string(),
                    "", target_);
    }
    sync_folder(target_.parent_path());
    keep_ = false;
}

bool StagedFolder::take_free_name() {
    if (renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) == 0) return true;
    std::error_code failure;
    return !fs::exists(target_, failure) && std::rename(staging_.c_str(), target_.c_str()) == 0;
}

bool StagedFolder::swap_with_target(const std::vector<std::string>& files) {
    const std::string hidden = hidden_prefix(target_);
    for (const auto& entry : fs::directory_iterator(target_))
        if (entry.path() != staging_ && entry.path().filename().string().starts_with(hidden))
            return false;  // another run's
    std::vector<std::string> there;
    std::set<std::string> ours = earlier_files();
    ours.insert(files.begin(), files.end());
    if (!list_files(target_, hidden, there)) return false;
    if (!std::all_of(there.begin(), there.end(), [&](const auto& name) { return ours.contains(name); }))
        return false;
    if (same_place(target_, fs::path(".")))
        return false;  // whoever stands in the folder would be left in the old one
    const fs::path beside = target_.parent_path() / staging_.filename();
    if (beside != staging_ && std::rename(staging_.c_str(), beside.c_str()) != 0) return false;
    staging_ = beside;
    take_over_mode(target_, staging_);
    return renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0;
}

void StagedFolder::move_file_by_file(const std::vector<std::string>& files) {
    const fs::path report = target_ / contents_.report;
    std::error_code failure;
    const bool had_report = fs::exists(report, failure);
    const std::string old_report = had_report ? read_file(report) : std::string();
    std::set<std::string> stale = earlier_files();
    Json names = Json::object();
    for (const std::string& name : stale) names[name] = Json::object();
    for (const std::string& name : files) names[name] = Json::object();
    const Json unfinished{
        {"unfinished", "a run ended while it put its results here; they do not belong together"},
        {"files", std::move(names)}};
    write_file(report, json_text(unfinished, 1) + "\n");
    std::vector<Move> moves;
    std::set<fs::path> touched;
    try {
        for (const std::string& name : files) {
            stale.erase(name);
            if (name == contents_.report) continue;
            Move move{staging_ / name, target_ / name, false};
            if (const int code = move_into_place(move); code != 0)
                throw write_error("a result", code, move.to);
            moves.push_back(move);
        }
        for (const Move& move : moves) touched.insert(move.to.parent_path());
        for (const fs::path& folder : touched)
            sync_folder(folder);  // before the report says that all is there
        if (std::rename((staging_ / contents_.report).c_str(), report.c_str()) != 0)
            throw write_error("the report", errno, report);
    } catch (...) {
        const bool as_before = move_back(moves);
        if (as_before && had_report) write_file(report, old_report);
        if (as_before && !had_report) fs::remove(report, failure);
        throw;
    }
    stale.erase(contents_.report);
    for (const std::string& name : stale) fs::remove(target_ / name, failure);
}

void StagedFolder::keep_results() noexcept {
    const std::string name = target_.filename().string() + ".kept";
    for (const fs::path& folder : {target_.parent_path(), target_})
        for (int number = 1; number < 1000; ++number) {
            kept_ = folder / (number > 1 ? fmt::format("{}{}", name, number) : name);
            if (renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, kept_.c_str(), RENAME_NOREPLACE) == 0) return;
            if (errno != EEXIST) break;
        }
    kept_ = staging_;
}

}  // namespace gse
