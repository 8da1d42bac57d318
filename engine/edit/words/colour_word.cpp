// Pixels to basic colour terms; a word into a sentence.
#include "engine/edit/words/colour_word.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/check.h"
#include "engine/language/vocabulary.h"

namespace gse::edit {
namespace {

constexpr float Counts = 0.5f;           // of a pixel's share
constexpr double LightnessWeight = 0.5;  // of its difference, beside those of a and b

using Colour = std::array<double, 3>;

struct Term {
    const char* word;
    Colour srgb;  // a typical sample
};

constexpr std::array<Term, 11> Terms{
    {{"red", {0.80, 0.10, 0.10}},
     {"blue", {0.10, 0.22, 0.80}},
     {"green", {0.15, 0.58, 0.18}},
     {"yellow", {0.93, 0.83, 0.15}},
     {"purple", {0.50, 0.15, 0.65}},
     {"orange", {0.93, 0.48, 0.08}},
     {"black", {0.07, 0.07, 0.07}},
     {"white", {0.72, 0.72, 0.72}},  // in light and shade: black things are dark everywhere
     {"brown", {0.42, 0.26, 0.13}},
     {"grey", {0.50, 0.50, 0.50}},
     {"pink", {0.95, 0.60, 0.70}}}};

double distance(const Colour& a, const Colour& b) {
    const double l = LightnessWeight * (a[0] - b[0]);
    return l * l + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

}  // namespace

Colour lab_of(const Colour& srgb) {
    const auto linear = [](double v) {
        return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    const double r = linear(srgb[0]), g = linear(srgb[1]), b = linear(srgb[2]);
    const auto f = [](double t) {
        constexpr double Edge = 6.0 / 29;
        return t > Edge * Edge * Edge ? std::cbrt(t) : t / (3 * Edge * Edge) + 4.0 / 29;
    };
    const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505),
                 y = f(0.2126 * r + 0.7152 * g + 0.0722 * b),
                 z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

ColourVote::ColourVote(const std::vector<std::string>& known) {
    for (std::size_t i = 0; i < Terms.size(); ++i)
        if (language::vocabulary_contains(known, Terms[i].word)) terms_.push_back(i);
    votes_.resize(terms_.size());
}

void ColourVote::add(const Image& picture, const Image& share) {
    GSE_CHECK_EQ(picture.data.size(), share.data.size() * 3);
    if (terms_.empty()) return;
    std::vector<Colour> colours;
    for (const auto term : terms_) colours.push_back(lab_of(Terms[term].srgb));
    for (std::size_t i = 0; i < share.data.size(); ++i) {
        if (!(share.data[i] > Counts)) continue;
        const Colour pixel = lab_of({picture.data[i * 3], picture.data[i * 3 + 1], picture.data[i * 3 + 2]});
        const auto nearest = std::min_element(
            colours.begin(), colours.end(),
            [&](const auto& a, const auto& b) { return distance(pixel, a) < distance(pixel, b); });
        ++votes_[static_cast<std::size_t>(nearest - colours.begin())];
    }
}

std::string ColourVote::winner() const {
    const auto word = [&](std::size_t i) { return std::string(Terms[terms_[i]].word); };
    const auto is_grey = [&](std::size_t i) {
        return word(i) == "black" || word(i) == "white" || word(i) == "grey";
    };
    std::size_t greys = 0, most = 0;
    for (std::size_t i = 0; i < votes_.size(); ++i) {
        if (is_grey(i)) greys += votes_[i];
        else most = std::max(most, votes_[i]);
    }
    std::string best;  // of those without a hue where they are more than any hue, else of the others
    std::size_t least = 0;
    for (std::size_t i = 0; i < votes_.size(); ++i)
        if (is_grey(i) == (greys > most) && votes_[i] > least) least = votes_[i], best = word(i);
    return best;
}

std::string colour_shown(const Image& picture, const Image& share, const std::vector<std::string>& known) {
    ColourVote vote(known);
    vote.add(picture, share);
    return vote.winner();
}

}  // namespace gse::edit
