// Camera files: real ones, made-up ones of every COLMAP model, and broken ones.
#include <algorithm>
#include <cmath>

#include "engine/io/bytes/encoding.h"
#include "engine/io/cameras/cameras.h"
#include "tests/unit/io/io_helpers.h"

namespace cameras_test {

using namespace gse;
using namespace gse::test;

namespace {

double largest_difference(const Camera& a, const Camera& b) {
    double largest = 0;
    for (std::size_t i = 0; i < 9; ++i)
        largest = std::max(largest, std::abs(a.rotation.rows()[i] - b.rotation.rows()[i]));
    return std::max({largest, length(a.translation - b.translation), std::abs(a.fx - b.fx),
                     std::abs(a.fy - b.fy), std::abs(a.cx - b.cx), std::abs(a.cy - b.cy)});
}

Camera some_camera(std::uint64_t seed) {
    Random random(seed);
    Camera camera =
        Camera::look_at({random.normal(), random.normal(), 5}, {0, 0, 0}, {0, -1, 0}, 0.9, 640, 480);
    camera.fy *= 1.1;
    return camera;
}

struct ModelCase {
    const char* name;
    std::int32_t number;
    std::vector<double> params;
    bool distorted;
};

std::vector<ModelCase> model_cases() {
    return {
        {"SIMPLE_PINHOLE", 0, {500, 320, 240}, false},
        {"PINHOLE", 1, {500, 510, 320, 240}, false},
        {"SIMPLE_RADIAL", 2, {500, 320, 240, 0.1}, true},
        {"SIMPLE_RADIAL", 2, {500, 320, 240, 0}, false},
        {"RADIAL", 3, {500, 320, 240, 0, 0.1}, true},
        {"OPENCV", 4, {500, 510, 320, 240, 0, 0, 0, 0}, false},
        {"OPENCV", 4, {500, 510, 320, 240, 0, 0, 0, 1e-3}, true},
        {"OPENCV_FISHEYE", 5, {500, 510, 320, 240, 0, 0, 0, 0}, true},
        {"FULL_OPENCV", 6, {500, 510, 320, 240, 0, 0, 0, 0, 0, 0, 0, 0.2}, true},
        {"FOV", 7, {500, 510, 320, 240, 0.9}, true},
        {"SIMPLE_RADIAL_FISHEYE", 8, {500, 320, 240, 0}, true},
        {"RADIAL_FISHEYE", 9, {500, 320, 240, 0, 0}, true},
        {"THIN_PRISM_FISHEYE", 10, {500, 510, 320, 240, 0, 0, 0, 0, 0, 0, 0, 0}, true},
        {"RAD_TAN_THIN_PRISM_FISHEYE", 11, {500, 510, 320, 240, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, true},
        {"SIMPLE_DIVISION", 12, {500, 320, 240, 0}, false},
        {"DIVISION", 13, {500, 510, 320, 240, 0.1}, true},
        {"SIMPLE_FISHEYE", 14, {500, 320, 240}, true},
        {"FISHEYE", 15, {500, 510, 320, 240}, true},
        {"EUCM", 16, {500, 510, 320, 240, 0.5, 1}, true},
        {"EQUIRECTANGULAR", 17, {640, 480}, true}};
}

std::string binary_cameras(const ModelCase& model) {
    std::string out;
    io::append_value(out, std::uint64_t{1});
    io::append_value(out, std::uint32_t{7});
    io::append_value(out, model.number);
    io::append_value(out, std::uint64_t{640});
    io::append_value(out, std::uint64_t{480});
    for (const double value : model.params) io::append_value(out, value);
    return out;
}

std::string binary_images(const Camera& camera, const std::string& name) {
    const Quat q = quaternion(camera.rotation);
    std::string out;
    io::append_value(out, std::uint64_t{1});
    io::append_value(out, std::uint32_t{3});
    for (const double value :
         {q.w, q.x, q.y, q.z, camera.translation.x, camera.translation.y, camera.translation.z})
        io::append_value(out, value);
    io::append_value(out, std::uint32_t{7});
    out += name + '\0';
    io::append_value(out, std::uint64_t{1});
    out += std::string(24, '\1');
    return out;
}

std::string text_cameras(const ModelCase& model) {
    std::string out = "# a comment\n7 " + std::string(model.name) + " 640 480";
    char number[32];
    for (const double value : model.params) {
        std::snprintf(number, sizeof number, " %.17g", value);
        out += number;
    }
    return out + "\n";
}

std::string text_image(const Camera& camera, const std::string& name, const std::string& points) {
    const Quat q = quaternion(camera.rotation);
    char line[400];
    std::snprintf(line, sizeof line, "3 %.17g %.17g %.17g %.17g %.17g %.17g %.17g 7 ", q.w, q.x, q.y, q.z,
                  camera.translation.x, camera.translation.y, camera.translation.z);
    return line + name + "\n" + points + "\n";
}

}  // namespace

DOCTEST_TEST_CASE("every COLMAP model is read, in binary and in text, and says whether it is distorted") {
    const Camera pose = some_camera(5);
    for (const ModelCase& model : model_cases()) {
        DOCTEST_CAPTURE(model.name);
        const std::string cameras = binary_cameras(model), images = binary_images(pose, "a b.jpg");
        const auto binary = parse_colmap_binary(as_bytes(cameras), as_bytes(images)).views;
        const auto text = parse_colmap_text(text_cameras(model), text_image(pose, "a b.jpg", "1 2 -1")).views;
        DOCTEST_REQUIRE(binary.size() == 1);
        DOCTEST_REQUIRE(text.size() == 1);
        DOCTEST_CHECK(binary[0].distorted == model.distorted);
        DOCTEST_CHECK(text[0].distorted == model.distorted);
        DOCTEST_CHECK(binary[0].name == "a b.jpg");
        DOCTEST_CHECK(text[0].name == "a b.jpg");
        DOCTEST_CHECK(largest_difference(binary[0].camera, text[0].camera) < 1e-12);
        DOCTEST_CHECK(length(binary[0].camera.centre() - pose.centre()) < 1e-9);
        DOCTEST_CHECK(binary[0].camera.cx == 320);
        DOCTEST_CHECK(binary[0].camera.cy == 240);
    }
}

DOCTEST_TEST_CASE("an image without points has an empty second line") {
    const std::string images = text_image(some_camera(1), "b.jpg", "") +
                               text_image(some_camera(2), "a.jpg", "") +
                               text_image(some_camera(3), "c.jpg", "");
    const auto views = parse_colmap_text(text_cameras(model_cases()[1]), images).views;
    DOCTEST_REQUIRE(views.size() == 3);
    DOCTEST_CHECK(views[0].name == "a.jpg");
    DOCTEST_CHECK(length(views[0].camera.centre() - some_camera(2).centre()) < 1e-9);
}

DOCTEST_TEST_CASE("broken COLMAP models are refused at any length") {
    const std::string cameras = binary_cameras(model_cases()[4]),
                      images = binary_images(some_camera(5), "a.jpg");
    for (std::size_t size = 0; size < cameras.size(); ++size)
        DOCTEST_REQUIRE(
            error_of([&] { parse_colmap_binary(as_bytes(cameras.substr(0, size)), as_bytes(images)); }));
    for (std::size_t size = 0; size < images.size(); ++size)
        DOCTEST_REQUIRE(
            error_of([&] { parse_colmap_binary(as_bytes(cameras), as_bytes(images.substr(0, size))); }));
    ModelCase bad = model_cases()[1];
    for (const double focal : {0.0, -5.0, HUGE_VAL, std::nan("")}) {
        bad.params[0] = focal;
        const std::string bytes = binary_cameras(bad);
        DOCTEST_CHECK(error_of([&] { parse_colmap_binary(as_bytes(bytes), as_bytes(images)); }));
    }
    DOCTEST_CHECK(error_of([&] { parse_colmap_text("7 MAGIC 640 480 1 2 3\n", ""); }));
    DOCTEST_CHECK(error_of([&] { parse_colmap_text("7 PINHOLE 0 480 500 500 320 240\n", ""); }));
    DOCTEST_CHECK(error_of([&] { parse_colmap_text("", text_image(some_camera(1), "a", "")); }));
}

DOCTEST_TEST_CASE("cameras.json round trip") {
    ScratchFolder scratch;
    std::vector<View> views;
    for (std::uint64_t i = 0; i < 5; ++i)
        views.push_back({"view " + std::to_string(i), some_camera(i), false});
    save_cameras_json(scratch.path() / "cameras.json", views);
    for (const auto& place : {scratch.path() / "cameras.json", scratch.path()}) {
        const auto again = load_cameras(place);
        DOCTEST_REQUIRE(again.size() == 5);
        for (std::size_t i = 0; i < 5; ++i) {
            DOCTEST_CHECK(again[i].name == views[i].name);
            DOCTEST_CHECK(largest_difference(again[i].camera, views[i].camera) < 1e-9);
        }
    }
}

DOCTEST_TEST_CASE("cameras.json that cannot be right is refused") {
    for (const char* text : {"", "{", "{}", "[]", "[1]", "[{\"width\": 10}]",
                             R"([{"id":0,"img_name":"a","width":0,"height":5,"position":[0,0,0],
                                 "rotation":[[1,0,0],[0,1,0],[0,0,1]],"fx":5,"fy":5}])",
                             R"([{"id":0,"img_name":"a","width":9,"height":5,"position":[0,0,0],
                                 "rotation":[[1,0,0],[0,1,0],[0,0,1]],"fx":-5,"fy":5}])",
                             R"([{"id":0,"img_name":"a","width":9,"height":5,"position":[0,0,0],
                                 "rotation":[[3,0,0],[0,1,0],[0,0,1]],"fx":5,"fy":5}])"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK(error_of([&] { parse_cameras_json(text); }));
    }
}

