// JSON camera files as other tools and people write them: read where their sense is plain, else left out with
// a word.
#include "tests/unit/io/camera_helpers.h"

namespace camera_kinds_test {

using namespace gse;
using namespace gse::test;
namespace fs = std::filesystem;

DOCTEST_TEST_CASE("a camera whose pose is not a number is left out, and named") {
    const auto views = ring(4);
    const std::vector<View> others = {views[0], views[2], views[3]};
    std::string lines = image_line(views[0], 1) + "\n2 nan 0 0 0 1 2 3 1 b.png\n\n" +
                        image_line(views[2], 3) + "\n" + image_line(views[3], 4) + "\n";
    const auto text = parse_colmap_text(OnePinhole, lines);
    check_views(text.views, others);
    check_note(text, {"1 of 4", "\"b.png\"", "not a finite number"});

    Json entries = camera_entries(views);
    entries[1]["position"][2] = "NaN";
    for (const char* none : {"NaN", "-Infinity", "null"}) {
        const auto list = parse_cameras_json(changed(entries.dump(), "\"NaN\"", none));
        check_views(list.views, others);
        check_note(list, {"1 of 4", "\"b.png\"", "position"});
    }
    Json file = transforms(views);
    file["frames"][1]["transform_matrix"][0][3] = "NaN";
    const auto frames = parse_transforms_json(changed(file.dump(), "\"NaN\"", "NaN"), {});
    check_views(frames.views, others);
    check_note(frames, {"1 of 4", "\"b.png\"", "transform_matrix"});
}

DOCTEST_TEST_CASE("cameras that are left out are counted by reason, and all of them refuse the file") {
    auto views = ring(3);
    Json entries = camera_entries(views);
    entries[0]["fx"] = -5;
    entries[2]["position"] = "here";
    const auto list = parse_cameras_json(entries.dump());
    check_views(list.views, {views[1]});
    DOCTEST_REQUIRE(list.notes.size() == 2);
    check_says(list.notes[0], {"1 of 3", "\"a.png\"", "-5"});
    check_says(list.notes[1], {"1 of 3", "\"c.png\"", "position"});
    entries[1]["fx"] = -5;
    check_says(message_of(error_of([&] { parse_cameras_json(entries.dump()); })),
               {"all 3 cameras are left out, 2 of them, ", "\"a.png\" and \"b.png\"", "-5"});

    Json many = Json::array();
    for (int i = 0; i < 30; ++i) many.push_back(i == 7 ? camera_entries(views)[2] : Json(i));
    check_note(parse_cameras_json(many.dump()), {"29 of 30", "\"camera_000\"", "21 others"});
}

DOCTEST_TEST_CASE("mirrored poses are left out with a word") {
    const auto views = ring(3);
    Json entries = camera_entries(views), file = transforms(views);
    for (int row = 0; row < 3; ++row) {
        auto& own = entries[1]["rotation"][row][0];
        own = -own.get<double>();
        auto& frame = file["frames"][1]["transform_matrix"][row][1];
        frame = -frame.get<double>();
    }
    for (const auto& list : {parse_cameras_json(entries.dump()), parse_transforms_json(file.dump(), {})}) {
        check_views(list.views, {views[0], views[2]});
        check_note(list, {"1 of 3", "\"b.png\"", "mirrored", "determinant"});
    }
    const auto sample = odd_folder() / "11_mirrored_poses/cam12d_mirrored";
    if (!available(sample)) return;
    check_says(message_of(error_of([&] { load_cameras(sample); })),
               {"3 cameras", "mirrored", "cameras.json"});
}

DOCTEST_TEST_CASE("image sizes from pictures, whatever the system that wrote their paths") {
    constexpr int Width = 64, Height = 48;
    Json file = transforms(ring(1));
    for (const char* key : {"w", "h", "fl_x", "fl_y"}) file.erase(key);
    file["camera_angle_x"] = 0.9;
    const std::array<std::pair<const char*, const char*>, 14> cases = {
        {{"images\\a.png", "images/a.png"},
         {".\\images\\a", "images/a.png"},
         {"./images/a.png", "images/a.png"},
         {"C:\\scans\\bear\\images\\a.png", "images/a.png"},
         {"C:/scans/bear/images/a.png", "images/a.png"},
         {"\\\\server\\scans\\images\\a.png", "images/a.png"},
         {"/home/somebody/bear/images/a.png", "images/a.png"},
         {"../bear/images/a.png", "images/a.png"},
         {"D:\\a.png", "images/a.png"},
         {"images/a", "images/a.png"},
         {"images/a", "images/a.PNG"},
         {"images/a.PNG", "images/a.png"},
         {"images/a.png", "Images/A.PNG"},
         {"train\\a", "train/a.Png"}}};
    for (const auto& [written, there] : cases) {
        DOCTEST_CAPTURE(written);
        const ScratchFolder scratch;
        write_picture(scratch.path() / there, Width, Height);
        file["frames"][0]["file_path"] = written;
        const auto list = parse_transforms_json(file.dump(), scratch.path());
        DOCTEST_REQUIRE(list.views.size() == 1);
        DOCTEST_CHECK(list.views[0].name == written);
        DOCTEST_CHECK(list.views[0].camera.width == Width);
        DOCTEST_CHECK(list.views[0].camera.height == Height);
        DOCTEST_CHECK(list.notes.empty());
    }
    for (const char* name : {"cam21_backslash_paths", "cam21b_slash_paths"}) {
        const auto sample = odd_folder() / "13_backslash_file_path" / name;
        if (!available(sample)) return;
        const auto list = read_cameras(sample);
        check_truth(list.views, sample / "truth.json");
        DOCTEST_CHECK(list.notes.empty());
    }
}

DOCTEST_TEST_CASE("an image size that is nowhere to be found is said to be assumed") {
    const ScratchFolder scratch;
    Json file = transforms(ring(3));
    for (const char* key : {"w", "h", "fl_x", "fl_y"}) file.erase(key);
    file["camera_angle_x"] = 0.9;
    const auto nowhere = parse_transforms_json(file.dump(), scratch.path());
    DOCTEST_CHECK(nowhere.views[0].camera.width == 800);
    check_note(nowhere, {"\"a.png\", \"b.png\" and \"c.png\"", "800 x 800", "assumed"});
    write_picture(scratch.path() / "b.png", 30, 20);
    write_file(scratch.path() / "c.png", "no picture");
    const auto some = parse_transforms_json(file.dump(), scratch.path());
    for (const View& view : some.views) DOCTEST_CHECK(view.camera.height == 20);
    check_note(some, {"\"a.png\" and \"c.png\"", "30 x 20", "assumed"});
}

DOCTEST_TEST_CASE("file names in capitals are file names") {
    for (const char* name : {"CAMERAS.JSON", "Cameras.json", "cameras.JSON"}) {
        const ScratchFolder scratch;
        write_file(scratch.path() / name, camera_entries(ring(2)).dump());
        DOCTEST_CHECK(only_cameras(scratch.path() / name));
        check_views(load_cameras(scratch.path()), ring(2));
        check_views(load_cameras(scratch.path() / name), ring(2));
    }
    for (const char* name : {"TRANSFORMS.JSON", "Transforms.json", "Transforms_Train.JSON"}) {
        const ScratchFolder scratch;
        write_file(scratch.path() / name, transforms(ring(2)).dump());
        DOCTEST_CHECK(only_cameras(scratch.path() / name));
        check_views(load_cameras(scratch.path()), ring(2));
        check_views(load_cameras(scratch.path() / name), ring(2));
    }
    const ScratchFolder scratch;
    write_model(scratch.path() / "SPARSE/0", "a.png", ".TXT");
    fs::rename(scratch.path() / "SPARSE/0/cameras.TXT", scratch.path() / "SPARSE/0/CAMERAS.TXT");
    check_views(load_cameras(scratch.path()), ring(1));
    check_views(load_cameras(scratch.path() / "SPARSE/0/CAMERAS.TXT"), ring(1));
    DOCTEST_CHECK(only_cameras(scratch.path() / "SPARSE/0/images.TXT"));
    // Two files that differ in case only: the one named as usual.
    save_cameras_json(scratch.path() / "cameras.json", ring(3));
    write_file(scratch.path() / "CAMERAS.JSON", "[]");
    DOCTEST_CHECK(load_cameras(scratch.path()).size() == 3);
}

DOCTEST_TEST_CASE("a frame without a pose is left out, and numbers as text are numbers") {
    const auto views = ring(3);
    Json file = transforms(views);
    file["w"] = "64";
    file["h"] = " 48 ";
    file["fl_x"] = number_text(views[0].camera.fx);
    auto& entry = file["frames"][0]["transform_matrix"][0][3];
    entry = number_text(entry.get<double>());
    check_views(parse_transforms_json(file.dump(), {}).views, views);
    for (const Json& pose : {Json(), Json("none"), Json::array({1, 2}), Json::array({1, 2, 3, 4}), Json(7),
                             Json::object({{"a", 1}})}) {
        file["frames"][1]["transform_matrix"] = pose;
        const auto list = parse_transforms_json(file.dump(), {});
        check_views(list.views, {views[0], views[2]});
        check_note(list, {"1 of 3", "\"b.png\"", "transform_matrix"});
    }
    file["frames"][1].erase("transform_matrix");
    check_note(parse_transforms_json(file.dump(), {}), {"1 of 3", "\"b.png\"", "transform_matrix"});
    file["frames"][1] = 5;
    check_note(parse_transforms_json(file.dump(), {}), {"1 of 3", "\"frame_001\""});
    for (const char* odd : {"64px", "6,4", "", " ", "0x40", "nan"}) {
        file["fl_x"] = odd;
        file.erase("fl_y");
        check_says(message_of(error_of([&] { parse_transforms_json(file.dump(), {}); })), {"fl_x"});
    }

    Json entries = camera_entries(views);
    entries[0]["width"] = "64";
    entries[0]["fx"] = number_text(views[0].camera.fx);
    entries[0]["rotation"][1][1] = number_text(entries[0]["rotation"][1][1].get<double>());
    entries[1]["img_name"] = 7;
    entries[2].erase("rotation");
    const auto list = parse_cameras_json(entries.dump());
    DOCTEST_CHECK(names_of(list.views) == std::vector<std::string>{"a.png", "7"});
    check_note(list, {"1 of 3", "\"c.png\"", "rotation"});
    const auto sample = odd_folder() / "10_bad_cameras_beside_scene/cam12a_img_name_number";
    if (!available(sample)) return;
    DOCTEST_CHECK(names_of(load_cameras(sample)) == std::vector<std::string>{"0", "1", "2"});
}

DOCTEST_TEST_CASE("no entry of a camera file brings up the words of a library") {
    const Json entries = camera_entries(ring(1)), file = transforms(ring(1));
    const std::array odd = {Json(),           Json(true),     Json("x"),
                            Json(-3),         Json(1e300),    Json::array(),
                            Json::array({1}), Json::object(), Json::array({Json::array({"x"}), 2, 3})};
    const auto check = [&](const std::string& text, auto&& parse) {
        DOCTEST_CAPTURE(text);
        try {
            parse(text);
        } catch (const Error& error) {
            DOCTEST_CHECK(std::string(error.what()).find("json.exception") == std::string::npos);
        } catch (const std::exception& other) { DOCTEST_FAIL(other.what()); }
    };
    const auto as_transforms = [](const std::string& text) { parse_transforms_json(text, "/nowhere"); };
    for (const Json& value : odd) {
        for (const auto& [key, old] : entries[0].items()) {
            Json one = entries;
            one[0][key] = value;
            check(one.dump(), parse_cameras_json);
        }
        for (const char* key : {"w", "h", "fl_x", "frames", "camera_model", "is_fisheye", "applied_transform",
                                "applied_scale", "k1", "cx"}) {
            Json one = file;
            one[key] = value;
            check(one.dump(), as_transforms);
        }
        for (const char* key : {"file_path", "transform_matrix", "camera_model", "w"}) {
            Json one = file;
            one["frames"][0][key] = value;
            check(one.dump(), as_transforms);
        }
        const ScratchFolder scratch;
        write_file(scratch.path() / "transforms.json", file.dump());
        for (const auto& parser :
             {value, Json{{"transform", value}, {"scale", 1}},
              Json{{"transform", file["frames"][0]["transform_matrix"]}, {"scale", value}}}) {
            write_file(scratch.path() / "dataparser_transforms.json", parser.dump());
            check("", [&](const std::string&) { load_cameras(scratch.path()); });
        }
    }
}

DOCTEST_TEST_CASE("cameras.json with flat rotations, and with fields of view in place of focal lengths") {
    auto views = ring(3);
    const Camera camera = views[0].camera;
    const double fov_x = 2 * std::atan(0.5 * camera.width / camera.fx),
                 fov_y = 2 * std::atan(0.5 * camera.height / camera.fy), degree = std::acos(-1.0) / 180;
    Json entries = camera_entries(views);
    for (Json& entry : entries) {
        Json flat = Json::array();
        for (const Json& row : entry["rotation"]) flat.insert(flat.end(), row.begin(), row.end());
        entry["rotation"] = flat;
    }
    check_views(parse_cameras_json(entries.dump()).views, views);

    const std::array<std::pair<const char*, double>, 8> cases = {{{"fov_x", fov_x},
                                                                  {"FovX", fov_x / degree},
                                                                  {"camera_angle_x", fov_x},
                                                                  {"fovy", fov_y / degree},
                                                                  {"FoVy", fov_y},
                                                                  {"camera_angle_y", fov_y},
                                                                  {"fov", fov_y / degree},
                                                                  {"fov", fov_y}}};
    for (const auto& [key, value] : cases) {
        DOCTEST_CAPTURE(key);
        Json one = entries;
        for (Json& entry : one) {
            entry.erase("fx");
            entry.erase("fy");
            entry[key] = value;
        }
        const auto list = parse_cameras_json(one.dump());
        check_views(list.views, views);
        for (const View& view : list.views) {
            DOCTEST_CHECK(std::abs(view.camera.fx - camera.fx) < LensRounding);
            DOCTEST_CHECK(std::abs(view.camera.fy - camera.fy) < LensRounding);
        }
        if (std::string(key) == "fov") check_note(list, {"\"fov\"", "vertical", "\"a.png\""});
        else DOCTEST_CHECK(list.notes.empty());
    }
    entries[0].erase("fx");  // square pixels
    entries[1].erase("fx");
    entries[1].erase("fy");
    const auto list = parse_cameras_json(entries.dump());
    DOCTEST_CHECK(list.views.at(0).camera.fx == views[0].camera.fy);
    check_note(list, {"\"b.png\"", "field of view"});
    entries[1]["fov"] = 200;
    check_note(parse_cameras_json(entries.dump()), {"\"b.png\"", "200"});

    Json file = transforms(views);
    for (Json& frame : file["frames"]) {
        Json flat = Json::array();
        for (const Json& row : frame["transform_matrix"]) flat.insert(flat.end(), row.begin(), row.end());
        frame["transform_matrix"] = flat;
    }
    check_views(parse_transforms_json(file.dump(), {}).views, views);
}

DOCTEST_TEST_CASE("the shared scenes with bad cameras beside them: what is good is read, the rest is said") {
    const auto folder = odd_folder() / "10_bad_cameras_beside_scene";
    if (!available(folder)) return;
    const auto beside = [&](const char* name) {
        const auto scene = folder / name / "scene.ply";
        return read_cameras(find_cameras(scene).value(), scene);
    };
    const auto one_bad = beside("cam03_nan_pose_bin");
    check_truth(one_bad.views, folder / "cam03_nan_pose_bin/truth.json");
    check_note(one_bad, {"1 of 4", "\"b.jpg\"", "not a finite number"});
    check_says(message_of(error_of([&] { beside("cam04_negative_fy"); })),
               {"3 cameras", "camera 1", "line 2 of cameras.txt", "-480"});
    check_says(message_of(error_of([&] { beside("cam05_spherical"); })), {"3 cameras", "SPHERICAL"});
    DOCTEST_CHECK(beside("cam12a_img_name_number").views.size() == 3);
}

}  // namespace camera_kinds_test
