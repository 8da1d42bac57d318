// English words by their classes: the one place that lists them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gse::language {

/// Stands for one scene in the sentences of DreamBooth ("a * bear").
inline const std::string Identifier = "*";

/// Classes of words, one bit each; a word may be in several.
enum class WordClass : std::uint32_t {
    IndefiniteArticle = 1u << 0,  // a
    DefiniteArticle = 1u << 1,    // the
    Possessive = 1u << 2,         // its
    Demonstrative = 1u << 3,      // this, some
    Caption = 1u << 4,            // photo (of): stands before a noun phrase and says nothing of it
    Pronoun = 1u << 5,            // it, her
    Joiner = 1u << 6,             // wearing, with, into: a noun phrase of the source's news follows
    Stop = 1u << 7,               // on, standing: ends a noun phrase
    Turning = 1u << 8,            // made, of, into, as: what follows is no thing beside the others
    Having = 1u << 9,             // wearing, with: who has something on, or holds it, stands before
    Beside = 1u << 10,            // with, and, under: what stands after is there besides
    Contentless = 1u << 11,       // add, left, view: neither name nor description, and no end of a phrase
    MakingVerb = 1u << 12,        // make, paint: "make the bear golden"
    Copula = 1u << 13,            // is, becomes: "the bear is golden"
    Colour = 1u << 14,            // basic colour terms
    Material = 1u << 15,          // wooden, gold
    State = 1u << 16,             // old, furry
    Ground = 1u << 17             // grass, floor: what things stand on or are in
};

constexpr WordClass operator|(WordClass a, WordClass b) {
    return static_cast<WordClass>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}

inline constexpr WordClass Article = WordClass::IndefiniteArticle | WordClass::DefiniteArticle;
inline constexpr WordClass Determiner = Article | WordClass::Possessive | WordClass::Demonstrative;
/// Passed over at the beginning of a noun phrase, as the identifier is.
inline constexpr WordClass Leading = Determiner | WordClass::Caption;
/// How a thing looks.
inline constexpr WordClass Description = WordClass::Colour | WordClass::Material | WordClass::State;

/// Tells whether a lower-case word is in one of the classes.
bool is_a(std::string_view word, WordClass classes);

/// Position of the target, seen from the source. Left and Right are those of who looks at the scene's front.
enum class Relation { None, Above, Beside, Left, Right, Behind, Before, Under };

/// Relation of what stands before a preposition ("beside", "on top of") to what stands after it; nothing for
/// other words.
std::optional<Relation> relation_named(std::string_view preposition);

/// Prepositions of several words ("in front of", "next to").
const std::vector<std::string>& compound_prepositions();

/// Words of the same meaning ("cub" for "bear"), then those of the same kind (other animals), in groups; the
/// word itself is among them. Empty for a word that is not listed.
std::vector<std::string_view> kindred_groups(std::string_view word);

/// The singular of an irregular plural ("men", "mice"); empty for other words.
std::string_view irregular_singular(std::string_view plural);

/// Place on its wearer that a thing usually takes: "top", "front", "neck" or "around"; nothing for a word
/// that names no such thing.
std::optional<std::string_view> listed_place(std::string_view thing);

/// Parts of a thing that its shape tells.
enum class PartShape { Head, UpperHalf, LowerHalf };

/// Shape of a part by its name ("head", "top half"); nothing for other words.
std::optional<PartShape> shape_of_part(std::string_view part);

}  // namespace gse::language
