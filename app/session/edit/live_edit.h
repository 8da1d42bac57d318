// An edit on the work thread: the roads between it and the window, and what the window knows of it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/engine_names.h"
#include "app/session/edit/snapshots.h"
#include "app/session/state/cost_profile.h"
#include "app/session/state/pending_result.h"
#include "engine/base/mailbox.h"
#include "engine/base/shared_queue.h"
#include "engine/neural/api/network_use.h"
#include "engine/pipeline/run/edit_job.h"
#include "engine/remote/drawing/partial_round.h"
#include "ui/model/view_model.h"

namespace gse::app {

constexpr const char* AddsElsewhere =
    "What is added goes where the search placed it: corrections of the label by hand do not move that.";

namespace edit_news {

/// The search is over.
struct Located {
    bool adds = false;
    Renamed renamed;
};
/// A search was made for this edit; the loop leaves alone what it found.
struct Found {
    std::shared_ptr<EditJob> job;
    std::vector<float> attention;  // per splat
    bool relabel = false;          // what it found is the label now
};
struct Preview {
    ui::GateView gate;
};
/// Views were redrawn.
struct Targets {
    ui::TargetRound round;
    bool waits = false;  // the fit begins when the artist says so
};
/// The orders of the artist so far are being carried out.
struct OrdersTaken {};
struct State {
    edit::EditSnapshot snapshot;
    GaussianSet set;
};
struct Step {
    ui::LossPoint point;
};
/// The drawing ended early, and the edit waits for an answer.
struct Partial {
    remote::PartialRound round;
};
/// Passes of the networks since the edit began.
struct Use {
    neural::NetworkUse use;
};

}  // namespace edit_news

using EditNews = std::variant<edit_news::Located, edit_news::Found, edit_news::Preview, edit_news::Targets,
                              edit_news::OrdersTaken, edit_news::State, edit_news::Step, edit_news::Partial,
                              edit_news::Use>;

/// Roads between the edit's thread and the window.
struct EditRoads {
    /// A word of the artist about redrawn views: an order, or none = the fit may begin.
    using Word = std::optional<edit::TargetOrder>;

    SharedQueue<EditNews> news;                // to the window
    SharedQueue<Word> words;                   // to the edit
    Mailbox<std::vector<std::uint8_t>> label;  // corrected by the artist, to the edit
    SharedQueue<bool> fits;                    // answers to edit_news::Partial
    std::shared_ptr<remote::DrawingStop> drawing = std::make_shared<remote::DrawingStop>();
};

/// Inputs of an edit beside its job.
struct EditStart {
    std::vector<std::uint8_t> label;             // empty = as located
    bool corrected = false;                      // by hand, after a search found it
    bool shows_preview = false;                  // what the model makes of a few views, before the loop
    bool brings_label = false;                   // applying it labels what its own search found
    bool reviews = false;                        // the artist looks at every round before it is fitted to
    std::optional<edit::EditSnapshot> snapshot;  // of an earlier run, to go on from
};

/// On the work thread: runs a located job and tells what happens, measuring preview, loop and result. Fills
/// `pending`. `run.attention` is of a search that was made for this edit; empty = it was known. `before`: use
/// of the networks when the job began. Throws Error.
void run_edit(MeasuredRun& run, const EditStart& start, const neural::NetworkUse& before, EditRoads& roads,
              PendingResult& pending, const PeakMemory& peak);

ui::NetworkCost cost_of(const neural::NetworkUse& use);

/// The window's knowledge of the running or last edit.
struct LiveEdit {
    std::shared_ptr<EditRoads> roads = std::make_shared<EditRoads>();
    std::string name, recipe, target;  // recipe as JSON
    int iterations = 0;
    bool adds = false;
    Renamed renamed;
    ui::GateView gate;
    std::vector<ui::LossPoint> losses;
    std::vector<ui::TargetRound> rounds;
    std::vector<edit::TargetOrder> orders;  // given, not taken yet
    bool waits = false;                     // for the artist's look at the redrawn views

    /// Says what is running.
    void describe(const EditRecipe& recipe);
    void take(const edit_news::Targets& targets);
    void order(const edit::TargetOrder& order);
    void fit();
    void show(ui::EditPart& model) const;
};

}  // namespace gse::app
