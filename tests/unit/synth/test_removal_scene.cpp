// Scenes with a thing to remove: the truth is their surroundings, without the shadow.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>

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

}  // namespace removal_scene_test
