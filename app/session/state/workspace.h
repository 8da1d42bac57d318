// Ground that all controllers stand on: the document, the jobs, messages, and what belongs to the window
// itself.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "app/session/state/notices.h"
#include "app/session/state/variations.h"
#include "app/session/state/waiting_results.h"
#include "engine/base/job_thread.h"
#include "engine/scene/document.h"
#include "engine/scene/gaussian_set.h"
#include "ui/model/command.h"

namespace gse::app {

struct ApplicationOptions {
    bool autosave = true;
    double autosave_seconds = 3;      // at most this much work is lost to a crash
    std::function<void()> wake = {};  // makes the window draw a frame
    std::function<void(float)> on_scale = {};
    float ui_scale = 0;       // for this start only; 0 = as the artist chose last
    float desktop_scale = 1;  // until the artist chooses
    std::function<void()> on_fullscreen = {};
    // Splats of a scene up to which the shadow of a dragged thing follows every move. The light of more takes
    // longer than a frame: there the shadow comes where the drag rests.
    std::size_t most_shaded_while_dragging = 100'000;
};

/// Kinds of jobs on the work thread.
enum class JobKind : std::uint8_t {
    Other,   // checks of models
    CutOut,  // a thing in a box
    Place,   // holes healed, other scenes put in
    Search,  // looks for words
    Vote,    // votes of the last search's views once more
    Edit     // search and loop
};

/// Threads of the window's jobs, each with one job at a time.
class Jobs {
public:
    explicit Jobs(MainQueue& queue);
    /// Starts a job on the work thread; false when one is running.
    bool start_work(JobKind kind, JobThread::Job job);
    bool works() const { return work.running(); }
    /// True when no search or edit may begin: one works, or another document is being read.
    bool occupied() const { return works() || reads_work; }
    /// Forgets the status of the last job, where that was about the scene.
    void forget_work() {
        if (kind_ != JobKind::Other) work.forget();
    }
    bool works_at(JobKind kind) const { return kind_ == kind && work.running(); }

    JobThread work;                // networks: searches, edits, checks of models
    JobThread files;               // what the artist reads and writes
    JobThread saver;               // autosaves
    JobThread counter;             // counts and measures beside the frames
    bool reads_work = false;       // `files` reads the document that takes the place of the open one
    std::function<void()> on_end;  // called when a job about the scene has left its result

private:
    JobKind kind_ = JobKind::Other;
};

/// Shared state of the controllers; main thread only.
struct Workspace {
    explicit Workspace(ApplicationOptions options);

    ApplicationOptions options;
    Notices notices;
    MainQueue queue;
    Document document;
    std::string scene_path, project_path;
    std::uint64_t opened = 0;                     // documents so far
    std::uint64_t content = 1;                    // rises with what the viewport shows
    std::uint64_t stroke = 0;                     // drags so far: those of one drag are one step of undo
    std::uint64_t next_edit_id = 1;               // of the edit stack
    std::uint64_t worked_at = 0;                  // step that the last search or edit led to; 0 = none
    std::size_t labelled = 0;                     // rows of the active label
    ui::NetworkCost cost;                         // of the running or last search or edit
    WaitingResults results;                       // of edits, to be applied or discarded
    KeptVariations variations;                    // of applied edits
    std::string layout;                           // places of the panels; part of settings and project
    bool layout_loaded = false;                   // the window has not taken it over yet
    bool settings_changed = false;                // to be written before the next frame
    std::function<void(const ui::Command&)> run;  // gives a command to its controller, at once
    std::unique_ptr<Jobs> jobs;                   // last: its threads end before what they use

    /// False, and said, where nothing is open.
    bool require_scene();
    /// The label that is shown and corrected; null where there is none.
    const NamedLabel* active_label() const;
    /// The splats as they are now, without labels and views.
    Scene scene() const;
    /// Shows a notice about the last step, with a button that takes it back while nothing came after it.
    void toast_step(std::string text);
    /// Shows an error that ended a job; a cancelled job is no error.
    void report_end(const Error& error);
    /// Forgets the status and the cost of the last search or edit.
    void forget_work();
    /// Another document is open: forgets all that belongs to the last one but its results.
    void take_document();
};

}  // namespace gse::app
