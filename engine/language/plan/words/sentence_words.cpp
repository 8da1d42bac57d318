// Splitting, spelling and language of a sentence.
#include "engine/language/plan/words/sentence_words.h"

#include <algorithm>
#include <cctype>

#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/words/clean_text.h"

namespace gse::language::plan {
namespace {

constexpr std::size_t LongestWord = 20;  // letters of a word that may be mended

bool is_letter(char letter) {
    const auto byte = static_cast<unsigned char>(letter);
    return std::isalnum(byte) != 0 || byte >= 0x80 || letter == '\'' || letter == '-';
}

bool is_number(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.';
    });
}

/// Words with their accents, and marks, in order.
std::vector<std::string> pieces_of(std::string_view text) {
    std::vector<std::string> pieces;
    std::string word;
    const auto flush = [&] {
        while (!word.empty() && (word.front() == '\'' || word.front() == '-')) word.erase(0, 1);
        const bool plural_owner = word.size() > 2 && word.ends_with("s'");
        while (!word.empty() && (word.back() == '\'' || word.back() == '-')) word.pop_back();
        if (!word.empty()) pieces.push_back(word);
        if (plural_owner) pieces.emplace_back("'s");
        word.clear();
    };
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char letter = text[at];
        const bool decimal = letter == '.' && !word.empty() && is_number(word) && at + 1 < text.size() &&
                             std::isdigit(static_cast<unsigned char>(text[at + 1])) != 0;
        const bool unit_begins = !word.empty() && is_number(word) &&
                                 std::isalpha(static_cast<unsigned char>(letter)) != 0 &&
                                 !(letter == 'd' || letter == 'k');
        if (unit_begins) flush();
        if (is_letter(letter) || decimal) {
            word += letter;
            continue;
        }
        flush();
        if (std::isspace(static_cast<unsigned char>(letter)) == 0) pieces.emplace_back(1, letter);
    }
    flush();
    return pieces;
}

void append(std::vector<std::string>& words, std::string_view phrase) {
    for (std::size_t begin = 0; begin < phrase.size();) {
        const std::size_t end = std::min(phrase.find(' ', begin), phrase.size());
        if (end > begin) words.emplace_back(phrase.substr(begin, end - begin));
        begin = end + 1;
    }
}

constexpr std::string_view KeptEndings[] = {"-shaped",  "-colored", "-like", "-style", "-sized",
                                            "-covered", "-looking", "-eyed", "-legged"};

/// One piece as words in American spelling; hyphens that join no known word are blanks.
void spell(std::vector<std::string>& words, const std::string& piece) {
    if (const auto other = meaning(Class::spelling, piece)) return append(words, *other);
    if (piece.size() > 2 && piece.ends_with("'s")) {
        spell(words, piece.substr(0, piece.size() - 2));
        words.emplace_back("'s");
        return;
    }
    const auto hyphen = piece.find('-');
    if (hyphen == std::string::npos || is_word(piece)) {
        words.push_back(piece);
        return;
    }
    std::string american = piece;
    if (const auto at = american.find("colour"); at != std::string::npos) american.erase(at + 4, 1);
    for (const auto ending : KeptEndings)
        if (american.ends_with(ending)) {
            words.push_back(american);
            return;
        }
    if (describes_part(american)) {
        words.push_back(american);
        return;
    }
    std::string joined = piece;
    std::erase(joined, '-');
    if (is_word(joined)) {
        words.push_back(joined);
        return;
    }
    spell(words, piece.substr(0, hyphen));
    if (hyphen + 1 < piece.size()) spell(words, piece.substr(hyphen + 1));
}

/// Calls `each(candidate, cost)` for every text one slip away; cheap ones are what fingers do.
template <class F> void for_slips(std::string_view typed, F&& each) {
    std::string text(typed);
    for (std::size_t i = 0; i + 1 < text.size(); ++i) {
        std::swap(text[i], text[i + 1]);
        each(text, i == 0 ? 2 : 0);
        std::swap(text[i], text[i + 1]);
    }
    for (std::size_t i = 0; i <= typed.size(); ++i)
        for (char letter = 'a'; letter <= 'z'; ++letter) {
            text = typed;
            text.insert(i, 1, letter);
            each(text, i == 0 ? 3 : 1);
            if (i == typed.size()) continue;
            text = typed;
            if (text[i] == letter) continue;
            text[i] = letter;
            each(text, i == 0 ? 5 : 3);
        }
    for (std::size_t i = 0; i < typed.size(); ++i) {
        text = typed;
        text.erase(i, 1);
        const bool doubled = i > 0 && typed[i] == typed[i - 1];
        each(text, doubled ? 1 : i == 0 ? 6 : 3);
    }
}

bool is_spellable(const std::string& word) {
    const auto all = spellable_words();
    return std::binary_search(all.begin(), all.end(), word);
}

}  // namespace

