// Regions of truth, shape by shape, and the suite's file.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/laboratory/eval/real/real_run.h"
#include "engine/laboratory/eval/real/real_suite.h"

namespace real_suite_test {

namespace {

using namespace gse;
using namespace gse::bench;
using Json = nlohmann::ordered_json;

const Json Ball = Json::parse(R"({"ellipsoid": {"centre": [0, 0, 0], "radii": [1, 1, 1]}})");
const Json Cube = Json::parse(R"({"box": {"centre": [0, 0, 0], "half": [0.5, 0.5, 0.5]}})");

TruthRegion region(const std::string& text) { return parse_region(Json::parse(text), "suite"); }

/// Message of the error that parsing a region ends with; empty = it does not.
std::string refusal(const std::string& text) {
    try {
        region(text);
    } catch (const Error& error) { return error.what(); }
    return {};
}

Json tiny_suite() {
    return {{"name", "tiny"},
            {"roots", {{"here", "scenes"}, {"there", "/elsewhere"}}},
            {"scenes",
             {{{"name", "bear"},
               {"root", "here"},
               {"file", "bear.ply"},
               {"up", "-y"},
               {"auto_up_right", false},
               {"front", 90},
               {"things", {{"head", {{"union", {Cube}}, {"either", {Ball}}}}}}}}},
            {"tasks",
             {{{"name", "bear.hat"},
               {"scene", "bear"},
               {"source", "bear"},
               {"prompt", "a bear wearing a hat"},
               {"kind", "add"},
               {"about", "head"},
               {"place", {{"union", {Cube, Ball}}}},
               {"known_word", true},
               {"cut_out", nullptr}}}}};
}

/// A suite's file for as long as it is needed.
class SuiteFile {
public:
    explicit SuiteFile(const Json& json)
        : path_(std::filesystem::temp_directory_path() /
                ("gse_real_suite_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".json")) {
        write_file(path_, json.dump());
    }
    ~SuiteFile() { std::filesystem::remove(path_); }
    SuiteFile(const SuiteFile&) = delete;
    SuiteFile& operator=(const SuiteFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

std::string suite_refusal(const Json& json, const std::vector<std::string>& roots = {}) {
    const SuiteFile file(json);
    try {
        read_real_suite(file.path(), roots);
    } catch (const Error& error) { return error.what(); }
    return {};
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

DOCTEST_TEST_CASE("a box holds its border, and turns with its axes") {
    const auto upright = region(R"({"box": {"centre": [1, 0, 0], "half": [2, 1, 0.5]}})");
    DOCTEST_CHECK(upright.contains({3, 1, 0.5}));
    DOCTEST_CHECK(!upright.contains({3.001, 0, 0}));
    DOCTEST_CHECK(!upright.contains({1, 0, -0.501}));
    // The long side lies along y.
    const auto turned = region(
        R"({"box": {"centre": [0, 0, 0], "half": [2, 1, 1], "axes": [[0, 1, 0], [1, 0, 0], [0, 0, 1]]}})");
    DOCTEST_CHECK(turned.contains({0, 2, 0}));
    DOCTEST_CHECK(!turned.contains({2, 0, 0}));
}

DOCTEST_TEST_CASE("an ellipsoid is as wide as its radii along its axes") {
    const auto shape = region(R"({"ellipsoid": {"centre": [0, 1, 0], "radii": [1, 2, 3]}})");
    DOCTEST_CHECK(shape.contains({0, 3, 0}));
    DOCTEST_CHECK(!shape.contains({0, 3.001, 0}));
    DOCTEST_CHECK(!shape.contains({0.9, 2.8, 0}));
    const auto turned = region(
        R"({"ellipsoid": {"centre": [0, 0, 0], "radii": [1, 2, 3],
                          "axes": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]}})");
    DOCTEST_CHECK(turned.contains({2.9, 0, 0}));
    DOCTEST_CHECK(!turned.contains({0, 0, 1.1}));
}

DOCTEST_TEST_CASE("a half-space ends at its offset") {
    const auto shape = region(R"({"halfspace": {"normal": [0, 0, 2], "offset": 1}})");
    DOCTEST_CHECK(shape.contains({9, 9, 0.5}));
    DOCTEST_CHECK(!shape.contains({0, 0, 0.51}));
}

DOCTEST_TEST_CASE("a prism is its polygon by the even-odd rule, between its ends") {
    // An L in the x-z plane: the square of two without its upper right quarter.
    const auto shape = region(R"({"prism": {"u": [1, 0, 0], "v": [0, 0, 1], "n": [0, 1, 0],
        "polygon": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], "low": -1, "high": 3}})");
    DOCTEST_CHECK(shape.contains({1.5, 3, 0.5}));
    DOCTEST_CHECK(shape.contains({0.5, -1, 1.5}));
    DOCTEST_CHECK(!shape.contains({1.5, 0, 1.5}));
    DOCTEST_CHECK(!shape.contains({0.5, 3.1, 0.5}));
    DOCTEST_CHECK(!shape.contains({-0.1, 0, 0.5}));
}

