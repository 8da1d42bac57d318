// Reading the data of the lexicon once, and looking words up in it.
#include "engine/language/plan/words/lexicon.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/language/plan/words/lexicon_data.h"

namespace gse::language::plan {
namespace {

constexpr std::size_t ClassCount = static_cast<std::size_t>(Class::Count);
// clang-format off
constexpr std::string_view ClassNames[] = {
    "spelling", "article", "definite", "possessive", "another", "all", "none", "some", "number",
    "pronoun_it", "pronoun_person", "pronoun_all", "everything", "everything_else", "something", "nobody",
    "relation", "inverse_relation", "wearing", "holding", "riding", "having", "without", "copula", "modal",
    "negation", "conjunction", "alternative", "contrast", "rather_than", "instead", "sequence", "than",
    "of", "made_of", "into", "from", "to", "like", "relative", "there_is", "degree", "more", "less",
    "most", "as_well", "courtesy", "request", "caption", "noise", "negative_prompt", "prefix",
    "verb_recolour", "verb_shift", "verb_make", "verb_turn", "verb_replace", "verb_swap", "verb_add",
    "verb_give", "verb_dress", "verb_cover", "verb_remove", "verb_relieve", "verb_shave", "verb_undress",
    "verb_empty", "verb_move", "verb_lift", "verb_size", "verb_scale", "verb_double", "verb_rotate",
    "verb_flip", "verb_face", "verb_duplicate", "verb_style", "verb_material", "verb_carve",
    "verb_pattern", "verb_alter", "verb_pose", "verb_raise", "verb_keep", "verb_become", "gone",
    "emerging", "colour", "colour_noun", "shade", "shift", "colour_word", "material", "material_surface",
    "material_sense", "pattern", "pattern_plain", "pattern_animal", "pattern_word", "size", "dimension",
    "times", "direction", "side", "clockwise", "turning", "flipping", "degrees", "unit", "animal_name",
    "person_name", "vehicle_name", "thing_name", "furniture_name", "plant_name", "clothes_name",
    "synonyms", "ground", "ground_name", "place", "backdrop", "environment", "weather_verb", "time_word",
    "style", "style_word", "style_effect", "state", "pose", "where_pose", "pose_manner", "look_word",
    "worn_adjective", "unworn_adjective", "worn", "pair_noun", "part", "body_place", "whole_part", "held",
    "ridden", "container", "floating", "covering", "compound", "masculine", "feminine", "person", "animal",
    "thing", "figure", "fire_words", "fire_verb", "meta_verb", "meta_noun", "meta", "question",
    "question_word", "injection", "narrative", "subordinate", "do_not", "whatever", "never_mind",
    "correction",
    "same_noise", "irregular", "irregular_verb", "foreign", "foreign_weak", "empty", "except",
    "what_stands", "shade_of", "contrast_change", "dressed_as", "only", "unwanted", "hour", "viewer",
    "wish", "verb_around", "verb_fill", "word_a", "word_against", "word_all", "word_and", "word_around",
    "word_as", "word_at", "word_away", "word_by", "word_chop", "word_clear", "word_cut", "word_dark",
    "word_down", "word_during", "word_except", "word_facing", "word_factor", "word_fall", "word_for",
    "word_from", "word_get", "word_give", "word_half", "word_has", "word_have", "word_here",
    "word_horizontally", "word_in", "word_it", "word_its", "word_leave", "word_like", "word_made",
    "word_make", "word_moon", "word_neither", "word_nor", "word_not", "word_nothing", "word_now",
    "word_of", "word_off", "word_on", "word_one", "word_ones", "word_out", "word_place", "word_places",
    "word_position", "word_positions", "word_put", "word_rainbow", "word_remain", "word_remains",
    "word_same", "word_sideways", "word_sky", "word_stars", "word_stay", "word_stays", "word_substitute",
    "word_sun", "word_take", "word_there", "word_throw", "word_times", "word_to", "word_try",
    "word_unchanged", "word_untouched", "word_up", "word_use", "word_vertically", "word_want", "word_wide",
    "word_wipe", "word_with", "word_x", "furniture", "word_version", "word_too", "layer", "seen_by",
    "time_of_day", "said_by", "where_is", "style_kind", "word_where", "word_colored", "part_made",
    "verb_wear", "word_across", "hand", "elision", "adverb", "praise", "verb_off", "word_whose",
    "plain_verb", "word_about", "furniture_flat", "word_into", "word_years", "word_both", "ordinal",
    "word_does", "verb_need", "quality", "heap", "facial_hair", "liked", "verb_toss", "copy_name",
    "modal_not", "weather_goes", "complaint", "word_what", "cloth", "before_place",
    "stuff_of", "place_word", "stuff_noun", "quality_word", "swap_places",
    "past_be", "wholly", "aside", "present",
    "vessel", "potted_plant", "support"};
// clang-format on
static_assert(std::size(ClassNames) == ClassCount);

struct Entry {
    std::vector<std::string_view> words;
    std::string_view phrase, value;
};

struct ClassTable {
    std::unordered_map<std::string_view, std::vector<Entry>> by_first;  // longest first
    std::unordered_map<std::string_view, std::string_view> values;
    bool is_verb = false;
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view Blanks = " \n\t\r";
    const auto begin = text.find_first_not_of(Blanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(Blanks) - begin + 1);
}

/// Calls `each` for every piece between separators, blanks around it left out.
template <class F> void for_pieces(std::string_view text, std::string_view separator, F&& each) {
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        const auto piece = trimmed(text.substr(begin, end - begin));
        if (!piece.empty()) each(piece);
        begin = end + separator.size();
    }
}

/// Tables of both files; views point into the compiled-in text.
class Tables {
public:
    Tables() {
        read_lexicon();
        read_words();
        for (auto& table : classes)
            for (auto& [first, entries] : table.by_first)
                std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
                    return a.words.size() > b.words.size();
                });
        std::sort(spellable.begin(), spellable.end());
        spellable.erase(std::unique(spellable.begin(), spellable.end()), spellable.end());
    }

    std::array<ClassTable, ClassCount> classes;
    std::unordered_map<std::string_view, std::uint32_t> kinds;
    std::unordered_set<std::string_view> english, verbs;
    std::vector<std::string_view> spellable;
    std::vector<std::vector<std::string_view>> synonyms;

