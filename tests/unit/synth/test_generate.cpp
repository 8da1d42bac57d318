// Properties of generated scenes: reproducible, labelled, finite, and exact under edits of one part.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/error.h"
#include "engine/laboratory/synth/synth.h"

namespace test_generate {

using namespace gse;
using namespace gse::synth;

namespace {

std::vector<float> rows(std::span<const float> values, const std::vector<Part>& parts, Part part) {
    const std::size_t stride = values.size() / parts.size();
    std::vector<float> result;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i] == part)
            result.insert(result.end(), values.begin() + static_cast<std::ptrdiff_t>(i * stride),
                          values.begin() + static_cast<std::ptrdiff_t>((i + 1) * stride));
    return result;
}

bool same(std::span<const float> a, std::span<const float> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

/// Bit-identical rows of one part, with or without the colours.
bool same_part(const SynthScene& a, const SynthScene& b, Part part, bool with_colour) {
    const auto& g = a.scene.gaussians;
    const auto& h = b.scene.gaussians;
    return rows(g.position(), a.parts, part) == rows(h.position(), b.parts, part) &&
           rows(g.log_scale(), a.parts, part) == rows(h.log_scale(), b.parts, part) &&
           rows(g.rotation(), a.parts, part) == rows(h.rotation(), b.parts, part) &&
           rows(g.opacity_logit(), a.parts, part) == rows(h.opacity_logit(), b.parts, part) &&
           (!with_colour || rows(g.sh(), a.parts, part) == rows(h.sh(), b.parts, part));
}

std::ptrdiff_t count(const SynthScene& scene, Part part) {
    return std::count(scene.parts.begin(), scene.parts.end(), part);
}

/// Mean colour of the rows of a part, as displayed.
Vec3 mean_colour(const SynthScene& scene, Part part) {
    Vec3 sum{};
    const auto sh = scene.scene.gaussians.sh();
    for (std::size_t i = 0; i < scene.parts.size(); ++i)
        if (scene.parts[i] == part)
            sum = sum + Vec3{colour_from_sh(sh[3 * i]), colour_from_sh(sh[3 * i + 1]),
                             colour_from_sh(sh[3 * i + 2])};
    return sum / static_cast<double>(count(scene, part));
}

/// Every object with every accessory and every material and ground at least once.
std::vector<SceneSpec> all_words() {
    std::vector<SceneSpec> specs;
    for (const auto& object : object_words())
        for (const auto& accessory : accessory_words()) {
            const std::size_t i = specs.size();
            const auto& colours = accessory_colour_words(accessory);
            specs.push_back({.object = object,
                             .material = material_words()[i % material_words().size()],
                             .accessory = accessory,
                             .accessory_colour = colours.empty() ? "" : colours[i % colours.size()],
                             .ground = ground_words()[i % ground_words().size()],
                             .seed = 100 + i});
        }
    return specs;
}

}  // namespace

DOCTEST_TEST_CASE("the word lists are long enough and the generator knows all of them") {
    DOCTEST_CHECK(object_words().size() >= 8);
    DOCTEST_CHECK(material_words().size() >= 8);
    DOCTEST_CHECK(accessory_words().size() >= 5);
    DOCTEST_CHECK(ground_words().size() >= 4);
    for (const auto& spec : all_words()) {
        DOCTEST_CAPTURE(spec.object);
        DOCTEST_CAPTURE(spec.accessory);
        const SynthScene scene = generate(spec);
        DOCTEST_CHECK(scene.parts.size() == scene.scene.gaussians.size());
        for (const Part part : {Part::Ground, Part::Object, Part::Accessory})
            DOCTEST_CHECK(count(scene, part) > 400);
    }
}