DOCTEST_TEST_CASE("regions are united, cut away and intersected, also within each other") {
    const std::string ball = Ball.dump(), cube = Cube.dump();
    const auto hollow = region(R"({"union": [)" + ball + R"(], "minus": [)" + cube + "]}");
    DOCTEST_CHECK(hollow.contains({0.9, 0, 0}));
    DOCTEST_CHECK(!hollow.contains({0.4, 0, 0}));
    const std::string lower = R"({"halfspace": {"normal": [0, 1, 0], "offset": 0}})";
    const auto half = region(R"({"all": [)" + ball + "," + lower + "]}");
    DOCTEST_CHECK(half.contains({0, -0.9, 0}));
    DOCTEST_CHECK(!half.contains({0, 0.1, 0}));
    const auto both = region(R"({"union": [{"all": [)" + ball + "," + lower + "]}," + cube + "]}");
    DOCTEST_CHECK(both.contains({0, 0.4, 0}));
    DOCTEST_CHECK(both.contains({0, -0.9, 0}));
    DOCTEST_CHECK(!both.contains({0, 0.9, 0}));
}

DOCTEST_TEST_CASE("a wrong region is refused in one sentence that names its place") {
    DOCTEST_CHECK(has(refusal(R"({"cone": {}})"), "suite: the shape \"cone\" is not known"));
    DOCTEST_CHECK(has(refusal(R"({"union": [{"box": {"centre": [0, 0]}}]})"), "shape 1, box, \"centre\""));
    DOCTEST_CHECK(has(refusal(R"({"box": {"centre": [0, 0, 0]}})"), "\"half\" is missing"));
    DOCTEST_CHECK(has(refusal(R"({"box": {"centre": [0, 0, 0], "half": [1, 1, 1], "axes": [[1, 0, 0]]}})"),
                      "\"axes\""));
    DOCTEST_CHECK(has(refusal(R"({"ellipsoid": {"centre": [0, 0, 0], "radii": [1, 0, 1]}})"), "\"radii\""));
    DOCTEST_CHECK(has(refusal(R"({"all": 3})"), "\"all\" is no list"));
    DOCTEST_CHECK(has(refusal("[]"), "no single shape"));
    DOCTEST_CHECK(has(refusal(R"({"prism": {"u": [1, 0, 0], "v": [0, 0, 1], "n": [0, 1, 0],
        "polygon": [[0, 0], [1, 1]], "low": 0, "high": 1}})"),
                      "fewer than three corners"));
    DOCTEST_CHECK(refusal(Cube.dump()).empty());
}

DOCTEST_TEST_CASE("a suite's scenes lie beside its file, or in the folder that is named") {
    const SuiteFile file(tiny_suite());
    const auto suite = read_real_suite(file.path());
    DOCTEST_REQUIRE(suite.tasks.size() == 1);
    const auto& task = suite.tasks.front();
    const auto& scene = suite.scene_of(task);
    DOCTEST_CHECK(scene.path == file.path().parent_path() / "scenes" / "bear.ply");
    DOCTEST_CHECK(scene.front == 90.0);
    DOCTEST_CHECK(scene.sides == std::vector<double>{20, 140, 260});
    DOCTEST_CHECK(suite.thing_of(task).either.size() == 1);
    DOCTEST_CHECK(task.cut_out.empty());
    DOCTEST_CHECK(!task.measures_label());
    DOCTEST_REQUIRE(task.place_box.has_value());
    DOCTEST_CHECK(task.place_box->high == Vec3{0.5, 0.5, 0.5});
    const auto moved = read_real_suite(file.path(), {"here=/other"});
    DOCTEST_CHECK(moved.scenes.front().path == "/other/bear.ply");
}

