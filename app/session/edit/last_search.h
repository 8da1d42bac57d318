// The last search: its job, and its evidence as the window shows it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/engine_names.h"
#include "app/session/state/arriving_views.h"
#include "app/session/state/stage.h"
#include "engine/neural/api/api.h"
#include "engine/pipeline/run/edit_job.h"
#include "ui/model/view_model.h"

namespace gse::app {

class LastSearch {
public:
    /// A search is the last one. No thread may be changing the job meanwhile.
    void remember(std::shared_ptr<EditJob> job, const EditRecipe& recipe);
    /// Shows what a search, or another threshold over its views, came to.
    void show_evidence(const EditJob& job);
    void take_attention(const GaussianSet& splats, std::vector<float> attention);
    /// Takes views of a search under way; where that comes to nothing, those of the one before come back.
    /// True when the viewport shows something else now.
    bool take_arriving(ArrivingViews& arriving, bool working);
    void forget();
    /// The step of undo that it led to, or came after.
    std::uint64_t step() const { return step_; }
    void set_step(std::uint64_t step) { step_ = step, undone_ = false; }
    /// Hides the evidence of a search that is undone; redone, it is shown again.
    void set_undone(bool undone) { undone_ = undone; }

    const std::shared_ptr<EditJob>& job() const { return job_; }
    const edit::EditWords& words() const { return words_; }
    bool of(const GaussianSet& splats) const { return splats_.shares_all_with(splats); }
    /// The word that it saw to be new, where it was of this source and sentence.
    std::string read_target(const edit::EditRequest& request) const;
    /// Weights that its model learned, if this recipe's model would learn them.
    std::optional<neural::TunedModel> tuning(const EditRecipe& recipe) const;
    const std::string& key() const { return key_; }  // of the recipe
    const edit::LabelThresholds& voted_with() const { return voted_with_; }
    void set_voted_with(const edit::LabelThresholds& with) { voted_with_ = with; }
    RowValues attention_of(const GaussianSet& splats) const;
    /// None of an undone search.
    const std::vector<ui::AttentionView>& views() const { return undone_ && !arriving_ ? none_ : views_; }
    const std::string& word() const { return word_; }
    bool arriving() const { return arriving_; }
    std::uint64_t number() const { return outcome_.number; }
    double threshold() const { return threshold_; }
    void set_threshold(double threshold) { threshold_ = threshold; }
    /// Shows a view as left out, or as put back, until the vote that follows.
    void leave_out(std::size_t view, bool out);
    void show(ui::SearchPart& model) const;

private:
    std::shared_ptr<EditJob> job_;
    // Asked by every frame: a job that runs may be changing job_ itself.
    edit::EditWords words_;
    bool target_read_ = false;
    std::string tuning_key_, key_;
    std::optional<neural::TunedModel> tuned_;
    GaussianSet splats_;
    edit::LabelThresholds voted_with_;
    // Evidence
    std::vector<ui::AttentionView> views_, none_;
    std::string word_, mode_;  // "bear", "modify: ..."
    double threshold_ = 0.5;
    bool arriving_ = false;  // a search is under way: views come in as they are attended
    bool undone_ = false;
    std::uint64_t step_ = 0;
    ui::SearchView outcome_;
    RowValues attention_;
    GaussianSet attention_of_;
};

}  // namespace gse::app
