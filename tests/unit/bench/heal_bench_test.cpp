// Healed scenes are nearer to the truth than scenes with a hole, and nothing else in them changes.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/laboratory/bench/heal_bench.h"

namespace heal_bench_test {

using namespace gse;

DOCTEST_TEST_CASE("healing beats deletion and a mean colour") {
    bench::HealBenchParameters parameters;
    parameters.kinds = "tiles corner plinth";
    parameters.seeds = 1, parameters.splats = 6000, parameters.views = 2, parameters.size = 96;
    parameters.capture_views = 24;
    const auto subject = bench::bench_heal(parameters, {}, {});
    DOCTEST_CHECK(subject.picture.width == 4 * 96);
    for (const auto& [name, kind] : subject.report["kinds"].items()) {
        DOCTEST_INFO(name, ": ", kind.dump());
        const auto figure = [&, &figures = kind](const char* key) { return figures[key].get<double>(); };
        constexpr double LeastGain = 5;  // dB; small pictures have little but the rim of a hole
        DOCTEST_CHECK(figure("psnr_heal") > figure("psnr_delete") + LeastGain);
        DOCTEST_CHECK(figure("psnr_heal") > figure("psnr_mean"));
        DOCTEST_CHECK(figure("ssim_heal") > figure("ssim_delete"));
        DOCTEST_CHECK(figure("ssim_heal") > figure("ssim_mean"));
        DOCTEST_CHECK(figure("changed_rows") == 0);
        DOCTEST_CHECK(figure("left") == 0);
    }
}

DOCTEST_TEST_CASE("an unknown kind of scene is refused") {
    bench::HealBenchParameters parameters;
    parameters.kinds = "moon";
    DOCTEST_CHECK_THROWS_AS(bench::bench_heal(parameters, {}, {}), Error);
}

}  // namespace heal_bench_test