DOCTEST_TEST_CASE("every attribute is finite and colours are displayable") {
    for (const auto& spec : all_words()) {
        const SynthScene scene = generate(spec);
        const auto& set = scene.scene.gaussians;
        const auto finite = [](std::span<const float> values) {
            return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
        };
        DOCTEST_CHECK(finite(set.position()));
        DOCTEST_CHECK(finite(set.log_scale()));
        DOCTEST_CHECK(finite(set.rotation()));
        DOCTEST_CHECK(finite(set.opacity_logit()));
        DOCTEST_CHECK(finite(set.sh()));
        constexpr double Rounding = 1e-5;  // colours go through float SH coefficients
        for (const float value : set.sh()) {
            const double colour = colour_from_sh(static_cast<double>(value));
            if (colour < -Rounding || colour > 1 + Rounding)
                DOCTEST_FAIL_CHECK("colour " << colour << " outside [0,1]");
        }
        const SceneStatistics statistics = compute_statistics(set);
        DOCTEST_CHECK(statistics.zero_quaternion_rows == 0);
        DOCTEST_CHECK(statistics.invisible_rows == 0);
        DOCTEST_CHECK(statistics.giant_rows == 0);
    }
}

DOCTEST_TEST_CASE("the same spec gives the same bits, another seed another shape") {
    const SceneSpec spec{.object = "dog",
                         .material = "wooden",
                         .accessory = "scarf",
                         .accessory_colour = "blue",
                         .ground = "sand",
                         .seed = 77};
    const SynthScene a = generate(spec);
    const SynthScene b = generate(spec);
    DOCTEST_CHECK(a.parts == b.parts);
    for (const Part part : {Part::Ground, Part::Object, Part::Accessory})
        DOCTEST_CHECK(same_part(a, b, part, true));
    SceneSpec other = spec;
    other.seed = 78;
    DOCTEST_CHECK_FALSE(same_part(a, generate(other), Part::Object, false));
}

DOCTEST_TEST_CASE("another material changes nothing but the object's colours") {
    for (const auto& object : object_words()) {
        SceneSpec spec{
            .object = object, .material = "red", .accessory = "hat", .accessory_colour = "green", .seed = 5};
        const SynthScene before = generate(spec);
        for (const char* material : {"blue", "stone", "golden"}) {
            DOCTEST_CAPTURE(object);
            DOCTEST_CAPTURE(material);
            spec.material = material;
            const SynthScene after = generate(spec);
            DOCTEST_CHECK(after.parts == before.parts);
            DOCTEST_CHECK(same(after.scene.gaussians.position(), before.scene.gaussians.position()));
            DOCTEST_CHECK(same_part(before, after, Part::Object, false));
            DOCTEST_CHECK_FALSE(same_part(before, after, Part::Object, true));
            DOCTEST_CHECK(same_part(before, after, Part::Ground, true));
            DOCTEST_CHECK(same_part(before, after, Part::Accessory, true));
        }
    }
}

DOCTEST_TEST_CASE("taking the accessory away leaves ground and object bit-identical") {
    for (const auto& spec : all_words()) {
        SceneSpec bare = spec;
        bare.accessory = bare.accessory_colour = "";
        const SynthScene with = generate(spec);
        const SynthScene without = generate(bare);
        DOCTEST_CHECK(count(without, Part::Accessory) == 0);
        DOCTEST_CHECK(same_part(with, without, Part::Ground, true));
        DOCTEST_CHECK(same_part(with, without, Part::Object, true));
    }
}

DOCTEST_TEST_CASE("another ground or accessory colour leaves the other parts as they are") {
    SceneSpec spec{.object = "cat", .material = "white", .accessory = "crown", .ground = "grass", .seed = 9};
    const SynthScene before = generate(spec);
    spec.ground = "tiles";
    const SynthScene tiles = generate(spec);
    DOCTEST_CHECK(same_part(before, tiles, Part::Object, true));
    DOCTEST_CHECK(same_part(before, tiles, Part::Accessory, true));
    DOCTEST_CHECK_FALSE(same_part(before, tiles, Part::Ground, true));
    spec.ground = "grass";
    spec.accessory_colour = "blue";
    const SynthScene blue = generate(spec);
    DOCTEST_CHECK(same_part(before, blue, Part::Accessory, false));
    DOCTEST_CHECK_FALSE(same_part(before, blue, Part::Accessory, true));
}