private:
    void read_lexicon() {
        std::size_t current = ClassCount;
        std::string_view rest = lexicon_text();
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            std::string_view line = rest.substr(0, end);
            rest.remove_prefix(std::min(end + 1, rest.size()));
            if (line.starts_with('#')) continue;
            const auto colon = line.find(':');
            if (colon != std::string_view::npos && line.find_first_of(" ,>") > colon) {
                const auto name =
                    std::find(std::begin(ClassNames), std::end(ClassNames), line.substr(0, colon));
                current = static_cast<std::size_t>(name - std::begin(ClassNames));
                line.remove_prefix(colon + 1);
            }
            if (current < ClassCount)
                for_pieces(line, ",", [&](std::string_view entry) { add(current, entry); });
        }
    }

    void add(std::size_t number, std::string_view text) {
        const auto kind = static_cast<Class>(number);
        if (kind == Class::synonyms) {
            auto& group = synonyms.emplace_back();
            for_pieces(text, ">", [&](std::string_view name) { group.push_back(name); });
        }
        const auto arrow = text.find(" > ");
        Entry entry;
        entry.phrase = trimmed(text.substr(0, arrow));
        entry.value = arrow == std::string_view::npos ? entry.phrase : trimmed(text.substr(arrow + 3));
        for_pieces(entry.phrase, " ", [&](std::string_view word) { entry.words.push_back(word); });
        auto& table = classes[number];
        table.is_verb = ClassNames[number].starts_with("verb_") || kind == Class::emerging ||
                        kind == Class::fire_verb || kind == Class::meta_verb || kind == Class::holding;
        table.values.emplace(entry.phrase, entry.value);
        if (table.is_verb) verbs.insert(entry.words.front());
        if (kind != Class::foreign && kind != Class::foreign_weak) {
            for (const auto& word : entry.words) {
                english.insert(word);
                if (word.size() > 2 && is_corrected_to(kind)) spellable.push_back(word);
            }
        }
        const auto first = entry.words.front();
        table.by_first[first].push_back(std::move(entry));
    }

    /// Chat, noise and foreign words attract no misspelt word.
    static bool is_corrected_to(Class kind) {
        switch (kind) {
            case Class::spelling:
            case Class::meta:
            case Class::noise:
            case Class::injection:
            case Class::narrative:
            case Class::meta_noun:
            case Class::meta_verb:
            case Class::irregular:
            case Class::request:
            case Class::courtesy:
            case Class::caption:
            case Class::never_mind:
            case Class::subordinate:
            case Class::as_well:
            case Class::correction: return false;
            default: return true;
        }
    }

    void read_words() {
        constexpr std::pair<std::string_view, std::uint32_t> Kinds[] = {
            {"animal:", Animal},   {"artifact:", Artifact},   {"person:", Person}, {"plant:", Plant},
            {"food:", Food},       {"object:", Object},       {"body:", Body},     {"worn:", Worn},
            {"vehicle:", Vehicle}, {"adjective:", Adjective}, {"verb:", Verb},     {"perhaps:", Perhaps},
            {"other:", Other}};
        std::uint32_t kind = 0;
        std::string_view rest = words_text();
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find_first_of(" \n"), rest.size());
            const auto word = rest.substr(0, end);
            if (word == "#") {
                rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
                continue;
            }
            rest.remove_prefix(std::min(end + 1, rest.size()));
            const auto* named = std::find_if(std::begin(Kinds), std::end(Kinds),
                                             [&](const auto& each) { return each.first == word; });
            if (named != std::end(Kinds)) kind = named->second;
            else if (!word.empty()) kinds[word] |= kind;
        }
    }
};