std::vector<std::string> slips_of(std::string_view typed, std::span<const std::string> needed,
                                  std::size_t most) {
    std::vector<std::pair<int, std::string>> found;
    if (typed.size() < 2 || typed.size() > LongestWord) return {};
    for_slips(typed, [&](const std::string& word, int cost) {
        if (word.size() < 3) return;
        const bool is_needed = std::find(needed.begin(), needed.end(), word) != needed.end();
        if (!is_needed && typed.size() < 3 && !has(Class::worn, word)) return;
        const bool usual = has(Class::worn, word) || has(Class::colour, word) || has(Class::ground, word) ||
                           is_grammatical(word) || has(Class::part, word) || has(Class::masculine, word) ||
                           has(Class::feminine, word) || has(Class::held, word);
        if (typed.size() < 4 && !is_needed && !usual) return;  // "exe" is no eve
        if (!is_needed && !is_spellable(word)) {
            const bool other_start = word.front() != typed.front() && cost > 2;  // "kermit" is no hermit
            if (typed.size() < 5 || other_start || !is_word(word)) return;
            cost += 10;
        }
        if (is_needed) cost -= 2;
        // what sentences are made of, before parts of rare names ("bale" of "hay bale")
        if (has(Class::colour, word) || has(Class::worn, word) || is_grammatical(word)) cost -= 1;
        if (has(Class::worn, word) && !has(Class::colour, word)) cost -= 1;
        if (has(Class::modal, word) || has(Class::copula, word)) cost -= 1;
        if (std::none_of(found.begin(), found.end(), [&](const auto& each) { return each.second == word; }))
            found.emplace_back(cost, word);
    });
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> words;
    for (auto& [cost, word] : found)
        if (words.size() < most) words.push_back(std::move(word));
    return words;
}

namespace {

struct Evidence {
    int foreign = 0, weak = 0, english = 0, unknown = 0;
    bool only_foreign = false;  // a weak word that is no English one
};

/// Words by language; those of courtesy are left out before.
Evidence evidence_of(const std::vector<std::string>& pieces) {
    Evidence found;
    std::vector<Word> words;
    for (const auto& piece : pieces) words.push_back({piece, piece, piece, false});
    for (std::size_t at = 0; at < words.size(); ++at) {
        if (const auto polite = match(Class::courtesy, std::span(words).subspan(at))) {
            at += polite.length - 1;
            continue;
        }
        const auto& text = words[at].text;
        if (std::isalpha(static_cast<unsigned char>(text[0])) == 0 &&
            static_cast<unsigned char>(text[0]) < 0x80)
            continue;
        const auto elided = text.find('\'');  // "l'ours", "dell'orso"
        const bool joined = elided != std::string::npos && elided + 2 < text.size() &&
                            has(Class::elision, text.substr(0, elided));
        const bool weak = has(Class::foreign_weak, text), foreign = has(Class::foreign, text) || joined;
        const bool english = is_word(text) || is_word(without_accents(text)) || has(Class::spelling, text);
        if (foreign && !weak && !is_word(text)) ++found.foreign;
        else if (weak || (foreign && is_word(text))) {
            ++found.weak;
            found.only_foreign = found.only_foreign || !is_word(text);
        } else if (english) ++found.english;
        else ++found.unknown;
    }
    return found;
}

bool is_foreign(const std::vector<std::string>& pieces) {
    const auto found = evidence_of(pieces);
    if (found.foreign == 0) return found.only_foreign && found.english == 0 && found.weak > 1;
    return found.foreign + found.unknown + found.weak > found.english || found.foreign >= 2;
}

}  // namespace

