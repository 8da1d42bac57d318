// Estimates add up what was measured, for what is still to be done.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/pipeline/estimate.h"

namespace {

using namespace gse;

pipeline::Measured measured() {
    pipeline::Measured measured;
    measured.load = 3;
    measured.question = 0.1;
    measured.rounds = 2;
    measured.idea = 4;
    measured.guidance = 0.05;
    measured.raster = 0.01;
    measured.rows = 1000;
    measured.finish = 1;
    measured.tune_step = 0.3;
    return measured;
}

pipeline::PlannedWork located() {
    pipeline::PlannedWork work;
    work.loaded = work.located = true;
    work.rows = 1000;
    return work;
}

}  // namespace

DOCTEST_TEST_CASE("an estimate is the sum of what is to be done") {
    edit::EditRequest request;
    request.iterations = 100;
    request.views = 10;
    request.dynamic_mask = false;
    auto work = located();
    DOCTEST_CHECK(pipeline::estimated_seconds(measured(), request, work) == doctest::Approx(4 + 100 * 0.06 + 1));
    work.shows_idea = false;
    DOCTEST_CHECK(pipeline::estimated_seconds(measured(), request, work) == doctest::Approx(100 * 0.06 + 1));
    work.first_iteration = 60;   // a branch
    DOCTEST_CHECK(pipeline::estimated_seconds(measured(), request, work) == doctest::Approx(40 * 0.06 + 1));
    work = located();
    work.rows = 3000;   // the model's part of a step stays
    DOCTEST_CHECK(pipeline::estimated_seconds(measured(), request, work) == doctest::Approx(4 + 100 * 0.08 + 1));
    work = located();
    work.loaded = work.located = false;
    work.tune_steps = 10;
    // Ten views twice.
    DOCTEST_CHECK(pipeline::estimated_seconds(measured(), request, work) ==
                  doctest::Approx(3 + 3 + 20 * 0.1 + 4 + 100 * 0.06 + 1));
    request.dynamic_mask = true;   // half of the steps, each view once an eighth
    auto known = measured();
    known.follow = 0.5;
    DOCTEST_CHECK(pipeline::estimated_seconds(known, request, located()) ==
                  doctest::Approx(4 + 100 * 0.06 + 20 * 0.1 + 1));
    known.refresh = 0.2;
    DOCTEST_CHECK(pipeline::estimated_seconds(known, request, located()) ==
                  doctest::Approx(4 + 100 * 0.06 + 20 * 0.2 + 1));
}

DOCTEST_TEST_CASE("what was never measured is not guessed") {
    edit::EditRequest request;
    DOCTEST_CHECK(pipeline::estimated_seconds({}, request, {}) < 0);
    auto known = measured();
    known.guidance = -1;
    DOCTEST_CHECK(pipeline::estimated_seconds(known, request, located()) < 0);
    known = measured();
    known.load = -1;
    DOCTEST_CHECK(pipeline::estimated_seconds(known, request, located()) > 0);   // it is loaded already
    auto work = located();
    work.loaded = false;
    DOCTEST_CHECK(pipeline::estimated_seconds(known, request, work) < 0);
}
