// Subjects of the benches over tiny scenes, their tables, and the page of all.
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/laboratory/bench/all_bench.h"
#include "engine/laboratory/bench/charts/machine.h"
#include "engine/laboratory/bench/charts/page.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "engine/laboratory/bench/raster/raster_sweep.h"
#include "engine/laboratory/bench/raster/stability_bench.h"
#include "engine/laboratory/bench/raster/stability_chart.h"
#include "engine/laboratory/bench/raster/turn_timer.h"
#include "engine/laboratory/bench/scale_bench.h"
#include "engine/raster/rasterizer.h"
#include "tests/test_paths.h"

namespace subject_test {

using namespace gse;
using namespace gse::bench;

namespace {

std::filesystem::path fresh_folder(const std::string& name) {
    const auto folder = test::binary_folder() / "bench_subjects" / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

/// Tells whether the page asks for anything that is not in it.
bool refers_elsewhere(const std::string& html) {
    for (const char* word : {"http:", "https:", "href", "url(", "@import", "<script", "<link", "<iframe"})
        if (html.find(word) != std::string::npos) return true;
    const std::string source = "src=\"";
    for (auto at = html.find(source); at != std::string::npos; at = html.find(source, at + 1))
        if (html.compare(at + source.size(), 5, "data:") != 0) return true;
    return false;
}

RasterSweepParameters tiny_sweep() {
    RasterSweepParameters parameters;
    parameters.splats = 400;
    parameters.width = 48, parameters.height = 32;
    parameters.views = 2, parameters.repetitions = 1;
    parameters.floor_cases = "400@48x32";
    return parameters;
}

ScaleBenchParameters tiny_scale() {
    ScaleBenchParameters parameters;
    parameters.splats = "100 400";
    parameters.sizes = "16 32 48";
    parameters.views = "3 6";
    parameters.shares = "0.1 1";
    parameters.usual_splats = 300, parameters.usual_size = 32, parameters.repetitions = 1;
    parameters.search = false;
    return parameters;
}

}  // namespace

DOCTEST_TEST_CASE(
    "the rasterizer's sweep has a point per instruction set and number of threads, with errors to the "
    "truth") {
    const auto subject = bench_raster_sweep(tiny_sweep(), {});
    std::set<std::string> kernels;
    int defaults = 0;
    for (const auto& point : subject.report["points"]) {
        kernels.insert(point["curve"].get<std::string>());
        defaults += point["default"].get<bool>();
        DOCTEST_CHECK(point["forward_ms"].get<double>() > 0);
        DOCTEST_CHECK(point["backward_ms"].get<double>() > 0);
        constexpr double rough = 1e-2;  // single precision is nearer by far
        DOCTEST_CHECK(point["max_abs_error"].get<double>() < rough);
        DOCTEST_CHECK(point["gradient_error"].get<double>() < rough);
    }
    const auto usable = raster::usable_kernels();
    DOCTEST_CHECK(kernels == std::set<std::string>(usable.begin(), usable.end()));
    DOCTEST_CHECK(defaults == 1);
    DOCTEST_CHECK(subject.report["fronts"].size() == 2);
    DOCTEST_CHECK(subject.tables[0].rows.size() == subject.report["points"].size());
    DOCTEST_CHECK(subject.picture.width > 0);
    DOCTEST_REQUIRE(subject.report["floor"].size() == 1);
    const auto& floor = subject.report["floor"][0];
    DOCTEST_CHECK(floor["picture"] == "48x32");
    DOCTEST_CHECK(floor["ms"]["total"].get<double>() > 0);
    DOCTEST_CHECK(floor["ratio"]["wall"].get<double>() > 0);
    DOCTEST_CHECK(subject.tables.size() == 2);
    DOCTEST_CHECK(subject.tables[1].rows[0].size() == subject.tables[1].head.size());
    auto wrong = tiny_sweep();
    for (const char* cases : {"400", "many@48x32", "400@48", "0@48x32"}) {
        wrong.floor_cases = cases;
        DOCTEST_CHECK_THROWS_AS(bench_raster_sweep(wrong, {}), Error);
    }
    wrong = tiny_sweep();
    wrong.kernels = "sse";
    DOCTEST_CHECK_THROWS_AS(bench_raster_sweep(wrong, {}), Error);
    wrong = tiny_sweep();
    wrong.thread_counts = "many";
    DOCTEST_CHECK_THROWS_AS(bench_raster_sweep(wrong, {}), Error);
}

DOCTEST_TEST_CASE("what the first picture of a view takes longer is not timed") {
    std::map<std::size_t, int> drawn;
    constexpr std::size_t views = 4;
    constexpr double slow_ms = 30;
    const auto draw = [&](std::size_t view) {
        if (drawn[view]++ == 0)
            std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(slow_ms));
    };
    TurnTimer timer;
    const auto first = timer.time(views, draw);
    DOCTEST_REQUIRE(first.size() == views);
    DOCTEST_CHECK(first.front() < slow_ms);
    DOCTEST_CHECK(first[views / 2] < slow_ms);  // of a busy machine the last may be slow all the same
    DOCTEST_CHECK(drawn == std::map<std::size_t, int>{{0, 2}, {1, 2}, {2, 2}, {3, 2}});
    timer.time(views, draw);  // is warm: one picture more
    DOCTEST_CHECK(drawn == std::map<std::size_t, int>{{0, 3}, {1, 3}, {2, 3}, {3, 4}});
}

DOCTEST_TEST_CASE("stability: a line per cause, every picture in one decade, the same figures again") {
    StabilityParameters parameters;
    parameters.scenes = 2;
    parameters.causes = "ordinary, few pixels,camera inside";
    const auto subject = bench_stability(parameters, {});
    const auto& causes = subject.report["causes"];
    DOCTEST_REQUIRE(causes.size() == 3);
    for (const auto& cause : causes)
        for (const char* kind : {"picture", "gradient", "row", "unclear_picture"}) {
            std::size_t counted = 0;
            for (const auto& count : cause[kind]["decades"]) counted += count.get<std::size_t>();
            DOCTEST_CHECK(counted == 2 * raster::usable_kernels().size());
            DOCTEST_CHECK(cause[kind]["median"].get<double>() <= cause[kind]["worst"].get<double>());
        }
    DOCTEST_CHECK(subject.tables[0].rows.size() == 3);
    DOCTEST_CHECK(bench_stability(parameters, {}).report == subject.report);
    parameters.seed = 9;
    DOCTEST_CHECK(bench_stability(parameters, {}).report != subject.report);
}

DOCTEST_TEST_CASE("a histogram's cells are where their counts are, and the darker the more") {
    std::vector<std::size_t> first(ErrorDecades, 0), second(ErrorDecades, 0);
    first[0] = 9, second[9] = 1, second[8] = 8;
    const auto image =
        draw_histograms("title", {"first", "second"}, {{"panel", {first, second}}}, {"a note"});
    const auto shade = [&](double across, int line) {  // at the upper left of a cell, where no number is
        return image.at(static_cast<int>(170 + across * 101 + 4), 110 + 26 * line + 4, 0);
    };
    DOCTEST_CHECK(image.width == 1200);
    DOCTEST_CHECK(shade(0, 0) < 0.2f);
    DOCTEST_CHECK(shade(1, 0) > 0.9f);
    DOCTEST_CHECK(shade(8, 1) < shade(9, 1));
    DOCTEST_CHECK(shade(9, 1) < 0.8f);
    DOCTEST_CHECK(shade(0, 1) > 0.9f);
}

DOCTEST_TEST_CASE("series grow until a limit, with exponents") {
    auto parameters = tiny_scale();
    const auto subject = bench_scale(parameters, {}, {});
    std::set<std::string> of;
    for (const auto& series : subject.report["series"]) {
        of.insert(series["of"].get<std::string>());
        DOCTEST_CHECK(series["left_out"].empty());
        for (const auto& cost : series["costs"]) {
            DOCTEST_CHECK(cost["points"].size() >= 2);
            if (cost["what"] != "memory") DOCTEST_CHECK(cost["exponent"].is_number());
        }
    }
    DOCTEST_CHECK(of == std::set<std::string>{"splats", "side", "views", "share"});
    DOCTEST_CHECK(subject.tables.size() == 4);
    parameters.limit_seconds = 0.001;  // no second point is as quick
    parameters.splats = "2000 20000000";
    const auto limited = bench_scale(parameters, {}, {});
    DOCTEST_CHECK(limited.report["series"][0]["left_out"].size() == 1);
    DOCTEST_REQUIRE_FALSE(limited.remarks.empty());
    DOCTEST_CHECK(limited.remarks[0].find("20,000,000") != std::string::npos);
}

DOCTEST_TEST_CASE("a subject is left as figures, picture and text") {
    const auto folder = fresh_folder("left") / "raster";
    const auto subject = bench_raster_sweep(tiny_sweep(), {});
    leave_subject(subject, folder);
    DOCTEST_CHECK(std::filesystem::file_size(folder / "raster.png") > 0);
    const auto report = parse_json<nlohmann::ordered_json>(read_file(folder / "raster.json"), "the report");
    DOCTEST_CHECK(report["parameters"]["splats"] == 400);
    DOCTEST_CHECK(report["files"].contains("raster.png"));
    DOCTEST_CHECK(subject_text(subject).find("default") != std::string::npos);
}

DOCTEST_TEST_CASE(
    "lists of numbers are read once each and ascending; wrong ones are refused with the setting's name") {
    DOCTEST_CHECK(numbers_in_list("views", "8, 4 8", 1, 100) == std::vector<double>{4, 8});
    DOCTEST_CHECK(numbers_in_list("views", "", 1, 100).empty());
    for (const char* wrong : {"four", "0", "101", "nan", "4x"}) {
        std::string message;
        try {
            numbers_in_list("views", wrong, 1, 100);
        } catch (const Error& error) { message = error.message(); }
        DOCTEST_CHECK(message.starts_with("views"));
    }
}

DOCTEST_TEST_CASE("base64") {
    for (const auto& [bytes, text] : {std::pair<std::string, std::string>{"", ""},
                                      {"f", "Zg=="},
                                      {"fo", "Zm8="},
                                      {"foo", "Zm9v"},
                                      {"foobar", "Zm9vYmFy"},
                                      {"\xff\xfe\xfd", "//79"}})
        DOCTEST_CHECK(base64_text(bytes) == text);  // RFC 4648, section 10, and bytes above 127
}

DOCTEST_TEST_CASE("the page escapes what it is told and refers to no other file") {
    const std::vector<PageSection> sections{{"Less <b>& more\"",
                                             {"a note"},
                                             "not a picture",
                                             {{"rows", {"setting", "ms"}, {{"a<b", "1"}}}},
                                             {"a remark"},
                                             {{"splats", 3}}}};
    const auto html = html_page("Page", {{"processor", "<unknown>"}}, sections);
    DOCTEST_CHECK_FALSE(refers_elsewhere(html));
    for (const char* text : {"Less &lt;b&gt;&amp; more&quot;", "a&lt;b", "&lt;unknown&gt;",
                             "data:image/png;base64,", "a remark", "a note"})
        DOCTEST_CHECK(html.find(text) != std::string::npos);
    DOCTEST_CHECK(html.find("<b>") == std::string::npos);
}

DOCTEST_TEST_CASE("all of one subject: the page is complete, and a subject that is not known is refused") {
    const auto folder = fresh_folder("all");
    AllBenchParameters parameters;
    parameters.subjects = "nothing";
    DOCTEST_CHECK_THROWS_AS(bench_all(parameters, {}, folder, {}), Error);
    parameters.subjects = "";
    const auto report = bench_all(parameters, {}, folder, {});
    DOCTEST_CHECK(report["subjects"].empty());
    const auto html = read_file(folder / "index.html");
    DOCTEST_CHECK_FALSE(refers_elsewhere(html));
    const auto machine = machine_json();
    for (const auto& [name, value] : machine.items()) DOCTEST_CHECK(html.find(name) != std::string::npos);
    DOCTEST_CHECK(std::filesystem::exists(folder / "all.json"));
}

}  // namespace subject_test
