// The front of a scene, read off pictures all around by a pair of encoders.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "engine/edit/search/front_reading.h"

namespace front_reading_test {

using namespace gse;
using namespace gse::edit;

namespace {

constexpr double Pi = std::numbers::pi;

/// Knows pictures by their first value, the azimuth at which they see the front, and words by their side;
/// likes one word better than the others in every picture, and one picture better than the others with every
/// word.
class ToyEncoder : public ImageTextEncoder {
public:
    explicit ToyEncoder(double strength) : strength_(strength) {}
    std::vector<float> image(const Image& image) override {
        const double turn = image.data[0];
        const auto of = [&](double middle) {
            return static_cast<float>(strength_ * std::cos(turn - middle));
        };
        const auto side = static_cast<float>(-strength_ * std::abs(std::cos(turn)));
        return {of(0), of(Pi), side, turn > 2 ? 1.5f : 0.5f};
    }
    std::vector<float> text(const std::string& sentence) override {
        if (sentence.ends_with("front view")) return {1, 0, 0, 1};
        return sentence.ends_with("back view") ? std::vector<float>{0, 1, 0, 0.5f}
                                               : std::vector<float>{0, 0, 1, 2};
    }

protected:
    double strength_;
};

/// Toy encoder that has learned to tell viewpoints: shares about the azimuth, in sectors of 15 degrees, as
/// sharp as it is strong.
class ToyClassifier final : public ToyEncoder {
public:
    using ToyEncoder::ToyEncoder;
    std::vector<float> viewpoint(const Image& image) override {
        constexpr int Sectors = 24;
        std::vector<float> shares(Sectors);
        float sum = 0;
        for (int s = 0; s < Sectors; ++s) {
            const double off = image.data[0] - 2 * Pi * s / Sectors;
            sum += shares[static_cast<std::size_t>(s)] =
                static_cast<float>(std::exp(strength_ * (std::cos(off) - 1)));
        }
        for (auto& share : shares) share /= sum;
        return shares;
    }
};

template <class Encoder> FrontReading read(double front, double strength, int count) {
    VocabularyRanker recognition(std::make_unique<Encoder>(strength), {});
    std::vector<Image> pictures;
    std::vector<double> azimuths;
    for (int i = 0; i < count; ++i) {
        azimuths.push_back(2 * Pi * i / count);
        pictures.emplace_back(2, 2, 1, static_cast<float>(azimuths.back() - front));
    }
    return read_front(recognition, "a bear", pictures, azimuths);
}

}  // namespace

DOCTEST_TEST_CASE(
    "the front is where the words for the sides fit, whatever else a picture or a word is liked for") {
    for (const double front : {-3.0, -2.0, -1.0, 0.0, 0.7, 1.6, 3.1})
        for (const int count : {8, 12, 24}) {
            DOCTEST_CAPTURE(front);
            DOCTEST_CAPTURE(count);
            const auto found = read<ToyEncoder>(front, 0.3, count);
            DOCTEST_CHECK(std::abs(std::remainder(found.azimuth - front, 2 * Pi)) < 30 * Pi / 180);
            DOCTEST_CHECK(found.lead > 0.01);
            DOCTEST_CHECK(found.clear);
        }
}

DOCTEST_TEST_CASE(
    "a model that tells viewpoints tells the front more exactly than cameras or sectors stand apart") {
    constexpr double Exact = 3 * Pi / 180;
    for (const double front : {-3.0, -2.0, -1.0, 0.0, 0.1, 0.7, 1.6, 3.1})
        for (const int count : {3, 8, 12}) {
            DOCTEST_CAPTURE(front);
            DOCTEST_CAPTURE(count);
            const auto found = read<ToyClassifier>(front, 25, count);
            DOCTEST_CHECK(std::abs(std::remainder(found.azimuth - front, 2 * Pi)) < Exact);
            DOCTEST_CHECK(found.clear);
        }
}

DOCTEST_TEST_CASE("where a classifier sees nothing clearly the words for the sides are asked") {
    /// Its pictures are unlike those it has learned from: any sector, alike.
    class Lost final : public ToyEncoder {
    public:
        using ToyEncoder::ToyEncoder;
        std::vector<float> viewpoint(const Image&) override { return std::vector<float>(24, 1.0f / 24); }
    };
    const auto lost = read<Lost>(1.6, 0.3, 12), told = read<ToyEncoder>(1.6, 0.3, 12);
    DOCTEST_CHECK((lost.azimuth == told.azimuth && lost.lead == told.lead && lost.clear && told.clear));
}

DOCTEST_TEST_CASE("one picture that a classifier is wrong about moves no front") {
    std::vector<std::vector<float>> seen;
    std::vector<double> azimuths;
    for (int i = 0; i < 12; ++i) {
        azimuths.push_back(2 * Pi * i / 12);
        std::vector<float> shares(24, 0.0f);
        shares[static_cast<std::size_t>(2 * i)] = 1;  // the front is at azimuth 0
        seen.push_back(shares);
    }
    std::rotate(seen[4].begin(), seen[4].begin() + 9, seen[4].end());
    const auto found = front_by_viewpoints(seen, azimuths);
    DOCTEST_CHECK(std::abs(found.azimuth) < 1e-3);
    DOCTEST_CHECK(found.clear);
}

DOCTEST_TEST_CASE("pictures that look alike from all sides have no front") {
    DOCTEST_CHECK(std::abs(read<ToyEncoder>(0.7, 0, 12).lead) < 1e-6);
    DOCTEST_CHECK(std::abs(read<ToyClassifier>(0.7, 0, 12).lead) < 1e-6);
    DOCTEST_CHECK(!read<ToyEncoder>(0.7, 0, 12).clear);
    DOCTEST_CHECK(!read<ToyClassifier>(0.7, 0, 12).clear);
}

DOCTEST_TEST_CASE("words of a side") {
    DOCTEST_CHECK(view_words(0, false) == "front view");
    DOCTEST_CHECK(view_words(2 * Pi - 0.3, false) == "front view");
    DOCTEST_CHECK(view_words(-Pi / 2, false) == "side view");
    DOCTEST_CHECK(view_words(3, false) == "back view");
    DOCTEST_CHECK(view_words(0.3, true) == "front view");
    DOCTEST_CHECK(view_words(Pi / 4, true) == "front left view");
    DOCTEST_CHECK(view_words(Pi / 2 - 2 * Pi, true) == "left side view");
    DOCTEST_CHECK(view_words(3 * Pi / 4, true) == "back left view");
    DOCTEST_CHECK(view_words(-Pi + 0.1, true) == "back view");
    DOCTEST_CHECK(view_words(Pi - 0.1, true) == "back view");
    DOCTEST_CHECK(view_words(-2.2, true) == "back right view");
    DOCTEST_CHECK(view_words(-Pi / 2, true) == "right side view");
    DOCTEST_CHECK(view_words(-0.7, true) == "front right view");
}

DOCTEST_TEST_CASE("the side that was looked at is the front, unless the pictures are sure of another") {
    const auto by_words = read<ToyEncoder>(0.7, 1, 24), sharp = read<ToyClassifier>(0.7, 30, 24),
               dull = read<ToyClassifier>(0.7, 2, 24);
    DOCTEST_REQUIRE(by_words.clear);
    DOCTEST_CHECK_FALSE(by_words.sure);
    DOCTEST_REQUIRE(sharp.sure);
    DOCTEST_REQUIRE(dull.clear);
    DOCTEST_REQUIRE_FALSE(dull.sure);
    for (const auto& unsure : {by_words, dull}) {
        DOCTEST_CHECK(chosen_front(unsure, -2.0) == -2.0);
        DOCTEST_CHECK(chosen_front(unsure, std::nullopt) == unsure.azimuth);
    }
    DOCTEST_CHECK(chosen_front(sharp, -2.0) == sharp.azimuth);
    DOCTEST_CHECK(chosen_front(std::nullopt, -2.0) == -2.0);
    DOCTEST_CHECK_FALSE(chosen_front(std::nullopt, std::nullopt).has_value());
    DOCTEST_CHECK_FALSE(chosen_front(FrontReading{}, std::nullopt).has_value());
}

}  // namespace front_reading_test
