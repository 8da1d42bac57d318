// Noun phrases and descriptions: "the bear's left ear", "two small wooden boxes", "dark blue".
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/words/lexicon.h"
#include "engine/language/plan/words/scene_words.h"

namespace gse::language::plan {

enum class Quality {
    Colour,
    Shift,
    Material,
    Surface,
    Pattern,
    Size,
    State,
    Pose,
    Worn,
    Unworn,
    Side,
    Style,
    Other
};

/// How a thing is, or is to be.
struct Attribute {
    Quality quality = Quality::Other;
    std::string value;   // as an operation has it: "golden", "bigger"
    std::string typed;   // as braces of a new thing have it: "golden", "big"
    std::string colour;  // of a pattern
};

/// Kind of thing that a noun phrase stands for.
enum class Naming { Thing, It, Person, They, Everything, EverythingElse, Something };

struct Phrase {
    Naming naming = Naming::Thing;
    std::string noun;   // singular, or as typed where it is said in plural only; empty: "the red one"
    std::string typed;  // the noun as typed
    std::vector<Attribute> attributes;
    std::string count;  // "2", "some", "all"; empty
    bool definite = false, indefinite = false, another = false, none = false, plural = false;
    bool single = false;             // "a single bear"
    bool some_of = false;            // "one of the bears"
    bool possessive = false;         // "its", "his"
    std::shared_ptr<Phrase> owner;   // "the bear's" ear, ear "of the bear"
    std::vector<Phrase> excepted;    // "everything except the bear"
    std::size_t begin = 0, end = 0;  // words

    bool has_determiner() const {
        return definite || indefinite || another || none || possessive || !count.empty();
    }
};

/// Position in the words of a sentence; reads what stands there.
class Cursor {
public:
    Cursor(std::span<const Word> words, const SceneWords& scene) : words_(words), scene_(&scene) {}

    std::size_t at = 0;
    bool done() const { return at >= words_.size(); }
    /// Words from the position to `end`.
    std::string text_to(std::size_t end) const;
    /// The word before the position; one without letters at the beginning.
    const Word& previous() const;
    /// Tells whether the word before the position names a thing or a place.
    bool is_thing_before() const;
    const Word& word(std::size_t ahead = 0) const;
    std::span<const Word> rest(std::size_t ahead = 0) const;
    Match peek(Class word_class, std::size_t ahead = 0) const { return match(word_class, rest(ahead)); }
    bool is(Class word_class, std::size_t ahead = 0) const { return peek(word_class, ahead).length > 0; }
    /// Steps over a phrase of the class.
    Match take(Class word_class);
    bool take_mark(char mark);
    bool is_mark(std::string_view marks, std::size_t ahead = 0) const;
    /// Tells whether an apostrophe and "s" stand there.
    bool is_owner_mark() const { return word().text == "'s"; }
    bool at_end_of_clause() const;

    /// A description at the position: colours joined by "and", "dark blue", "more wooden", "striped".
    /// `in_phrase`: a noun may follow ("leopard bear").
    bool take_attribute(Attribute& attribute, bool in_phrase);
    /// Descriptions joined by commas and "and".
    std::vector<Attribute> take_attributes();
    /// `split`: the phrase ends behind a thing of the scene ("give the bear wings").
    bool take_phrase(Phrase& phrase, bool split = false);
    /// Words of a noun that begins there; 0 where none does.
    std::size_t noun_length(std::size_t ahead = 0) const;
    bool ends_phrase(std::size_t ahead, bool after_noun) const;
    bool is_scene_noun(std::string_view noun) const;

private:
    bool take_colour(Attribute& attribute, bool in_phrase);
    bool take_pattern(Attribute& attribute, bool in_phrase);
    bool take_style(Attribute& attribute);
    bool take_plain_attribute(Attribute& attribute, bool in_phrase);
    bool take_other_attribute(Attribute& attribute, bool in_phrase);
    bool take_graded(Attribute& attribute);
    bool take_pronoun(Phrase& phrase);
    void take_determiners(Phrase& phrase);
    void take_nouns(Phrase& phrase, bool split, std::size_t length);
    bool take_body(Phrase& phrase, bool split);
    void take_maker(Phrase& phrase);
    void take_owner_behind(Phrase& phrase, bool split = false);
    void take_whole_behind(Phrase& phrase);
    bool describes_to_the_end() const;
    bool reads_as_noun(const Phrase& phrase) const;
    void close_noun(Phrase& phrase, std::size_t begin, std::size_t end) const;
    std::span<const Word> words_;
    const SceneWords* scene_;
};

/// Makes the attribute ask for less of itself: "too long" asks for shorter.
void temper(Attribute& attribute);
/// A new thing as the phrase says it.
Thing thing_of(const Phrase& phrase);
/// Text of an attribute in the braces of a new thing.
std::string brace_text(const Attribute& attribute);

}  // namespace gse::language::plan
