// Strategies to have views drawn, and the choice among them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/pipeline/run/edit_quality.h"
#include "engine/pipeline/run/scene_edit.h"

namespace gse::pipeline {

/// One way to have views drawn.
struct DrawStrategy {
    enum class Ground { Scene, Plain, DefaultColour };
    bool restyle = false;           // SdsParameters::restyle
    Ground ground = Ground::Scene;  // Plain: the model is shown it in place of the scene. DefaultColour: the
                                    // views are given it without the model
    /// For keys of drawn pictures.
    const char* name() const;
};

/// A plain ground under what changes, or under what something is added to; none where it stands on nothing,
/// or is not asked for.
std::optional<edit::GroundUnder> plain_ground_under(const SceneEdit& scene_edit);

/// Strategies worth a try, in their order; at least one. `ground`: plain_ground_under().
std::vector<DrawStrategy> draw_strategies(const SceneEdit& scene_edit,
                                          const std::optional<edit::GroundUnder>& ground);

/// Pictures of one request.
struct CachedPictures {
    edit::EditViewsRequest request;
    std::size_t views = 0;
    edit::EditedViews pictures;
};

/// Keeps what is drawn before anything is fitted: a strategy that is the best after all draws nothing twice.
class CachedViews final : public edit::MultiViewEditor {
public:
    /// Both stay alive.
    CachedViews(edit::MultiViewEditor& editor, std::vector<CachedPictures>& drawn)
        : editor_(editor), drawn_(drawn) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& request,
                           const JobControl& job) override;
    bool supports_appearance_editing() const override { return editor_.supports_appearance_editing(); }

private:
    edit::MultiViewEditor& editor_;
    std::vector<CachedPictures>& drawn_;
};

/// Chooses a strategy by the pictures that it has drawn: each in turn, until one is good, then the best.
class StrategyChooser {
public:
    explicit StrategyChooser(std::vector<DrawStrategy> strategies);
    /// The strategy to draw with now, and pictures that it has drawn already.
    const DrawStrategy& strategy() const { return tried_[at_].strategy; }
    std::vector<CachedPictures>& drawn() { return tried_[at_].drawn; }
    bool several() const { return tried_.size() > 1; }
    /// The quality of pictures that were judged before; none of a strategy that was not tried.
    const std::optional<EditQuality>& quality() const { return tried_[at_].quality; }

    /// Tells whether these pictures are the ones to use; else the strategy is another one.
    bool accepts(const EditQuality& quality);
    /// The model could draw no pictures; false where no strategy is left, else the strategy is another one.
    bool skips();

private:
    struct Tried {
        DrawStrategy strategy;
        std::vector<CachedPictures> drawn = {};
        std::optional<EditQuality> quality = {};
    };
    bool is_last() const { return at_ + 1 == tried_.size(); }
    bool accept();
    void go_back();

    std::vector<Tried> tried_;
    std::size_t at_ = 0, best_ = 0;
    double best_score_;
    bool decided_ = false;
};

}  // namespace gse::pipeline
