// Views drawn by one strategy: a candidate that is judged, and fitted to if it is chosen.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/edit/target_views/strategies/colour_remap.h"
#include "engine/edit/target_views/strategies/look_correction.h"
#include "engine/pipeline/run/draw_strategy.h"

namespace gse::pipeline {

/// Lays a remapped colour's pattern over what is labelled, but for the ground that an old thing hid.
struct PatternLayer {
    edit::ColourRemap remap;
    Vec3 up, front;
    std::uint64_t seed;

    GaussianSet over(const GaussianSet& set, std::vector<std::uint8_t> rows,
                     const std::vector<std::uint8_t>& hole_fill) const;
    /// Hands on states of the edit which show it.
    edit::SnapshotCallback over(edit::SnapshotCallback snapshots) const;
};

/// Draws, judges and fits by one strategy. Refers to all it is given.
class ViewCandidate {
public:
    /// `drawn`: keeps pictures for later, may be null; `ground`: plain_ground_under().
    ViewCandidate(const SceneEdit& scene_edit, const DrawStrategy& strategy,
                  const std::optional<edit::GroundUnder>& ground, std::vector<CachedPictures>* drawn);
    ViewCandidate(const ViewCandidate&) = delete;

    /// Has the first views drawn: sheet(), or failure() where the model could draw nothing of use; neither
    /// where the edit was stopped. Throws other Errors as edit::Optimiser does.
    void draw();
    const std::optional<edit::ViewTargets>& sheet() const { return sheet_; }
    const std::optional<Error>& failure() const { return failure_; }
    /// Tells whether the drawn views show what was asked.
    EditQuality judge() const;
    /// Fits the scene to the drawn views. Throws as edit::Optimiser does.
    Edited fit();

private:
    template <class Editor, class... Parts> Editor& add(Parts&&... parts);
    void add_editors(const DrawStrategy& strategy, const std::optional<edit::GroundUnder>& ground,
                     std::vector<CachedPictures>* drawn);
    /// Look that the sentence gives to what is there; none for a new thing, or one that a remap makes.
    std::optional<edit::Look> look_asked() const;
    void show(const edit::ViewTargets& sheet);

    const SceneEdit& scene_edit_;
    edit::CheckedRequest request_;  // with what the model is told
    std::optional<edit::ColourRemap> remap_;
    std::optional<PatternLayer> pattern_;
    neural::SdsParameters settings_;
    std::vector<std::unique_ptr<edit::MultiViewEditor>> editors_;  // each draws with the one before it
    edit::DyedViews* remapped_ = nullptr;                          // one of them
    edit::LookCorrection* corrected_ = nullptr;                    // another
    std::unique_ptr<edit::AttentionSource> attention_;
    std::unique_ptr<edit::Optimiser> optimiser_;
    std::optional<edit::ViewTargets> sheet_;
    std::optional<Error> failure_;
    std::vector<edit::ViewTargets> sheets_;
};

}  // namespace gse::pipeline
