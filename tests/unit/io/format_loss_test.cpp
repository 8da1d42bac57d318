// Losses of formats: measured on the written bytes and told, worst error per field.
#include <algorithm>
#include <limits>
#include <regex>

#include "engine/base/log.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/scene/format_loss.h"
#include "tests/unit/io/io_helpers.h"

namespace format_loss_test {

using namespace gse;
using namespace gse::test;

namespace {

/// Everything the log says while `body` runs, at or above warning.
template <class F> std::string said_by(F&& body) {
    std::string said;
    log::set_sink([&](log::Level level, std::string_view text) {
        if (level >= log::Level::Warning) said += std::string(text) + "\n";
    });
    body();
    log::set_sink({});
    return said;
}

std::string said_of_saving(const Scene& scene, const char* name) {
    const ScratchFolder scratch;
    return said_by([&] { save_scene(scratch.path() / name, scene); });
}

/// The number after `words` in the text; -1 when they are not there.
double number_after(const std::string& text, const std::string& words) {
    std::smatch found;
    return std::regex_search(text, found, std::regex(words + " up to ([-+0-9.e]+)")) ? std::stod(found[1])
                                                                                     : -1;
}

}  // namespace

DOCTEST_TEST_CASE("sizes that SPZ clips are told with their factor and number") {
    constexpr double Small = 0.0003;  // a scene in which a ten-thousandth of a unit is large
    Scene scene = random_scene(100, 0, 1, Small);
    GaussianData data = scene.gaussians.to_data();
    for (float& value : data.log_scale) value = value / 6 - 9;
    // SPZ holds log-scales up to 255 / 16 - 10.
    constexpr float most = 255.0f / 16 - 10;
    for (std::size_t row = 0; row < 7; ++row) data.log_scale[row * 3] = most + std::log(2.8f);
    data.log_scale[3 * 50 + 1] = -10 - std::log(5.0f);
    scene.gaussians = GaussianSet(std::move(data));
    const std::string said = said_of_saving(scene, "a.spz");
    DOCTEST_CHECK(said.find("sizes up to 2.8 times too small (visibly for 7 splats)") != std::string::npos);
    DOCTEST_CHECK(said.find("sizes up to 5 times too large (visibly for 1 splat)") != std::string::npos);
}

DOCTEST_TEST_CASE("flat splats whose thickness no view shows are not told to be too thick") {
    constexpr double Roundings = 5;  // per cent: half a step of SPZ is 3.2
    GaussianData data = random_gaussians(200, 0, 6);
    for (std::size_t row = 0; row < 200; ++row) {
        data.log_scale[row * 3] = row % 2 == 0 ? -23.0f : -std::numeric_limits<float>::infinity();
        data.log_scale[row * 3 + 1] = -13.6f;
    }
    Scene scene;
    scene.gaussians = GaussianSet(data);
    for (const char* name : {"a.spz", "a.compressed.ply", "a.sog"}) {
        const std::string said = said_of_saving(scene, name);
        DOCTEST_CAPTURE(said);
        DOCTEST_CHECK(said.find("times too large") == std::string::npos);
        DOCTEST_CHECK(number_after(said, "sizes") < Roundings);
    }
    // Thickness that a view shows is told, and so are the larger axes.
    const auto told = [&](std::size_t axis, float log_scale) {
        GaussianData back = data;
        for (std::size_t row = 0; row < 30; ++row) back.log_scale[row * 3 + axis] = log_scale;
        const std::string text = io::describe_loss(scene.gaussians, GaussianSet(back), {});
        return text.substr(0, text.find(", "));
    };
    DOCTEST_CHECK(told(0, -3).find("times too large (visibly for 30 splats)") != std::string::npos);
    DOCTEST_CHECK(told(2, 0).find("times too large (visibly for 30 splats)") != std::string::npos);
    DOCTEST_CHECK(told(0, -11.5f).find("visibly") == std::string::npos);
}

DOCTEST_TEST_CASE("every lossy field of every format is told, and a plain PLY loses nothing") {
    const Scene scene = random_scene(300, 2, 5);
    DOCTEST_CHECK(said_of_saving(scene, "a.ply") == "");
    const std::string spz = said_of_saving(scene, "a.spz"),
                      compressed = said_of_saving(scene, "a.compressed.ply");
    const std::string splat = said_of_saving(scene, "a.splat");
    for (const char* field : {"rotations", "opacities", "colours", "view-dependent colours"})
        for (const std::string& said : {spz, compressed, splat}) {
            DOCTEST_CAPTURE(field);
            DOCTEST_CAPTURE(said);
            DOCTEST_CHECK(number_after(said, field) > 0);
        }
    for (const std::string& said : {spz, compressed}) {
        DOCTEST_CHECK(number_after(said, "positions") > 0);
        DOCTEST_CHECK(number_after(said, "sizes") > 0);
    }
    DOCTEST_CHECK(number_after(splat, "positions") == -1);  // floats
    DOCTEST_CHECK(number_after(splat, "sizes") == -1);
}

DOCTEST_TEST_CASE("what is said of a scene beside its splats is told where the format has no place for it") {
    Scene scene = random_scene(20, 0, 9);
    scene.info.antialiased = scene.info.up_known = true;
    scene.info.up = {0, 0, 1};
    const std::string spz = said_of_saving(scene, "a.spz"), splat = said_of_saving(scene, "a.splat");
    const std::string compressed = said_of_saving(scene, "a.compressed.ply");
    const auto says = [](const std::string& said, const char* words) {
        return said.find(words) != std::string::npos;
    };
    for (const char* words : {"which way is up", "antialiasing; .ply, .compressed.ply, .spz and .sog do"})
        DOCTEST_CHECK(says(splat, words));
    for (const char* words : {"which way is up", "antialiasing"})
        DOCTEST_CHECK_FALSE(says(compressed, words));
    DOCTEST_CHECK(says(spz, "which way is up in the scene; .ply and .compressed.ply do"));
    DOCTEST_CHECK_FALSE(says(spz, "antialiasing"));
    scene.info.antialiased = scene.info.up_known = false;
    for (const char* words : {"which way is up", "antialiasing"})
        DOCTEST_CHECK_FALSE(says(said_of_saving(scene, "a.splat"), words));
}

DOCTEST_TEST_CASE("the told errors are those of the file") {
    const Scene scene = random_scene(500, 0, 9);
    const ScratchFolder scratch;
    const std::string said = said_by([&] { save_scene(scratch.path() / "a.spz", scene); });
    const Scene back = load_scene(scratch.path() / "a.spz");
    double moved = 0;
    for (std::size_t i = 0; i < 500; ++i) {
        double squares = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double d = static_cast<double>(scene.gaussians.position()[i * 3 + axis]) -
                             back.gaussians.position()[i * 3 + axis];
            squares += d * d;
        }
        moved = std::max(moved, std::sqrt(squares));
    }
    DOCTEST_CHECK(number_after(said, "positions") == doctest::Approx(moved).epsilon(0.06));
    DOCTEST_CHECK(number_after(said, "opacities") ==
                  doctest::Approx(opacity_difference(scene.gaussians, back.gaussians)).epsilon(0.06));
}

