// COLMAP models as other tools and people write and place them: read where their sense is plain, else left
// out with a word.
#include "tests/unit/io/camera_helpers.h"

namespace colmap_kinds_test {

using namespace gse;
using namespace gse::test;
namespace fs = std::filesystem;

DOCTEST_TEST_CASE("images.txt without the lines of points: every image is read") {
    auto views = ring(4);
    const std::string points = "775.26 1029.32 8574 10.5 20.5 -1\n";
    check_views(parse_colmap_text(OnePinhole, image_lines(views, "")).views, views);
    check_views(parse_colmap_text(OnePinhole, image_lines(views, points)).views, views);
    check_views(parse_colmap_text(OnePinhole, image_lines(views, "\n")).views, views);
    check_views(parse_colmap_text(OnePinhole, image_lines(views, "# points\n" + points)).views, views);
    std::string mixed;
    for (int i = 0; i < 4; ++i)
        mixed += image_line(views[static_cast<std::size_t>(i)], i + 1) +
                 std::array{"", "\n", "", "3 4 -1\n"}[static_cast<std::size_t>(i)];
    check_views(parse_colmap_text(OnePinhole, mixed).views, views);
    for (const char* name : {"000", "0 1", "a b", "1.5", "-1"}) {  // names of numbers look like points
        DOCTEST_CAPTURE(name);
        views[1].name = name;
        auto expected = views;
        std::stable_sort(expected.begin(), expected.end(),
                         [](const View& a, const View& b) { return a.name < b.name; });
        check_views(parse_colmap_text(OnePinhole, image_lines(views, "")).views, expected);
        check_views(parse_colmap_text(OnePinhole, image_lines(views, points)).views, expected);
    }
    // Threes of whole numbers that begin like an image are points.
    const std::string whole = "1 2 3 4 5 6 7 8 1 10 11 12\n";
    check_views(parse_colmap_text(OnePinhole, image_lines(ring(3), whole)).views, ring(3));
}

DOCTEST_TEST_CASE("a damaged line of images.txt costs its image and no other") {
    const auto views = ring(3);
    const std::string lines =
        image_line(views[0], 1) + "\n2 0.5 1.#QNAN 0 0 1 2 3 1 b.png\n\n" + image_line(views[2], 3) + "\n";
    const auto list = parse_colmap_text(OnePinhole, lines);
    check_views(list.views, {views[0], views[2]});
    check_note(list, {"1 of 3", "line 3 of images.txt", "1.#QNAN"});
    const auto lost =
        parse_colmap_text(OnePinhole, image_line(views[0], 1) + "\n" + image_line(views[1], 2, 9));
    check_note(lost, {"\"b.png\"", "no camera 9"});
}

DOCTEST_TEST_CASE("models without a focal length are named, with what to do") {
    const auto views = ring(3);
    const std::string lines = image_lines(views, "\n");
    for (const char* model : {"SPHERICAL 4096 2048 4096 2048", "SPHERICAL 4096 2048 1 2048 1024"}) {
        const auto error = error_of([&] { parse_colmap_text("1 " + std::string(model) + "\n", lines); });
        check_says(message_of(error),
                   {"3 cameras", "SPHERICAL", "panoramas", "line 1 of cameras.txt", "cut"});
        DOCTEST_CHECK(error->code() == ErrorCode::Unsupported);
    }
    check_says(message_of(error_of([&] { parse_colmap_text("1 THIN_PRISM 64 48 9 9 9 9\n", lines); })),
               {"\"THIN_PRISM\"", "not known", "undistort"});
    const auto viewpoints = parse_colmap_text("1 EQUIRECTANGULAR 64 48 64 48\n", lines);
    check_views(viewpoints.views, views);
    check_note(viewpoints, {"EQUIRECTANGULAR", "panoramas", "\"c.png\"", "viewpoints"});

    Json file = transforms(views);
    for (const char* model : {"EQUIRECTANGULAR", "equirectangular", "SPHERICAL", "ORTHOPHOTO", "VR180_L"}) {
        file["camera_model"] = model;
        check_says(message_of(error_of([&] { parse_transforms_json(file.dump(), {}); })),
                   {"3 cameras", "no focal length", "perspective pictures"});
    }
    file.erase("camera_model");
    file["frames"][2]["camera_model"] = "EQUIRECTANGULAR";
    const auto list = parse_transforms_json(file.dump(), {});
    check_views(list.views, {views[0], views[1]});
    check_note(list, {"\"c.png\"", "EQUIRECTANGULAR", "panoramas"});
    file["frames"][2].erase("camera_model");
    file["frames"][2]["equirectangular"] = true;  // instant-ngp
    check_note(parse_transforms_json(file.dump(), {}), {"\"c.png\"", "EQUIRECTANGULAR"});

    for (const char* name : {"cam05_spherical", "cam14_equirectangular"}) {
        const auto sample = odd_folder() / "21_spherical_equirectangular" / name;
        if (!available(sample)) return;
        check_says(message_of(error_of([&] { load_cameras(sample); })), {"panoramas", "cut", name});
    }
}

DOCTEST_TEST_CASE("a camera line with a wrong number of parameters: model, counts, file and line are named") {
    const auto views = ring(2);
    const std::string lines = image_line(views[0], 1, 1) + "\n" + image_line(views[1], 2, 2) + "\n";
    const std::array<std::pair<const char*, std::array<const char*, 3>>, 6> cases = {
        {{"PINHOLE 64 48 66 66 32", {"PINHOLE", "needs 4", "has 3"}},
         {"OPENCV 64 48 66 66 32 24", {"OPENCV", "needs 8", "has 4"}},
         {"SIMPLE_PINHOLE 64 48", {"SIMPLE_PINHOLE", "needs 3", "has 0"}},
         {"SIMPLE_PINHOLE 64 48 66 66 32 24", {"SIMPLE_PINHOLE", "needs 3", "has 4"}},
         {"PINHOLE 64", {"PINHOLE", "ends before", "image size"}},
         {"PINHOLE 64 48 66 wide 32 24", {"camera 2", "\"wide\"", "number"}}}};
    for (const auto& [line, words] : cases) {
        const auto list = parse_colmap_text(OnePinhole + ("2 " + std::string(line)) + "\n", lines);
        check_views(list.views, {views[0]});
        check_note(list, {"\"b.png\"", words[0], words[1], words[2], "camera 2", "line 3 of cameras.txt"});
        const auto error =
            error_of([&] { parse_colmap_text("2 " + std::string(line), image_line(views[1], 2, 2)); });
        check_says(message_of(error), {words[0], words[1], words[2], "line 1 of cameras.txt"});
    }
    check_says(message_of(error_of([&] { parse_colmap_text("one PINHOLE 64 48 66 66 32 24\n", lines); })),
               {"line 1 of cameras.txt", "\"one\""});
}

DOCTEST_TEST_CASE("COLMAP models are found in the usual layouts, in any case") {
    for (const char* place :
         {"dense/0/sparse", "dense/sparse", "dense/sparse/0", "distorted/sparse/0", "distorted/sparse",
          "undistorted/sparse", "undistorted/sparse/0", "sparse/1", "sparse/7", "sparse_text", "colmap_text",
          "Sparse/0", "SPARSE", "colmap/sparse/0", "colmap/sparse", "Colmap/Sparse/0", "colmap", "sparse"}) {
        DOCTEST_CAPTURE(place);
        const ScratchFolder scratch;
        write_model(scratch.path() / place, "a.png");
        save_scene(scratch.path() / "scene.ply", random_scene(2, 0, 1));
        const auto found = find_cameras(scratch.path() / "scene.ply");
        DOCTEST_REQUIRE(found.has_value());
        const auto list = read_cameras(*found, scratch.path() / "scene.ply");
        DOCTEST_CHECK(list.views.size() == 1);
        DOCTEST_CHECK(list.notes.empty());
    }
    for (const char* name : {"cam07a_dense_0_sparse", "cam07b_distorted", "cam07c_sparse_text",
                             "cam07d_sparse_1", "cam07e_colmap_text", "cam07f_Sparse"}) {
        const auto sample = odd_folder() / "23_colmap_layouts" / name;
        if (!available(sample)) return;
        DOCTEST_CHECK(only_cameras(sample));
        DOCTEST_CHECK(load_cameras(sample).size() == 2);
    }
}

DOCTEST_TEST_CASE("among several COLMAP models the nearest is taken, and a note says so") {
    const ScratchFolder scratch;
    const std::array places = {"distorted/sparse/0", "colmap_text", "dense/0/sparse", "sparse/2",
                               "sparse/1",           "sparse",      "sparse/0"};
    for (std::size_t i = 0; i < places.size(); ++i) {  // each of them is preferred to those before
        write_model(scratch.path() / places[i], places[i]);
        const auto list = read_cameras(scratch.path());
        DOCTEST_CHECK(list.views.at(0).name == places[i]);
        if (i == 0) DOCTEST_CHECK(list.notes.empty());
        else
            check_note(list,
                       {"several COLMAP models", (std::string(places[i]) + " is taken").c_str(), places[0]});
    }
    DOCTEST_CHECK(load_cameras(scratch.path() / "sparse/2").at(0).name == "sparse/2");
    fs::remove(scratch.path() / "sparse/cameras.txt");
    fs::remove(scratch.path() / "sparse/images.txt");
    check_note(read_cameras(scratch.path() / "sparse"), {"0 is taken", "1, 2"});
    save_cameras_json(scratch.path() / "cameras.json", ring(2));
    DOCTEST_CHECK(load_cameras(scratch.path()).size() == 2);
}

DOCTEST_TEST_CASE("numbered folders are COLMAP's components only below one called sparse") {
    const ScratchFolder scratch;
    for (int i = 0; i < 3; ++i) write_model(scratch.path() / std::to_string(i), "a.png");
    DOCTEST_CHECK(error_of([&] { load_cameras(scratch.path()); }).has_value());
}

}  // namespace colmap_kinds_test
