// Scanned scenes with truth made by hand, and the sentences that are typed for them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/laboratory/eval/real/truth_region.h"
#include "engine/math/framing.h"

namespace gse::bench {

/// Truth of a thing of a scene.
struct RealThing {
    TruthRegion region;
    std::vector<TruthRegion> either;  // splats in these count neither way
};

struct RealScene {
    std::string name;
    std::filesystem::path path;
    std::string up;               // "-y" and so on
    std::optional<double> front;  // azimuth of orbit_camera() about `up`, degrees; none = it has none
    bool auto_up_right = false;   // the up axis was guessed right when the suite was made
    std::vector<double> sides;    // azimuths of its pictures from the front, degrees
    std::map<std::string, RealThing> things;
};

struct RealTask {
    std::string name;
    std::size_t scene = 0;  // index in RealSuite::scenes
    std::string source, prompt;
    std::string accept;       // what a good result shows, for the eye
    std::string kind;         // recolour, material, add, replace, remove or ground
    std::string about;        // key of the scene's things; empty = no label is measured
    std::string cut_out;      // box around the thing, for --cut-out with the true up axis; empty = none
    bool known_word = false;  // the model knew the source when the suite was made
    std::optional<TruthRegion> place;  // where new splats belong
    std::optional<Bounds> place_box;   // first box of `place`, which pictures of an addition show

    /// True where the label is compared with the truth.
    bool measures_label() const { return !about.empty() && kind != "add"; }
};

struct RealSuite {
    std::string name;
    std::vector<RealScene> scenes;
    std::vector<RealTask> tasks;

    const RealScene& scene_of(const RealTask& task) const { return scenes[task.scene]; }
    const RealThing& thing_of(const RealTask& task) const { return scene_of(task).things.at(task.about); }
};

/// Reads a suite. Relative roots of scenes are folders beside the file. `roots`: "NAME=FOLDER" each, in place
/// of the file's. Throws Error (NotFound, Unreadable, Malformed, InvalidArgument).
RealSuite read_real_suite(const std::filesystem::path& path, const std::vector<std::string>& roots = {});

}  // namespace gse::bench
