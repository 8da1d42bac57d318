// Reading noun phrases.
#include "engine/language/plan/phrases/phrase.h"

#include <algorithm>
#include <cctype>

namespace gse::language::plan {
namespace {

const Word NoWord{};

constexpr Class EndingClasses[] = {Class::relation,    Class::inverse_relation,
                                   Class::wearing,     Class::having,
                                   Class::without,     Class::made_of,
                                   Class::of,          Class::into,
                                   Class::to,          Class::from,
                                   Class::like,        Class::relative,
                                   Class::than,        Class::contrast,
                                   Class::rather_than, Class::conjunction,
                                   Class::article,     Class::definite,
                                   Class::possessive,  Class::negation,
                                   Class::there_is,    Class::modal,
                                   Class::pronoun_it,  Class::pronoun_person,
                                   Class::alternative, Class::all,
                                   Class::some};

/// Classes that end a phrase when its noun is there already: "the bear smile", "the bear upside down".
constexpr Class EndingAfterNoun[] = {
    Class::copula,  Class::pose,        Class::verb_pose,   Class::look_word,  Class::emerging,
    Class::gone,    Class::direction,   Class::flipping,    Class::turning,    Class::degree,
    Class::as_well, Class::holding,     Class::riding,      Class::times,      Class::more,
    Class::less,    Class::verb_become, Class::verb_keep,   Class::instead,    Class::courtesy,
    Class::number,  Class::another,     Class::fire_words,  Class::clockwise,  Class::verb_face,
    Class::none,    Class::sequence,    Class::subordinate, Class::word_there, Class::word_does};

constexpr Class NounClasses[] = {
    Class::compound,    Class::worn,         Class::held,         Class::part,        Class::ground,
    Class::place,       Class::thing,        Class::person,       Class::animal,      Class::container,
    Class::ridden,      Class::floating,     Class::pair_noun,    Class::ground_name, Class::backdrop,
    Class::animal_name, Class::person_name,  Class::vehicle_name, Class::thing_name,  Class::furniture_name,
    Class::plant_name,  Class::clothes_name, Class::colour_word,  Class::pattern_word};

std::string joined_texts(std::span<const Word> words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word.text;
    return text;
}

bool is_count(std::string_view text) {
    return !text.empty() && text.size() < 5 && std::all_of(text.begin(), text.end(), [](char c) {
        return std::isdigit(static_cast<unsigned char>(c)) != 0;
    });
}

constexpr std::string_view AdjectiveEndings[] = {"ful",     "ous",      "ish",   "less",    "-like",
                                                 "-shaped", "-colored", "-eyed", "-legged", "-looking",
                                                 "-sized",  "-covered", "able",  "ible",    "esque"};

bool looks_like_adjective(std::string_view word) {
    return std::any_of(
        std::begin(AdjectiveEndings), std::end(AdjectiveEndings),
        [&](std::string_view ending) { return word.size() > ending.size() + 2 && word.ends_with(ending); });
}

}  // namespace

const Word& Cursor::word(std::size_t ahead) const {
    return at + ahead < words_.size() ? words_[at + ahead] : NoWord;
}

const Word& Cursor::previous() const { return at > 0 && at <= words_.size() ? words_[at - 1] : NoWord; }

std::string Cursor::text_to(std::size_t end) const { return joined_texts(words_.subspan(at, end - at)); }

bool Cursor::is_thing_before() const {
    const auto& word = previous();
    return !word.mark && !word.text.empty() && !is_scene_noun(word.singular) &&
           ((kinds_of(word.singular) & (Concrete | Other | Perhaps)) != 0 || has(Class::ground, word.text) ||
            has(Class::place, word.text));
}

std::span<const Word> Cursor::rest(std::size_t ahead) const {
    return at + ahead < words_.size() ? words_.subspan(at + ahead) : std::span<const Word>();
}

Match Cursor::take(Class word_class) {
    const auto found = peek(word_class);
    at += found.length;
    return found;
}

bool Cursor::is_mark(std::string_view marks, std::size_t ahead) const {
    const auto& here = word(ahead);
    return here.mark && marks.find(here.text[0]) != std::string_view::npos;
}

bool Cursor::take_mark(char mark) {
    if (!is_mark(std::string_view(&mark, 1))) return false;
    ++at;
    return true;
}

bool Cursor::at_end_of_clause() const { return done() || is_mark(".,;!?:"); }

bool Cursor::is_scene_noun(std::string_view noun) const {
    return std::any_of(scene_->things.begin(), scene_->things.end(), [&](const SceneThing& thing) {
        const auto blank = thing.noun.rfind(' ');
        return thing.noun == noun || (blank != std::string::npos && thing.noun.substr(blank + 1) == noun);
    });
}

std::size_t Cursor::noun_length(std::size_t ahead) const {
    std::size_t longest = 0;
    const auto here = rest(ahead);
    if (here.empty() || here[0].mark) return 0;
    for (const auto kind : NounClasses) longest = std::max(longest, match(kind, here).length);
    for (const auto& thing : scene_->things) {
        const auto count =
            static_cast<std::size_t>(std::count(thing.noun.begin(), thing.noun.end(), ' ')) + 1;
        if (count > longest && count <= here.size()) {
            const auto first = joined_texts(here.first(count));
            const auto last = count > 1 ? joined_texts(here.first(count - 1)) + " " + here[count - 1].singular
                                        : here[0].singular;
            if (first == thing.noun || last == thing.noun) longest = count;
        }
    }
    if (longest > 0) return longest;
    constexpr std::uint32_t Nouns = Concrete | Perhaps | Other;
    const auto kinds = kinds_of(here[0].singular);
    if ((kinds & Nouns) != 0) return 1;
    if ((kinds & Kind::Verb) != 0 && here[0].text.ends_with('r')) return 1;
    return 0;
}

bool Cursor::ends_phrase(std::size_t ahead, bool after_noun) const {
    if (word(ahead).text.empty() || word(ahead).mark) return true;
    if (!after_noun && peek(Class::compound, ahead).length > 1) return false;  // "a red sports car"
    const bool describes = peek(Class::relation, ahead).length == 1 && peek(Class::state, ahead) &&
                           noun_length(ahead + 1) > 0 && !after_noun;  // "round window"
    const bool part = !after_noun && at + ahead > 0 && has(Class::definite, words_[at + ahead - 1].text) &&
                      peek(Class::part, ahead) && peek(Class::of, ahead + 1);  // "the inside of its ears"
    for (const auto kind : EndingClasses)
        if (peek(kind, ahead) && !describes && !part) return true;
    if (!after_noun) return peek(Class::copula, ahead).length > 0 && noun_length(ahead) == 0;
    const bool thing = (kinds_of(word(ahead).text) & Concrete) != 0;
    const bool owner = at + ahead > 0 && is_scene_noun(words_[at + ahead - 1].singular);  // "the bear fly"
    for (const auto kind : EndingAfterNoun)
        if (peek(kind, ahead) && !(thing && kind == Class::verb_pose && !owner)) return true;
    return false;
}

bool Cursor::take_pronoun(Phrase& phrase) {
    phrase.begin = at;
    constexpr std::pair<Class, Naming> Pronouns[] = {{Class::everything_else, Naming::EverythingElse},
                                                     {Class::everything, Naming::Everything},
                                                     {Class::pronoun_all, Naming::They},
                                                     {Class::pronoun_it, Naming::It},
                                                     {Class::pronoun_person, Naming::Person}};
    for (const auto& [kind, naming] : Pronouns) {
        auto found = peek(kind);
        if (kind == Class::everything && is(Class::word_all) && peek(Class::except, 1)) found.length = 1;
        if (!found) continue;
        // "her hat", "this bear", "the thing on the grass"
        if (naming != Naming::Everything && naming != Naming::EverythingElse) {
            const bool determines = peek(Class::possessive).length == found.length ||
                                    peek(Class::definite).length == found.length;
            Attribute ignored;
            Cursor ahead = *this;
            ahead.at += found.length;
            Cursor how = ahead;  // "make this blue"
            const bool alone = kind == Class::pronoun_it && how.take_attribute(ignored, false) &&
                               how.at_end_of_clause() && ignored.quality == Quality::Colour;
            if (determines && !alone && !ahead.ends_phrase(0, true) &&
                (ahead.noun_length() > 0 || ahead.take_attribute(ignored, true)) &&
                (kind != Class::pronoun_person || ahead.noun_length() > 0))
                continue;
            const auto behind = ahead.peek(Class::relation);
            if (found.length > 1 && (behind || ahead.peek(Class::relative))) continue;
        }
        at += found.length;
        if (kind == Class::pronoun_it && is(Class::word_all)) {
            ++at;
            phrase.naming = Naming::They;
            phrase.end = at;
            return true;
        }
        if (kind == Class::pronoun_all && is(Class::word_all)) ++at;
        phrase.naming = naming;
        phrase.definite = true;
        phrase.end = at;
        if (naming == Naming::Everything && peek(Class::except)) {
            Cursor ahead = *this;
            ahead.take(Class::except);
            Phrase excepted;
            if (ahead.take_phrase(excepted)) {
                phrase.excepted.push_back(excepted);
                at = ahead.at;
                while (ahead.take_mark(','), ahead.take(Class::conjunction), ahead.at > at) {
                    if (!ahead.take_phrase(excepted) || excepted.noun.empty() || !excepted.definite ||
                        !ahead.at_end_of_clause())
                        break;
                    phrase.excepted.push_back(excepted);
                    at = ahead.at;
                }
                phrase.end = at;
            }
        }
        return true;
    }
    return false;
}

void Cursor::take_determiners(Phrase& phrase) {
    while (!done()) {
        const bool graded =
            (phrase.indefinite && !phrase.single) || (peek(Class::colour, 1) && noun_length(2) == 0);
        if (peek(Class::more) && graded && phrase.count.empty()) break;  // "more red", "a more colorful bear"
        if (const auto found = peek(Class::number); found && found.length >= peek(Class::some).length &&
                                                    !(found.length == 1 && word(1).text.empty())) {
            at += found.length;
            phrase.count = found.value;
            if (found.value == "1") phrase.count.clear(), phrase.single = true, phrase.indefinite = true;
        } else if (is_count(word().text) && !peek(Class::unit, 1) && !peek(Class::degrees, 1)) {
            phrase.count = word().text;
            if (phrase.count == "1") phrase.count.clear(), phrase.single = true;
            ++at;
            if (is(Class::word_x) && word(1).text.size() > 1) ++at;
        } else if (take(Class::another)) phrase.another = true;
        else if (take(Class::all)) phrase.count = "all", phrase.definite = true;
        else if (take(Class::none)) phrase.none = true;
        else if (take(Class::some)) phrase.count = "some";
        else if (const auto degree = peek(Class::degree);
                 is(Class::word_a) && (degree.length > 2 || (degree.length == 2 && !is(Class::size, 1))))
            at += degree.length;  // "a little bit bluer"
        else if (take(Class::article)) phrase.indefinite = true;
        else if (peek(Class::definite)) take(Class::definite), phrase.definite = true;
        else if (take(Class::possessive)) phrase.possessive = true;
        else if (peek(Class::of) && phrase.count == "all") take(Class::of);
        else if (peek(Class::of) && (phrase.single || !phrase.count.empty()) &&
                 (peek(Class::definite, 1) || peek(Class::possessive, 1))) {  // "one of the bears"
            at += 2;
            phrase.some_of = true;
            phrase.indefinite = false;
        } else if (take(Class::caption)) {
        } else if (phrase.indefinite && !noun_length() && peek(Class::quality_word) &&
                   !ends_phrase(peek(Class::quality_word).length, false)) {
            take(Class::quality_word);  // "a hyperrealistic golden bear"
        } else break;
    }
}

void Cursor::close_noun(Phrase& phrase, std::size_t begin, std::size_t end) const {
    const auto typed = words_.subspan(begin, end - begin);
    phrase.typed = joined_texts(typed);
    if (has(Class::pair_noun, phrase.typed) || has(Class::pair_noun, typed.back().text))
        phrase.noun = phrase.typed;
    else {
        phrase.noun = typed.size() > 1
                          ? joined_texts(typed.first(typed.size() - 1)) + " " + typed.back().singular
                          : typed.back().singular;
        if (const auto named = meaning(Class::compound, phrase.noun)) phrase.noun = *named;
    }
    // "stacks of books": the first noun is in plural
    if (typed.size() > 2 && phrase.typed.find(" of ") != std::string::npos)
        phrase.noun = typed.front().singular + phrase.typed.substr(typed.front().text.size());
    const bool of = typed.size() > 2 && phrase.typed.find(" of ") != std::string::npos;
    const auto& head = of ? typed.front() : typed.back();
    phrase.plural = head.text != head.singular;
    phrase.end = end;
}

bool Cursor::reads_as_noun(const Phrase& phrase) const {
    if (peek(Class::colour).length > 1) return false;  // "a grass green bear"
    if (is_scene_noun(word().singular)) return true;
    if (peek(Class::colour) && is(Class::colour_word, 1)) return false;  // "a violet color"
    bool last = ends_phrase(1, true);
    const std::size_t length = noun_length();
    if (length > 1) return true;
    if (Cursor colours = *this; peek(Class::colour) && is(Class::word_and, 1) && peek(Class::colour, 2)) {
        Attribute both;  // "an orange and black bear"
        if (colours.take_colour(both, true) && colours.at > at + 2 && colours.noun_length() > 0) return false;
    }
    const bool compound = has(Class::held, word(1).singular) || has(Class::thing, word(1).singular);
    if (!last && length == 1 && !compound) {  // "the animal blue": what follows describes and ends the clause
        Cursor ahead = *this, whole = *this;
        Attribute behind;
        ++ahead.at;
        const bool describes =
            ahead.take_attribute(behind, false) && (ahead.at_end_of_clause() || ahead.ends_phrase(0, true));
        last = describes && !(whole.take_attribute(behind, false) && whole.at > at + 1) &&
               !ahead.is_scene_noun(word(1).singular);
    }
    if (!last || length == 0) {
        // two nouns of which the first is also an adjective: "gold fish" describes
        return false;
    }
    if (has(Class::ground, word().text) || has(Class::ground, word().singular)) return true;
    const auto kinds = kinds_of(word().singular);
    bool things = (kinds & Concrete) != 0;
    for (const auto kind :
         {Class::thing, Class::worn, Class::held, Class::floating, Class::animal_name, Class::person_name,
          Class::vehicle_name, Class::plant_name, Class::clothes_name, Class::thing_name, Class::part})
        things = things || peek(kind);
    const bool plural = word().text != word().singular;
    if (phrase.attributes.empty() && !phrase.has_determiner())
        return things && (plural || !has(Class::material, word().text)) && !has(Class::colour, word().text) &&
               !has(Class::size, word().text) && !has(Class::state, word().text) &&
               !has(Class::pattern_plain, word().text) && !has(Class::pose, word().text);
    if (!things) return false;
    if (phrase.indefinite && has(Class::pattern_plain, word().text) && has(Class::thing, word().text) &&
        phrase.attributes.empty())
        return true;  // "a rainbow"
    // "a darker red", "the blue": colours that name no thing
    if (has(Class::size, word().text) || has(Class::state, word().text) ||
        has(Class::pattern_plain, word().text) || has(Class::pose, word().text))
        return false;
    return !has(Class::colour, word().text) || peek(Class::thing) || peek(Class::held) ||
           (kinds & (Plant | Food | Animal)) != 0;
}

/// Tells whether nothing but a colour, a ground, a material or a pattern stands before the end.
bool Cursor::describes_to_the_end() const {
    Attribute shade;  // "light blue"
    if (Cursor behind = *this; has(Class::shade, word().text) && behind.take_colour(shade, false) &&
                               (behind.at_end_of_clause() || behind.peek(Class::conjunction)))
        return true;
    for (const auto kind : {Class::colour, Class::ground, Class::material, Class::pattern}) {
        Cursor behind = *this;
        if (behind.take(kind) && (behind.at_end_of_clause() || behind.peek(Class::conjunction) ||
                                  (kind == Class::colour && behind.peek(Class::having))))
            return true;
    }
    return false;
}

/// Nouns one behind the other: "fire truck".
void Cursor::take_nouns(Phrase& phrase, bool split, std::size_t length) {
    const std::size_t begin = at;
    at += length;
    while (!done() && !ends_phrase(0, true)) {
        const auto so_far = joined_texts(words_.subspan(begin, at - begin));
        const bool owner = is_scene_noun(words_[at - 1].singular);
        if (owner && word().text.ends_with("ing") && peek(Class::possessive, 1))
            break;  // "scratching its back"
        const bool raises = peek(Class::verb_raise).length == 1 && peek(Class::possessive, 1);
        if (owner && (raises || peek(Class::swap_places))) break;  // "the bear raises its arms"
        if (owner && peek(Class::verb_face) && (peek(Class::direction, 1) || peek(Class::definite, 1))) break;
        const bool telegraphic =  // "bear hat": it wears one
            owner && at == begin + 1 && !phrase.has_determiner() && phrase.attributes.empty() &&
            peek(Class::worn) && !is_scene_noun(word().singular) && begin == 0;
        if (telegraphic) break;
        if (owner &&
            (split || peek(Class::part) || peek(Class::colour_word) || is_scene_noun(word().singular)))
            break;
        const bool part =
            has(Class::part, words_[at - 1].singular) && peek(Class::colour);  // "its beak orange"
        if ((owner || part) && describes_to_the_end())
            break;  // "make the bear violet", "make the grass gravel"
        Attribute ignored;
        Cursor ahead = *this;
        const std::size_t more = noun_length();
        if (more == 0) break;
        if (more == 1 && !is_scene_noun(word().singular) && ahead.take_attribute(ignored, false) &&
            !peek(Class::thing) && !peek(Class::person))
            break;
        at += more;
    }
    close_noun(phrase, begin, at);
}

bool Cursor::take_body(Phrase& phrase, bool split) {
    const std::size_t start = at;
    while (!done()) {
        const bool comma_list = is_mark(",") && !phrase.attributes.empty();
        if (comma_list) {  // "a big, round bear"
            Cursor ahead = *this;
            ++ahead.at;
            Attribute next;
            if (ahead.ends_phrase(0, false) || ahead.reads_as_noun(phrase) ||
                !ahead.take_attribute(next, true))
                break;
            while (ahead.is_mark(",")) {  // "long, white, curly hair"
                ++ahead.at;
                if (ahead.ends_phrase(0, false) || !ahead.take_attribute(next, true)) break;
            }
            if (ahead.noun_length() == 0) break;
            ++at;
        }
        if (ends_phrase(0, false)) break;
        Attribute attribute;
        const std::size_t before = at;
        if (!reads_as_noun(phrase) && take_attribute(attribute, true)) {
            phrase.attributes.push_back(attribute);
            if (is(Class::word_and) && !ends_phrase(1, false)) {  // "a big and round bear"
                Cursor ahead = *this;
                ++ahead.at;
                Attribute next;
                if (!ahead.reads_as_noun(phrase) && ahead.take_attribute(next, true) &&
                    ahead.noun_length() > 0 && !ahead.ends_phrase(0, false))
                    ++at;
            }
            continue;
        }
        at = before;
        const std::size_t length = noun_length();
        if (length == 0) {
            if (!ends_phrase(0, false) && looks_like_adjective(word().text)) {
                phrase.attributes.push_back({Quality::Other, word().text, word().text, ""});
                ++at;
                continue;
            }
            const bool tows = phrase.indefinite && phrase.attributes.empty() && !ends_phrase(0, false) &&
                              (kinds_of(word().text) & Kind::Verb) != 0 && noun_length(1) == 1 &&
                              (kinds_of(word(1).singular) & Concrete) != 0 && ends_phrase(2, true);
            if (!tows) break;
            take_nouns(phrase, split, 2);  // "a tow truck"
            return true;
        }
        take_nouns(phrase, split, length);
        return true;
    }
    phrase.end = at;
    if (at > start && (phrase.attributes.size() > 0) && (phrase.definite || phrase.has_determiner()))
        return true;  // "the red one", "the red"
    return false;
}

/// "a witch's hat": a kind of hat, of no witch.
void Cursor::take_maker(Phrase& phrase) {
    const bool kind = phrase.indefinite && phrase.attributes.empty() && !is_scene_noun(phrase.noun) &&
                      (kinds_of(phrase.noun) & (Person | Animal)) != 0;
    if (!kind || !is_owner_mark()) return;
    Cursor ahead = *this;
    ++ahead.at;
    Phrase made;
    if (!ahead.take_body(made, false) || made.noun.empty() || !made.attributes.empty()) return;
    phrase.noun += "'s " + made.noun;
    phrase.typed += "'s " + made.typed;
    phrase.plural = made.plural;
    at = ahead.at;
    phrase.end = at;
}

void Cursor::take_owner_behind(Phrase& phrase, bool split) {
    Cursor behind = *this;  // "give the bear wings": no wings of the bear
    if (split && behind.take(Class::part) && (behind.at_end_of_clause() || behind.peek(Class::conjunction)))
        return;
    const bool plural_owner = phrase.plural && is_scene_noun(words_[at - 1].singular) && peek(Class::part) &&
                              !ends_phrase(0, false);
    const bool bare_owner =
        is_scene_noun(phrase.noun) &&
        (peek(Class::part) || (peek(Class::colour_word) && !peek(Class::look_word))) &&
        !ends_phrase(0, false) && !peek(Class::direction) && !peek(Class::times) &&
        !(peek(Class::verb_face) && (peek(Class::direction, 1) || peek(Class::definite, 1))) &&
        !peek(Class::pose) && !peek(Class::state);
    if (is_owner_mark() || plural_owner || bare_owner) {
        const std::size_t mark = at;
        if (is_owner_mark()) ++at;
        Phrase owned;
        owned.begin = phrase.begin;
        owned.definite = true;
        const std::size_t before = at;
        if (take(Class::all)) owned.count = "all";
        if (take_body(owned, false) && !owned.noun.empty()) {
            auto owner = std::make_shared<Phrase>(phrase);
            owner->plural = false;
            owned.owner = owner;
            owned.definite = true;
            phrase = owned;
            take_owner_behind(phrase);
            return;
        }
        Cursor said = *this;  // "the bear's blue", where nothing is owned
        said.at = before;
        const auto attributes = said.take_attributes();
        const bool described = !attributes.empty() &&
                               std::none_of(attributes.begin(), attributes.end(), [](const Attribute& each) {
                                   return each.quality == Quality::Other;
                               });
        at = described ? before : mark;
        return;
    }
    take_whole_behind(phrase);
}

/// "(ear) of the bear", "(bowl) of fruit".
void Cursor::take_whole_behind(Phrase& phrase) {
    if (!peek(Class::of)) return;
    Cursor ahead = *this;
    ahead.take(Class::of);
    Phrase whole;
    const bool holds = has(Class::container, phrase.noun) || has(Class::held, phrase.noun);
    const bool many = ahead.word().text != ahead.word().singular && !is_scene_noun(phrase.noun) &&
                      (!has(Class::part, phrase.noun) || has(Class::worn, phrase.noun));
    if (!ahead.take_phrase(whole) && (holds || many) && ahead.noun_length() > 0) {  // "a bowl of honey"
        whole.noun = whole.typed = ahead.word().text;
        ++ahead.at;
    } else if (Attribute stuff;
               ahead.at == at + 1 && has(Class::layer, phrase.noun) && ahead.take_attribute(stuff, false)) {
        phrase.noun = phrase.typed = "paint";  // "a coat of gold"
        phrase.attributes = {stuff};
        at = ahead.at;
        phrase.end = at;
        return;
    } else if (ahead.at == at + 1) return;
    if (has(Class::layer, phrase.noun) && has(Class::colour_word, whole.noun) && !whole.attributes.empty()) {
        phrase.noun = phrase.typed = whole.noun;  // "a coat of white paint"
        phrase.attributes = whole.attributes;
        at = ahead.at;
        phrase.end = at;
        return;
    }
    const bool part = has(Class::part, phrase.noun) || has(Class::part, words_[phrase.end - 1].singular) ||
                      has(Class::colour_word, phrase.noun) || has(Class::part, phrase.typed) ||
                      has(Class::quality, phrase.noun);
    if ((part && (whole.definite || whole.possessive || whole.naming != Naming::Thing ||
                  is_scene_noun(whole.noun))) ||
        whole.naming == Naming::It || (is_scene_noun(phrase.noun) && is_scene_noun(whole.noun))) {
        phrase.owner = std::make_shared<Phrase>(whole);
        phrase.definite = true;
        at = ahead.at;
        phrase.end = at;
    } else if (!whole.definite && whole.naming == Naming::Thing && !whole.noun.empty() &&
               (!has(Class::material, whole.noun) ||
                (whole.plural && (has(Class::heap, phrase.noun) || has(Class::worn, phrase.noun)))) &&
               (!part || has(Class::worn, phrase.noun)) &&
               ((kinds_of(words_[phrase.end - 1].singular) & (Artifact | Perhaps | Other | Object)) != 0 ||
                has(Class::thing, phrase.noun)) &&
               (!is_scene_noun(phrase.noun) || whole.indefinite)) {
        phrase.noun += " of " + (whole.typed.empty() ? whole.noun : whole.typed);  // "bowl of fruit"
        at = ahead.at;
        phrase.end = at;
    }
}

bool Cursor::take_phrase(Phrase& phrase, bool split) {
    const std::size_t start = at;
    phrase = {};
    phrase.begin = at;
    while (take(Class::caption)) {}
    if (take_pronoun(phrase)) return true;
    take_determiners(phrase);
    if (phrase.has_determiner() && take_pronoun(phrase)) return true;  // "all of it"
    if (!take_body(phrase, split)) {
        at = start;
        return false;
    }
    phrase.begin = start;
    if (phrase.noun.empty()) {
        if (is(Class::word_one) || is(Class::word_ones)) ++at;
    } else if (has(Class::thing_name, phrase.noun) && (phrase.noun == "one" || phrase.noun == "ones"))
        phrase.noun.clear();
    if (phrase.some_of && phrase.single) phrase.plural = false;
    take_maker(phrase);
    take_owner_behind(phrase, split);
    if (phrase.definite && !phrase.owner) {  // "the car on the left"
        const auto side = peek(Class::direction);
        if (side.length > 2 && (is(Class::word_on) || is(Class::word_at) || is(Class::word_in)) &&
            has(Class::side, side.value) && !peek(Class::of, side.length)) {
            phrase.attributes.push_back(
                {Quality::Side, std::string(side.value), std::string(side.value), ""});
            at += side.length;
        }
    }
    phrase.end = at;
    return true;
}

}  // namespace gse::language::plan