DOCTEST_TEST_CASE("a wrong suite is refused in one sentence") {
    Json json = tiny_suite();
    json["tasks"][0]["scene"] = "cat";
    DOCTEST_CHECK(has(suite_refusal(json), "task \"bear.hat\": there is no scene \"cat\""));
    json = tiny_suite();
    json["tasks"][0]["about"] = "tail";
    DOCTEST_CHECK(has(suite_refusal(json), "has no thing \"tail\""));
    json = tiny_suite();
    json["tasks"][0].erase("prompt");
    DOCTEST_CHECK(has(suite_refusal(json), "\"prompt\" is missing"));
    json = tiny_suite();
    json["scenes"][0]["up"] = "up";
    DOCTEST_CHECK(has(suite_refusal(json), "scene \"bear\": \"up\" is none of"));
    json = tiny_suite();
    json["scenes"][0]["root"] = "nowhere";
    DOCTEST_CHECK(has(suite_refusal(json), "no root \"nowhere\""));
    DOCTEST_CHECK(has(suite_refusal(tiny_suite(), {"nowhere=/other"}), "NAME=FOLDER"));
    DOCTEST_CHECK(has(suite_refusal(Json(3)), "no object"));
    DOCTEST_CHECK(suite_refusal(tiny_suite()).empty());
}

DOCTEST_TEST_CASE("modes are named, and tasks have those that make sense for them") {
    DOCTEST_CHECK(parse_modes("word, click") == std::vector{RealMode::Word, RealMode::Click});
    DOCTEST_CHECK_THROWS_AS(parse_modes("word sideways"), Error);
    DOCTEST_CHECK_THROWS_AS(parse_modes(" "), Error);
    const SuiteFile file(tiny_suite());
    auto suite = read_real_suite(file.path());
    auto& task = suite.tasks.front();
    auto& scene = suite.scenes.front();
    DOCTEST_CHECK(has_mode(scene, task, RealMode::Word));
    DOCTEST_CHECK(!has_mode(scene, task, RealMode::Box));
    task.cut_out = "0,0,1,1";
    DOCTEST_CHECK(has_mode(scene, task, RealMode::Box));
    DOCTEST_CHECK(has_mode(scene, task, RealMode::Upright));
    DOCTEST_CHECK(has_mode(scene, task, RealMode::Click));
    task.about.clear();
    DOCTEST_CHECK(!has_mode(scene, task, RealMode::Click));
    scene.auto_up_right = true;
    DOCTEST_CHECK(!has_mode(scene, task, RealMode::Upright));
}

DOCTEST_TEST_CASE("the recipe of a task says no more than its mode") {
    const SuiteFile file(tiny_suite());
    auto suite = read_real_suite(file.path());
    auto& task = suite.tasks.front();
    task.cut_out = "0,0,1,1";
    const auto recipe = [&](RealMode mode) { return real_recipe(suite.scene_of(task), task, mode, {}); };
    const auto word = recipe(RealMode::Word);
    DOCTEST_CHECK(word.request.source == "bear");
    DOCTEST_CHECK(word.request.prompt == "a bear wearing a hat");
    DOCTEST_CHECK(word.job.up == "auto");
    DOCTEST_CHECK(word.job.cut_out.empty());
    DOCTEST_CHECK(recipe(RealMode::Upright).job.up == "-y");
    DOCTEST_CHECK(recipe(RealMode::Upright).job.cut_out.empty());
    DOCTEST_CHECK(recipe(RealMode::Box).job.up == "-y");
    DOCTEST_CHECK(recipe(RealMode::Box).job.cut_out == "0,0,1,1");
}

DOCTEST_TEST_CASE("refusals fall into classes by their sentence") {
    DOCTEST_CHECK(refusal_cause("the model does not know the word \"skull\"") == "word not known");
    DOCTEST_CHECK(refusal_cause("the model can draw \"robot\" but not find it") == "word not known");
    DOCTEST_CHECK(refusal_cause("the model drew the car into 0 of 12 views") == "not drawn");
    DOCTEST_CHECK(refusal_cause("the sentence asks for nothing") == "other");
}

}  // namespace real_suite_test