DOCTEST_TEST_CASE("transforms.json round trip: pose, focal lengths, principal point and size of every view") {
    constexpr double Rounding = 1e-9;  // the reader takes a scale out of the matrix, which has none
    ScratchFolder scratch;
    std::vector<View> views;
    for (std::uint64_t i = 0; i < 5; ++i) {
        views.push_back({"images/view " + std::to_string(i) + ".png", some_camera(i), false});
        views.back().camera.cx += 3.25 * static_cast<double>(i);
        views.back().camera.width += static_cast<int>(i);
    }
    views[4].distorted = true;  // its coefficients are not known any more: a pinhole is written
    const auto path = scratch.path() / "transforms.json";
    save_cameras(path, views);
    for (const auto& place : {path, scratch.path()}) {
        const auto again = load_cameras(place);
        DOCTEST_REQUIRE(again.size() == 5);
        for (std::size_t i = 0; i < 5; ++i) {
            DOCTEST_CHECK(again[i].name == views[i].name);
            DOCTEST_CHECK(again[i].camera.width == views[i].camera.width);
            DOCTEST_CHECK(again[i].camera.height == views[i].camera.height);
            DOCTEST_CHECK(largest_difference(again[i].camera, views[i].camera) < Rounding);
            DOCTEST_CHECK_FALSE(again[i].distorted);
        }
    }
    // nerfstudio's tools undo applied_transform: it says that nothing was done to the axes.
    DOCTEST_CHECK(read_file(path).find("applied_transform") != std::string::npos);
}

