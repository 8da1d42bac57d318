// Tells whether drawn scenes count as things on a ground.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/laboratory/synth/without_ground.h"

namespace scene_ground_test {

using namespace gse;

DOCTEST_TEST_CASE("drawn scenes stand on their own ground, and without it in nothing") {
    ThreadPool pool{1};
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        Random random(seed);
        const auto scene = synth::generate(synth::held_out_spec(random, 0.5));
        DOCTEST_INFO(scene.spec.object, " ", scene.spec.accessory, " on ", scene.spec.ground);
        const auto& set = scene.scene.gaussians;
        const auto views = orbit_views(fit_orbit(compute_statistics(set), scene.scene.info.up), 6, 48, 48);
        DOCTEST_CHECK_FALSE(
            edit::ground_below("a cat", set, views, scene.scene.info.up, *rasterizer, edit::ModelTraits{})
                .has_value());
        DOCTEST_CHECK(edit::ground_below("a cat", synth::without_ground(scene).scene.gaussians, views,
                                         scene.scene.info.up, *rasterizer, edit::ModelTraits{})
                          .has_value());
    }
}

}  // namespace scene_ground_test
