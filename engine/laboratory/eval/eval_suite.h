// The synthetic edits that eval measures a model on: source scene, sentence and true edited scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/laboratory/synth/synth.h"

namespace gse::bench {

/// One edit with its ground truth.
struct EvalCase {
    std::string kind;  // "recolour", "material", "add", "ground", "replace", "dye" or "compound"
    synth::SceneSpec source;
    synth::SceneSpec target;                 // same seed: the same scene but for what the sentence changes
    std::string prompt;                      // describes the target
    std::string word;                        // the source word
    std::string target_word;                 // the new word; empty for "compound"
    synth::Part part = synth::Part::Object;  // what changes; in the source scene, or new in the target
};

/// Kinds of edits that are measured unless others are named.
const std::vector<std::string>& eval_kinds();

/// Makes `count` edits, the kinds in turn. The target's combination of object, material and accessory is
/// always one that training never saw. For recolour and material edits of scenes with an accessory (half of
/// them) the source's is too.
/// "replace" puts another object, of one material or another, in the place of one without an accessory.
/// Scene seeds are drawn from `seed`. Combinations repeat only when there are no others. Edits that replace
/// are drawn apart: the others do not depend on them.
/// "compound" changes two or three things by one sentence; it names no single new word.
/// `drawn_words`: additions and replacements are of synth::more_accessory_words() and more_object_words().
/// Throws Error for an unknown kind.
std::vector<EvalCase> make_suite(std::uint64_t seed, int count, const std::vector<std::string>& kinds,
                                 bool drawn_words = false);

}  // namespace gse::bench
