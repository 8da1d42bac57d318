// Tables of colours, metals and what may stand before them.
#include "engine/edit/words/dye_words.h"

#include <algorithm>
#include <iterator>

#include "engine/language/vocabulary.h"
#include "engine/scene/surface_pattern.h"

namespace gse::edit {
namespace {

// Single words of CSS Color 4 (W3C), some of them as painters mean them, and painters' own.
constexpr NamedColour ColourNames[] = {
    {"red", 0xd91212},        {"blue", 0x1a38e0},      {"green", 0x088c29},       {"yellow", 0xfce014},
    {"purple", 0x851fb8},     {"orange", 0xfa780a},    {"black", 0x17171a},       {"white", 0xf2f2f0},
    {"pink", 0xfa73ad},       {"brown", 0x663314},     {"gray", 0x78787a},        {"grey", 0x78787a},
    {"turquoise", 0x0fc2bd},  {"teal", 0x008080},      {"cyan", 0x00d5e0},        {"aqua", 0x20d8d8},
    {"aquamarine", 0x70e8c4}, {"azure", 0x3f9fe8},     {"navy", 0x10185c},        {"indigo", 0x3c1a82},
    {"violet", 0x8a4fe0},     {"magenta", 0xe0189c},   {"fuchsia", 0xf030b0},     {"crimson", 0xbe1236},
    {"scarlet", 0xf0280c},    {"maroon", 0x6c1020},    {"burgundy", 0x6a0f2c},    {"coral", 0xff7050},
    {"salmon", 0xfa8a78},     {"peach", 0xffbe98},     {"tan", 0xcaa472},         {"beige", 0xe6d8b8},
    {"ivory", 0xf8f2da},      {"cream", 0xfaeec2},     {"khaki", 0xb4a468},       {"olive", 0x6c7018},
    {"lime", 0x8ee010},       {"mint", 0x96ecbe},      {"emerald", 0x0c9c5e},     {"jade", 0x24a878},
    {"lavender", 0xb8a4ec},   {"lilac", 0xc8a0d8},     {"plum", 0x80306c},        {"mauve", 0xb884b0},
    {"ruby", 0xb80c40},       {"sapphire", 0x1040a8},  {"amber", 0xfaac10},       {"mustard", 0xd2a41c},
    {"ochre", 0xc07c24},      {"chocolate", 0x4a240e}, {"caramel", 0xb8702c},     {"chestnut", 0x803a20},
    {"sienna", 0x984824},     {"umber", 0x644a34},     {"charcoal", 0x38393e},    {"slate", 0x5c6a78},
    {"ebony", 0x241c1a},      {"cobalt", 0x0c44ac},    {"ultramarine", 0x2018a0}, {"denim", 0x2c5c90},
    {"chartreuse", 0xa8e810}, {"rust", 0xa0441a},      {"vermilion", 0xe64022},   {"periwinkle", 0x8c94ee}};

constexpr NamedMetal Metals[] = {{"silver", 0xf6f9ff, 0x1f2129},   {"bronze", 0xea9e66, 0x240f08},
                                 {"copper", 0xfa9468, 0x34100a},   {"brass", 0xf2dc7c, 0x3a2a08},
                                 {"chrome", 0xffffff, 0x101216},   {"steel", 0xc8d0dc, 0x22272e},
                                 {"platinum", 0xf4f2ec, 0x34342f}, {"pewter", 0xa8acac, 0x26282a},
                                 {"gold", 0xf8dc78, 0x3c2004},     {"golden", 0xf8dc78, 0x3c2004}};

constexpr ColourModifier Modifiers[] = {
    {"dark", 0.45f, 0}, {"light", 0.6f, 0.4f}, {"pale", 0.45f, 0.52f}, {"deep", 0.65f, 0}};

template <class List> auto entry_of(const List& list, const std::string& word) {
    const auto found =
        std::find_if(std::begin(list), std::end(list), [&](const auto& entry) { return word == entry.word; });
    return found == std::end(list) ? nullptr : &*found;
}

bool lists_word(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

const NamedColour* colour_named(const std::string& word) { return entry_of(ColourNames, word); }
const NamedMetal* metal_named(const std::string& word) { return entry_of(Metals, word); }
const ColourModifier* modifier_named(const std::string& word) { return entry_of(Modifiers, word); }

std::vector<std::string> dye_words(const std::vector<std::string>& known) {
    std::vector<std::string> words;
    if (!lists_word(known, PlainBase)) return words;
    const auto add = [&](const auto& list) {
        for (const auto& entry : list)
            if (!lists_word(known, entry.word)) words.emplace_back(entry.word);
    };
    add(ColourNames);
    if (lists_word(known, MetalBase)) add(Metals);
    add(Modifiers);
    for (const auto& word : pattern_words())
        if (!lists_word(known, word)) words.push_back(word);
    return words;
}

std::vector<std::string> with_dyes(std::vector<std::string> drawn, const std::vector<std::string>& known) {
    const auto dyes = dye_words(language::promptable_vocabulary(known, drawn));
    drawn.insert(drawn.end(), dyes.begin(), dyes.end());
    return drawn;
}

}  // namespace gse::edit