DOCTEST_TEST_CASE("the budget of Gaussians is kept") {
    constexpr double Over = 1.1;    // hidden points are estimated, not known, before sampling
    constexpr double Under = 0.65;  // without an accessory its share is not used
    for (const int budget : {2000, 6000, 50000})
        for (const auto& object : object_words()) {
            SceneSpec spec{.object = object, .seed = 3, .gaussian_budget = budget};
            DOCTEST_CAPTURE(budget);
            DOCTEST_CAPTURE(object);
            DOCTEST_CHECK(static_cast<double>(generate(spec).parts.size()) > Under * budget);
            spec.accessory = "scarf";
            DOCTEST_CHECK(static_cast<double>(generate(spec).parts.size()) < Over * budget);
        }
}

DOCTEST_TEST_CASE("objects stand on the ground, about one unit tall, facing -z") {
    for (const auto& object : object_words())
        for (std::uint64_t seed = 0; seed < 8; ++seed) {
            DOCTEST_CAPTURE(object);
            const SynthScene scene = generate({.object = object, .seed = seed});
            const auto position = rows(scene.scene.gaussians.position(), scene.parts, Part::Object);
            double lowest = -10, highest = 10;  // y points down
            for (std::size_t i = 1; i < position.size(); i += 3) {
                lowest = std::max<double>(lowest, position[i]);
                highest = std::min<double>(highest, position[i]);
            }
            DOCTEST_CHECK(std::abs(lowest) < 0.05);
            DOCTEST_CHECK(-highest > 0.55);
            DOCTEST_CHECK(-highest < 1.2);
            DOCTEST_CHECK(scene.head.y < -0.45);
        }
}

DOCTEST_TEST_CASE("colour words mean their colours") {
    const auto object_colour = [](const char* material) {
        return mean_colour(generate({.object = "ball", .material = material, .seed = 4}), Part::Object);
    };
    const Vec3 red = object_colour("red"), blue = object_colour("blue"), green = object_colour("green");
    DOCTEST_CHECK(red.x > 2 * std::max(red.y, red.z));
    DOCTEST_CHECK(blue.z > 2 * std::max(blue.x, blue.y));
    DOCTEST_CHECK(green.y > 2 * std::max(green.x, green.z));
    const Vec3 yellow = object_colour("yellow"), golden = object_colour("golden");
    DOCTEST_CHECK(golden.y < yellow.y - 0.1);  // golden is browner
    // Every two materials differ in their mean colour, stone aside (its mean is a grey of its own).
    constexpr double Distinct = 0.09;
    for (const auto& a : material_words())
        for (const auto& b : material_words()) {
            if (a >= b) continue;
            DOCTEST_CAPTURE(a);
            DOCTEST_CAPTURE(b);
            DOCTEST_CHECK(length(object_colour(a.c_str()) - object_colour(b.c_str())) > Distinct);
        }
}

DOCTEST_TEST_CASE("an accessory is large and sits at the head") {
    for (const auto& object : object_words()) {
        DOCTEST_CAPTURE(object);
        const SynthScene scene =
            generate({.object = object, .accessory = "hat", .accessory_colour = "red", .seed = 2});
        const auto hat = rows(scene.scene.gaussians.position(), scene.parts, Part::Accessory);
        double left = 10, right = -10, top = 10, bottom = -10;
        for (std::size_t i = 0; i < hat.size(); i += 3) {
            left = std::min<double>(left, hat[i]);
            right = std::max<double>(right, hat[i]);
            top = std::min<double>(top, hat[i + 1]);
            bottom = std::max<double>(bottom, hat[i + 1]);
        }
        DOCTEST_CHECK(right - left > 0.5);
        DOCTEST_CHECK(bottom - top > 0.22);
        const auto body = rows(scene.scene.gaussians.position(), scene.parts, Part::Object);
        double highest = 10;
        for (std::size_t i = 1; i < body.size(); i += 3) highest = std::min<double>(highest, body[i]);
        DOCTEST_CHECK(top < highest);
        DOCTEST_CHECK(std::abs(bottom - highest) < 0.3);
    }
}

