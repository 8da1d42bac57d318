// Scenes of others put in front of what a view of another shows.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"
#include "engine/pipeline/scene/shown_surface.h"
#include "engine/scene/transform/merge_place.h"
#include "engine/scene/transform/transformed.h"
#include "tests/test_paths.h"

namespace shown_surface_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

/// Height of a set in the picture, of its height.
double seen_height(const Camera& camera, const GaussianSet& set) {
    double low = camera.height, high = 0;
    for (std::size_t row = 0; row < set.size(); ++row) {
        const auto p = set.position().subspan(row * 3, 3);
        const Vec3 at = camera.to_camera({p[0], p[1], p[2]});
        const double y = camera.fy * at.y / at.z + camera.cy;
        if (at.z > 0) low = std::min(low, y), high = std::max(high, y);
    }
    return (high - low) / camera.height;
}

}  // namespace

DOCTEST_TEST_CASE("a scene that is put into a room is seen, from the first view and from others") {
    const auto kitchen = test::shared_folder() / "data/scenes/room_kitchen.v2.spz",
               guitar = test::shared_folder() / "data/scenes/object_guitar.compressed.ply";
    if (!test::available(kitchen) || !test::available(guitar)) return;
    const Scene host = load_standing_scene(kitchen), guest = load_standing_scene(guitar);
    const OrbitParameters orbit = whole_orbit(host, RenderParameters{});
    for (const double azimuth : {-1.0, 0.0, 1.6, 3.1, 4.7}) {
        const Camera camera =
            azimuth < 0 ? first_view(host, 1280, 720) : orbit_camera(orbit, azimuth, 1280, 720);
        MergeWishes wishes;
        wishes.seen = shown_surface(host.gaussians, camera, host.info.antialiased);
        const MergePlace place = merge_place(host, guest, wishes);
        const GaussianSet put_in = transformed(guest.gaussians, place.placement);
        DOCTEST_CAPTURE(azimuth);
        DOCTEST_CHECK(seen_share(*wishes.seen, put_in) > 0.9);  // few of its rows float outside of its box
        DOCTEST_CHECK(seen_height(wishes.seen->camera, put_in) > 1.0 / 12);
    }
}

DOCTEST_TEST_CASE("what stands inside of a closed room is seen from no side of it") {
    Scene room;
    GaussianData data;
    constexpr int Side = 60;  // splats along a wall of two units
    for (int i = 0; i < Side; ++i)
        for (int k = 0; k < Side; ++k)
            for (int face = 0; face < 6; ++face) {
                const std::size_t row = data.size();
                data.resize(row + 1);
                Vec3 at{2.0 * i / Side - 1, 2.0 * k / Side - 1, face % 2 == 0 ? -1.0 : 1.0};
                if (face / 2 == 1) std::swap(at.x, at.z);
                if (face / 2 == 2) std::swap(at.y, at.z);
                for (int axis = 0; axis < 3; ++axis) {
                    data.position[row * 3 + static_cast<std::size_t>(axis)] = static_cast<float>(at[axis]);
                    data.log_scale[row * 3 + static_cast<std::size_t>(axis)] = -3;
                }
                data.rotation[row * 4] = 1;
                data.opacity_logit[row] = 5;
            }
    room.gaussians = GaussianSet(std::move(data));
    const auto at_distance = [&](double away) {
        return transformed(room.gaussians, Affine::move_by({0, 0, away}) * Affine::scale_about(0.2, {}));
    };
    DOCTEST_CHECK_FALSE(is_seen_from_around(room, at_distance(0)));
    DOCTEST_CHECK(is_seen_from_around(room, at_distance(-1.3)));
}

}  // namespace shown_surface_test
