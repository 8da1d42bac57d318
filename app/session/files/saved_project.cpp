// The project's file: writes it, knows what it holds, and sees other windows that write it.
#include "app/session/files/saved_project.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <utility>

#include "engine/io/files/free_path.h"

namespace gse::app {

bool SavedProject::begin(const std::filesystem::path& file, std::optional<Recovery::Moment> holds) {
    holds_ = holds;
    saved_at_.clear();
    return follow(file);
}

bool SavedProject::follow(const std::filesystem::path& file) {
    if (file != file_ || lock_.refused()) {
        lock_ = ProjectLock();  // first, so that the same file can be locked again
        if (!file.empty()) lock_ = ProjectLock(file);
    }
    file_ = file;
    stamp_ = stamp_of(file);
    return !lock_.refused();
}

/// Sentence about another window's work that a save there would replace; empty = there is none.
std::string SavedProject::conflict(const std::filesystem::path& target) const {
    const auto name = target.filename().string();
    const FileStamp now = stamp_of(target);
    const bool own = target == file_;
    if (own && now != stamp_ && now != FileStamp())
        return fmt::format("{} was saved by another window or program since it was opened here.", name);
    const bool may_be_held = !own || lock_.refused();
    return may_be_held && ProjectLock(target).refused()
               ? fmt::format("{} is open in another window, too.", name)
               : std::string();
}

void SavedProject::save(const std::filesystem::path& target, std::shared_ptr<ProjectData> data,
                        const Recovery::Moment& now, std::function<void()> then) {
    const auto reason = conflict(target);
    if (reason.empty()) return write(target, std::move(data), now, std::move(then));
    const auto copy = first_free(target);
    const auto save_as = [this, data, now, then](const std::filesystem::path& path) {
        return [this, data, now, then, path] { write(path, data, now, then); };
    };
    workspace_.notices.ask("Whose work is to stay?", reason + " Saving here replaces that work.",
                           {{{fmt::format("Save as {}", copy.filename().string())}, save_as(copy)},
                            {{"Replace it", "", true}, save_as(target)},
                            {{"Cancel"}, {}}});
}

void SavedProject::offer_copy(std::function<void(const std::filesystem::path&)> save_as) {
    const auto copy = first_free(file_);
    workspace_.notices.ask(
        "The project is open in another window",
        fmt::format("{} is open in another window, too. Work on a copy, or go on and be asked before a save "
                    "replaces the other window's.",
                    file_.filename().string()),
        {{{fmt::format("Save as {}", copy.filename().string())}, [save_as, copy] { save_as(copy); }},
         {{"Go on"}, {}}});
}

void SavedProject::write(const std::filesystem::path& target, std::shared_ptr<ProjectData> data,
                         const Recovery::Moment& now, std::function<void()> then) {
    const auto work = [this, data, target](const JobControl& control) {
        control.report("saving", 0, 0);
        writer_->save(target, *data);
    };
    auto done = [this, target, now, then = std::move(then)](const Error* error) {
        if (error != nullptr) return workspace_.notices.report(*error);
        workspace_.project_path = target.string();
        holds_ = now;
        follow(target);
        saved_at_ = fmt::format("saved {:%H:%M}{}", fmt::localtime(std::time(nullptr)),
                                workspace_.options.autosave ? " (autosave on)" : "");
        workspace_.notices.toast(fmt::format("Saved {}", target.filename().string()));
        then();
    };
    if (!workspace_.jobs->files.start({fmt::format("Save {}", target.filename().string()), work, done}))
        workspace_.notices.toast("Another file is being read or written; save again in a moment.");
}

}  // namespace gse::app