DOCTEST_TEST_CASE("cameras are written in the form that the name asks for, and nothing where that is none") {
    ScratchFolder scratch;
    const std::vector<View> views = {{"a", some_camera(1), false}};
    for (const char* name : {"transforms.json", "transforms_edited.json", "cameras.json", "mine.json"}) {
        save_cameras(scratch.path() / name, views);
        const bool list = read_file(scratch.path() / name).starts_with("[");
        DOCTEST_CHECK(list != names_transforms(name));
        DOCTEST_CHECK(largest_difference(load_cameras(scratch.path() / name)[0].camera, views[0].camera) <
                      1e-9);
    }
    for (const char* name : {"cameras.txt", "cameras", "transforms.jsn"}) {
        const auto refused = error_of([&] { save_cameras(scratch.path() / name, views); });
        DOCTEST_REQUIRE(refused.has_value());
        DOCTEST_CHECK(refused->code() == ErrorCode::InvalidArgument);
        DOCTEST_CHECK_FALSE(std::filesystem::exists(scratch.path() / name));
    }
    DOCTEST_CHECK(error_of([&] { save_cameras(scratch.path() / "none.json", {}); }).has_value());
    DOCTEST_CHECK_FALSE(std::filesystem::exists(scratch.path() / "none.json"));
}

