// Words by class, read from the lexicon's two data files, which are compiled in.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace gse::language::plan {

/// Classes of words and phrases; lexicon.txt names them in the same spelling, ClassNames in the same order.
enum class Class : std::uint16_t {
    // clang-format off
    spelling, article, definite, possessive, another, all, none, some, number, pronoun_it, pronoun_person,
    pronoun_all, everything, everything_else, something, nobody, relation, inverse_relation, wearing,
    holding, riding, having, without, copula, modal, negation, conjunction, alternative, contrast,
    rather_than, instead, sequence, than, of, made_of, into, from, to, like, relative, there_is, degree,
    more, less, most, as_well, courtesy, request, caption, noise, negative_prompt, prefix, verb_recolour,
    verb_shift, verb_make, verb_turn, verb_replace, verb_swap, verb_add, verb_give, verb_dress, verb_cover,
    verb_remove, verb_relieve, verb_shave, verb_undress, verb_empty, verb_move, verb_lift, verb_size,
    verb_scale, verb_double, verb_rotate, verb_flip, verb_face, verb_duplicate, verb_style, verb_material,
    verb_carve, verb_pattern, verb_alter, verb_pose, verb_raise, verb_keep, verb_become, gone, emerging,
    colour, colour_noun, shade, shift, colour_word, material, material_surface, material_sense, pattern,
    pattern_plain, pattern_animal, pattern_word, size, dimension, times, direction, side, clockwise,
    turning, flipping, degrees, unit, animal_name, person_name, vehicle_name, thing_name, furniture_name,
    plant_name, clothes_name, synonyms, ground, ground_name, place, backdrop, environment, weather_verb,
    time_word, style, style_word, style_effect, state, pose, where_pose, pose_manner, look_word,
    worn_adjective, unworn_adjective, worn, pair_noun, part, body_place, whole_part, held, ridden,
    container, floating, covering, compound, masculine, feminine, person, animal, thing, figure, fire_words,
    fire_verb, meta_verb, meta_noun, meta, question, question_word, injection, narrative, subordinate,
    do_not, whatever, never_mind, correction, same_noise, irregular, irregular_verb, foreign, foreign_weak,
    empty, except, what_stands, shade_of, contrast_change, dressed_as, only, unwanted, hour, viewer, wish,
    verb_around, verb_fill, word_a, word_against, word_all, word_and, word_around, word_as, word_at,
    word_away, word_by, word_chop, word_clear, word_cut, word_dark, word_down, word_during, word_except,
    word_facing, word_factor, word_fall, word_for, word_from, word_get, word_give, word_half, word_has,
    word_have, word_here, word_horizontally, word_in, word_it, word_its, word_leave, word_like, word_made,
    word_make, word_moon, word_neither, word_nor, word_not, word_nothing, word_now, word_of, word_off,
    word_on, word_one, word_ones, word_out, word_place, word_places, word_position, word_positions,
    word_put, word_rainbow, word_remain, word_remains, word_same, word_sideways, word_sky, word_stars,
    word_stay, word_stays, word_substitute, word_sun, word_take, word_there, word_throw, word_times,
    word_to, word_try, word_unchanged, word_untouched, word_up, word_use, word_vertically, word_want,
    word_wide, word_wipe, word_with, word_x, furniture, word_version, word_too, layer, seen_by,
    time_of_day, said_by, where_is, style_kind, word_where, word_colored, part_made, verb_wear,
    word_across, hand, elision, adverb, praise, verb_off, word_whose, plain_verb, word_about,
    furniture_flat, word_into, word_years, word_both, ordinal, word_does, verb_need, quality, heap,
    facial_hair, liked, verb_toss, copy_name, modal_not, weather_goes, complaint, word_what,
    cloth, before_place, stuff_of, place_word, stuff_noun, quality_word, swap_places,
    past_be, wholly, aside, present, vessel, potted_plant, support,
    Count
    // clang-format on
};

/// Things that a word names by its first meaning, one bit each (words.txt).
enum Kind : std::uint32_t {
    Animal = 1u << 0,
    Artifact = 1u << 1,
    Person = 1u << 2,
    Plant = 1u << 3,
    Food = 1u << 4,
    Object = 1u << 5,
    Body = 1u << 6,
    Worn = 1u << 7,
    Vehicle = 1u << 8,
    Adjective = 1u << 9,
    Verb = 1u << 10,
    Perhaps = 1u << 11,
    Other = 1u << 12,
    Concrete = Animal | Artifact | Person | Plant | Food | Object | Body | Worn | Vehicle
};

/// A word of a sentence with its base forms; a mark has no letters.
struct Word {
    std::string text;      // lower case, American spelling
    std::string singular;  // "bear" of "bears"; the text itself where it is no plural
    std::string base;      // "wear" of "wearing"; the text itself where it is no such form
    bool mark = false;
};

/// Phrase found at the beginning of some words.
struct Match {
    std::size_t length = 0;  // words; 0 = none
    std::string_view value;  // what it means; the phrase itself where nothing stands behind ">"
    explicit operator bool() const { return length > 0; }
};

/// Longest phrase of the class that the words begin with.
Match match(Class word_class, std::span<const Word> words);

/// Tells whether the phrase is of the class; its meaning.
bool has(Class word_class, std::string_view phrase);
std::optional<std::string_view> meaning(Class word_class, std::string_view phrase);

/// Tells whether the word serves the grammar (articles, prepositions, verbs) or describes; no slip is looked
/// for in it.
bool is_grammatical(std::string_view word);

/// Bits of Kind of one word; 0 for a word that is in no list.
std::uint32_t kinds_of(std::string_view word);

/// Tells whether a noun names an animal, a person or a likeness of one (a statue, a robot): what may stand on
/// a pedestal.
bool names_figure(std::string_view noun);

/// Tells whether a noun names a vessel that plants grow out of (a vase, a flowerpot).
bool names_vessel(std::string_view noun);

/// Tells whether a noun names what another thing stands on or in (a pedestal, a stand, a vessel).
bool names_support(std::string_view noun);

/// Tells whether a noun names a plant that may stand in a vessel.
bool names_potted_plant(std::string_view noun);

/// Tells whether it is an English word, in any form.
bool is_word(std::string_view word);

/// Word with its base forms.
Word word_of(std::string text);

/// "blue-eyed", "gold-rimmed": how a part is, and its name ("blue", "eyes"); empty for other words.
std::pair<std::string, std::string> described_part(std::string_view word);
inline bool describes_part(std::string_view word) { return !described_part(word).second.empty(); }

/// Every word of the lexicon's English classes: what a misspelt word may stand for.
std::span<const std::string_view> spellable_words();

/// Other names of a thing, and the thing: pairs "sweater", "jumper" of the class synonyms.
bool are_synonyms(std::string_view noun, std::string_view other);

}  // namespace gse::language::plan
