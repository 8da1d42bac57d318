// Autosave files, and the check that their process still lives.
#include "engine/io/project/autosave.h"

#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <random>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"
#include "engine/io/bytes/fingerprint.h"
#include "engine/io/files/user_files.h"

namespace gse {
namespace {

using Json = nlohmann::json;

/// Contents of a /proc file, which has no size. Empty when it is missing.
std::string read_line(const std::string& path) {
    std::ifstream stream(path);
    std::string line;
    std::getline(stream, line);
    return line;
}

/// Id that changes with every start of the machine. Empty if the system does not tell.
std::string boot_id() { return read_line("/proc/sys/kernel/random/boot_id"); }

/// Line of the process in /proc, from its state on; empty if there is no such process or it has ended.
std::string stat_of(long process) {
    const std::string line = read_line(fmt::format("/proc/{}/stat", process));
    // The name before it, in brackets, may hold blanks and brackets.
    const std::size_t name_end = line.rfind(')');
    if (name_end == std::string::npos || name_end + 2 >= line.size()) return {};
    const char state = line[name_end + 2];
    const bool ended = state == 'Z' || state == 'X';  // dead, though its parent has not asked for it yet
    return ended ? std::string() : line.substr(name_end + 2);
}

/// Start of the process in ticks since the boot. Empty if there is no such process or it has ended.
std::string process_start(long process) {
    const std::string line = stat_of(process);
    std::size_t at = line.empty() ? std::string::npos : 0;
    for (int field = 3; field < 22 && at != std::string::npos; ++field) {  // the state is field 3
        at = line.find(' ', at);
        if (at != std::string::npos) ++at;
    }
    return at == std::string::npos ? std::string() : line.substr(at, line.find(' ', at) - at);
}

bool owner_lives(const Json& json) {
    const long process = json.value("process", 0L);
    if (process <= 0 || json.value("boot", "") != boot_id()) return false;
    const std::string start = json.value("start", "");
    if (start.empty()) return kill(static_cast<pid_t>(process), 0) == 0 || errno != ESRCH;  // no /proc
    return start == process_start(process);
}

std::string random_id() {
    std::random_device device;
    return fmt::format("{:08x}{:08x}", device(), device());
}

std::filesystem::path sidecar_of(std::filesystem::path autosave) {
    return autosave.replace_extension(".json");
}

void remove_pair(const std::filesystem::path& autosave) {
    std::error_code ignored;
    std::filesystem::remove(autosave, ignored);
    std::filesystem::remove(sidecar_of(autosave), ignored);
}

std::string absolute_name(const std::filesystem::path& path) {
    std::error_code failure;
    return path.empty() ? std::string()
                        : std::filesystem::absolute(path, failure).lexically_normal().string();
}

/// Finds the recoverable project of a sidecar. Returns false, and removes files without use, if there is
/// none.
bool recover(const std::filesystem::path& sidecar, Recoverable& found) {
    const Json json = try_parse_json(read_file(sidecar));
    if (!json.is_object() || owner_lives(json)) return false;
    found.file = std::filesystem::path(sidecar).replace_extension(".gsep");
    found.project = path_of_text(json.value("project", ""));
    found.scene = path_of_text(json.value("scene", ""));
    std::error_code failure, project_failure;
    const auto saved = std::filesystem::last_write_time(found.file, failure);
    if (failure) {
        remove_pair(found.file);
        return false;
    }
    if (!found.project.empty()) {
        const auto project_saved = std::filesystem::last_write_time(found.project, project_failure);
        if (!project_failure && project_saved >= saved) {
            remove_pair(found.file);
            return false;
        }
    }
    const auto moment = std::chrono::file_clock::to_sys(saved).time_since_epoch();
    found.saved_at = std::chrono::duration_cast<std::chrono::seconds>(moment).count();
    return true;
}

}  // namespace

std::filesystem::path autosave_folder() { return state_folder() / "autosave"; }

Autosave::Autosave(std::filesystem::path folder) : folder_(std::move(folder)), session_(random_id()) {}

void Autosave::write(const ProjectData& project, const std::filesystem::path& project_path,
                     ProjectWriter& writer) {
    const std::lock_guard lock(mutex_);
    const std::string saved_as = absolute_name(project_path);
    const std::string head = saved_as.empty() ? "unsaved" : fmt::format("{:016x}", io::hash_bytes(saved_as));
    const std::filesystem::path path = folder_ / fmt::format("{}-{}.gsep", head, session_);
    const std::filesystem::path before = path_;
    if (path != before) {
        // The sidecar comes first: without an autosave beside it, it means nothing.
        const auto now = std::chrono::system_clock::now().time_since_epoch();
        const Json json = {{"process", static_cast<long>(getpid())},
                           {"boot", boot_id()},
                           {"start", process_start(getpid())},
                           {"project", text_of_path(saved_as)},
                           {"scene", text_of_path(project.source.path.string())},
                           {"time", std::chrono::duration_cast<std::chrono::seconds>(now).count()}};
        write_file(sidecar_of(path), json_text(json, 1));
    }
    writer.save(path, project);
    path_ = path;
    if (!before.empty() && before != path) remove_pair(before);
}

void Autosave::discard() {
    const std::lock_guard lock(mutex_);
    if (!path_.empty()) remove_pair(path_);
    path_.clear();
}

void Autosave::leave() {
    const std::lock_guard lock(mutex_);
    if (path_.empty()) return;
    Json json = try_parse_json<Json>(read_file(sidecar_of(path_)));
    if (!json.is_object()) json = Json::object();
    json["process"] = 0;
    write_file(sidecar_of(path_), json.dump(1, ' ', false, Json::error_handler_t::replace));
    path_.clear();
    session_ = random_id();
}

std::vector<Recoverable> find_recoverable(const std::filesystem::path& folder) {
    std::vector<Recoverable> all;
    std::error_code failure;
    std::filesystem::directory_iterator entry(folder, failure);
    std::vector<std::filesystem::path> sidecars;
    for (; !failure && entry != std::filesystem::directory_iterator(); entry.increment(failure))
        if (entry->path().extension() == ".json" && !entry->path().filename().string().starts_with('.'))
            sidecars.push_back(entry->path());
    for (const auto& sidecar : sidecars) {
        try {
            Recoverable found;
            if (recover(sidecar, found)) all.push_back(std::move(found));
        } catch (const Error& error) {
            log::warning("an autosave is passed over: {}", error.what());
        } catch (const Json::exception&) {
            log::warning("an autosave is passed over, its description is damaged: {}", sidecar.string());
        }
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.saved_at > b.saved_at; });
    return all;
}

void discard(const Recoverable& recoverable) { remove_pair(recoverable.file); }

}  // namespace gse
