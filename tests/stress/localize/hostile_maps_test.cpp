// Maps and masks nobody expects: empty, one pixel, non-finite, enormous.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>

#include "engine/localize/back_projection.h"
#include "engine/localize/clusters.h"
#include "engine/localize/points.h"

namespace hostile_maps_test {

namespace {

using namespace gse;

}  // namespace

DOCTEST_TEST_CASE("sizes from nothing to a large picture") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {3, 2}, {512, 384}}) {
        const Mask full(width, height, 1);
        const Image map(width, height, 1, 1);
        const auto clusters = localize::dbscan(full, {2, 4});
        DOCTEST_CHECK(clusters.size() == full.data.size());
        localize::clean_clusters(full, map, {2, 4}, 0.25);
        for (const auto& point : localize::choose_points(map, full)) {
            DOCTEST_CHECK((point.x > 0 && point.x < width));
            DOCTEST_CHECK((point.y > 0 && point.y < height));
        }
        DOCTEST_CHECK(localize::dilate(full, 3).count() == full.data.size());
        DOCTEST_CHECK(localize::resize_mask(full, 7, 5).count() == 35);
        DOCTEST_CHECK(localize::resize_image(map, 64, 64).data[2080] == doctest::Approx(1));
    }
}

DOCTEST_TEST_CASE("values that are not numbers are outside") {
    Image map(8, 8, 1, std::numeric_limits<float>::quiet_NaN());
    map.at(3, 3, 0) = std::numeric_limits<float>::infinity();
    const Mask mask = localize::threshold_map(map, 0.5);
    DOCTEST_CHECK(mask.count() == 1);
    localize::clean_clusters(mask, map, {2, 1}, 0.25);
    localize::choose_points(map, mask);
}

DOCTEST_TEST_CASE("a label of a scene that nobody sees is empty") {
    GaussianData data;
    data.resize(5);
    for (std::size_t row = 0; row < 5; ++row)
        data.position[row * 3 + 2] = -100, data.opacity_logit[row] = -30;
    const GaussianSet set(std::move(data));
    const auto rasterizer = raster::make_plain_rasterizer();
    OrbitParameters orbit;
    std::vector<localize::MaskedView> views;
    for (const auto& view : orbit_views(orbit, 4, 16, 16))
        views.push_back({view.camera, Image(16, 16, 1, 1), false});
    const auto field = localize::back_project(set.spans(), views, {}, *rasterizer);
    const auto label = localize::bits(field, 0.5, 0);
    for (const auto bit : label) DOCTEST_CHECK(bit == 0);
    for (const float share : field.probability) DOCTEST_CHECK(share == 0);
}

}  // namespace hostile_maps_test
