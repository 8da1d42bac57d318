// Displacements of redrawn pictures.
#include <doctest/doctest.h>

#include "engine/remote/views/registration.h"
#include "tests/unit/remote/test_pictures.h"

namespace registration_test {
namespace {

using namespace gse;
using namespace gse::remote;

using namespace remote_pictures;

constexpr int Side = 256;

DOCTEST_TEST_CASE("registration: finds shifts and scales around a changed object, and undoes them") {
    const auto sent = waves(Side);
    const auto mask = disc(Side, 70);
    struct Case {
        double dx, dy, scale;
    };
    for (const auto& [dx, dy, scale] :
         {Case{0, 0, 1}, {1, 0, 1}, {-3.4, 2.2, 1}, {5, -4, 1}, {2, 1, 1.015}}) {
        DOCTEST_CAPTURE(dx);
        DOCTEST_CAPTURE(scale);
        auto drawn = waves(Side, dx, dy, scale);
        paint(drawn, mask, {0.9f, 0.7f, 0.1f});
        add_noise(drawn, 0.02, 3);
        const auto found = register_pictures(sent, drawn, mask);
        DOCTEST_REQUIRE(found.has_value());
        DOCTEST_CHECK(found->dx * Side == doctest::Approx(dx).epsilon(0.02).scale(5));
        DOCTEST_CHECK(found->dy * Side == doctest::Approx(dy).epsilon(0.02).scale(5));
        DOCTEST_CHECK(found->scale == doctest::Approx(scale).epsilon(0.002));
        const auto back = moved_back(waves(Side, dx, dy, scale), *found);
        double most = 0;
        for (int y = 16; y < Side - 16; ++y)
            for (int x = 16; x < Side - 16; ++x)
                most = std::max(most, std::abs(static_cast<double>(back.at(x, y, 0) - sent.at(x, y, 0))));
        DOCTEST_CHECK(most < 0.03);
    }
}

DOCTEST_TEST_CASE("registration: a shift of a tenth of the picture is found, and its reach told") {
    const auto found = register_pictures(waves(Side), waves(Side, 20, 0), disc(Side, 60));
    DOCTEST_REQUIRE(found.has_value());
    DOCTEST_CHECK(found->reach() * Side == doctest::Approx(20).epsilon(0.05));
}

DOCTEST_TEST_CASE("registration: an even picture, and one that changes everywhere, tell nothing") {
    const Image even(Side, Side, 3, 0.5f);
    DOCTEST_CHECK(!register_pictures(even, even, disc(Side, 60)).has_value());
    DOCTEST_CHECK(!register_pictures(waves(Side), waves(Side), Mask(Side, Side, 1)).has_value());
}

}  // namespace
}  // namespace registration_test
