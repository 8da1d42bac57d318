// Pixels of one colour in another.
#include "engine/edit/target_views/strategies/colour_remap.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/random.h"
#include "engine/language/grammar.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/math/sh.h"

namespace gse::edit {
namespace {

using Rgb = std::array<float, 3>;

constexpr Rgb Red{0.85f, 0.07f, 0.07f};  // as models draw it where light falls on it
// Degrees from the hue that most of a thing has which was drawn red: up to the first a pixel counts as that,
// beyond the second it has a colour of its own. What cannot be called red is no thing's hue.
constexpr float SameHue = 16, OtherHue = 28, MostOffRed = 36;
// Saturation of gold, the channels' difference over the largest.
constexpr float Colourless = 0.2f, Coloured = 0.45f;
// Red, the largest channel of gold, in its darkest and its brightest reflections.
constexpr float GoldShade = 0.25f, GoldLit = 0.98f;

Rgb rgb_of(unsigned value) {
    return {static_cast<float>(value >> 16 & 255) / 255, static_cast<float>(value >> 8 & 255) / 255,
            static_cast<float>(value & 255) / 255};
}

bool lists_dye(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::optional<ColourRemap> dye_named(const std::string& word, const std::vector<std::string>& known) {
    ColourRemap dye{{word}, PlainBase, {}, {}, false};
    if (const auto* name = colour_named(word); name != nullptr) {
        dye.colour = rgb_of(name->rgb);
    } else if (const auto* metal = metal_named(word); metal != nullptr && lists_dye(known, MetalBase)) {
        dye.base = MetalBase, dye.metal = true;
        dye.colour = rgb_of(metal->lit), dye.shade = rgb_of(metal->shade);
    } else {
        return std::nullopt;
    }
    return dye;
}

void modify(const ColourModifier& modifier, ColourRemap& dye) {
    for (auto* colour : {&dye.colour, &dye.shade})
        for (auto& channel : *colour) channel = modifier.own * channel + modifier.white;
}

Vec3 vec_of(const Rgb& colour) { return {colour[0], colour[1], colour[2]}; }

/// The pattern named at `index`, in the colour beside it.
std::optional<ColourRemap> patterned(const std::vector<std::string>& words, std::size_t begin,
                                     std::size_t index, std::size_t end) {
    const auto pattern = pattern_named(words[index]);
    if (!pattern) return std::nullopt;
    ColourRemap dye{{words[index]}, PlainBase, {}, {}, false, pattern};
    if (!takes_colours(pattern->kind)) return dye;
    const auto colour_at_place = [&](std::size_t i) {
        return i >= begin && i < end ? colour_named(words[i]) : nullptr;
    };
    const auto *before = colour_at_place(index - 1),
               *after = colour_at_place(index + 1);  // begin is 0: the one before is beyond every end
    const auto* name = before != nullptr ? before : after;
    if (name == nullptr) return dye;
    dye.words.insert(before != nullptr ? dye.words.begin() : dye.words.end(), name->word);
    dye.pattern->first = vec_of(rgb_of(name->rgb));
    if (std::string(name->word) == "white") dye.pattern->second = {0.08, 0.08, 0.09};
    return dye;
}

/// First word of the noun phrase that the word at `index` belongs to.
std::size_t phrase_begin(const std::vector<std::string>& words, std::size_t index) {
    while (index > 0 && !language::ends_phrase(words[index - 1]) &&
           !language::is_a(words[index - 1], language::Determiner))
        --index;
    return index;
}

float ramp(float low, float high, float value) {
    return std::clamp((value - low) / (high - low), 0.0f, 1.0f);
}

/// Degrees from red, of pixels in which that is the largest channel: yellow is 60, magenta -60. `chroma`
/// above 0.
float hue_of(const Rgb& pixel, float chroma) { return 60 * (pixel[1] - pixel[2]) / chroma; }

/// The hue that most of what is about red has, by the chroma of pixels: what a model calls red differs from
/// thing to thing.
class HueVote {
public:
    void add(const Rgb& pixel, double share) {
        const auto [low, high] = std::minmax({pixel[0], pixel[1], pixel[2]});
        if (high - low <= 0 || pixel[0] < high) return;
        const float hue = hue_of(pixel, high - low);
        if (std::abs(hue) <= MostOffRed)
            votes_[static_cast<std::size_t>(std::lround(hue + MostOffRed))] += share * (high - low);
    }
    /// Their median; 0 where there are none.
    float hue() const {
        double all = 0, below = 0;
        for (const double votes : votes_) all += votes;
        for (std::size_t i = 0; i < votes_.size() && all > 0; ++i)
            if ((below += votes_[i]) >= 0.5 * all) return static_cast<float>(i) - MostOffRed;
        return 0;
    }

private:
    std::array<double, 2 * static_cast<std::size_t>(MostOffRed) + 1> votes_{};
};

/// Pixel that mixes grey and red of the hue `red_hue`, with the red replaced by the colour (linear unmixing).
Rgb dyed_red(const Rgb& pixel, const Rgb& colour, float red_hue) {
    const auto [low, high] = std::minmax({pixel[0], pixel[1], pixel[2]});
    if (high - low <= 0 || pixel[0] < high) return pixel;
    const float much = 1 - ramp(SameHue, OtherHue, std::abs(hue_of(pixel, high - low) - red_hue));
    const float red = (high - low) / (Red[0] - Red[1]), grey = low - red * Red[1];
    Rgb dyed = pixel;
    for (std::size_t c = 0; c < 3; ++c) dyed[c] += much * (red * colour[c] + grey - pixel[c]);
    return dyed;
}

/// Gold's reflections in another metal's tones; its highlights are pale.
Rgb dyed_gold(const Rgb& pixel, const ColourRemap& dye) {
    const auto [low, high] = std::minmax({pixel[0], pixel[1], pixel[2]});
    if (high <= 0 || pixel[0] < pixel[2]) return pixel;
    const float much = std::max(ramp(Colourless, Coloured, (high - low) / high), ramp(0.8f, 0.95f, high));
    const float lit = ramp(GoldShade, GoldLit, high);
    Rgb dyed = pixel;
    for (std::size_t c = 0; c < 3; ++c)
        dyed[c] += much * (dye.shade[c] + (dye.colour[c] - dye.shade[c]) * lit * std::sqrt(lit) - pixel[c]);
    return dyed;
}

}  // namespace

std::optional<ColourRemap> dye_of(const language::EditSentence& sentence, language::EditMode mode,
                                  const std::vector<std::string>& known) {
    if (!lists_dye(known, PlainBase)) return std::nullopt;
    const auto& words = sentence.sentence().words();
    const std::size_t target = sentence.sentence().position_of(sentence.target());
    if (target >= words.size()) return std::nullopt;
    const std::size_t begin = phrase_begin(words, target);
    std::size_t end = target + language::words_of(sentence.target()).size();
    if (mode != language::EditMode::Modify) --end;  // the thing itself, whatever it is called
    for (std::size_t i = begin; i < end; ++i)
        if (auto dye = lists_dye(known, words[i]) ? std::nullopt : patterned(words, begin, i, end))
            return dye;
    for (std::size_t i = end; i-- > begin;) {
        auto dye = dye_named(words[i], known);
        if (!dye) continue;
        const auto* modifier = i > begin ? modifier_named(words[i - 1]) : nullptr;
        if (modifier != nullptr) {
            modify(*modifier, *dye);
            dye->words.insert(dye->words.begin(), words[i - 1]);
        } else if (lists_dye(known, words[i])) {
            return std::nullopt;  // the model's own word
        }
        return dye;
    }
    return std::nullopt;
}

std::string told_with(const ColourRemap& dye, const std::string& sentence) {
    auto words = language::words_of(sentence);
    for (auto at = words.begin();
         (at = std::search(at, words.end(), dye.words.begin(), dye.words.end())) != words.end();) {
        at = words.erase(at, at + static_cast<std::ptrdiff_t>(dye.words.size()));
        at = words.insert(at, dye.base) + 1;
    }
    return language::joined(words);
}

namespace {

void apply_dye(const ColourRemap& dye, const Image& share, float red_hue, Image& picture) {
    for (std::size_t p = 0; p < share.data.size(); ++p) {
        if (!(share.data[p] > 0)) continue;
        float* at = &picture.data[3 * p];
        const Rgb pixel{at[0], at[1], at[2]},
            dyed = dye.metal ? dyed_gold(pixel, dye) : dyed_red(pixel, dye.colour, red_hue);
        for (std::size_t c = 0; c < 3; ++c)
            at[c] = std::clamp(pixel[c] + std::min(share.data[p], 1.0f) * (dyed[c] - pixel[c]), 0.0f, 1.0f);
    }
}

}  // namespace

void apply_dye(const ColourRemap& dye, std::span<const Image> shares, std::span<Image> pictures) {
    GSE_CHECK_EQ(shares.size(), pictures.size());
    HueVote vote;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        GSE_CHECK_EQ(pictures[i].channels, 3);
        GSE_CHECK(shares[i].width == pictures[i].width && shares[i].height == pictures[i].height);
        for (std::size_t p = 0; p < shares[i].data.size(); ++p)
            if (const float* at = &pictures[i].data[3 * p]; shares[i].data[p] > 0)
                vote.add({at[0], at[1], at[2]}, shares[i].data[p]);
    }
    for (std::size_t i = 0; i < pictures.size(); ++i) apply_dye(dye, shares[i], vote.hue(), pictures[i]);
}

namespace {

/// dyed_red() of colours near one: red's share of each goes into the colour.
Mat3 near_map(const Rgb& pixel, const Rgb& colour, float red_hue) {
    const std::size_t low = pixel[1] < pixel[2] ? 1 : 2;
    const Rgb dyed = dyed_red(pixel, colour, red_hue);
    const float span = pixel[0] - pixel[low], red = span / (Red[0] - Red[1]);
    // How much of it was red by its hue: dyed - pixel = much (red colour + grey - pixel).
    double much = 0, whole = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double change = red * colour[c] + pixel[low] - red * Red[1] - pixel[c];
        much += change * (dyed[c] - pixel[c]), whole += change * change;
    }
    much = whole > 0 ? much / whole : 0;
    Mat3 map;
    for (std::size_t c = 0; c < 3; ++c) {
        Vec3 row{0, 0, 0};
        const double share = 1 / (Red[0] - Red[1]);
        row.x = much * share * (colour[c] - Red[1]);
        row[static_cast<int>(low)] = much * (1 - share * (colour[c] - Red[1]));
        row[static_cast<int>(c)] += 1 - much;
        for (int k = 0; k < 3; ++k) map(static_cast<int>(c), k) = row[k];
    }
    return map;
}

/// A point of the world in thing space.
Vec3 within_thing(const DyedThing& thing, const Vec3& point) {
    const Vec3 from = (point - thing.standing.foot) / figure_height(thing.standing);
    return {dot(from, cross(thing.up, thing.front)), dot(from, thing.up), -dot(from, thing.front)};
}

}  // namespace

