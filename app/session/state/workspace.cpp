// Ground that all controllers stand on: the document, the jobs, messages, and what belongs to the window
// itself.
#include "app/session/state/workspace.h"

#include <utility>

namespace gse::app {

Jobs::Jobs(MainQueue& queue)
    : work(queue, JobThread::Priority::Patient), files(queue), saver(queue, JobThread::Priority::Patient),
      counter(queue, JobThread::Priority::Patient) {}

bool Jobs::start_work(JobKind kind, JobThread::Job job) {
    job.done = [this, kind, done = std::move(job.done)](const Error* error) {
        if (done) done(error);
        if (on_end && kind != JobKind::Other) on_end();
    };
    if (!work.start(std::move(job))) return false;
    kind_ = kind;
    return true;
}

Workspace::Workspace(ApplicationOptions chosen)
    : options(std::move(chosen)), notices(options.wake), jobs(std::make_unique<Jobs>(queue)) {
    queue.set_wake(options.wake);
    notices.follow([this] { return document.revision(); });
    jobs->on_end = [this] { worked_at = document.revision(); };
}

bool Workspace::require_scene() {
    if (!document.empty()) return true;
    notices.toast("Open a scene first.");
    return false;
}

const NamedLabel* Workspace::active_label() const {
    if (document.empty()) return nullptr;
    const auto& state = document.state();
    if (state.active_label < 0 || state.active_label >= static_cast<int>(state.labels.size())) return nullptr;
    return &state.labels[static_cast<std::size_t>(state.active_label)];
}

Scene Workspace::scene() const {
    Scene scene;
    scene.gaussians = document.state().current;
    scene.info = document.state().info;
    scene.extra = current_columns(document.state());
    return scene;
}

void Workspace::toast_step(std::string text) {
    notices.toast_of_step(std::move(text), "Undo", [this, revision = document.revision()] {
        if (document.revision() == revision) return run(ui::command::Undo{});
        notices.toast("More was done since: History leads back to any step.");
    });
}

void Workspace::report_end(const Error& error) {
    if (error.code() != ErrorCode::Cancelled) notices.report_of_step(error);
}

void Workspace::forget_work() {
    jobs->forget_work();
    cost = {};
    worked_at = 0;
}

void Workspace::take_document() {
    ++opened;
    next_edit_id = 1;
    labelled = 0;
    variations.forget();
    forget_work();
    notices.forget();
}

}  // namespace gse::app
