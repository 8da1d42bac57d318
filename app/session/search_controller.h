// The request and its search results: searches, votes of their views, and the scope of an edit (label or
// search).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/session/cost_book.h"
#include "app/session/edit/asked_sentence.h"
#include "app/session/edit/last_search.h"
#include "app/session/edit/server_controller.h"
#include "app/session/edit/step_chain.h"
#include "app/session/model_controller.h"
#include "app/session/state/cost_profile.h"
#include "app/session/state/edit_scope.h"
#include "app/session/state/stage.h"
#include "app/session/state/workspace.h"
#include "app/session/view_controller.h"
#include "engine/base/content_hash.h"

namespace gse::app {

/// Inputs of a job beside its recipe and model, as they are now.
struct SearchGround {
    Scene scene;
    std::vector<View> views;
    std::optional<neural::TunedModel> tuned;
    std::vector<std::string> said;
    std::vector<std::uint8_t> found = {};  // [N] the source, where a step before has found it

    EditJobInput input(const MeasuredRun& run, std::vector<std::uint8_t> label) const {
        const bool known = label.empty() && !found.empty();
        return {scene,
                views,
                run.model,
                std::move(label),
                {},
                tuned,
                said,
                run.segmenters,
                known ? found : std::vector<std::uint8_t>{},
                run.server};
    }
};

class SearchController {
public:
    SearchController(Workspace& workspace, ViewController& view, ModelController& models,
                     ServerController& servers, CostBook& costs);

    void run(const ui::SearchCommand& command);
    /// Takes views that came in, votes where that is wanted, and follows words and labels. Once per frame.
    void refresh();
    void show(ui::SearchPart& model) const;
    /// Another document is open: nothing was searched in it.
    void take_document();
    /// The document changed: what its edits say of the scene.
    void follow_document();

    const edit::EditRequest& request() const { return sentence_.request(); }
    AskedSentence& sentence() { return sentence_; }
    /// `waits`: the words are those of a scene that will be opened, and stay when it is.
    void set_request(const edit::EditRequest& request, bool waits = false);
    /// Fields that still are as `before` has them become as `after` has them.
    void move_request(const edit::EditRequest& before, const edit::EditRequest& after);

    /// The recipe of the request, or of its step, as it is now, with the target that it implies.
    EditRecipe recipe() const;
    /// The recipe of a job: a target that nobody has chosen is left to the pictures.
    EditRecipe open_recipe(EditRecipe recipe) const;
    /// The last search where it is that of the recipe and of the splats as they are now; else null.
    std::shared_ptr<EditJob> fitting_job() const;
    /// Prepares a job about to begin: what belonged to another search goes.
    void begin_edit();
    std::shared_ptr<MeasuredRun> begin_run();
    SearchGround ground(const EditRecipe& recipe) const;
    /// Ground of a step on what the steps before it left.
    SearchGround ground(const StepChain& chain) const;
    /// Takes what a search found, for a recipe; labels it where `relabel`. The word that it saw to be new is
    /// in last().target().
    void take_found(const std::shared_ptr<EditJob>& job, std::vector<float> attention, EditRecipe recipe,
                    bool relabel);
    const LastSearch& last() const { return last_; }

    /// The label that says what an edit may change; null = a search does.
    const NamedLabel* scope() const;
    /// The label that does so in another state of the document.
    const NamedLabel* scope(const DocumentState& state) const;
    /// Makes that label the active one, which is shown and corrected.
    void show_scope();
    /// Who makes, corrects or picks a label by hand means it to be edited.
    void choose_label_by_hand();
    void rename_label(const std::string& from, const std::string& to);
    /// Nobody has chosen the label that is active now.
    void forget_choice() { choice_.reset(); }
    /// A choice of any source is of the source as it is now.
    void choose_for_source();
    /// Moves through the undo steps; what labels were found with goes with them, into request and evidence.
    void travel(const std::function<void()>& move);
    RowValues attention() const { return last_.attention_of(workspace_.document.state().current); }

    void to_json(nlohmann::json& json) const { json["request"] = fields_to_json(request()); }
    void from_json(const nlohmann::json& json);

private:
    using Clock = std::chrono::steady_clock;
    /// Votes of the last search's views that it has not been told yet.
    struct Vote {
        edit::LabelThresholds with;
        std::string step, merge_key;  // of the undo step it makes; empty = none: undo brought it back
    };
    template <class C> void on(const C& command);
    std::string read_target() const;
    void take_located(const std::shared_ptr<EditJob>& job, std::vector<float> attention);
    void label_located(const EditJob& job, const std::string& step, const std::string& merge_key);
    void vote_if_wanted();
    void end_vote(const std::shared_ptr<EditJob>& job, const Vote& vote, const Error* error);
    void set_scope(bool by_label);
    void refresh_scope();
    void refresh_reading();
    void refresh_estimate();

    Workspace& workspace_;
    ViewController& view_;
    ModelController& models_;
    ServerController& servers_;
    CostBook& costs_;
    AskedSentence sentence_;
    std::size_t words_read_ = 0;  // of the sentence, by the text encoder; 0 = all, or not known
    bool words_wait_ = true;      // for a scene that is not open yet
    LastSearch last_;
    std::string looked_from_;  // where the camera was turned to when it began; empty = nowhere
    std::optional<Vote> wanted_vote_;
    std::shared_ptr<ArrivingViews> arriving_ = std::make_shared<ArrivingViews>();  // of the search under way
    std::optional<ScopeChoice> choice_;  // of the label that was active then
    ContentKey scope_key_;               // that the four below were made for
    ui::EditScope scope_;
    std::string server_search_;
    bool labelled_by_hand_ = false, attention_corrected_ = false;
    Clock::time_point last_estimate_{};
};

}  // namespace gse::app
