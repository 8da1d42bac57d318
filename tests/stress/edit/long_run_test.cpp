// Thousands of iterations over a tiny scene: nothing drifts, grows or breaks. GSE_STRESS_ITERATIONS = how
// many.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstdlib>

#include "engine/base/log.h"
#include "engine/base/process_memory.h"
#include "engine/edit/optimise/oracle_guidance.h"
#include "engine/scene/delta.h"
#include "tests/unit/edit/view_oracle.h"

namespace long_run_test {

namespace {

using namespace gse;

constexpr std::size_t Windows = 10;                  // of the run, over which losses are averaged
constexpr double WarmUp = 0.2;                       // share of the run
[[maybe_unused]] constexpr double MostGrowthMb = 8;  // after that, beside the history
constexpr std::size_t Start = 10;                    // iterations whose mean is the loss at the start
constexpr double LossRise = 1.05;  // a window against the one before: views are drawn in another order
constexpr double LossFloor = 0.1;  // of the loss at the start: below, it wavers with the size of Adam's steps

int iterations() {
    const char* asked = std::getenv("GSE_STRESS_ITERATIONS");
    return asked != nullptr ? std::atoi(asked) : 10000;
}

/// That a figure of the history falls, and then stays where it is.
template <class Figure> void check_falls(const edit::EditResult& result, const Figure& figure) {
    std::vector<double> means(Windows, 0);
    std::vector<std::size_t> counts(Windows, 0);
    double start = 0;
    for (std::size_t i = 0; i < result.history.size(); ++i) {
        const std::size_t window = i * Windows / result.history.size();
        if (i < Start) start += figure(result.history[i]) / Start;
        means[window] += figure(result.history[i]);
        ++counts[window];
    }
    for (std::size_t i = 0; i < Windows; ++i) {
        means[i] /= static_cast<double>(counts[i]);
        DOCTEST_CAPTURE(i);
        DOCTEST_CHECK(std::isfinite(means[i]));
        DOCTEST_CHECK(means[i] <= std::max(LossRise * (i > 0 ? means[i - 1] : start), LossFloor * start));
    }
    DOCTEST_CHECK(means.back() < LossFloor * start);
}

/// Resident memory at the end of the warm-up and at the end of the run.
struct MemoryWatch {
    double begin_mb = 0, end_mb = 0;
    void see(int iteration, int count) {
        if (iteration == static_cast<int>(WarmUp * count)) begin_mb = current_rss_mb();
        if (iteration + 1 == count) end_mb = current_rss_mb();
    }
};

void check_run(const GaussianSet& base, const std::vector<std::uint8_t>& label,
               const edit::EditResult& result, int count) {
    DOCTEST_CHECK(result.iterations == count);
    DOCTEST_CHECK_FALSE(result.failure.has_value());
    DOCTEST_CHECK(result.skipped_steps == 0);
    DOCTEST_CHECK(result.skipped_rows == 0);
    DOCTEST_CHECK(result.nonfinite == 0);
    std::size_t changed = 0;
    for (std::size_t row = 0; row < base.size(); ++row) {
        if (label[row] != 0) continue;
        const auto now = result.base_to_new[row];
        changed += now >= 0 && same_row(base.spans(), row, result.set.spans(), static_cast<std::size_t>(now))
                       ? 0
                       : 1;
    }
    DOCTEST_CHECK(changed == 0);
    for (const auto& record : result.history) {
        DOCTEST_REQUIRE(std::isfinite(record.preservation));
        DOCTEST_REQUIRE(std::isfinite(record.anchor));
    }
}

void check_memory(const MemoryWatch& memory, const edit::EditResult& result) {
    const double history_mb = 400.0 * static_cast<double>(result.history.size()) / 1e6;
    DOCTEST_CAPTURE(memory.begin_mb);
    DOCTEST_CAPTURE(memory.end_mb);
#ifdef GSE_SANITIZED
    DOCTEST_MESSAGE("memory is not compared: a sanitizer keeps what was freed (" << history_mb
                                                                                 << " MB of history)");
#else
    DOCTEST_CHECK(memory.end_mb - memory.begin_mb < MostGrowthMb + history_mb);
#endif
}

}  // namespace

DOCTEST_TEST_CASE(
    "a long run of pulls: nothing outside the label drifts, losses fall, memory does not grow") {
    log::set_level(log::Level::Off);
    const int count = iterations();
    const test::Redrawing ball(24);
    edit::OracleGuidance guidance(ball.target, ball.plan.views, ball.plan.settings, *ball.rasterizer);
    auto request = test::asked("ball", "a blue ball", "blue");
    request.method = "sds";
    request.iterations = count;
    request.densify_every = request.densify_from = std::max(20, count / 20);
    request.geometry_share = 1;
    MemoryWatch memory;
    edit::EditTools tools{*ball.rasterizer, &guidance, {}, {}};
    tools.iteration = [&](const edit::IterationRecord& record) { memory.see(record.iteration, count); };
    const auto result = edit::run_edit(ball.scene.set, ball.plan, request, tools);
    log::set_level(log::Level::Info);
    check_run(ball.scene.set, ball.scene.first, result, count);
    check_falls(result, [](const auto& record) { return record.guidance.at("loss"); });
    check_memory(memory, result);
}

DOCTEST_TEST_CASE("a long run of redrawn views: the same, round after round") {
    log::set_level(log::Level::Off);
    test::Redrawing ball(24);
    constexpr int rounds = 20;
    const int count = iterations() / rounds * rounds;
    const auto request = test::view_request(rounds, count / rounds);
    MemoryWatch memory;
    ball.tools.iteration = [&](const edit::IterationRecord& record) { memory.see(record.iteration, count); };
    const auto result = ball.edited(request);
    log::set_level(log::Level::Info);
    check_run(ball.scene.set, ball.scene.first, result, count);
    check_falls(result, [](const auto& record) { return record.preservation; });
    check_memory(memory, result);
}

}  // namespace long_run_test
