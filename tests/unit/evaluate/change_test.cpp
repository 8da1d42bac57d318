// Direction of a change in an encoder's space, and sameness of a change along a path.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.h"
#include "engine/evaluate/consistency.h"
#include "engine/evaluate/direction.h"

namespace change_test {

namespace {

using namespace gse;
using namespace gse::evaluate;

constexpr double Rounding = 1e-6;  // vectors and pictures are float

using Vector = std::vector<float>;

Vector noise(std::uint64_t seed) {
    Random random(seed);
    Vector vector(16);
    for (auto& value : vector) value = static_cast<float>(random.normal());
    return vector;
}

Vector scaled(Vector vector, float factor) {
    for (auto& value : vector) value *= factor;
    return vector;
}

/// Four pictures of random noise; `after` is each plus its own shift inside the left half.
struct Path {
    std::vector<Image> before, after;
    std::vector<Mask> masks;
    explicit Path(const std::vector<float>& shifts) {
        for (std::size_t i = 0; i < shifts.size(); ++i) {
            Random random(i + 1);
            Image picture(8, 6, 3);
            for (auto& value : picture.data) value = static_cast<float>(random.uniform());
            Image edited = picture;
            Mask mask(8, 6);
            for (int y = 0; y < 6; ++y)
                for (int x = 0; x < 4; ++x) {
                    mask.at(x, y) = 1;
                    for (int c = 0; c < 3; ++c) edited.at(x, y, c) += shifts[i];
                }
            before.push_back(picture);
            after.push_back(edited);
            masks.push_back(mask);
        }
    }
    double value(bool closed = true) const { return path_inconsistency({before, after, masks, closed}); }
};

}  // namespace

DOCTEST_TEST_CASE("a picture that changes as the words do scores 1, against them -1") {
    const Vector from = noise(1), to = noise(2);
    DOCTEST_CHECK(direction_score({from, to, from, to}) == doctest::Approx(1));
    DOCTEST_CHECK(direction_score({to, from, from, to}) == doctest::Approx(-1));
    // Lengths do not matter, only directions do.
    DOCTEST_CHECK(direction_score({scaled(from, 3), scaled(to, 0.2f), from, scaled(to, 7)}) ==
                  doctest::Approx(1));
}

DOCTEST_TEST_CASE("no change has no direction") {
    const Vector from = noise(1), to = noise(2);
    DOCTEST_CHECK(direction_score({from, from, from, to}) == 0);
    DOCTEST_CHECK(direction_score({from, scaled(from, 2), from, to}) == 0);
    DOCTEST_CHECK(direction_score({from, to, from, from}) == 0);
    DOCTEST_CHECK(cosine(Vector(16, 0.0f), from) == 0);
    DOCTEST_CHECK(std::abs(cosine(from, from) - 1) < Rounding);
}

DOCTEST_TEST_CASE("the same change everywhere is consistent, whatever the pictures show") {
    DOCTEST_CHECK(Path({0.25f, 0.25f, 0.25f, 0.25f}).value() < Rounding);
    DOCTEST_CHECK(Path({0, 0, 0, 0}).value() == 0);
}

DOCTEST_TEST_CASE("a change that flickers is measured by its size") {
    DOCTEST_CHECK(Path({0.3f, 0, 0.3f, 0}).value() == doctest::Approx(0.3).epsilon(1e-4));
    // One step up between four pictures: once on the open path, twice around the closed one.
    DOCTEST_CHECK(Path({0, 0, 0.3f, 0.3f}).value(false) == doctest::Approx(0.1).epsilon(1e-4));
    DOCTEST_CHECK(Path({0, 0, 0.3f, 0.3f}).value(true) == doctest::Approx(0.15).epsilon(1e-4));
}

DOCTEST_TEST_CASE("pictures that do not show the edit are no neighbours") {
    Path path({0.3f, 0.9f, 0.3f, 0.3f});
    path.masks[1] = Mask(8, 6);
    DOCTEST_CHECK(path.value() < Rounding);
    for (auto& mask : path.masks) mask = Mask(8, 6);
    DOCTEST_CHECK(path.value() == 0);
}

}  // namespace change_test