DOCTEST_TEST_CASE("a Blender frame: field of view over the width, OpenGL axes turned to ours") {
    const char* text = R"({"camera_angle_x": 1.5707963267948966, "w": 200, "h": 100, "frames": [
        {"file_path": "./train/r_0", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})";
    const auto views = parse_transforms_json(text, {}).views;
    DOCTEST_REQUIRE(views.size() == 1);
    const Camera& camera = views[0].camera;
    DOCTEST_CHECK(camera.fx == doctest::Approx(100));
    DOCTEST_CHECK(camera.fy == doctest::Approx(100));
    DOCTEST_CHECK(camera.cy == 50);
    DOCTEST_CHECK(length(camera.centre() - Vec3{1, 2, 3}) < 1e-12);
    DOCTEST_CHECK(length(camera.forward() - Vec3{0, 0, -1}) < 1e-12);  // an OpenGL camera looks along -z
    const Vec3 above = camera.to_camera({1, 3, 3});
    DOCTEST_CHECK(above.y < 0);  // and its up is our -y
}

DOCTEST_TEST_CASE("nerfstudio: distortion, values per frame, the world its splats live in") {
    const std::string text = R"({"fl_x": 100, "fl_y": 110, "w": 200, "h": 100, "k1": 0.0,
        "applied_transform": [[0,1,0,0],[1,0,0,0],[0,0,-1,0]], "frames": [
        {"file_path": "a.jpg", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]},
        {"file_path": "b.jpg", "k1": 0.1, "fl_x": 50, "w": 300, "h": 150,
         "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})";
    const auto views = parse_transforms_json(text, {}).views;
    DOCTEST_REQUIRE(views.size() == 2);
    DOCTEST_CHECK(!views[0].distorted);
    DOCTEST_CHECK(views[0].camera.fy == 110);
    DOCTEST_CHECK(views[1].distorted);
    DOCTEST_CHECK(views[1].camera.fx == 50);
    DOCTEST_CHECK(views[1].camera.width == 300);
    // The file written at export counts from the world before applied_transform: a transform equal to the
    // applied one changes nothing but the scale.
    ScratchFolder scratch;
    write_file(scratch.path() / "transforms.json", text);
    write_file(scratch.path() / "dataparser_transforms.json",
               R"({"transform": [[0,1,0,0],[1,0,0,0],[0,0,-1,0]], "scale": 0.5})");
    const auto scaled = load_cameras(scratch.path());
    DOCTEST_CHECK(length(scaled[0].camera.centre() - Vec3{0.5, 1, 1.5}) < 1e-12);
    DOCTEST_CHECK(largest_difference({.rotation = scaled[0].camera.rotation},
                                     {.rotation = views[0].camera.rotation}) < 1e-12);
    // The export writes it beside the splats, which may lie elsewhere; it is the one that counts for them.
    const ScratchFolder exported;
    write_file(exported.path() / "dataparser_transforms.json",
               R"({"transform": [[0,1,0,0],[1,0,0,0],[0,0,-1,0]], "scale": 2})");
    for (const auto& scene : {exported.path(), exported.path() / "splat.ply"})
        DOCTEST_CHECK(length(load_cameras(scratch.path(), scene)[0].camera.centre() - Vec3{2, 4, 6}) < 1e-12);
    const ScratchFolder elsewhere;
    DOCTEST_CHECK(length(load_cameras(scratch.path(), elsewhere.path() / "splat.ply")[0].camera.centre() -
                         Vec3{0.5, 1, 1.5}) < 1e-12);
}

DOCTEST_TEST_CASE("transforms.json that cannot be right is refused") {
    for (
        const char* text :
        {"", "{}", "[]", R"({"frames": []})", R"({"frames": [{}]})", R"({"frames": 3})",
         R"({"w": 10, "h": 10, "frames": [{"transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3]]}]})",
         R"({"w": 10, "h": 10, "fl_x": 0, "frames": [{"transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3]]}]})",
         R"({"w": -10, "h": 10, "fl_x": 5, "frames": [{"transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3]]}]})",
         R"({"w": 10, "h": 10, "fl_x": 5, "frames": [{"transform_matrix": [[0,0,0,1],[0,1,0,2],[0,0,1,3]]}]})",
         R"({"w": 10, "h": 10, "fl_x": 5, "frames": [{"transform_matrix": [[1,0,0],[0,1,0],[0,0,1]]}]})"}) {
        DOCTEST_CAPTURE(text);
        DOCTEST_CHECK(error_of([&] { parse_transforms_json(text, {}); }));
    }
}