const Tables& tables() {
    static const Tables Data;
    return Data;
}

bool fits(const Entry& entry, std::span<const Word> words, bool is_verb) {
    if (entry.words.size() > words.size()) return false;
    for (std::size_t i = 0; i < entry.words.size(); ++i) {
        const auto& word = words[i];
        const auto wanted = entry.words[i];
        const bool last = i + 1 == entry.words.size();
        if (wanted == word.text || (last && !is_verb && wanted == word.singular) ||
            (i == 0 && is_verb && wanted == word.base))
            continue;
        return false;
    }
    return true;
}

/// Tells whether it is a noun or a verb that takes endings.
bool takes_ending(std::string_view word, bool verb) {
    const auto& data = tables();
    const auto found = data.kinds.find(word);
    const auto kinds = found == data.kinds.end() ? 0u : found->second;
    if (verb) return (kinds & Kind::Verb) != 0 || data.verbs.contains(word);
    if ((kinds & (Concrete | Perhaps | Other)) != 0) return true;
    constexpr Class Nouns[] = {Class::animal,     Class::person,      Class::thing,      Class::worn,
                               Class::held,       Class::part,        Class::place,      Class::container,
                               Class::plant_name, Class::animal_name, Class::person_name};
    return data.english.contains(word) &&
           (kinds == 0 ||
            std::any_of(std::begin(Nouns), std::end(Nouns), [&](Class kind) { return has(kind, word); }));
}

bool in_tables(std::string_view word) {
    return tables().kinds.contains(word) || tables().english.contains(word);
}

std::string cut(std::string_view word, std::size_t letters, std::string_view ending = {}) {
    return std::string(word.substr(0, word.size() - letters)) + std::string(ending);
}

/// The first of the candidates that is a word, else the text.
std::string first_word(std::string_view text, std::initializer_list<std::string> candidates) {
    for (const auto& each : candidates)
        if (each.size() > 1 && in_tables(each)) return each;
    return std::string(text);
}

std::string singular_of(std::string_view text) {
    if (const auto irregular = meaning(Class::irregular, text)) return std::string(*irregular);
    if (text.size() < 4 || !text.ends_with('s') || text.ends_with("ss") || text.ends_with("us"))
        return std::string(text);
    if (text.ends_with("ies")) return first_word(text, {cut(text, 3, "y"), cut(text, 1)});
    if (text.ends_with("ves")) return first_word(text, {cut(text, 1), cut(text, 3, "f"), cut(text, 3, "fe")});
    if (text.ends_with("es")) return first_word(text, {cut(text, 1), cut(text, 2)});
    return first_word(text, {cut(text, 1)});
}

std::string base_of(std::string_view text) {
    if (const auto irregular = meaning(Class::irregular_verb, text)) return std::string(*irregular);
    const auto doubled = [&](std::size_t ending) {
        const std::size_t size = text.size() - ending;
        return size > 2 && text[size - 1] == text[size - 2] ? cut(text, ending + 1) : std::string();
    };
    if (text.size() > 4 && text.ends_with("ing"))
        return first_word(text, {doubled(3), cut(text, 3, "e"), cut(text, 3)});
    if (text.size() > 3 && text.ends_with("ied")) return first_word(text, {cut(text, 3, "y")});
    if (text.size() > 3 && text.ends_with("ed"))
        return first_word(text, {cut(text, 1), doubled(2), cut(text, 2)});
    if (text.size() > 3 && text.ends_with("ies")) return first_word(text, {cut(text, 3, "y")});
    if (text.size() > 3 && text.ends_with("es")) return first_word(text, {cut(text, 1), cut(text, 2)});
    if (text.size() > 3 && text.ends_with('s') && !text.ends_with("ss"))
        return first_word(text, {cut(text, 1)});
    return std::string(text);
}

}  // namespace

