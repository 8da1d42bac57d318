// Things, materials, accessories and grounds that only what draws is to learn.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/laboratory/synth/synth.h"

namespace more_words_test {

namespace {

using namespace gse;
using namespace gse::synth;

bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_more(const SceneSpec& spec) {
    return has(more_object_words(), spec.object) || has(more_material_words(), spec.material) ||
           has(more_accessory_words(), spec.accessory) || has(more_ground_words(), spec.ground) ||
           (has(drawn_vocabulary(), spec.accessory_colour) && !has(material_words(), spec.accessory_colour));
}

bool all_finite(const SynthScene& scene) {
    const auto fine = [](std::span<const float> values) {
        return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
    };
    const auto& set = scene.scene.gaussians;
    return fine(set.position()) && fine(set.log_scale()) && fine(set.rotation()) &&
           fine(set.opacity_logit()) && fine(set.sh());
}

std::size_t count(const SynthScene& scene, Part part) {
    return static_cast<std::size_t>(std::count(scene.parts.begin(), scene.parts.end(), part));
}

/// Positions of a part's splats.
std::vector<float> places(const SynthScene& scene, Part part) {
    std::vector<float> result;
    for (std::size_t i = 0; i < scene.parts.size(); ++i)
        for (std::size_t axis = 0; axis < 3 && scene.parts[i] == part; ++axis)
            result.push_back(scene.scene.gaussians.position()[3 * i + axis]);
    return result;
}

}  // namespace

DOCTEST_TEST_CASE(
    "every further thing stands on the ground, about one unit tall, in every further material and "
    "accessory") {
    std::size_t i = 0;
    for (const auto& object : more_object_words())
        for (const auto& accessory : more_accessory_words()) {
            const SceneSpec spec{.object = object,
                                 .material = more_material_words()[i % more_material_words().size()],
                                 .accessory = accessory,
                                 .ground = more_ground_words()[i % more_ground_words().size()],
                                 .seed = 40 + i};
            ++i;
            DOCTEST_CAPTURE(object);
            DOCTEST_CAPTURE(accessory);
            const auto scene = generate(spec);
            DOCTEST_CHECK(all_finite(scene));
            DOCTEST_CHECK(count(scene, Part::Accessory) > 30);
            const auto position = places(scene, Part::Object);
            double lowest = -10, highest = 10;  // y points down
            for (std::size_t k = 1; k < position.size(); k += 3) {
                lowest = std::max<double>(lowest, position[k]);
                highest = std::min<double>(highest, position[k]);
            }
            DOCTEST_CHECK(std::abs(lowest) < 0.06);
            DOCTEST_CHECK(-highest > 0.5);
            DOCTEST_CHECK(-highest < 1.25);
        }
}

DOCTEST_TEST_CASE("further accessories fit known things, and taking them away changes nothing else") {
    for (const auto& object : object_words())
        for (const auto& accessory : more_accessory_words()) {
            SceneSpec spec{.object = object, .accessory = accessory, .seed = 9};
            DOCTEST_CAPTURE(object);
            DOCTEST_CAPTURE(accessory);
            const auto with = generate(spec);
            DOCTEST_CHECK(count(with, Part::Accessory) > 30);
            spec.accessory.clear();
            DOCTEST_CHECK(places(generate(spec), Part::Object) == places(with, Part::Object));
        }
}

DOCTEST_TEST_CASE("specs of further words have one, are never held out, and others have none") {
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const auto more = training_spec_of_more(random, 0.6),
                   looks = training_spec_of_more(random, 0.6, true);
        DOCTEST_CHECK(is_more(more));
        DOCTEST_CHECK(is_more(looks));
        DOCTEST_CHECK_FALSE(held_out(more));
        DOCTEST_CHECK_FALSE(held_out(looks));
        DOCTEST_CHECK_FALSE(has(more_object_words(), looks.object));
        DOCTEST_CHECK_FALSE(has(more_accessory_words(), looks.accessory));
        DOCTEST_CHECK_FALSE(is_more(random_spec(random, 0.6)));
    }
    const auto& all = drawn_vocabulary();
    DOCTEST_CHECK(std::equal(vocabulary().begin(), vocabulary().end(), all.begin()));
    for (const auto& word : vocabulary())
        DOCTEST_CHECK(std::count(all.begin(), all.end(), word) ==
                      std::count(vocabulary().begin(), vocabulary().end(), word));
}

DOCTEST_TEST_CASE("another variant is another thing on the same ground") {
    for (const char* object : {"cat", "rabbit"}) {
        SceneSpec spec{.object = object, .material = "stone", .seed = 21};
        const auto one = generate(spec);
        spec.variant = 1;
        const auto other = generate(spec);
        DOCTEST_CHECK(places(one, Part::Object) != places(other, Part::Object));
        DOCTEST_CHECK(places(one, Part::Ground) == places(other, Part::Ground));
        DOCTEST_CHECK(turn_of(spec) != turn_of(one.spec));
    }
}

}  // namespace more_words_test