DOCTEST_TEST_CASE("the shared camera folders open and look at their own points") {
    const auto folder = data_folder() / "cameras";
    if (!available(folder)) return;
    const auto plush = load_cameras(folder / "3dgs_output_plush");
    DOCTEST_CHECK(plush.size() > 50);
    DOCTEST_CHECK(plush[0].camera.width == 3958);
    const auto door = load_cameras(folder / "lund_door");
    DOCTEST_REQUIRE(door.size() == 12);
    DOCTEST_CHECK(door[0].name == "DSC_0001.JPG");
    DOCTEST_CHECK(door[0].distorted);
    DOCTEST_CHECK(load_cameras(folder / "phone_tensorf/sparse/0").size() == 184);
    DOCTEST_CHECK(load_cameras(folder / "phone_tensorf/transforms_train.json").size() > 100);
    const auto brush = load_cameras(folder / "brush_tiny");
    DOCTEST_REQUIRE(brush.size() == 1);
    DOCTEST_CHECK(!brush[0].distorted);

    // The input points of the plush folder, read by hand: 27-byte rows after the header.
    const std::string ply = read_file(folder / "3dgs_output_plush/input.ply");
    std::vector<float> points;
    for (std::size_t at = ply.find("end_header\n") + 11; at + 27 <= ply.size(); at += 27 * 16) {
        float xyz[3];
        std::memcpy(xyz, ply.data() + at, sizeof xyz);
        points.insert(points.end(), xyz, xyz + 3);
    }
    constexpr double LeastShare = 0.3;  // a wrong axis or inverse sees close to nothing
    DOCTEST_CHECK(visible_share(plush, points) > LeastShare);
    std::vector<View> turned = plush;  // cameras of another world
    for (View& view : turned) view.camera.rotation = Mat3::from_rows({1, 0, 0, 0, -1, 0, 0, 0, -1});
    DOCTEST_CHECK(visible_share(turned, points) < visible_share(plush, points));
    DOCTEST_CHECK(visible_share({}, points) == 0);
}

DOCTEST_TEST_CASE("a camera file, and a folder with cameras and no scene, are cameras for another scene") {
    ScratchFolder scratch;
    const auto folder = scratch.path() / "capture";
    const std::vector<View> views{{"a", some_camera(1), false}};
    std::filesystem::create_directories(folder / "sparse/0");
    DOCTEST_CHECK_FALSE(only_cameras(folder));
    for (const char* part : {"cameras.txt", "images.txt"})
        write_file(folder / "sparse/0" / part, "# COLMAP\n");
    DOCTEST_CHECK(only_cameras(folder));
    DOCTEST_CHECK(only_cameras(folder / "sparse/0"));
    DOCTEST_CHECK(only_cameras(folder / "sparse/0/images.txt"));
    save_cameras_json(scratch.path() / "cameras.json", views);
    DOCTEST_CHECK(only_cameras(scratch.path() / "cameras.json"));
    DOCTEST_CHECK(only_cameras(scratch.path() / "bear.cameras.json"));
    DOCTEST_CHECK_FALSE(only_cameras(scratch.path() / "meta.json"));
    DOCTEST_CHECK_FALSE(only_cameras(scratch.path() / "cameras.txt"));  // without its images
    save_scene(folder / "scene.ply", random_scene(2, 0, 1));
    DOCTEST_CHECK_FALSE(only_cameras(folder));  // a scene and its cameras
    DOCTEST_CHECK_FALSE(only_cameras(folder / "scene.ply"));
}

DOCTEST_TEST_CASE("cameras are found beside a scene and above an Inria output folder, and nowhere else") {
    ScratchFolder scratch;
    const auto root = scratch.path() / "model";
    const auto scene = root / "point_cloud/iteration_7/point_cloud.ply";
    save_scene(scene, random_scene(2, 0, 1));
    DOCTEST_CHECK(!find_cameras(scene).has_value());
    write_file(scratch.path() / "cameras.json", "[]");
    DOCTEST_CHECK(!find_cameras(scene).has_value());  // not ours: one folder too high
    save_cameras_json(root / "cameras.json", {{"a", some_camera(1), false}});
    DOCTEST_REQUIRE(find_cameras(scene).has_value());
    DOCTEST_CHECK(load_cameras(*find_cameras(scene)).size() == 1);
    DOCTEST_CHECK(find_cameras(root).has_value());
    DOCTEST_CHECK(error_of([&] { load_cameras(scratch.path() / "nothing"); }));
    DOCTEST_CHECK(error_of([&] { load_cameras(scene); }));
}

}  // namespace cameras_test
