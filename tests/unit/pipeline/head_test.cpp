// Wearer of an accessory: the head, where it is smaller than those of the figures that the model learned
// from.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/edit/placement/head.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/run/edit_job.h"
#include "tests/unit/edit/box_rows.h"
#include "tests/unit/edit/requests.h"

namespace head_test {

namespace {

using namespace gse;

const Vec3 Up{0, -1, 0}, Front{0, 0, -1};

std::vector<std::uint8_t> thing_bits(const synth::SynthScene& made) {
    std::vector<std::uint8_t> bits;
    for (const auto part : made.parts) bits.push_back(part == synth::Part::Object ? 1 : 0);
    return bits;
}

/// A person 1.8 high on a ground, arms out, with some haze above and around that is too faint to be one.
test::BoxRows person() {
    test::BoxRows rows;
    rows.box(-0.09, 0.09, 1.55, 1.8, -0.1, 0.1, 400, true)
        .box(-0.05, 0.05, 1.45, 1.55, -0.05, 0.05, 100, true);
    rows.box(-0.5, 0.5, 1.2, 1.45, -0.12, 0.12, 900, true).box(-0.2, 0.2, 0, 1.2, -0.12, 0.12, 1500, true);
    rows.box(-3, 3, -0.01, 0.01, -3, 3, 3000, false);
    return rows;
}

edit::CheckedRequest wearing(const std::string& thing) {
    return test::asked("person", "a person wearing " + thing, thing);
}

double lowest(const GaussianSet& set, const std::vector<std::uint8_t>& bits) {
    double low = 1e300;
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (bits[row] != 0) low = std::min(low, -static_cast<double>(set.position()[row * 3 + 1]));
    return low;
}

/// Largest distance of a row of the head from (x, z).
double reach(const GaussianSet& set, const edit::HeadRegion& head, double x, double z) {
    double most = 0;
    for (std::size_t row = 0; row < head.bits.size(); ++row)
        if (head.bits[row] != 0)
            most = std::max<double>(most,
                                    std::hypot(set.position()[row * 3] - x, set.position()[row * 3 + 2] - z));
    return most;
}

}  // namespace

DOCTEST_TEST_CASE("the heads of all figures that the bundled model learned from are large") {
    for (const auto& object : synth::object_words())
        for (std::uint64_t seed = 700; seed < 703; ++seed) {
            DOCTEST_CAPTURE(object);
            synth::SceneSpec spec;
            spec.object = object;
            spec.seed = seed;
            const auto made = synth::generate(spec);
            const auto& set = made.scene.gaussians;
            const auto bits = thing_bits(made);
            DOCTEST_CHECK(edit::bust_of(set, bits, Up, Front).head >= edit::ModelTraits{}.small_head);
            DOCTEST_CHECK(
                edit::wearer_of(wearing("hat"), set, bits, Up, Front, true, edit::ModelTraits{}).bits ==
                bits);
        }
}

DOCTEST_TEST_CASE("a person's hat goes to the head, a scarf to head and neck, wings to all of it") {
    const auto rows = person();
    const auto set = rows.set();
    const auto bust = edit::bust_of(set, rows.bits, Up, Front);
    DOCTEST_CHECK(bust.head * 1.8 < 0.3);  // the head is 0.25 high
    const auto whole =
        edit::wearer_of(wearing("wings"), set, rows.bits, Up, Front, true, edit::ModelTraits{});
    DOCTEST_CHECK(whole.bits == rows.bits);
    DOCTEST_CHECK(whole.standing.height == doctest::Approx(1.8).epsilon(0.05));
    DOCTEST_CHECK(
        edit::wearer_of(wearing("hat"), set, rows.bits, Up, Front, false, edit::ModelTraits{}).bits ==
        rows.bits);  // nothing is drawn into the views
    const auto hat =
        edit::wearer_of(wearing("red hat"), set, rows.bits, Up, Front, true, edit::ModelTraits{});
    DOCTEST_CHECK(hat.bits == bust.bits);
    DOCTEST_CHECK(lowest(set, hat.bits) > 1.45);
    DOCTEST_CHECK(hat.standing.height < 0.3);  // the shoulders below are no ground that it stands on
    const auto scarf =
        edit::wearer_of(wearing("scarf"), set, rows.bits, Up, Front, true, edit::ModelTraits{});
    DOCTEST_CHECK(lowest(set, scarf.bits) < 1.5);  // the neck ends at 1.45
    DOCTEST_CHECK(lowest(set, scarf.bits) > 1.2);
}

DOCTEST_TEST_CASE("wings beside a head are no part of it, and make it no larger") {
    auto rows = person();
    const auto alone = edit::bust_of(rows.set(), rows.bits, Up, Front);
    for (const double side : {-0.3, 0.3})
        rows.box(side - 0.15, side + 0.15, 1.2, 1.65, 0.08, 0.12, 500, true);
    const auto set = rows.set();
    const auto winged = edit::bust_of(set, rows.bits, Up, Front);
    DOCTEST_CHECK(winged.head == doctest::Approx(alone.head).epsilon(0.25));
    DOCTEST_CHECK(reach(set, winged, 0, 0) < 0.25);
}

DOCTEST_TEST_CASE("the head of an animal is the end that rises above its back, not all of its top") {
    test::BoxRows rows;  // neck and head upright over one end of a body four times as long as wide
    rows.box(-0.2, 0.2, 0.8, 1.2, -0.8, 0.8, 3000, true).box(-0.1, 0.1, 1.2, 1.7, 0.55, 0.8, 700, true);
    for (const double z : {-0.7, 0.7}) rows.box(-0.15, 0.15, 0, 0.8, z - 0.1, z + 0.1, 500, true);
    const auto set = rows.set();
    const auto bust = edit::bust_of(set, rows.bits, Up, Front);
    DOCTEST_CHECK(bust.head < 0.26);
    DOCTEST_CHECK(reach(set, bust, 0, 0.675) < 0.3);
}

DOCTEST_TEST_CASE("where the head of a walking animal hangs lower than its back, none is clear") {
    test::BoxRows low;
    low.box(-0.2, 0.2, 0.5, 1, -0.8, 0.8, 3000, true).box(-0.15, 0.15, 0.4, 0.8, 0.8, 1.2, 700, true);
    for (const double z : {-0.7, 0.7}) low.box(-0.15, 0.15, 0, 0.5, z - 0.1, z + 0.1, 500, true);
    const edit::ModelTraits traits;
    DOCTEST_CHECK(edit::is_head_unclear(low.set(), low.bits, Up, Front, traits));
    auto head = low;  // labelled alone: it was pointed at
    std::fill(head.bits.begin(), head.bits.end(), std::uint8_t{0});
    std::fill(head.bits.begin() + 3000, head.bits.begin() + 3700, std::uint8_t{1});
    DOCTEST_CHECK_FALSE(edit::is_head_unclear(head.set(), head.bits, Up, Front, traits));
    const auto upright = person();
    DOCTEST_CHECK_FALSE(edit::is_head_unclear(upright.set(), upright.bits, Up, Front, traits));
}

DOCTEST_TEST_CASE("a cone has no head") {
    test::BoxRows rows;
    for (int slice = 0; slice < 40; ++slice) {
        const double half = 0.5 * (1 - slice / 40.0);
        rows.box(-half, half, slice * 0.05, (slice + 1) * 0.05, -half, half, 40 + 400 * half, true);
    }
    DOCTEST_CHECK(edit::bust_of(rows.set(), rows.bits, Up, Front).head >= edit::ModelTraits{}.small_head);
}

DOCTEST_TEST_CASE(
    "rows of a label that are too faint to be seen are no part of the head, nor is the head made of them") {
    auto rows = person();
    const auto before = edit::bust_of(rows.set(), rows.bits, Up, Front);
    const auto seen = rows.bits.size();
    rows.box(-0.8, 0.8, 0, 2.4, -0.8, 0.8, 500, true);
    GaussianData data = rows.data;
    for (std::size_t row = seen; row < rows.bits.size(); ++row)
        data.opacity_logit[row] = -4;  // opacity 0.018
    const GaussianSet hazy(std::move(data));
    const auto after = edit::bust_of(hazy, rows.bits, Up, Front);
    DOCTEST_CHECK(after.head == before.head);
    DOCTEST_CHECK(std::vector<std::uint8_t>(after.bits.begin(),
                                            after.bits.begin() + static_cast<std::ptrdiff_t>(seen)) ==
                  before.bits);
    DOCTEST_CHECK(std::count(after.bits.begin() + static_cast<std::ptrdiff_t>(seen), after.bits.end(), 1) ==
                  0);
}

#ifdef GSE_NEURAL
DOCTEST_TEST_CASE(
    "a person's hat is drawn around the head, and the film shows the person from head to foot") {
    const auto rows = person();
    Scene scene;
    scene.gaussians = rows.set();
    scene.info.up = Up;
    auto request = test::asked("person", "a person wearing a red hat", "hat");
    request.views = 8;
    request.place_views = request.shape_views = 4;
    request.place_steps = request.shape_steps = 1;
    request.shape_fit_steps = 2;
    pipeline::EditRecipe recipe;
    recipe.request = request.plain();
    pipeline::EditJob job(recipe, {scene, {}, pipeline::load_recipe_model({}), rows.bits}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    DOCTEST_REQUIRE(job.located().mode == edit::EditMode::Add);
    const Camera near = job.views().front().camera;  // a head of 0.25 in a picture of 1.74 times its height
    DOCTEST_CHECK(near.width / near.fx * near.to_camera({0, -1.7, 0}).z < 1);
    job.run({});
    const Camera film = orbit_camera(job.film_orbit(), 0, 100, 100);
    for (const double height : {0.02, 1.78}) {
        const Vec3 end = film.to_camera({0, -height, 0});
        DOCTEST_CHECK(std::abs(film.fy * end.y / end.z) < 50);
    }
}
#endif

DOCTEST_TEST_CASE("only what is worn takes the place of something worn, and only where it replaces it") {
    const auto instead = [](const std::string& source, const std::string& target) {
        return language::EditSentence(language::Sentence("a bear with " + target), source, target);
    };
    const auto crown = instead("hat", "crown"), sunglasses = instead("hat", "sunglasses");
    DOCTEST_CHECK(edit::replaces_accessory(crown, edit::EditMode::Replace));
    DOCTEST_CHECK_FALSE(edit::replaces_accessory(crown, edit::EditMode::Add));
    DOCTEST_CHECK_FALSE(edit::replaces_accessory(crown, edit::EditMode::Modify));
    DOCTEST_CHECK_FALSE(edit::moves_worn_place(crown, edit::EditMode::Replace));
    DOCTEST_CHECK(edit::moves_worn_place(sunglasses, edit::EditMode::Replace));
    DOCTEST_CHECK_FALSE(edit::moves_worn_place(sunglasses, edit::EditMode::Modify));
    // Of a crown on the ground.
    DOCTEST_CHECK_FALSE(edit::replaces_accessory(instead("ball", "sunglasses"), edit::EditMode::Replace));
    DOCTEST_CHECK_FALSE(edit::replaces_accessory(instead("hat", "ball"), edit::EditMode::Replace));
}

}  // namespace head_test
