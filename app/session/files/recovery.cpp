// Nothing is lost: the autosave of the open document, and work of other sessions that can be had back.
#include "app/session/files/recovery.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/log.h"

namespace gse::app {
namespace {

constexpr double ListSeconds = 2;        // between two looks for work of programs that ended
constexpr double ThumbnailSeconds = 30;  // a picture of the scene is drawn anew this often at most

std::string moment_text(std::int64_t seconds) {
    const std::time_t moment = seconds, now = std::time(nullptr);
    const std::tm then = fmt::localtime(moment), today = fmt::localtime(now);
    const bool same_day = then.tm_year == today.tm_year && then.tm_yday == today.tm_yday;
    return same_day ? fmt::format("today {:%H:%M}", then) : fmt::format("{:%d %B, %H:%M}", then);
}

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code ignored;
    return !a.empty() && !b.empty() && (a == b || std::filesystem::equivalent(a, b, ignored));
}

std::string running_text(const nlohmann::json& edit) {
    const auto name = edit.value("name", "");
    const int iteration = edit.value("iteration", -1), iterations = edit.value("iterations", 0);
    if (edit.value("waits", false))
        return iteration >= 0 && iteration + 1 < iterations
                   ? fmt::format("The edit \"{}\", stopped at iteration {} of {}, was not applied yet.", name,
                                 iteration, iterations)
                   : fmt::format("The edit \"{}\" was not applied yet.", name);
    if (iteration < 0) return fmt::format("The edit \"{}\" had just begun.", name);
    return fmt::format("The edit \"{}\" was running, at iteration {} of {}.", name, iteration, iterations);
}

ui::RecoveryView view_of(const Recoverable& found) {
    ui::RecoveryView view;
    const auto& place = found.project.empty() ? found.scene : found.project;
    view.file = found.file.string();
    view.name = place.empty() ? "a scene" : place.filename().string();
    view.place = place.string();
    view.facts = moment_text(found.saved_at);
    try {
        const ProjectSummary summary = read_project_summary(found.file);
        view.thumbnail = summary.thumbnail;
        std::size_t edits = summary.stack.size();
        if (const auto edit = summary.jobs.find("edit"); edit != summary.jobs.end()) {
            view.running = running_text(*edit);
            if (!summary.stack.empty() && edit->value("id", std::uint64_t{0}) == summary.stack.back().id)
                --edits;
        }
        view.facts += fmt::format(", {} splats", summary.splats);
        if (edits > 0) view.facts += fmt::format(", {} edit{}", edits, edits == 1 ? "" : "s");
        if (!summary.scene_found)
            view.running += (view.running.empty() ? "" : " ") + std::string("Its scene file is gone.");
    } catch (const std::exception& error) {
        log::warning("an autosave cannot be looked at: {}", error.what());
    }
    return view;
}

}  // namespace

void Recovery::write(const Moment& moment, Content content, ProjectWriter& writer,
                     std::function<void()> then) {
    last_ = Clock::now();
    moment_ = moment;
    autosaved_ = true;
    const auto& data = content.data;
    workspace_.jobs->saver.start(
        {"Autosave",
         [this, content, project = workspace_.project_path, &writer](const JobControl&) {
             content.data->state = content.state();  // here: a large edit takes a while
             content.data->thumbnail = content.picture();
             autosave_->write(*content.data, project, writer);
         },
         [this, data, then, opened = workspace_.opened](const Error* error) {
             if (opened != workspace_.opened) return autosave_->discard();  // of a document that is gone
             if (error != nullptr) return workspace_.notices.report(*error);
             if (data->thumbnail != thumbnail_) thumbnail_ = data->thumbnail, thumbnail_made_ = Clock::now();
             forget_recovered();
             if (then) then();
         }});
}

bool Recovery::due(const Moment& moment) const {
    return moment_ != moment && seconds_since(last_) >= workspace_.options.autosave_seconds;
}

void Recovery::discard() {
    autosave_->discard();
    autosaved_ = false;
    forget_recovered();
}

void Recovery::forget_recovered() {
    if (recovered_) gse::discard(*recovered_);
    recovered_.reset();
}

void Recovery::let_go() {
    if (!std::exchange(keep_, false)) return discard();
    try {
        autosave_->leave();
    } catch (const Error& error) {  // it stays all the same, and is offered once this program has ended
        workspace_.notices.report(error);
        autosave_ = std::make_unique<Autosave>();
    }
    autosaved_ = false;
    recovered_.reset();
}

void Recovery::begin(const Moment& moment, std::optional<Recoverable> recovered) {
    moment_ = recovered ? std::nullopt : std::optional(moment);
    recovered_ = std::move(recovered);
    thumbnail_.reset();
    list();
    start_page_seen_ = true;
}

std::shared_ptr<const Image> Recovery::thumbnail() const {
    return seconds_since(thumbnail_made_) < ThumbnailSeconds ? thumbnail_ : nullptr;
}

void Recovery::list() {
    const auto before = std::exchange(offers_, {});
    for (const auto& found : find_recoverable()) {
        if (recovered_ && recovered_->file == found.file) continue;
        auto view = view_of(found);
        const bool of_this = same_file(found.scene, workspace_.scene_path) ||
                             same_file(found.project, workspace_.project_path);
        const bool was = std::any_of(before.begin(), before.end(),
                                     [&](const auto& old) { return old.file == view.file && old.offered; });
        view.offered = !workspace_.document.empty() && (of_this || was || !start_page_seen_);
        offers_.push_back(std::move(view));
    }
}

void Recovery::refresh() {
    if (seconds_since(listed_) < ListSeconds) return;
    listed_ = Clock::now();
    if (find_recoverable().size() != offers_.size()) list();
}

void Recovery::run(const ui::command::DiscardRecovery& command) {
    for (const auto& found : find_recoverable())
        if (found.file == command.project) gse::discard(found);
    std::erase_if(offers_, [&](const auto& view) { return view.file == command.project; });
}

void Recovery::run(const ui::command::PostponeRecovery& command) {
    for (auto& view : offers_)
        if (view.file == command.project) view.offered = false;
}

}  // namespace gse::app
