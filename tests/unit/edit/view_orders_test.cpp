// An artist's orders about redrawn views while the edit runs, and branches that go on with redrawn views; by
// oracles.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <set>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/target_views/view_round.h"
#include "tests/unit/edit/edit_scenes.h"
#include "tests/unit/edit/view_oracle.h"

namespace view_orders_test {

using namespace gse;
using namespace gse::test;
using edit::TargetChoice;

namespace {

/// An artist who looks at every sheet and says something at given moments.
struct Artist {
    std::vector<edit::ViewTargets> sheets;
    std::map<int, std::vector<edit::TargetOrder>> says;  // by how often they were asked
    int asked = 0;

    void sit_at(edit::EditTools& tools) {
        tools.targets = [this](const edit::ViewTargets& sheet) { sheets.push_back(sheet); };
        tools.target_orders = [this]() -> std::vector<edit::TargetOrder> {
            const auto found = says.find(asked++);
            return found == says.end() ? std::vector<edit::TargetOrder>() : found->second;
        };
    }
    const edit::ViewTarget& last(std::size_t index) const { return sheets.back().views[index]; }
};

std::set<std::size_t> drawn(const edit::EditResult& result, int from = 0) {
    std::set<std::size_t> views;
    for (const auto& line : result.history)
        if (line.iteration >= from) views.insert(line.view);
    return views;
}

edit::EditSnapshot snapshot_at(Redrawing& run, const edit::CheckedRequest& request, int iteration) {
    std::optional<edit::EditSnapshot> found;
    run.tools.snapshot = [&](edit::EditSnapshot snapshot) {
        if (snapshot.iteration == iteration) found = std::move(snapshot);
    };
    run.edited(request);
    run.tools.snapshot = {};
    run.oracle.inputs.clear();
    run.oracle.asked.clear();
    DOCTEST_REQUIRE(found.has_value());
    return *found;
}

}  // namespace

DOCTEST_TEST_CASE(
    "redrawn views are shown as soon as they are there, and an artist who says nothing changes nothing") {
    Redrawing run, alone;
    Artist artist;
    artist.sit_at(run.tools);
    int steps = 0;
    run.tools.iteration = [&](const edit::IterationRecord&) { ++steps; };
    std::vector<int> shown_before;  // steps of the fit that were done when a sheet came
    run.tools.targets = [&](const edit::ViewTargets& sheet) {
        artist.sheets.push_back(sheet);
        shown_before.push_back(steps);
    };
    const auto result = run.edited(view_request(2, 10));
    DOCTEST_CHECK(shown_before == std::vector{0, 10});
    DOCTEST_REQUIRE(artist.sheets.size() == 2);
    DOCTEST_CHECK(artist.sheets[1].round == 1);
    DOCTEST_CHECK(artist.sheets[1].rounds == 2);
    for (const auto& sheet : artist.sheets) {
        DOCTEST_REQUIRE(sheet.views.size() == 4);
        for (const auto& target : sheet.views) {
            DOCTEST_CHECK(!target.dropped);
            DOCTEST_CHECK(target.attempt == 0);
            DOCTEST_CHECK(target.before->width == run.plan.views[target.view].camera.width);
            DOCTEST_CHECK(target.before->data != target.after->data);
        }
    }
    // The scene has changed.
    DOCTEST_CHECK(artist.sheets[0].views[0].before->data != artist.sheets[1].views[0].before->data);
    DOCTEST_CHECK(result.redrawn_views == 8);
    DOCTEST_CHECK(same_bytes(alone.edited(view_request(2, 10)).set, result.set));
}

DOCTEST_TEST_CASE(
    "a view that is dropped before the fit is not fitted to, and one that is accepted again is") {
    Redrawing run;
    Artist artist;
    artist.sit_at(run.tools);
    const auto chosen = drawn(Redrawing().edited(view_request(1, 30)));
    DOCTEST_REQUIRE(chosen.size() == 4);
    const std::size_t unwanted = *std::next(chosen.begin());
    artist.says[0] = {{0, unwanted, TargetChoice::Drop}};
    auto result = run.edited(view_request(1, 30));
    DOCTEST_CHECK(drawn(result).size() == 3);
    DOCTEST_CHECK(!drawn(result).contains(unwanted));
    DOCTEST_CHECK(artist.sheets.back().views[1].dropped);
    DOCTEST_CHECK(run.oracle.inputs.size() == 1);  // nothing was redrawn for it
    // Again, and brought back in the middle.
    artist = {};
    artist.says[0] = {{0, unwanted, TargetChoice::Drop}};
    artist.says[12] = {
        {0, unwanted, TargetChoice::Accept}};  // asked twice where there were orders: before the twelfth step
    Redrawing again;
    artist.sit_at(again.tools);
    result = again.edited(view_request(1, 30));
    DOCTEST_CHECK(drawn(result, 12).contains(unwanted));
    for (const auto& line : result.history) DOCTEST_CHECK((line.view != unwanted || line.iteration >= 11));
    DOCTEST_CHECK(!artist.sheets.back().views[1].dropped);
    DOCTEST_CHECK(result.changed_outside_label == 0);
}

DOCTEST_TEST_CASE("a view that was not drawn is missing: it cannot be accepted, and Redo has it drawn") {
    const auto chosen = drawn(Redrawing().edited(view_request(1, 30)));
    DOCTEST_REQUIRE(chosen.size() == 4);
    const std::size_t first = *chosen.begin(), second = *std::next(chosen.begin());
    for (const bool redone : {false, true}) {
        DOCTEST_CAPTURE(redone);
        Redrawing run;
        run.oracle.missing_in_round = 2;
        run.oracle.fails_alone = !redone;
        Artist artist;
        artist.sit_at(run.tools);
        artist.says[0] = {{0, first, TargetChoice::Accept}, {0, second, TargetChoice::Redo}};
        const auto result = run.edited(view_request(1, 30));
        DOCTEST_CHECK(artist.sheets.front().views[0].missing);
        DOCTEST_CHECK(artist.last(0).missing);
        DOCTEST_CHECK(artist.last(0).dropped);
        DOCTEST_CHECK(artist.last(1).missing == !redone);
        DOCTEST_CHECK(artist.last(1).dropped == !redone);
        DOCTEST_CHECK_FALSE(artist.last(2).missing);
        DOCTEST_CHECK_FALSE(drawn(result).contains(first));
        DOCTEST_CHECK(drawn(result).contains(second) == redone);
    }
}

DOCTEST_TEST_CASE("the next round begins with all views again") {
    Redrawing run;
    Artist artist;
    artist.sit_at(run.tools);
    const auto chosen = drawn(Redrawing().edited(view_request(2, 12)));
    artist.says[0] = {{0, *chosen.begin(), TargetChoice::Drop}};
    const auto result = run.edited(view_request(2, 12));
    DOCTEST_CHECK(drawn(result, 12) == chosen);
    DOCTEST_CHECK(!artist.sheets.back().views[0].dropped);
}

DOCTEST_TEST_CASE("the last view that is used is not dropped, nor one of a round that is over") {
    Redrawing run;
    Artist artist;
    artist.sit_at(run.tools);
    const auto chosen = drawn(Redrawing().edited(view_request(1, 20)));
    for (const auto view : chosen) artist.says[0].push_back({0, view, TargetChoice::Drop});
    artist.says[1] = {{7, *chosen.begin(), TargetChoice::Redo}, {0, 1000, TargetChoice::Redo}};
    log::set_level(log::Level::Off);
    const auto result = run.edited(view_request(1, 20));
    log::set_level(log::Level::Info);
    DOCTEST_CHECK(drawn(result) == std::set<std::size_t>{*chosen.rbegin()});
    DOCTEST_CHECK(std::count_if(artist.sheets.back().views.begin(), artist.sheets.back().views.end(),
                                [](const auto& target) { return target.dropped; }) == 3);
    DOCTEST_CHECK(run.oracle.inputs.size() == 1);
}

DOCTEST_TEST_CASE("a view is redrawn anew from what the round began with, each time from another seed") {
    Redrawing run;
    Artist artist;
    artist.sit_at(run.tools);
    const auto chosen = drawn(Redrawing().edited(view_request(1, 20)));
    const std::size_t wanted = *chosen.begin();
    run.oracle.noisy = true;
    artist.says[0] = {{0, wanted, TargetChoice::Redo}};  // before the fit
    artist.says[8] = {{0, wanted, TargetChoice::Drop},
                      {0, wanted, TargetChoice::Redo}};  // in the middle: it counts again
    const auto result = run.edited(view_request(1, 20));
    const auto& inputs = run.oracle.inputs;
    DOCTEST_REQUIRE(inputs.size() == 3);
    DOCTEST_CHECK(inputs[1].seed != inputs[0].seed);
    DOCTEST_CHECK(inputs[2].seed != inputs[1].seed);
    DOCTEST_CHECK(inputs[2].round == 0);
    DOCTEST_REQUIRE(run.oracle.asked[1].size() == 1);
    DOCTEST_CHECK(run.oracle.asked[1][0].rendered.data == run.oracle.asked[0][0].rendered.data);
    // Though the scene has changed.
    DOCTEST_CHECK(run.oracle.asked[2][0].rendered.data == run.oracle.asked[0][0].rendered.data);
    DOCTEST_CHECK(artist.last(0).attempt == 2);
    DOCTEST_CHECK(!artist.last(0).dropped);
    DOCTEST_CHECK(artist.last(1).attempt == 0);
    DOCTEST_CHECK(artist.last(0).after->data != artist.sheets.front().views[0].after->data);
    DOCTEST_CHECK(artist.last(1).after->data == artist.sheets.front().views[1].after->data);
    DOCTEST_CHECK(drawn(result, 8).contains(wanted));
    DOCTEST_CHECK(result.redrawn_views == 4 + 2);
    Redrawing again;
    again.oracle.noisy = true;
    Artist same;
    same.says = artist.says;
    same.sit_at(again.tools);
    DOCTEST_CHECK(
        same_bytes(again.edited(view_request(1, 20)).set, result.set));  // the same words, the same edit
}

DOCTEST_TEST_CASE(
    "a view that cannot be redrawn anew stays as it is; a stop while it waits for the artist ends the edit") {
    Redrawing run;
    Artist artist;
    artist.sit_at(run.tools);
    const auto chosen = drawn(Redrawing().edited(view_request(1, 20)));
    run.oracle.fails_alone = true;
    artist.says[3] = {{0, *chosen.begin(), TargetChoice::Redo}};
    log::set_level(log::Level::Off);
    const auto result = run.edited(view_request(1, 20));
    log::set_level(log::Level::Info);
    DOCTEST_CHECK(result.iterations == 20);
    DOCTEST_CHECK(!result.failure);
    DOCTEST_CHECK(artist.last(0).attempt == 0);
    DOCTEST_CHECK(same_bytes(result.set, Redrawing().edited(view_request(1, 20)).set));
    Redrawing stopped;
    std::stop_source stop;
    stopped.tools.job.stop = stop.get_token();
    stopped.tools.target_orders = [&] {
        stop.request_stop();  // as cancel does while the artist is waited for
        return std::vector<edit::TargetOrder>();
    };
    const auto nothing = stopped.edited(view_request(1, 20));
    DOCTEST_CHECK(nothing.stopped);
    DOCTEST_CHECK(nothing.iterations == 0);
}

DOCTEST_TEST_CASE("a corrected label shows what is fitted to now, and what was dropped stays dropped") {
    Redrawing run;
    Artist artist;
    artist.sit_at(run.tools);
    const auto chosen = drawn(Redrawing().edited(view_request(1, 20)));
    artist.says[0] = {{0, *chosen.begin(), TargetChoice::Drop}};
    std::vector<std::uint8_t> half = run.scene.first;
    for (std::size_t row = 0; row < half.size() / 4; ++row) half[row] = 0;  // the upper half of the ball
    int asked = 0;
    run.tools.new_label = [&]() -> std::optional<std::vector<std::uint8_t>> {
        return asked++ == 5 ? std::optional(half) : std::nullopt;
    };
    const auto result = run.edited(view_request(1, 20));
    DOCTEST_CHECK(result.label_changes == 1);
    DOCTEST_CHECK(!drawn(result).contains(*chosen.begin()));
    DOCTEST_CHECK(artist.last(0).dropped);
    DOCTEST_CHECK(artist.last(1).after->data != artist.sheets.front().views[1].after->data);
    DOCTEST_CHECK(artist.last(1).before->data == artist.sheets.front().views[1].before->data);
}

DOCTEST_TEST_CASE("a branch redraws nothing that it need not") {
    const auto request = view_request(2, 20);
    Redrawing run;
    Artist artist;
    const auto chosen = drawn(Redrawing().edited(request));
    artist.says[0] = {{0, *chosen.begin(), TargetChoice::Drop}};
    artist.sit_at(run.tools);
    auto sparse = request;
    sparse.snapshot_every = 10;
    const auto start = snapshot_at(run, sparse, 10);  // in the middle of the first round
    run.tools.start = &start;
    Artist later;
    later.sit_at(run.tools);
    const auto branch = run.edited(request);
    DOCTEST_CHECK(branch.iterations == 40);
    DOCTEST_REQUIRE(run.oracle.inputs.size() == 1);  // the second round
    DOCTEST_CHECK(run.oracle.inputs[0].round == 1);
    DOCTEST_REQUIRE(later.sheets.size() == 2);
    DOCTEST_CHECK(later.sheets[0].views[0].dropped);  // as it was in the snapshot
    DOCTEST_CHECK(later.sheets[0].views[1].after->data == artist.sheets[0].views[1].after->data);
    for (const auto& line : branch.history)
        DOCTEST_CHECK((line.view != *chosen.begin() || line.iteration >= 20));
    DOCTEST_CHECK(branch.history.front().iteration == 10);
    // At the end of a round the next one begins; with other settings the round is redrawn.
    Redrawing fresh;
    const auto end = snapshot_at(fresh, sparse, 20);
    fresh.tools.start = &end;
    fresh.edited(request);
    DOCTEST_CHECK(fresh.oracle.inputs.size() == 1);
    DOCTEST_CHECK(fresh.oracle.inputs[0].round == 1);
    Redrawing other;
    const auto middle = snapshot_at(other, sparse, 10);
    other.tools.start = &middle;
    auto stronger = request;
    stronger.view_strength = 0.9;
    other.edited(stronger);
    DOCTEST_CHECK(other.oracle.inputs.size() == 2);
    other.oracle.inputs.clear();
    other.tools.redraw_key = "another model";
    other.edited(request);
    DOCTEST_CHECK(other.oracle.inputs.size() == 2);
    other.oracle.inputs.clear();
    other.tools.redraw_key = {};
    other.plan.views[*chosen.begin()].camera.fx *= 1.1;
    other.edited(request);
    DOCTEST_CHECK(other.oracle.inputs.size() == 2);
}

namespace {

/// Another value that passes the field's check.
template <class T> void change(T& value, double low, double high) {
    if constexpr (std::is_same_v<T, bool>) value = !value;
    else if constexpr (std::is_same_v<T, int>)
        value = value * 2 <= high ? value * 2 + 1 : static_cast<int>(low) + 1;
    else if constexpr (std::is_same_v<T, double> || std::is_same_v<T, Overridable>)
        value = value * 2 <= high ? value * 2 + 0.125 : low + 0.125;
}

}  // namespace

DOCTEST_TEST_CASE("settings that are said to have no effect have none") {
    for (const bool by_views : {true, false}) {
        const auto run = [by_views](const edit::CheckedRequest& request) {
            Redrawing edit;
            auto guidance = towards({0.1, 0.1, 0.9});
            edit::EditTools pulling{*edit.rasterizer, &guidance, {}, {}};
            return edit::run_edit(edit.scene.set, edit.plan, request, by_views ? edit.tools : pulling).set;
        };
        auto request = view_request(1, 12);
        request.iterations = 12;
        request.densify_every = 6;
        request.densify_from = 6;
        const auto plain = run(request);
        const auto& method = *edit::method_named(by_views ? "views" : "sds");
        std::size_t unused = 0;
        edit::EditSettings::visit_fields(
            request, [&](const char* name, auto& value, const FieldHelp& help, auto... range) {
                DOCTEST_CHECK(method.counts(help.uses) == edit::why_unused(method, help.uses).empty());
                if (method.counts(help.uses)) return;
                ++unused;
                DOCTEST_CAPTURE(name);
                const auto kept = value;
                if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>)
                    value = edit::Qualities.back();
                else if constexpr (sizeof...(range) == 1) change(value, (range.low, ...), (range.high, ...));
                else change(value, 0, 1e9);
                DOCTEST_CHECK(value != kept);
                DOCTEST_CHECK(same_bytes(run(request), plain));
                value = kept;
            });
        DOCTEST_CHECK(unused == (by_views ? 13 : 15));
    }
    const std::set<std::string> always{"seed", "strength", "rate_colour", "snapshot_every",
                                       "label_threshold"};
    const edit::EditRequest usual;
    edit::EditRequest::visit_fields(usual,
                                    [&](const char* name, const auto&, const FieldHelp& help, auto...) {
                                        if (always.contains(name)) DOCTEST_CHECK(help.uses == 0);
                                    });
}

DOCTEST_TEST_CASE("large pictures are shown smaller") {
    Redrawing run(300);
    Artist artist;
    artist.sit_at(run.tools);
    run.edited(view_request(1, 1));
    DOCTEST_CHECK(artist.last(0).before->width == edit::ShownSide);
    DOCTEST_CHECK(artist.last(0).after->height == edit::ShownSide);
}

}  // namespace view_orders_test
