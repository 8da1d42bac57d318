// Nothing is lost: the autosave of the open document, and work of other sessions that can be had back.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session/state/workspace.h"
#include "engine/io/project/autosave.h"
#include "engine/io/project/project_file.h"

namespace gse::app {

class Recovery {
public:
    /// State of the document that an autosave is of.
    struct Moment {
        std::uint64_t revision = 0;  // of the document
        std::uint64_t live = 0;      // of what runs or waits; 0 = nothing
        std::uint64_t keys = 0;      // of the camera path
        bool operator==(const Moment&) const = default;
    };
    /// Work to write. State and picture are made on the saver's thread.
    struct Content {
        std::shared_ptr<ProjectData> data;
        std::function<DocumentState()> state;
        std::function<std::shared_ptr<const Image>()> picture;
    };

    explicit Recovery(Workspace& workspace) : workspace_(workspace) {}

    // The autosave of the open document
    /// Writes it, then calls `then` (may be empty).
    void write(const Moment& moment, Content content, ProjectWriter& writer, std::function<void()> then);
    /// Something changed since the last one, which is old enough; nothing is being written.
    bool due(const Moment& moment) const;
    /// There is one of this document, and it is not to be left.
    bool stale() const { return autosaved_ && !keep_; }
    void discard();
    /// The document goes: what was open is saved, given up, or left to be offered again.
    void let_go();
    /// The document that is open now was recovered from there; nothing is written of it yet.
    void begin(const Moment& moment, std::optional<Recoverable> recovered);
    /// The last one is older than what was saved since.
    void outdate() { moment_.reset(); }
    /// Notes that recovered work is saved and not needed any more.
    void forget_recovered();
    void keep(bool keep) { keep_ = keep; }  // the autosave stays when this document goes
    bool keeps() const { return keep_; }
    /// The picture of the last autosave, while it is new enough; else null.
    std::shared_ptr<const Image> thumbnail() const;

    // Work of other sessions
    void list();
    /// Lists anew where more can be had back: a program that was killed may end after this one began.
    void refresh();
    void run(const ui::command::DiscardRecovery& command);
    void run(const ui::command::PostponeRecovery& command);
    void see_start_page() { start_page_seen_ = true; }
    void show(ui::DocumentPart& model) const { model.recoverable = offers_; }

private:
    using Clock = std::chrono::steady_clock;
    Workspace& workspace_;
    std::unique_ptr<Autosave> autosave_ = std::make_unique<Autosave>();
    std::optional<Recoverable> recovered_;  // open now, on disk until it is saved or autosaved anew
    bool keep_ = false, autosaved_ = false, start_page_seen_ = false;
    std::optional<Moment> moment_;  // of the last autosave; none = to be written anew
    Clock::time_point last_ = Clock::now();
    std::shared_ptr<const Image> thumbnail_;
    Clock::time_point thumbnail_made_{};
    std::vector<ui::RecoveryView> offers_;  // newest first
    Clock::time_point listed_ = Clock::now();
};

}  // namespace gse::app
