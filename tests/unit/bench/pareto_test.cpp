// The Pareto picture: which points its line goes through, and that it is drawn.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/io/image/image_file.h"
#include "engine/laboratory/bench/charts/pareto_chart.h"
#include "tests/test_paths.h"

namespace pareto_test {

using namespace gse;
using namespace gse::bench;

namespace {

Chart sample_chart() {
    Chart chart;
    chart.title = "What an edit removes of the error, and what it costs";
    chart.notes = {"A ring marks the default.", "The search comes on top."};
    for (const char* title : {"TFLOP per edit", "seconds per edit"})
        chart.panels.push_back(
            {title,
             "error removed",
             {{"sds: iterations",
               {0.8f, 0.33f, 0.1f},
               {{0.15, 0.21, "25"}, {0.3, 0.36, "50"}, {0.6, 0.48, "100"}, {1.2, 0.55, "200", true}}},
              {"views: views x steps x rounds",
               {0.1f, 0.4f, 0.75f},
               {{0.06, 0.31, "4x4x1"},
                {0.07, 0.29, "8x2x1"},
                {0.17, 0.5, "8x6x1", true},
                {0.34, 0.51, "8x6x2"},
                {0.4, 0.49, "16x8x1"}}}}});
    return chart;
}

/// Pixels of about that colour.
std::size_t count_colour(const Image& image, const DrawColour& colour) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        double difference = 0;
        for (std::size_t c = 0; c < 3; ++c) difference += std::abs(image.data[i * 3 + c] - colour[c]);
        count += difference < 0.05;
    }
    return count;
}

}  // namespace

DOCTEST_TEST_CASE("the line goes through the points that no cheaper one reaches") {
    const std::vector<ChartPoint> points{{4, 0.5, ""}, {1, 0.3, ""}, {2, 0.2, ""},           {3, 0.5, ""},
                                         {5, 0.6, ""}, {0, 0.9, ""}, {0.5, std::nan(""), ""}};
    DOCTEST_CHECK(pareto_front(points) == std::vector<std::size_t>{1, 3, 4});
    DOCTEST_CHECK(pareto_front({}).empty());
}

DOCTEST_TEST_CASE("the picture is as wide as promised and shows every curve in both panels") {
    const auto chart = sample_chart();
    const Image picture = draw_chart(chart);
    DOCTEST_CHECK(picture.width == ChartWidth);
    DOCTEST_CHECK(picture.height < ChartWidth);
    const auto folder = test::binary_folder() / "bench_pictures";
    std::filesystem::create_directories(folder);
    write_png(folder / "pareto.png", picture);
    if (text_width("x", 10) == 0) return;  // built without OpenCV
    constexpr std::size_t least = 800;     // pixels of nine dots and two lines
    for (const auto& curve : chart.panels[0].curves)
        DOCTEST_CHECK(count_colour(picture, curve.colour) > least);
    auto without = chart;
    for (auto& panel : without.panels) panel.curves[1].points.clear();
    DOCTEST_CHECK(count_colour(draw_chart(without), chart.panels[0].curves[1].colour) <
                  count_colour(picture, chart.panels[0].curves[1].colour) / 2);
}

DOCTEST_TEST_CASE("a picture of nothing, or of points that cannot be drawn, is a picture too") {
    DOCTEST_CHECK(draw_chart({}).width == ChartWidth);
    Chart chart = sample_chart();
    chart.panels[0].curves[0].points = {
        {0, 0.5, "free"}, {1, std::numeric_limits<double>::infinity(), "endless"}, {2, -0.4, "worse"}};
    chart.panels[1].curves.clear();
    DOCTEST_CHECK(draw_chart(chart).width == ChartWidth);
}

}  // namespace pareto_test
