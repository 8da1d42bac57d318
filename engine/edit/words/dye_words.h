// Names of colours that a model of few words is not told, and what they are drawn in.
#pragma once

#include <string>
#include <vector>

namespace gse::edit {

inline constexpr const char* PlainBase = "red";  // word of the model that colours and patterns are drawn in
inline constexpr const char* MetalBase = "golden";  // word of the model that metals are drawn in

/// A colour by its name.
struct NamedColour {
    const char* word;
    unsigned rgb;  // 0xRRGGBB, display values
};

/// A metal where it is lit and where it mirrors what is dark.
struct NamedMetal {
    const char* word;
    unsigned lit, shade;
};

/// Effect of "dark" and its like on a colour: the colour's own share, and that of white.
struct ColourModifier {
    const char* word;
    float own, white;
};

/// Entries of that word; null where there is none.
const NamedColour* colour_named(const std::string& word);
const NamedMetal* metal_named(const std::string& word);
const ColourModifier* modifier_named(const std::string& word);

/// Names of colours (CSS Color 4's that are one word, painters' names, metals), "dark", "light", "pale",
/// "deep" that may stand before one, and pattern_words(), beside which one may stand. Empty where a model of
/// the words `known` has none to draw them in, or takes any word.
std::vector<std::string> dye_words(const std::vector<std::string>& known);

/// `drawn`, words that a model of the words `known` draws besides, with the dyes behind it.
std::vector<std::string> with_dyes(std::vector<std::string> drawn, const std::vector<std::string>& known);

}  // namespace gse::edit
