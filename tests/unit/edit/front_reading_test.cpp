// The front of a scene, read off pictures all around by a pair of encoders.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "engine/edit/front_reading.h"

using namespace gse;
using namespace gse::edit;

namespace {

constexpr double Pi = std::numbers::pi;

/// Knows pictures by their first value, the azimuth at which they see the front, and words by their side; likes one word
/// better than the others in every picture, and one picture better than the others with every word.
class ToyEncoder : public TextImageScore {
public:
    explicit ToyEncoder(double strength) : strength_(strength) {}
    std::vector<float> image(const Image& image) override {
        const double turn = image.data[0];
        const auto of = [&](double middle) { return static_cast<float>(strength_ * std::cos(turn - middle)); };
        const auto side = static_cast<float>(-strength_ * std::abs(std::cos(turn)));
        return {of(0), of(Pi), side, turn > 2 ? 1.5f : 0.5f};
    }
    std::vector<float> text(const std::string& sentence) override {
        if (sentence.ends_with("front view")) return {1, 0, 0, 1};
        return sentence.ends_with("back view") ? std::vector<float>{0, 1, 0, 0.5f} : std::vector<float>{0, 0, 1, 2};
    }

private:
    double strength_;
};

FrontReading read(double front, double strength, int count) {
    Recognition recognition(std::make_unique<ToyEncoder>(strength), {});
    std::vector<Image> pictures;
    std::vector<double> azimuths;
    for (int i = 0; i < count; ++i) {
        azimuths.push_back(2 * Pi * i / count);
        pictures.emplace_back(2, 2, 1, static_cast<float>(azimuths.back() - front));
    }
    return read_front(recognition, "a bear", pictures, azimuths);
}

}  // namespace

DOCTEST_TEST_CASE("the front is where the words for the sides fit, whatever else a picture or a word is liked for") {
    for (const double front : {-3.0, -2.0, -1.0, 0.0, 0.7, 1.6, 3.1})
        for (const int count : {8, 12, 24}) {
            DOCTEST_CAPTURE(front);
            DOCTEST_CAPTURE(count);
            const auto found = read(front, 0.3, count);
            DOCTEST_CHECK(std::abs(std::remainder(found.azimuth - front, 2 * Pi)) < 30 * Pi / 180);
            DOCTEST_CHECK(found.lead > 0.01);
        }
}

DOCTEST_TEST_CASE("pictures that look alike from all sides have no front") {
    DOCTEST_CHECK(std::abs(read(0.7, 0, 12).lead) < 1e-6);
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
