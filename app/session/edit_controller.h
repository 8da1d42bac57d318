// Edits and their results: what runs, its states, and what waits to be applied or discarded.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/session/cost_book.h"
#include "app/session/edit/live_edit.h"
#include "app/session/edit/server_controller.h"
#include "app/session/edit/snapshots.h"
#include "app/session/edit/step_chain.h"
#include "app/session/model_controller.h"
#include "app/session/search_controller.h"
#include "app/session/state/stage.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"

namespace gse::app {

class EditController {
public:
    EditController(Workspace& workspace, ViewController& view, ModelController& models,
                   ServerController& servers, CostBook& costs, SearchController& search)
        : workspace_(workspace), view_(view), models_(models), servers_(servers), costs_(costs),
          search_(search) {}

    void run(const ui::EditCommand& command);
    /// Takes what the running edit told. Once per frame, and when it ends.
    void refresh();
    void show(ui::EditPart& model) const;
    /// Another document is open, with a result that waits to be applied where its work was kept.
    void take_document(std::optional<PendingResult> pending);
    /// Forgets what the last run showed: its pictures, curves, states and redrawn views.
    void forget_run();

    bool runs() const { return workspace_.jobs->works_at(JobKind::Edit); }
    void discard_result();
    /// Splats of the viewport: a state that is looked at, the result that waits, the newest state, else the
    /// document.
    Stage stage();
    /// Hands a corrected label to the edit that runs; the loop takes it over before its next step.
    void correct_label(const std::vector<std::uint8_t>& bits);
    /// Splats of an export that differ from the document's; empty = the document's.
    std::string said_of_stage() const;

    // For the recovery folder
    /// Another number for each state that would be kept; 0 = nothing runs or waits.
    std::uint64_t kept_number() const;
    nlohmann::json kept_json() const;
    /// The document's state with what runs or waits on its stack, to be made on another thread.
    std::function<DocumentState()> kept_state() const;

private:
    template <class C> void on(const C& command);
    template <class N> void take(N&& news);
    EditStart start_from(std::optional<edit::EditSnapshot> from) const;
    void read_steps();
    void say_why_nothing_runs();
    void begin_steps(const language::plan::SceneWords& scene);
    void start(std::optional<edit::EditSnapshot> from);
    std::string title_of(const EditRecipe& recipe) const;
    bool take_step(PendingResult pending, const Error* error);
    void end_steps();
    void end(const Error* error);
    bool shows_states() const;
    std::size_t steps_before(const PendingResult* whole) const;
    const edit::EditSnapshot* usable_snapshot(int iteration);
    void go_on_from_branch();

    Workspace& workspace_;
    ViewController& view_;
    ModelController& models_;
    ServerController& servers_;
    CostBook& costs_;
    SearchController& search_;
    LiveEdit live_;
    EditRecipe recipe_;                  // of the edit that runs
    StepChain chain_;                    // that it is a step of
    std::vector<std::string> left_out_;  // steps that the artist has left out of the last edit
    Snapshots snapshots_;
    std::optional<edit::EditSnapshot> branch_;  // to go on from when the running edit has ended
};

}  // namespace gse::app
