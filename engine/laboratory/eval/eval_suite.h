// The synthetic edits that eval measures a model on: source scene, sentence and true edited scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/laboratory/synth/synth.h"

namespace gse::bench {

/// Change of place, size or number that a sentence asks for; nothing else changes.
struct AskedPlace {
    double size = 1;       // factor
    double degrees = 0;    // about the upright axis, counter-clockwise as seen from above
    double right = 0;      // of who looks at the front: -1, 0 or 1
    double forward = 0;    // towards who looks at the front: -1, 0 or 1
    double distance = 0;   // world units; 0 = as far as the thing is wide or deep
    int things = 1;        // afterwards; 0 = it is gone
    bool scanned = false;  // the scene lacks what no view of a scan shows
};

/// One edit with its ground truth.
struct EvalCase {
    std::string kind;  // "recolour", "material", "add", "ground", "replace", "dye", "compound", or of
                       // rearranged_kinds()
    synth::SceneSpec source;
    synth::SceneSpec target;                 // same seed: the same scene but for what the sentence changes
    std::string prompt;                      // describes the target
    std::string word;                        // the source word
    std::string target_word;                 // the new word; empty for "compound"
    synth::Part part = synth::Part::Object;  // what changes; in the source scene, or new in the target
    AskedPlace asked = {};                   // of rearranged_kinds()
};

/// Kinds in which nothing is drawn: "remove", "resize", "move", "rotate", "duplicate".
const std::vector<std::string>& rearranged_kinds();
bool is_rearranged(const std::string& kind);

/// Kinds of edits that are measured unless others are named.
const std::vector<std::string>& eval_kinds();

/// Makes `count` edits, the kinds in turn. The target's combination of object, material and accessory is
/// always one that training never saw. For recolour and material edits of scenes with an accessory (half of
/// them) the source's is too.
/// "replace" puts another object, of one material or another, in the place of one without an accessory.
/// Scene seeds are drawn from `seed`. Combinations repeat only when there are no others. Edits that replace
/// are drawn apart: the others do not depend on them.
/// "compound" changes two or three things by one sentence; it names no single new word.
/// Those of rearranged_kinds() keep the spec; every second "remove" is of a scene as a scan holds it.
/// `drawn_words`: additions and replacements are of synth::more_accessory_words() and more_object_words().
/// Throws Error for an unknown kind.
std::vector<EvalCase> make_suite(std::uint64_t seed, int count, const std::vector<std::string>& kinds,
                                 bool drawn_words = false);

}  // namespace gse::bench
