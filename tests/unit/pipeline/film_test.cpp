// Camera paths as files: what comes back, what is refused, and how many frames a film may have.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/pipeline/report/film.h"
#include "engine/scene/scene.h"
#include "tests/test_paths.h"

namespace film_test {

using namespace gse;

namespace {

std::string key_text(const std::string& time, const std::string& more = R"(, "easing": 0)",
                     const std::string& focal = "36") {
    return R"({"time": )" + time + R"(, "position": [)" + time +
           R"(, 0, 0], "rotation": [1, 0, 0, 0], "focal_length_mm": )" + focal + more + "}";
}

std::string path_text(const std::string& first, const std::string& second) {
    return R"({"version": 1, "keyframes": [)" + first + ", " + second + "]}";
}

struct PathFile {
    test::ScratchFolder scratch;
    std::filesystem::path path = scratch.path() / "path.json";

    std::vector<CameraKey> load(const std::string& text) const {
        std::filesystem::remove(path);
        write_file(path, text);
        return pipeline::load_camera_path(path, 64, 48);
    }
    std::string refused(const std::string& text) const {
        try {
            load(text);
        } catch (const Error& error) {
            DOCTEST_CHECK(error.path() == path);
            return error.message();
        }
        return "";
    }
};

}  // namespace

DOCTEST_TEST_CASE("a path whose times ask for billions of frames is one sentence") {
    const PathFile file;
    const auto keys = file.load(path_text(key_text("0"), key_text("1e9")));
    DOCTEST_REQUIRE(keys.size() == 2);
    for (const double fps : {30.0, 1e300}) {
        try {
            pipeline::path_cameras(keys, fps, 64, 48);
            DOCTEST_FAIL("billions of cameras");
        } catch (const Error& error) {
            DOCTEST_CHECK(error.code() == ErrorCode::InvalidArgument);
            DOCTEST_CHECK(error.message().find("a film has 1000000 at most") != std::string::npos);
        }
    }
    DOCTEST_CHECK(
        pipeline::path_cameras(file.load(path_text(key_text("0"), key_text("2"))), 10, 64, 48).size() == 21);
}

DOCTEST_TEST_CASE("times that do not increase and numbers that are none are refused") {
    const PathFile file;
    for (const auto& [first, second] : {std::pair{"0", "0"}, {"1", "0"}, {"-1", "-1.5"}})
        DOCTEST_CHECK(file.refused(path_text(key_text(first), key_text(second))) ==
                      "the cameras of this path are not in the order of time");
    for (const char* focal : {"0", "-5", "1.5e308"})
        DOCTEST_CHECK(file.refused(path_text(key_text("0"), key_text("1", "", focal))) ==
                      "a camera of this path is not valid");
    const auto huge =
        R"({"time": 2, "position": [1e308, 1e308, 0], "rotation": [1, 0, 0, 0], "focal_length_mm": 36})";
    DOCTEST_CHECK(file.refused(path_text(key_text("0"), huge)) == "a camera of this path is not valid");
    const auto turned =
        R"({"time": 2, "position": [0, 0, 0], "rotation": [1e200, 0, 0, 1e200], "focal_length_mm": 36})";
    DOCTEST_CHECK(file.refused(path_text(key_text("0"), turned)) == "a camera of this path is not valid");
}

DOCTEST_TEST_CASE("easing is walked as the file says, kept, and refused where it is unknown") {
    const PathFile file;
    const auto middle = [&](const std::string& easing) {  // a quarter of the way from 0 to 1 in time
        const auto cameras =
            pipeline::path_cameras(file.load(path_text(key_text("0", easing), key_text("1"))), 4, 64, 48);
        return cameras.at(1).centre().x;
    };
    const double linear = middle("");
    DOCTEST_CHECK(middle(R"(, "easing": 0)") == linear);
    DOCTEST_CHECK(middle(R"(, "easing": "linear")") == linear);
    DOCTEST_CHECK(middle(R"(, "easing": 1)") < linear);
    DOCTEST_CHECK(middle(R"(, "easing": 2)") > linear);
    DOCTEST_CHECK(middle(R"(, "easing": 3)") < linear);
    for (const char* unknown : {R"(, "easing": 4)", R"(, "easing": "bounce")", R"(, "easing": [])"})
        DOCTEST_CHECK(
            file.refused(path_text(key_text("0", unknown), key_text("1"))).find("0 to 3 are known") !=
            std::string::npos);
    const auto keys = file.load(path_text(key_text("0", R"(, "easing": 2)"), key_text("1")));
    const auto again = file.scratch.path() / "again.json";
    pipeline::save_camera_path(again, keys);
    const auto back = pipeline::load_camera_path(again, 64, 48);
    DOCTEST_CHECK(back.at(0).easing == Easing::Out);
    DOCTEST_CHECK(back.at(1).easing == Easing::Linear);
    DOCTEST_CHECK(length(back.at(1).camera.centre() - keys.at(1).camera.centre()) < 1e-12);
}

namespace {

/// A pole of splats at these heights.
Scene pole(const std::vector<float>& heights) {
    GaussianData data;
    data.resize(heights.size());
    for (std::size_t row = 0; row < heights.size(); ++row) {
        data.position[row * 3 + 1] = heights[row];
        for (std::size_t axis = 0; axis < 3; ++axis) data.log_scale[row * 3 + axis] = -4;
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 4;
    }
    Scene scene;
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

}  // namespace

DOCTEST_TEST_CASE(
    "what stands tall is whole in a turn around it and in a picture, also on a foot of few splats") {
    std::vector<float> even, footed;
    for (int row = 0; row < 200; ++row) even.push_back(static_cast<float>(row) / 20);
    for (int row = 0; row < 190; ++row) footed.push_back(static_cast<float>(row) / 95);
    for (int row = 1; row <= 10; ++row) footed.push_back(2 + 0.15f * static_cast<float>(row));
    pipeline::RenderParameters render;
    render.width = 160;
    const auto cut_off = [&](const std::vector<float>& heights, const Camera& camera) {
        int count = 0;
        for (const double end : {heights.front(), heights.back()}) {
            const Vec3 at = camera.to_camera({0, end, 0});
            const double y = camera.fy * at.y / at.z + camera.cy;
            count += at.z <= 0 || y < 0 || y > render.height ? 1 : 0;
        }
        return count;
    };
    for (const auto& heights : {even, footed}) {
        const Scene scene = pole(heights);
        render.height = 90;
        int cut = 0;
        for (const auto& camera :
             pipeline::turn_cameras(pipeline::scene_orbit(scene, render), {}, 0, render.width, render.height))
            cut += cut_off(heights, camera);
        DOCTEST_CHECK(cut > 0);
        for (const auto& camera :
             pipeline::turn_cameras(pipeline::whole_orbit(scene, render), {}, 0, render.width, render.height))
            DOCTEST_CHECK(cut_off(heights, camera) == 0);
        const Camera one = pipeline::choose_camera(scene, {}, render);
        DOCTEST_CHECK(cut_off(heights, one) == 0);
        render.zoom = 2;  // half as far from the same middle
        const Vec3 middle = pipeline::whole_orbit(scene, render).centre;
        DOCTEST_CHECK(length(pipeline::choose_camera(scene, {}, render).centre() - middle) ==
                      doctest::Approx(0.5 * length(one.centre() - middle)));
        render.zoom = 1;
    }
    render.height = 160;  // where it fits, nothing moves
    const Scene scene = pole(even);
    DOCTEST_CHECK(pipeline::whole_orbit(scene, render).radius ==
                  doctest::Approx(pipeline::scene_orbit(scene, render).radius));
}

}  // namespace film_test
