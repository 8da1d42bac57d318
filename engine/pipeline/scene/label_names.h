// Labels of a scene by their names, as words of sentences about it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace gse::pipeline {

/// Label with that name that marks splats, else one whose name is that of a file with such a thing
/// ("object_guitar" for "guitar"); null where there is none. Letter case does not count.
const Label* label_named(const LabelSet& labels, std::string_view name);

/// Label with that name, for a word that the model cannot find; null for another word. `known` holds the
/// words of the model; empty = it takes any.
const Label* label_for(const LabelSet& labels, std::string_view word, const std::vector<std::string>& known);

/// Words that a sentence may call the thing of a label by: the name in lower case, and the thing of a file's
/// name.
std::vector<std::string> words_for_label(std::string_view name);

/// Names of the labels that mark splats, in lower case, and the things of those that are names of files.
std::vector<std::string> label_names(const LabelSet& labels);

/// Labels of other rows. Row i takes the bits of row sources[i]; -1 = a new row, which no label marks.
LabelSet gathered(const LabelSet& labels, std::span<const std::int64_t> sources);

}  // namespace gse::pipeline
