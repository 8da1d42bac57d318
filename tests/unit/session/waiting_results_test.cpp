// Results side by side: one is shown, none is lost while another is made.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <utility>

#include "app/session/state/waiting_results.h"
#include "engine/scene/label_ops.h"

namespace waiting_results_test {

using namespace gse;
using namespace gse::app;

namespace {

PendingResult result_with(std::uint64_t seed) {
    PendingResult result;
    result.seed = seed;
    result.name = "a red cat";
    return result;
}

}  // namespace

DOCTEST_TEST_CASE("results that wait: the last one is shown, any can be, and the next seed is no one's") {
    WaitingResults results;
    DOCTEST_CHECK_FALSE(results);
    DOCTEST_CHECK(results.kept() == nullptr);
    DOCTEST_CHECK(results.next_seed() == 0);
    for (const std::uint64_t seed : {7, 3}) results.add(result_with(seed));
    DOCTEST_REQUIRE(results);
    DOCTEST_CHECK(results->seed == 3);
    DOCTEST_CHECK(results.shows_last());
    DOCTEST_CHECK(results.next_seed() == 8);
    results.show(0);
    DOCTEST_CHECK(results->seed == 7);
    DOCTEST_CHECK_FALSE(results.shows_last());
    results.show(2);
    DOCTEST_CHECK(results.shown() == 0u);
    results.reset(result_with(5));
    DOCTEST_CHECK(results.all().size() == 1);
    results.reset();
    DOCTEST_CHECK_FALSE(results);
    results.come_back();
    DOCTEST_CHECK_FALSE(results);
}

DOCTEST_TEST_CASE(
    "results that wait: what is set aside for another edit comes back where that comes to nothing") {
    WaitingResults results;
    for (const std::uint64_t seed : {1, 2, 3}) results.add(result_with(seed));
    results.show(1);
    results.set_aside();
    DOCTEST_CHECK_FALSE(results);
    DOCTEST_REQUIRE(results.kept() != nullptr);
    DOCTEST_CHECK(results.kept()->seed == 2);  // what is saved meanwhile
    results.come_back();
    DOCTEST_CHECK(results->seed == 2);
    results.set_aside();
    results.add(result_with(4));
    results.come_back();
    DOCTEST_CHECK(results->seed == 4);
    DOCTEST_CHECK(results.all().size() == 4);
}

DOCTEST_TEST_CASE("results that wait: the oldest go where there are too many") {
    WaitingResults results;
    for (std::uint64_t seed = 0; seed < WaitingResults::Most + 3; ++seed) results.add(result_with(seed));
    DOCTEST_CHECK(results.all().size() == WaitingResults::Most);
    DOCTEST_CHECK(results.all().front().seed == 3);
    DOCTEST_CHECK(results->seed == WaitingResults::Most + 2);
}

DOCTEST_TEST_CASE(
    "a label that has its thing's name takes that of what the thing became, where no other has it") {
    const auto names_after = [](const std::vector<std::string>& names, const Renamed& renamed) {
        GaussianData rows;
        rows.resize(2);
        Scene scene;
        scene.gaussians = GaussianSet(rows);
        DocumentState state = initial_state(scene, {});
        for (const auto& name : names) state.labels.push_back(empty_label(name, rows.size()));
        PendingResult result;
        result.renamed = renamed;
        EditNode node;
        node.id = 1;
        node.delta = std::make_shared<const SceneDelta>(make_delta(
            state.current, *state.row_ids, GaussianSet(rows), std::vector<std::int64_t>{0, 1}, node.id));
        std::vector<std::string> after;
        for (const auto& label : with_result(state, std::move(node), result).labels)
            after.push_back(label.name);
        return after;
    };
    using Names = std::vector<std::string>;
    DOCTEST_CHECK(names_after({"bear", "hat"}, {"hat", "crown"}) == Names{"bear", "crown"});
    DOCTEST_CHECK(names_after({"my hat"}, {"hat", "crown"}) == Names{"my hat"});
    DOCTEST_CHECK(names_after({"hat", "crown"}, {"hat", "crown"}) == Names{"hat", "crown"});
    DOCTEST_CHECK(names_after({"hat"}, {}) == Names{"hat"});
}

}  // namespace waiting_results_test
