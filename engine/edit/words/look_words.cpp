// Tones by word, and a test of hue and chroma.
#include "engine/edit/words/look_words.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/edit/words/colour_word.h"

namespace gse::edit {
namespace {

struct NamedLook {
    const char* word;
    Look look;
};

// Diffuse colours keep two fifths of their light in shade; metals mirror dark surroundings.
constexpr NamedLook Looks[] = {
    {"red", {{0.34f, 0.03f, 0.03f}, {0.92f, 0.12f, 0.11f}}},
    {"blue", {{0.04f, 0.09f, 0.34f}, {0.16f, 0.32f, 0.93f}}},
    {"green", {{0.05f, 0.23f, 0.06f}, {0.22f, 0.70f, 0.25f}}},
    {"yellow", {{0.42f, 0.35f, 0.04f}, {1.00f, 0.90f, 0.22f}}},
    {"purple", {{0.20f, 0.05f, 0.27f}, {0.60f, 0.22f, 0.76f}}},
    {"orange", {{0.42f, 0.19f, 0.02f}, {1.00f, 0.56f, 0.12f}}},
    {"pink", {{0.45f, 0.24f, 0.31f}, {1.00f, 0.68f, 0.78f}}},
    {"brown", {{0.17f, 0.10f, 0.05f}, {0.52f, 0.33f, 0.18f}}},
    {"black", {{0.01f, 0.01f, 0.01f}, {0.22f, 0.22f, 0.23f}}},
    {"white", {{0.56f, 0.57f, 0.59f}, {0.98f, 0.98f, 0.98f}}},
    {"grey", {{0.22f, 0.22f, 0.23f}, {0.64f, 0.64f, 0.65f}}},
    {"gray", {{0.22f, 0.22f, 0.23f}, {0.64f, 0.64f, 0.65f}}},
    {"wooden", {{0.26f, 0.15f, 0.07f}, {0.70f, 0.48f, 0.27f}}},
    {"stone", {{0.30f, 0.29f, 0.28f}, {0.72f, 0.71f, 0.69f}}},
    {"golden", {{0.36f, 0.21f, 0.04f}, {1.00f, 0.85f, 0.40f}}},
    {"silver", {{0.28f, 0.29f, 0.31f}, {0.93f, 0.94f, 0.96f}}},
};

constexpr double LeastHue = 14;  // chroma of a look's middle from which its hue tells it
constexpr double SameHue = 13 * std::numbers::pi / 180;
constexpr double LeastChroma = 0.5;                  // of the look's
constexpr double MostGrey = 14;                      // chroma of a pixel without a hue
constexpr double SameLightness = 22, SameGrey = 14;  // of tones with a hue, and of others

double chroma_of(const std::array<double, 3>& lab) { return std::hypot(lab[1], lab[2]); }

std::array<double, 3> lab_of_tone(const std::array<float, 3>& tone) {
    return lab_of({tone[0], tone[1], tone[2]});
}

}  // namespace

std::optional<Look> look_named(const std::string& word) {
    const auto* found = std::find_if(std::begin(Looks), std::end(Looks),
                                     [&](const NamedLook& look) { return word == look.word; });
    return found == std::end(Looks) ? std::nullopt : std::optional(found->look);
}

std::array<float, 3> Look::tone(float light) const {
    std::array<float, 3> tone{};
    for (std::size_t c = 0; c < 3; ++c) tone[c] = shade[c] + (lit[c] - shade[c]) * light;
    return tone;
}

LookTest::LookTest(const Look& look) : look_(look) {
    const auto lab = lab_of_tone(look.tone(0.5f));
    chroma_ = chroma_of(lab);
    has_hue_ = chroma_ >= LeastHue;
    hue_ = std::atan2(lab[2], lab[1]);
}

bool LookTest::has(const std::array<double, 3>& srgb, float light) const {
    const auto lab = lab_of(srgb);
    const double off = std::abs(lab[0] - lab_of_tone(look_.tone(light))[0]);
    if (!has_hue_) return chroma_of(lab) <= MostGrey && off <= SameGrey;
    // In shade a colour has less chroma by as much as it is darker.
    const double least = LeastChroma * chroma_ * std::min(1.0, lab[0] / 50);
    const double turn = std::remainder(std::atan2(lab[2], lab[1]) - hue_, 2 * std::numbers::pi);
    return chroma_of(lab) >= least && std::abs(turn) <= SameHue && off <= SameLightness;
}

}  // namespace gse::edit
