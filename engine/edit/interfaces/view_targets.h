// Exchange between a round of view guidance and an artist: the redrawn views, and orders about them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "engine/edit/interfaces/interfaces.h"

namespace gse::edit {

/// Sides of the pictures that are shown are at most this many pixels.
constexpr int ShownSide = 256;

/// One redrawn view as it stands.
struct ViewTarget {
    std::size_t view = 0;  // index into the plan's views
    std::shared_ptr<const Image> before,
        after;             // [H,W,3] in [0,1]: what was redrawn, and what the scene is fitted to
    int attempt = 0;       // how often it was redrawn anew
    bool dropped = false;  // the fit does not use it
    bool missing = false;  // it was never drawn: there is nothing to use before it is redrawn
};

/// The redrawn views of a round; another value whenever something about them changes.
struct ViewTargets {
    int round = 0, rounds = 1;
    std::vector<ViewTarget> views;           // ascending by view
    std::string sentence = {};               // that the model was told, where it is not the artist's own
    std::vector<std::string> warnings = {};  // what is suspicious about the pictures, and what would help
};

/// Used by the fit (all are at first), not used, or redrawn from another seed and used.
enum class TargetChoice { Accept, Drop, Redo };

struct TargetOrder {
    int round = 0;
    std::size_t view = 0;  // index into the plan's views
    TargetChoice choice = TargetChoice::Accept;
};

/// Inputs and outcome of a round: enough to go on fitting from a snapshot without asking the model again.
/// Never changed once it is handed out.
struct RoundState {
    int round = 0;
    std::string key;                                     // of the settings that the pictures follow from
    std::vector<std::size_t> views;                      // of the plan, ascending
    std::shared_ptr<const std::vector<EditView>> begun;  // per view: what was redrawn
    std::vector<std::shared_ptr<const Image>> edited;    // per view: as the model would have it, [H,W,3]
    std::vector<int> attempts;                           // per view
    std::vector<bool> dropped;                           // per view
    std::string sentence = {};                           // that the model was told; empty = the edit's
    std::vector<std::string> warnings = {};              // of the round as it was redrawn
    double raised = 0;                                   // strength of redrawing beyond what was asked
    std::vector<bool> missing = {};                      // per view: it was not drawn; empty = all were
};

}  // namespace gse::edit