DOCTEST_TEST_CASE("rows that a format cannot hold are counted, and a file of none is not written") {
    Scene scene = random_scene(10, 0, 3);
    GaussianData data = scene.gaussians.to_data();
    for (std::size_t row = 0; row < 4; ++row) data.position[row * 3] = std::nanf("");
    scene.gaussians = GaussianSet(data);
    const ScratchFolder scratch;
    log::set_level(log::Level::Off);
    for (const char* name : {"a.spz", "a.splat", "a.compressed.ply", "a.sog"}) {
        const SavedRows rows = save_scene(scratch.path() / name, scene);
        DOCTEST_CHECK(rows.written == 6);
        DOCTEST_CHECK(rows.left_out == 4);
        DOCTEST_CHECK(load_scene(scratch.path() / name).gaussians.size() == 6);
    }
    DOCTEST_CHECK(save_scene(scratch.path() / "a.ply", scene).written == 10);
    for (float& value : data.position) value = std::nanf("");
    scene.gaussians = GaussianSet(data);
    DOCTEST_CHECK(error_of([&] { save_scene(scratch.path() / "none.spz", scene); }));
    DOCTEST_CHECK_FALSE(std::filesystem::exists(scratch.path() / "none.spz"));
    log::set_level(log::Level::Info);
}

DOCTEST_TEST_CASE("flat, spherical and unrotated splats give no false alarm") {
    Scene scene = random_scene(20, 0, 4);
    GaussianData data = scene.gaussians.to_data();
    for (std::size_t row = 0; row < 20; ++row) {
        data.log_scale[row * 3] = -std::numeric_limits<float>::infinity();
        data.opacity_logit[row] = std::numeric_limits<float>::infinity();
        for (std::size_t i = 0; i < 4; ++i) data.rotation[row * 4 + i] = 0;
    }
    scene.gaussians = GaussianSet(std::move(data));
    const std::string said = said_of_saving(scene, "a.splat");
    DOCTEST_CHECK(said.find("sizes") == std::string::npos);
    DOCTEST_CHECK(said.find("rotations") == std::string::npos);
    DOCTEST_CHECK(said.find("nan") == std::string::npos);
}

}  // namespace format_loss_test
