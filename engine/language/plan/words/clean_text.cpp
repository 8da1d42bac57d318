// Characters of a sentence: Unicode by ICU, and the noise of prompts.
#include "engine/language/plan/words/clean_text.h"

#include <unicode/locid.h>
#include <unicode/normalizer2.h>
#include <unicode/uchar.h>
#include <unicode/unistr.h>
#include <unicode/uscript.h>

#include <array>
#include <regex>

#include "engine/language/plan/notation/plan.h"

namespace gse::language::plan {
namespace {

constexpr std::size_t LongestText = 4000;  // bytes; longer ones are no sentence

/// Typographic characters that the compatibility forms of Unicode do not make plain.
UChar32 plain(UChar32 code) {
    switch (code) {
        case 0x00b4:
        case 0x0060:
        case 0x2018:
        case 0x2019:
        case 0x02bc:
        case 0x2032: return '\'';
        case 0x201a:
        case 0x201c:
        case 0x201d:
        case 0x201e:
        case 0x00ab:
        case 0x00bb:
        case '"': return ' ';
        case 0x2013:
        case 0x2014:
        case 0x2015: return 0x2014;
        case 0x2022:
        case 0x00b7:
        case '\n':
        case '\r':
        case 0x2028:
        case 0x2029: return '\n';
        case 0x2192:
        case 0x21d2: return '>';
        case 0x00b0: return code;
        default: return code;
    }
}

bool is_picture(UChar32 code) {
    const auto kind = u_charType(code);
    return code > 0x2000 && (kind == U_OTHER_SYMBOL || kind == U_MODIFIER_SYMBOL || code >= 0x1f000);
}

struct Characters {
    icu::UnicodeString text;
    bool foreign_script = false, has_letters = false;
};

Characters characters_of(std::string_view utf8) {
    icu::UnicodeString mapped;
    const auto raw =
        icu::UnicodeString::fromUTF8(icu::StringPiece(utf8.data(), static_cast<int32_t>(utf8.size())));
    for (int32_t at = 0; at < raw.length(); at = raw.moveIndex32(at, 1)) {
        const UChar32 code = plain(raw.char32At(at));
        if (u_hasBinaryProperty(code, UCHAR_DEFAULT_IGNORABLE_CODE_POINT) || code == 0xfffd) continue;
        if (is_picture(code)) mapped.append(static_cast<UChar32>(0x2606));  // one sign for all of them
        else if (code != '\n' && u_iscntrl(code)) mapped.append(static_cast<UChar32>(' '));
        else mapped.append(code);
    }
    Characters found;
    UErrorCode error = U_ZERO_ERROR;
    const auto* compose = icu::Normalizer2::getNFKCInstance(error);
    found.text = U_SUCCESS(error) ? compose->normalize(mapped, error) : mapped;
    found.text.toLower(icu::Locale::getRoot());
    for (int32_t at = 0; at < found.text.length(); at = found.text.moveIndex32(at, 1)) {
        const UChar32 code = found.text.char32At(at);
        if (!u_isalpha(code)) continue;
        found.has_letters = true;
        UErrorCode unknown = U_ZERO_ERROR;
        const auto script = uscript_getScript(code, &unknown);
        if (script != USCRIPT_LATIN && script != USCRIPT_COMMON) found.foreign_script = true;
    }
    return found;
}

struct Rule {
    std::regex pattern;
    const char* by;
};

/// Marks of programs: what has them is no sentence of an artist.
const std::regex& code_pattern() {
    static const std::regex Pattern(R"(\$\(|%[snxd]%|\.\./|https?://|www\.|</?[a-z]+>|;\s*drop |)"
                                    R"(\{\s*'?[a-z_]+'?\s*:|\\x|<\?|\[\[(?![a-z ]+\]\])|\w\(\)|&&|\|\||==)");
    return Pattern;
}

/// Marks that a prompt has for programs that draw, and their plain form.
const std::array<Rule, 24>& noise_rules() {
    static const std::array<Rule, 24> Rules = {{
        {std::regex(R"(<(lora|lyco|hypernet|embedding|ti)[^>]*>)"), " "},
        {std::regex(R"(\bembedding:\S+)"), " "},
        {std::regex(R"(\bf/[0-9.]+|\b[0-9]+ ?mm\b|\biso ?[0-9]+\b)"), " "},
        {std::regex(R"((^|\s)--?[a-z]{1,10}(\s+[0-9][0-9.:]*)?(?=\s*($|--)))"), " "},
        {std::regex(R"((^|\s)--[a-z]+(\s+[0-9][0-9.:]*|\s+[a-z]+(?=\s+--|\s*$))?)"), " "},
        {std::regex(R"(:\s*[0-9]+(\.[0-9]+)?\s*\))"), ")"},
        {std::regex(R"(([a-z])::?[0-9]+(\.[0-9]+)?(?![a-z]))"), "$1"},
        {std::regex(R"((^|\n)\s*(\(?[0-9]{1,2}[.)]|[-*])\s+)"), "\n"},
        {std::regex(R"((\w)(\+{1,4}|-{2,4})(?=\s|$|,))"), "$1"},
        {std::regex(R"(\)[0-9]+(\.[0-9]+)?(?=\s|$|,))"), ")"},
        {std::regex(R"([()\[\]])"), " "},
        {std::regex(R"(-+>|=+>|=|>)"), " > "},
        {std::regex("\xe2\x80\x94|(^|\\s)-{1,3}(?=\\s)"), " , "},
        {std::regex(R"(\.{2,}|\xe2\x80\xa6)"), " . "},
        {std::regex(R"((!+)1+(?=\s|$))"), "$1"},
        {std::regex(R"(\s\+\s|&)"), " and "},
        {std::regex(R"(\bw/o\b)"), " without "},
        {std::regex(R"(\bw/)"), " with "},
        {std::regex(R"(_)"), " "},
        {std::regex(R"(\n+)"), " , "},
        {std::regex(R"((^|\s)[SsVv]\*)"), " "},
        {std::regex(R"(<?\b(sks|ohwx|zwx)\b>?)"), " "},
        {std::regex(R"(\bscore_[0-9]+(_up)?\b)"), " "},
        {std::regex(R"([*#~]|\xe2\x98\x86)"), " "},
    }};
    return Rules;
}

/// A picture in the place of a word ("put a [hat] on it") cannot be read.
bool has_picture_word(const std::string& text) {
    static const std::regex Pattern("(^|\\s)(a|an|the|with|of|into|my)\\s+\xe2\x98\x86");
    return std::regex_search(text, Pattern);
}

}  // namespace

CleanText clean_text(std::string_view raw) {
    CleanText clean;
    if (raw.size() > LongestText) return {"", reason::NotASentence, true};
    static const std::regex Break(R"(\bBREAK\b)");
    const auto text = std::regex_replace(std::string(raw), Break, ",");
    const auto characters = characters_of(text);
    clean.has_letters = characters.has_letters;
    characters.text.toUTF8String(clean.text);
    if (clean.text.find_first_not_of(" \n\t") == std::string::npos) return {"", reason::Empty, false};
    if (characters.foreign_script) clean.refused = reason::Language;
    else if (!characters.has_letters) clean.refused = reason::NotASentence;
    if (!clean.refused.empty()) return clean;
    static const std::regex Choice(R"(\{[^{}]*\|[^{}]*\})"), Wildcard(R"(__[a-z]+__)");
    if (std::regex_search(clean.text, Choice)) clean.refused = reason::Ambiguous;
    if (std::regex_search(clean.text, Wildcard)) clean.refused = reason::Incomplete;
    if (has_picture_word(clean.text)) clean.refused = reason::NotASentence;
    static const std::regex Lora(R"(<(lora|lyco|hypernet|embedding|ti)[^>]*>)");
    if (std::regex_search(std::regex_replace(clean.text, Lora, ""), code_pattern()))
        clean.refused = reason::NotASentence;
    if (!clean.refused.empty()) return clean;
    static const std::regex Listed(R"(^\s*\(?[1a][.)]\s)"), Number(R"(\s\(?([0-9]{1,2}[.)]|[a-e]\))\s+)");
    if (std::regex_search(clean.text, Listed))  // "1) blue bear 2) red hat"
        clean.text = std::regex_replace(clean.text, Number, "\n");
    for (const auto& rule : noise_rules()) clean.text = std::regex_replace(clean.text, rule.pattern, rule.by);
    return clean;
}

std::string without_accents(std::string_view text) {
    UErrorCode error = U_ZERO_ERROR;
    const auto* decompose = icu::Normalizer2::getNFKDInstance(error);
    const auto raw =
        icu::UnicodeString::fromUTF8(icu::StringPiece(text.data(), static_cast<int32_t>(text.size())));
    const auto apart = U_SUCCESS(error) ? decompose->normalize(raw, error) : raw;
    icu::UnicodeString bare;
    for (int32_t at = 0; at < apart.length(); at = apart.moveIndex32(at, 1))
        if (u_charType(apart.char32At(at)) != U_NON_SPACING_MARK) bare.append(apart.char32At(at));
    std::string utf8;
    bare.toUTF8String(utf8);
    return utf8;
}

}  // namespace gse::language::plan
