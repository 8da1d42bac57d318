// One task of the suite, made as `gseditpro edit` makes it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/laboratory/eval/real/real_figures.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::bench {

/// Ways to make the edit of a task.
enum class RealMode {
    Word,     // the sentence alone
    Upright,  // with the scene's true up axis
    Box,      // with the true up axis and the task's box around the thing
    Click     // with the true up axis and one click on the thing
};

/// "word", "upright", "box", "click".
std::string mode_name(RealMode mode);
/// Modes of a list with spaces or commas between. Throws Error (InvalidArgument) for another name.
std::vector<RealMode> parse_modes(const std::string& text);
/// True for a mode that a task is made in. "box" needs a box, "click" a thing with truth. "upright" needs a
/// known word in a scene whose up axis the suite says is guessed wrong.
bool has_mode(const RealScene& scene, const RealTask& task, RealMode mode);

/// Recipe of a task; `settings` are of model, machine and edit. A click comes from truth_click().
pipeline::EditRecipe real_recipe(const RealScene& scene, const RealTask& task, RealMode mode,
                                 pipeline::EditRecipe settings);

enum class RealEnding {
    Refused,  // nothing was made
    KeptOut,  // made, and judged to have failed
    Done
};

/// "refused", "kept out", "done".
std::string ending_name(RealEnding ending);

/// Colour of the search's confidence in the window.
enum class SureLevel {
    None,   // nothing was looked for
    Green,  // sure enough
    Amber   // unsure
};

/// "", "green", "amber".
std::string level_name(SureLevel level);

/// Outcome of a run. Fields of the search stay empty where the sentence was refused before it.
struct RealOutcome {
    RealEnding ending = RealEnding::Refused;
    std::string message, remedy;       // of a refusal, or of what was kept out
    std::string cause;                 // class of a refusal: see refusal_cause()
    std::optional<double> confidence;  // of the search; of several steps the least
    SureLevel level = SureLevel::None;
    std::string edit_mode;  // modify, add or replace; of the last step
    std::size_t steps = 1;
    std::optional<double> front_read;  // azimuth, degrees, about `up`
    std::optional<Vec3> up;            // up axis of the run
    std::optional<double> score;       // of the redrawn views; none = nobody can tell
    bool warned = false;               // the window's bar says that the pictures do not show the sentence
    nlohmann::ordered_json judgement;
    double seconds = 0;

    Scene before;
    GaussianSet after;
    Rows label;  // [before] rows that any step may have changed
};

/// Class of a refusal: "word not known", "unsure", "not found", "no place", "not drawn", or "other".
std::string refusal_cause(const std::string& message);

/// Makes the edit of a recipe. Several steps follow each other; one that is judged to have failed is kept
/// out. A refusal is an outcome. Throws Error (Cancelled) on a stop.
RealOutcome run_real_task(const pipeline::EditRecipe& recipe, const JobControl& control);

}  // namespace gse::bench