Match match(Class word_class, std::span<const Word> words) {
    const auto& table = tables().classes[static_cast<std::size_t>(word_class)];
    if (words.empty()) return {};
    Match best;
    const auto look = [&](std::string_view first) {
        const auto found = table.by_first.find(first);
        if (found == table.by_first.end()) return;
        for (const auto& entry : found->second)
            if (entry.words.size() > best.length && fits(entry, words, table.is_verb)) {
                best = {entry.words.size(), entry.value};
                return;
            }
    };
    look(words[0].text);
    if (words[0].singular != words[0].text && !table.is_verb) look(words[0].singular);
    if (words[0].base != words[0].text && table.is_verb) look(words[0].base);
    return best;
}

bool has(Class word_class, std::string_view phrase) {
    return tables().classes[static_cast<std::size_t>(word_class)].values.contains(phrase);
}

std::optional<std::string_view> meaning(Class word_class, std::string_view phrase) {
    const auto& values = tables().classes[static_cast<std::size_t>(word_class)].values;
    const auto found = values.find(phrase);
    return found == values.end() ? std::nullopt : std::optional(found->second);
}

bool is_grammatical(std::string_view word) {
    const auto of = [&](Class kind) {
        const auto& values = tables().classes[static_cast<std::size_t>(kind)].values;
        return values.contains(word) || values.contains(base_of(word));
    };
    for (auto kind = static_cast<std::size_t>(Class::article);
         kind <= static_cast<std::size_t>(Class::verb_keep); ++kind)
        if (of(static_cast<Class>(kind))) return true;
    for (const auto kind : {Class::colour, Class::material, Class::size, Class::pattern, Class::colour_word,
                            Class::side, Class::direction, Class::except})
        if (of(kind)) return true;
    return false;
}

std::uint32_t kinds_of(std::string_view word) {
    const auto found = tables().kinds.find(word);
    return found == tables().kinds.end() ? 0 : found->second;
}

namespace {

/// Singular of a noun's last word: "pot" of "plant pots".
std::string head_of(std::string_view noun) {
    return word_of(std::string(noun.substr(noun.find_last_of(' ') + 1))).singular;
}

bool is_of(Class word_class, std::string_view noun) {
    return has(word_class, noun) || has(word_class, head_of(noun));
}

}  // namespace

bool names_figure(std::string_view noun) {
    return (kinds_of(head_of(noun)) & (Animal | Person)) != 0 || is_of(Class::figure, noun);
}

bool names_vessel(std::string_view noun) { return is_of(Class::vessel, noun); }

bool names_support(std::string_view noun) { return names_vessel(noun) || is_of(Class::support, noun); }

bool names_potted_plant(std::string_view noun) { return is_of(Class::potted_plant, noun); }

bool is_word(std::string_view word) {
    if (in_tables(word)) return true;
    const auto singular = singular_of(word), base = base_of(word);
    if (singular != word && takes_ending(singular, false)) return true;
    if (base != word && takes_ending(base, true)) return true;
    if (word.ends_with("ier") && in_tables(cut(word, 3, "y"))) return true;
    if (word.ends_with("er") && (in_tables(cut(word, 1)) || in_tables(cut(word, 2)))) return true;
    if (word.ends_with("est") && (in_tables(cut(word, 2)) || in_tables(cut(word, 3)))) return true;
    if (word.ends_with("ly") && in_tables(cut(word, 2))) return true;
    return word.ends_with("'s") && in_tables(cut(word, 2));
}

std::pair<std::string, std::string> described_part(std::string_view word) {
    const auto hyphen = word.rfind('-');
    if (hyphen == std::string_view::npos || !word.ends_with("ed")) return {};
    const auto how = word.substr(0, hyphen);
    std::string part = cut(word.substr(hyphen + 1), 2);
    if (!has(Class::part, part) && has(Class::part, part + "e")) part += "e";  // "nosed"
    if (part.size() > 2 && part[part.size() - 1] == part[part.size() - 2] && !has(Class::part, part))
        part.pop_back();  // "rimmed"
    const bool described = has(Class::colour, how) || has(Class::material, how) || has(Class::size, how);
    if (!described || !has(Class::part, part)) return {};
    if (has(Class::pair_noun, part + "s")) part += "s";
    return {std::string(how), part};
}

Word word_of(std::string text) {
    Word word;
    word.singular = singular_of(text);
    word.base = base_of(text);
    word.text = std::move(text);
    return word;
}

std::span<const std::string_view> spellable_words() { return tables().spellable; }

bool are_synonyms(std::string_view noun, std::string_view other) {
    if (noun == other) return true;
    return std::any_of(tables().synonyms.begin(), tables().synonyms.end(), [&](const auto& group) {
        return group.front() == noun && std::find(group.begin(), group.end(), other) != group.end();
    });
}

}  // namespace gse::language::plan
