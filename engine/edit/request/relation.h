// Where the sentence says that the new thing is: beside, behind, under, ...
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace gse::edit {

/// Where the target is, seen from the source. Left and Right are those of who looks at the scene's front.
enum class Relation { None, Above, Beside, Left, Right, Behind, Before, Under };

/// Prepositions of several words ("in front of", "next to"), for terms_of().
const std::vector<std::string>& compound_prepositions();

/// Where "beside", "on top of", ... put what stands before them, seen from what stands after them; nothing
/// for other words.
std::optional<Relation> relation_named(const std::string& preposition);

/// Whether the term at `i` is the last of its noun phrase, but for what the thing does ("a ball bouncing
/// beside"): "blue" in "a blue bear on the grass" is none.
bool names_thing(const std::vector<std::string>& terms, std::size_t i);

/// The relation that the sentence states between the two: "a ball beside a bear", "a bear with a ball beside
/// it". Where it states the source's place ("a bear under a hat"), that of the target is the opposite one.
/// None = it states none.
Relation relation_of(const std::string& sentence, const std::string& source, const std::string& target);

/// "beside", "left", ...; the name of a place for anchor_region(). Empty for None and Above: there the thing
/// itself says it.
std::string place_name(Relation relation);

}  // namespace gse::edit