/// "right behind the vase", "i just need a hat": says as much without the adverb.
void drop_degrees(std::vector<Word>& words) {
    for (std::size_t i = 1; i + 2 < words.size(); ++i) {  // "right behind the vase"
        const auto before = match(Class::before_place, std::span(words).subspan(i, 1)).length > 0;
        const bool side = match(Class::definite, std::span(words).subspan(i - 1)).length > 0 ||
                          match(Class::possessive, std::span(words).subspan(i - 1)).length > 0 ||
                          match(Class::to, std::span(words).subspan(i - 1)).length > 0 ||
                          match(Class::article, std::span(words).subspan(i - 1)).length > 0;
        if (before && !side && match(Class::place_word, std::span(words).subspan(i + 1)))
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (std::size_t i = 0; i + 2 < words.size(); ++i) {  // "i just need"
        const bool person = words[i].text == "i" || words[i].text == "we";
        if (person && !match(Class::only, std::span(words).subspan(i)) &&
            has(Class::adverb, words[i + 1].text))
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
}

/// "paint only its nose", "make just the hat blue": says as much without the adverb.
void drop_adverbs(std::vector<Word>& words, std::span<const std::string> needed) {
    for (std::size_t i = 0; i + 2 < words.size(); ++i)  // "remove: bear"
        if ((i == 0 || words[i - 1].mark) && has(Class::plain_verb, words[i].text) &&
            words[i + 1].text == ":")
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    for (std::size_t i = 0; i + 1 < words.size(); ++i)  // "a blue blue bear"
        if (words.size() > 3 && words[i].text.size() > 1 && !words[i].mark &&
            words[i].text == words[i + 1].text &&
            std::find(needed.begin(), needed.end(), words[i].text) == needed.end())
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    for (std::size_t i = 0; i + 2 < words.size(); ++i) {
        const auto is_a = [&](std::size_t at, Class kind) {
            return match(kind, std::span(words).subspan(at, 1)).length > 0;
        };
        const bool object = is_a(i + 2, Class::definite) || is_a(i + 2, Class::possessive) ||
                            is_a(i + 2, Class::article) || is_a(i + 2, Class::pronoun_it);
        if (is_a(i, Class::plain_verb) && is_a(i + 1, Class::adverb) && object)
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
}

/// Steps of a list behind slashes, as commas have them: "blue bear / red hat".
std::string with_commas(std::string_view text) {
    std::string commas(text);
    for (std::size_t at = commas.find(" / "); at != std::string::npos; at = commas.find(" / "))
        commas.replace(at, 3, ", ");
    return commas;
}

/// Tells whether what stands there is said of "it", and not owned by it: "it's made of gold".
bool is_predicate(const std::vector<std::string>& pieces, std::size_t at) {
    const auto& word = pieces[at];
    for (const auto kind : {Class::article, Class::negation, Class::degree, Class::like, Class::number})
        if (has(kind, word)) return true;
    const bool last = at + 1 == pieces.size() || std::ispunct(static_cast<unsigned char>(pieces[at + 1][0]));
    const bool participle =
        word == "made" || (word.size() > 4 && word.ends_with("ed")) || word.ends_with("ing");
    const bool describes = has(Class::colour, word) || has(Class::material, word) ||
                           has(Class::state, word) || has(Class::material_surface, word) ||
                           has(Class::size, word);
    return participle || (describes && last);
}

/// "sun glasses", "a t shirt": one word each.
void join_compounds(std::vector<std::string>& words) {
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {  // "sun glasses"
        const auto joined = words[i] + words[i + 1];
        const bool apart = has(Class::worn, words[i] + " " + words[i + 1]) ||
                           has(Class::compound, words[i] + " " + words[i + 1]);
        const bool letter = words[i] == "t" && words[i + 1].starts_with("shirt");  // "a t shirt"
        if (letter) {
            words[i] = "t-" + words[i + 1];
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
            continue;
        }
        if (apart || words[i].size() < 3 || words[i + 1].size() < 3) continue;
        if (!has(Class::worn, joined) && !has(Class::thing, joined) && !has(Class::held, joined)) continue;
        words[i] = joined;
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
}

/// "squeeze it so that it gets narrower": a comma in the place of the joint.
void join_clauses(std::vector<std::string>& words) {
    for (std::size_t i = 2; i + 2 < words.size(); ++i)
        if ((words[i] == "so" || words[i] == "such") && words[i + 1] == "that") {
            words[i] = ",";
            words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        }
}

SentenceWords sentence_words(std::string_view clean, std::span<const std::string> needed) {
    SentenceWords found;
    const auto pieces = pieces_of(with_commas(clean));
    if (is_foreign(pieces)) {
        found.refused = reason::Language;
        return found;
    }
    std::vector<std::string> words;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const auto piece = without_accents(pieces[i]);
        if (piece == "it's" && i + 1 < pieces.size() && is_predicate(pieces, i + 1)) append(words, "it is");
        else spell(words, piece);
    }
    join_compounds(words);
    join_clauses(words);
    for (auto& word : words) {
        const bool letters = std::isalpha(static_cast<unsigned char>(word[0])) != 0;
        const bool is_needed = std::find(needed.begin(), needed.end(), word) != needed.end();
        if (letters && !is_word(word) && !is_needed && word.find('-') == std::string::npos) {
            auto others = slips_of(word, needed, found.words.empty() ? 5 : 1);
            const auto verb = std::find_if(others.begin(), others.end(), [](const std::string& other) {
                return has(Class::plain_verb, other);  // the first word is mostly an order: "mak it blue"
            });
            if (verb != others.end()) word = *verb;
            else if (!others.empty())
                word = meaning(Class::spelling, others.front()).value_or(others.front());
            else found.unknown.push_back(word);
        }
        auto made = word_of(word);
        made.mark = !letters && std::isdigit(static_cast<unsigned char>(word[0])) == 0 && word != "'s" &&
                    word != "%" && static_cast<unsigned char>(word[0]) < 0x80;
        found.words.push_back(std::move(made));
    }
    drop_degrees(found.words);
    drop_adverbs(found.words, needed);
    const auto letters = static_cast<std::size_t>(
        std::count_if(found.words.begin(), found.words.end(), [](const Word& word) { return !word.mark; }));
    if (letters > 0 && found.unknown.size() * 2 >= letters) {
        const bool pronounced =
            std::any_of(found.unknown.begin(), found.unknown.end(),
                        [](const std::string& word) { return static_cast<unsigned char>(word[0]) >= 0x80; });
        found.refused = pronounced ? reason::Language : reason::NotASentence;
    }
    return found;
}

}  // namespace gse::language::plan