DOCTEST_TEST_CASE("the cameras frame the scene and follow the azimuth") {
    const SynthScene scene = generate({.object = "bear", .accessory = "hat", .seed = 1});
    for (const double azimuth : {0.0, 1.5, 3.1}) {
        const Camera camera = scene_camera(scene, azimuth, 0.3, 1.0, 64, 64);
        std::size_t inside = 0, all = 0;
        const auto position = scene.scene.gaussians.position();
        for (std::size_t i = 0; i < scene.parts.size(); ++i) {
            if (scene.parts[i] == Part::Ground) continue;
            const Vec3 p = camera.to_camera({position[3 * i], position[3 * i + 1], position[3 * i + 2]});
            const double u = camera.fx * p.x / p.z + camera.cx, v = camera.fy * p.y / p.z + camera.cy;
            ++all;
            inside += p.z > 0.2 && u > 0 && u < 64 && v > 0 && v < 64 ? 1u : 0u;
        }
        DOCTEST_CHECK(inside == all);
    }
    DOCTEST_CHECK(scene_camera(scene, 0, 0.3, 1, 64, 64).centre().z < -1);
    DOCTEST_CHECK(scene_camera(scene, 3.14159, 0.3, 1, 64, 64).centre().z > 1);
    DOCTEST_CHECK(scene_camera(scene, 0, 0.3, 1, 64, 64).centre().y < 0);  // above the ground
    const Camera wide = scene_camera(scene, 0, 0.3, 1, 128, 64);
    constexpr double Rounding = 1e-9;
    DOCTEST_CHECK(std::abs(wide.fy - scene_camera(scene, 0, 0.3, 1, 64, 64).fy) < Rounding);
    const Camera close = head_camera(scene, 0.2, 0.2, 1.6, 64, 64);
    const Vec3 head = close.to_camera(scene.head);
    DOCTEST_CHECK(std::abs(head.x) < Rounding);
    DOCTEST_CHECK(std::abs(head.y) < Rounding);
}

DOCTEST_TEST_CASE("unknown words are refused with the known ones") {
    DOCTEST_CHECK_THROWS_AS(generate({.object = "unicorn"}), Error);
    DOCTEST_CHECK_THROWS_AS(generate({.material = "furry"}), Error);
    DOCTEST_CHECK_THROWS_AS(generate({.accessory = "cigar"}), Error);
    DOCTEST_CHECK_THROWS_AS(generate({.ground = "lava"}), Error);
    try {
        generate({.object = "unicorn"});
    } catch (const Error& error) {
        DOCTEST_CHECK(std::string(error.what()).find("bear") != std::string::npos);
    }
}

DOCTEST_TEST_CASE("a thing shows its front to the azimuth at which it is turned to") {
    SceneSpec spec;
    spec.object = "dog";  // its face is before its middle
    for (const std::uint64_t seed : {1, 2, 3}) {
        spec.seed = seed;
        spec.heading = 0;
        const double turn = turn_of(spec);
        DOCTEST_CHECK(std::abs(turn) <= 0.22);
        for (const double heading : {0.0, 1.0, -2.0}) {
            spec.heading = heading;
            DOCTEST_CHECK(turn_of(spec) == doctest::Approx(turn + heading));
            const auto scene = generate(spec);
            Vec3 middle{};
            for (std::size_t row = 0; row < scene.parts.size(); ++row)
                if (scene.parts[row] == Part::Object)
                    middle = middle + Vec3{scene.scene.gaussians.position()[row * 3], 0,
                                           scene.scene.gaussians.position()[row * 3 + 2]};
            middle = middle * (1.0 / static_cast<double>(count(scene, Part::Object)));
            const Vec3 camera = scene_camera(scene, turn_of(spec), 0, 1, 8, 8).centre();
            const Vec3 face = scene.head - middle;
            const double along = face.x * camera.x + face.z * camera.z;
            DOCTEST_CHECK(along >
                          0.98 * std::hypot(face.x, face.z) * std::hypot(camera.x, camera.z));  // 11 degrees
        }
    }
}

}  // namespace test_generate
