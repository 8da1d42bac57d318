// Scenes with a thing to remove: the truth is their surroundings, without the shadow.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/laboratory/synth/removal_scene.h"

namespace removal_scene_test {

using namespace gse;

DOCTEST_TEST_CASE("the truth differs from the surroundings in colours alone, and only to lighter ones") {
    for (const auto& name : synth::removal_scene_names()) {
        DOCTEST_INFO(name);
        const auto scene = synth::removal_scene(name, 3, 3000);
        const std::size_t around = scene.surroundings();
        DOCTEST_REQUIRE(around < scene.scene.size());
        const auto first = [](std::span<const float> values, std::size_t count) {
            return values.first(count);
        };
        DOCTEST_CHECK(std::ranges::equal(scene.truth.position(), first(scene.scene.position(), around * 3)));
        DOCTEST_CHECK(
            std::ranges::equal(scene.truth.opacity_logit(), first(scene.scene.opacity_logit(), around)));
        bool lighter = true, shadow = false;
        for (std::size_t i = 0; i < around * 3; ++i) {
            lighter = lighter && scene.truth.sh()[i] >= scene.scene.sh()[i];
            shadow = shadow || scene.truth.sh()[i] > scene.scene.sh()[i] + 0.1F;
        }
        DOCTEST_CHECK(lighter);
        DOCTEST_CHECK(shadow);
        DOCTEST_CHECK(static_cast<std::size_t>(std::count(scene.thing.begin(), scene.thing.end(), 1)) ==
                      scene.scene.size() - around);
    }
}

DOCTEST_TEST_CASE("a thing stands upright at a place of another scene") {
    const auto ground = synth::removal_scene("behind", 3, 3000).truth;
    for (const Vec3& up : {Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0.6, 0.8, 0}}) {
        const Vec3 place{0.2, 0, 0.3};
        const auto scene = synth::removal_scene_on(ground, up, place, 0.5, 4);
        DOCTEST_CHECK(scene.truth.shares_all_with(ground));
        double low = 1e9, high = -1e9, away = 0;
        for (std::size_t row = ground.size(); row < scene.scene.size(); ++row) {
            const float* p = &scene.scene.position()[row * 3];
            const Vec3 at = Vec3{p[0], p[1], p[2]} - place;
            low = std::min(low, dot(at, up)), high = std::max(high, dot(at, up));
            away = std::max(away, length(at - up * dot(at, up)));
        }
        DOCTEST_CHECK(std::abs(low) < 0.01);
        DOCTEST_CHECK(high > 0.35);
        DOCTEST_CHECK(high < 0.65);
        DOCTEST_CHECK(away < 0.5);
    }
}

}  // namespace removal_scene_test