GaussianSet dye_rows(const ColourRemap& dye, const DyedThing& thing, std::span<const std::uint8_t> rows,
                     const GaussianSet& set, std::uint64_t seed) {
    GSE_CHECK_EQ(rows.size(), set.size());
    if (!dye.pattern || !(figure_height(thing.standing) > 0)) return set;
    auto pattern = *dye.pattern;
    Random random(seed);
    pattern.offset = {random.uniform(0, 50), random.uniform(0, 50), random.uniform(0, 50)};
    auto data = set.to_data();
    const std::size_t stride = data.sh_stride();
    const auto colour_of = [&](std::size_t row) {
        Rgb colour;
        for (std::size_t c = 0; c < 3; ++c)
            colour[c] = static_cast<float>(std::clamp(colour_from_sh(data.sh[row * stride + c]), 0.0, 1.0));
        return colour;
    };
    std::vector<std::size_t> dyed_rows;
    HueVote vote;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const float* sh = &data.sh[row * stride];
        const float* at = &data.position[3 * row];
        if (rows[row] == 0 || !std::isfinite(sh[0] + sh[1] + sh[2] + at[0] + at[1] + at[2])) continue;
        dyed_rows.push_back(row);
        vote.add(colour_of(row), 1);
    }
    const float red_hue = vote.hue();
    for (const std::size_t row : dyed_rows) {
        float* sh = &data.sh[row * stride];
        const Vec3 shown =
            colour_at(pattern, within_thing(thing, {data.position[3 * row], data.position[3 * row + 1],
                                                    data.position[3 * row + 2]}));
        const Rgb pixel = colour_of(row), colour{static_cast<float>(shown.x), static_cast<float>(shown.y),
                                                 static_cast<float>(shown.z)};
        const Rgb dyed = dyed_red(pixel, colour, red_hue);
        if (dyed == pixel) continue;
        const Mat3 map = near_map(pixel, colour, red_hue);
        for (std::size_t c = 0; c < 3; ++c)
            sh[c] = static_cast<float>(sh_from_colour(std::clamp(dyed[c], 0.0f, 1.0f)));
        for (std::size_t k = 3; k + 2 < stride; k += 3) {
            const Vec3 value = map * Vec3{sh[k], sh[k + 1], sh[k + 2]};
            for (std::size_t c = 0; c < 3; ++c) sh[k + c] = static_cast<float>(value[static_cast<int>(c)]);
        }
    }
    return GaussianSet(std::move(data));
}

EditedViews DyedViews::edit(const std::vector<EditView>& views, const EditViewsRequest& input,
                            const JobControl& job) {
    EditViewsRequest told = input;
    if (!told.sentence.empty()) told.sentence = told_with(dye_, told.sentence);
    auto targets = guidance_.edit(views, told, job);
    drawn_.clear();
    std::vector<Image> shares;
    for (std::size_t v = 0; v < targets.images.size(); ++v) {
        drawn_.push_back({views[v].original, targets.images[v]});
        Image& share = shares.emplace_back(views[v].mask.width, views[v].mask.height, 1);
        for (std::size_t p = 0; p < share.data.size(); ++p) {
            const float drawn = targets.outlines.empty() ||
                                        targets.outlines[v].data.size() != share.data.size() || !input.anew
                                    ? 1
                                    : targets.outlines[v].data[p];
            share.data[p] = views[v].mask.data[p] != 0 ? drawn : 0;
        }
    }
    if (!dye_.pattern) apply_dye(dye_, shares, targets.images);
    targets.unfinished = dye_.pattern.has_value();
    return targets;
}

}  // namespace gse::edit
