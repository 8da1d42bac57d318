// Noun phrases and what stands between them, over the terms of a sentence.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/language/lexicon.h"

namespace gse::language {

/// The words as terms: compound prepositions ("next to") and each of the phrases are one entry.
std::vector<std::string> noun_terms(const std::vector<std::string>& words,
                                    const std::vector<std::string>& phrases);

/// Tells whether a term stands between noun phrases: "wearing", "on", "next to".
bool ends_phrase(std::string_view term);

/// Tells whether a term is passed over at the beginning of a noun phrase: "the", "its", "photo", "*".
bool is_leading(std::string_view term);

/// "it", "him", ...: what stands for the source after a preposition.
bool is_pronoun(std::string_view term);

/// Tells whether a (lower-case) word names or describes something: "bear", "golden"; not "the", "wearing" or
/// "remove".
bool says_something(std::string_view word);

/// Tells whether the word at `i` is an "in" that puts something on: "in flames", "in a hat", but not "in
/// gold", "in the snow".
bool says_worn(const std::vector<std::string>& words, std::size_t i);

/// Tells whether a noun phrase may begin with the term at `i`: the first one, and what follows a joint.
bool begins_phrase(const std::vector<std::string>& terms, std::size_t i);

/// Last word of the noun phrase that begins at `first`, behind articles and the "of" of "made of"; empty
/// where none follows.
std::string head_of_phrase(const std::vector<std::string>& terms, std::size_t first);

/// True when the term at `i` is the last of its noun phrase, apart from the object's action ("a ball bouncing
/// beside"). "blue" in "a blue bear on the grass" is not.
bool names_thing(const std::vector<std::string>& terms, std::size_t i);

/// Grounds are what things stand on or are in, not things: one in the place of another changes no shape.
bool is_ground(std::string_view word);
/// Tells whether the phrase's last word is a ground.
bool names_ground(std::string_view phrase);
/// True for a ground that all of a scene may stand on ("grass", "floor"), and not a part of one ("lake").
bool names_scene_ground(std::string_view phrase);

/// Place on its wearer that a thing ("hat", "top hat") usually takes: "top" for what is not known.
std::string usual_place(std::string_view thing);
/// Tells whether the place is known, not only supposed.
bool has_usual_place(std::string_view thing);

/// The relation that the terms state between the two phrases: "a ball beside a bear", "a bear with a ball
/// beside it". Where they state the source's place ("a bear under a hat"), that of the target is the opposite
/// one. None = they state none.
Relation relation_of(const std::vector<std::string>& terms, const std::string& source,
                     const std::string& target);

/// "beside", "left", ...; the name of a place for anchor_region(). Empty for None and Above: there the thing
/// itself says it.
std::string place_name(Relation relation);

}  // namespace gse::language
