// Charts of the benches: fronts both ways, axes, names that keep off each other, and what cannot be drawn.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/io/image/image_file.h"
#include "engine/laboratory/bench/charts/growth.h"
#include "engine/laboratory/bench/charts/pareto_chart.h"
#include "engine/laboratory/bench/charts/setting_points.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "tests/test_paths.h"

namespace chart_test {

using namespace gse;
using namespace gse::bench;

namespace {

constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();

SettingPoint setting(const std::string& name, double cost, double error, bool standard = false) {
    return {"curve", name, standard, {{"name", name}}, {{"ms", cost}, {"error", error}}};
}

const Facet ErrorFacet{"ms", "error", "ms", "error"};

double ink(const Image& image) {
    double sum = 0;
    for (const float value : image.data) sum += 1 - value;
    return sum;
}

}  // namespace

DOCTEST_TEST_CASE("the front of errors goes down, that of merits goes up") {
    const std::vector<ChartPoint> points{{1, 0.5, ""}, {2, 0.6, ""}, {3, 0.2, ""},
                                         {4, 0.2, ""}, {5, 0.9, ""}, {Nothing, 0, ""}};
    DOCTEST_CHECK(pareto_front(points, true) == std::vector<std::size_t>{0, 2});
    DOCTEST_CHECK(pareto_front(points, false) == std::vector<std::size_t>{0, 1, 4});
}

DOCTEST_TEST_CASE("linear ticks are round, lie within, and are about as many as wanted") {
    DOCTEST_CHECK(linear_ticks(0, 1, 5) == std::vector<double>{0, 0.2, 0.4, 0.2 * 3, 0.8, 1});
    for (const auto& [low, high] : {std::pair{-3.0, 17.0}, {0.913, 0.957}, {1e-7, 3e-7}, {-1e6, 1e6}}) {
        const auto ticks = linear_ticks(low, high, 6);
        DOCTEST_CHECK(ticks.size() >= 3);
        DOCTEST_CHECK(ticks.size() <= 7);
        DOCTEST_CHECK(ticks.front() >= low - 1e-9 * (high - low));
        DOCTEST_CHECK(ticks.back() <= high + 1e-9 * (high - low));
    }
    DOCTEST_CHECK(linear_ticks(1, 1, 5).empty());
    DOCTEST_CHECK(linear_ticks(0, Nothing, 5).empty());
}

DOCTEST_TEST_CASE("logarithmic ticks are powers of ten over many of them, and 1, 2, 5 over few") {
    const auto many = logarithmic_ticks(1e-6, 1e-1), few = logarithmic_ticks(0.9, 21);
    DOCTEST_REQUIRE(many.size() == 6);
    DOCTEST_CHECK(many[2] == doctest::Approx(1e-4));
    DOCTEST_REQUIRE(few.size() == 5);
    DOCTEST_CHECK(few[3] == doctest::Approx(10));
    DOCTEST_CHECK(logarithmic_ticks(0, 1).empty());
    DOCTEST_CHECK(logarithmic_ticks(2, 1).empty());
}

DOCTEST_TEST_CASE("numbers on axes and in tables") {
    const std::vector<std::pair<double, std::string>> cases{
        {0, "0"},           {0.25, "0.25"}, {12.345, "12.3"},         {999.9, "1,000"},
        {3e6, "3,000,000"}, {1e-5, "1e-5"}, {-1234567, "-1,234,567"}, {Nothing, "-"}};
    for (const auto& [value, text] : cases) DOCTEST_CHECK(number_text(value) == text);
}

DOCTEST_TEST_CASE("the default is on the front unless something is clearly cheaper or better for as much") {
    const auto default_of = [](const std::vector<SettingPoint>& points) {
        return fronts_of(points, {ErrorFacet})[0]["default"];
    };
    const auto good =
        default_of({setting("usual", 10, 0.1, true), setting("worse", 5, 0.2), setting("dear", 20, 0.05)});
    DOCTEST_CHECK(good["on_front"] == true);
    DOCTEST_CHECK(good["name"] == "curve, usual");
    const auto noise =
        default_of({setting("usual", 10, 0.1, true), setting("as good", 10 * (1 - CostNoise / 2), 0.1)});
    DOCTEST_CHECK(noise["on_front"] == true);
    const auto beaten =
        default_of({setting("usual", 10, 0.1, true), setting("cheap", 5, 0.1), setting("better", 10, 0.05)});
    DOCTEST_CHECK(beaten["on_front"] == false);
    DOCTEST_CHECK(beaten["beaten_by"] == nlohmann::ordered_json{"curve, cheap", "curve, better"});
    DOCTEST_CHECK(default_of({setting("usual", 10, Nothing, true)})["on_front"] == false);
    DOCTEST_CHECK(default_of({setting("other", 10, 1)}).is_null());
}

DOCTEST_TEST_CASE(
    "a lead within the scatter of the cases is named and does not count; one that is sure does") {
    const auto with_cases = [](SettingPoint point, const std::vector<double>& errors) {
        point.figures["per_case"]["error"] = errors;
        return point;
    };
    const auto usual = with_cases(setting("usual", 10, 0.25, true), {0.1, 0.2, 0.3, 0.4});
    const auto chance = with_cases(setting("by chance", 10, 0.2),
                                   {0.1, 0.2, 0.3, 0.2});  // one case of four: 0.05, error 0.05
    const auto sure = with_cases(setting("sure", 10, 0.2), {0.05, 0.15, 0.25, 0.35});  // each case by as much
    const auto alone = setting("of other cases", 10, 0.2);
    const auto fronts = [&](const std::vector<SettingPoint>& points) {
        return fronts_of(points, {ErrorFacet});
    };
    const auto scatter = fronts({usual, chance})[0]["default"];
    DOCTEST_CHECK(scatter["on_front"] == true);
    DOCTEST_REQUIRE(scatter["within_scatter"].size() == 1);
    DOCTEST_CHECK(scatter["within_scatter"][0]["name"] == "curve, by chance");
    DOCTEST_CHECK(scatter["within_scatter"][0]["lead"].get<double>() == doctest::Approx(0.05));
    DOCTEST_CHECK(scatter["within_scatter"][0]["standard_error"].get<double>() == doctest::Approx(0.05));
    const auto beaten = fronts({usual, chance, sure, alone})[0]["default"];
    DOCTEST_CHECK(beaten["on_front"] == false);
    DOCTEST_CHECK(beaten["beaten_by"] == nlohmann::ordered_json{"curve, sure", "curve, of other cases"});
    const auto said = front_remarks(fronts({usual, chance}), {"Against time"});
    DOCTEST_REQUIRE(said.size() == 1);
    DOCTEST_CHECK(said[0].find("within the scatter") != std::string::npos);
    DOCTEST_CHECK(said[0].find("curve, by chance (by 0.05, standard error 0.05)") != std::string::npos);
}

DOCTEST_TEST_CASE("the slope through logarithms is the power; what has no logarithm is left out") {
    const auto power = growth_exponent({{1, 3}, {10, 300}, {100, 30000}, {0, 5}, {5, Nothing}, {7, -1}});
    DOCTEST_REQUIRE(power);
    DOCTEST_CHECK(*power == doctest::Approx(2));
    DOCTEST_CHECK_FALSE(growth_exponent({}));
    DOCTEST_CHECK_FALSE(growth_exponent({{4, 2}}));
    DOCTEST_CHECK_FALSE(growth_exponent({{4, 2}, {4, 3}}));
}

DOCTEST_TEST_CASE("panels, guides, legends and notes are drawn; more panels make more rows") {
    if (text_width("x", 10) == 0) return;  // built without OpenCV
    std::vector<SettingPoint> points;
    for (int i = 0; i < 12; ++i)  // three heaps of names that would lie on each other
        points.push_back({i % 2 == 0 ? "even" : "odd",
                          "setting number " + std::to_string(i),
                          i == 4,
                          {},
                          {{"ms", 10 + i % 3 + 0.01 * i}, {"error", std::pow(10, -1 - i % 3)}}});
    Chart chart;
    chart.title = "Twelve settings";
    chart.notes = {std::string(40, 'x') + " a note that is too long for one line of the picture " +
                   std::string(90, 'y') + " and goes on"};
    chart.panels = {panel_of(points, ErrorFacet)};
    DOCTEST_REQUIRE(chart.panels[0].curves.size() == 2);
    chart.panels[0].guides = {{11, "a limit"}};
    const Image one = draw_chart(chart);
    write_png(test::binary_folder() / "bench_pictures" / "heaps.png", one);
    auto unnamed = chart;
    for (auto& curve : unnamed.panels[0].curves)
        for (auto& point : curve.points) point.name.clear();
    DOCTEST_CHECK(ink(draw_chart(unnamed)) < ink(one));
    auto unguided = chart;
    unguided.panels[0].guides.clear();
    DOCTEST_CHECK(ink(draw_chart(unguided)) < ink(one));
    for (int i = 0; i < 2; ++i) chart.panels.push_back(panel_of(points, ErrorFacet));
    chart.panels[1].title = "Growth", chart.panels[1].line = ChartLine::AllPoints;
    const Image three = draw_chart(chart);
    DOCTEST_CHECK(three.width == ChartWidth);
    DOCTEST_CHECK(three.height > one.height + chart.plot_height);
}

DOCTEST_TEST_CASE("what the axes cannot show is left out, and an axis of one point or none is drawn") {
    for (const auto scale : {ChartScale::Percent, ChartScale::Linear, ChartScale::Logarithmic}) {
        const auto with = [&](std::vector<ChartPoint> points) {
            Chart chart;
            chart.panels = {{"ms",
                             "error",
                             {{"", {0, 0, 0}, std::move(points)}},
                             ChartLine::CommonFront,
                             scale,
                             true,
                             "",
                             {}}};
            return draw_chart(chart);
        };
        const Image none = with({});
        DOCTEST_CHECK(
            with(
                {{0, 1, ""}, {-1, 1, ""}, {1, Nothing, ""}, {std::numeric_limits<double>::infinity(), 1, ""}})
                .data == none.data);
        DOCTEST_CHECK((with({{1, 0, ""}}).data == none.data) ==
                      (scale == ChartScale::Logarithmic || text_width("x", 10) == 0));
        for (const float value : with({{2, 0.5, "one"}}).data) DOCTEST_REQUIRE((value >= 0 && value <= 1));
    }
}

}  // namespace chart_test
