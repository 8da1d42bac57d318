// Meaning of the synthetic world's words for its generator.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/laboratory/synth/synth.h"

namespace gse::synth {

/// Throws Error for a word that is not in its list.
void require_known_words(const SceneSpec& spec);

bool contains(const std::vector<std::string>& words, const std::string& word);

/// Position of a word in `words`, else behind them in `more`; the word is known.
std::uint64_t word_index(const std::vector<std::string>& words, const std::vector<std::string>& more,
                         const std::string& word);

/// Colours of a word of more_accessory_words().
const std::vector<std::string>& more_accessory_colour_words(const std::string& accessory);

/// Material of the accessory: its colour word, or its natural one.
std::string accessory_material(const SceneSpec& spec);

/// A word people may type for one of the lists' words ("wood" for "wooden").
struct Synonym {
    const char* typed;
    const char* meant;
};

const std::vector<Synonym>& synonyms();

/// The list word a typed word stands for: itself, or what the synonym means.
std::string canonical_word(const std::string& typed);

}  // namespace gse::synth
