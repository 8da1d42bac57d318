// Every third-party file of the shared data opens or gives the right sentence.
#include <algorithm>

#include "tests/unit/io/io_helpers.h"

namespace shared_files_test {

using namespace gse;
using namespace gse::test;

namespace {

struct Expected {
    const char* file;
    std::size_t count;
    int sh_degree;
    const char* format;
};

void check_scene(const Expected& expected) {
    const auto path = data_folder() / expected.file;
    if (!available(path)) return;
    DOCTEST_CAPTURE(expected.file);
    const Scene scene = load_scene(path);
    DOCTEST_CHECK(scene.gaussians.size() == expected.count);
    DOCTEST_CHECK(scene.gaussians.sh_degree() == expected.sh_degree);
    DOCTEST_CHECK(scene.info.format == expected.format);
    const SceneStatistics statistics = compute_statistics(scene.gaussians);
    DOCTEST_CHECK(statistics.nan_rows == 0);
    DOCTEST_CHECK(statistics.infinite_rows == 0);
    DOCTEST_CHECK(statistics.invisible_rows < statistics.count);
    DOCTEST_CHECK(statistics.mean_opacity > 0.01);
    DOCTEST_CHECK(length(statistics.robust_high - statistics.robust_low) > 0);
}

}  // namespace

DOCTEST_TEST_CASE("every shared scene opens with the right count and degree") {
    for (const Expected& expected :
         {Expected{"scenes/food_hamburger_sh0.ply", 52709, 0, "ply"},
          Expected{"scenes/garden_sunflowers_sh3.ply", 14051, 3, "ply"},
          Expected{"scenes/text_fruit-drops_sh3.ply", 4721, 3, "ply"},
          Expected{"scenes/train-1000_sh3.ply", 1000, 3, "ply"},
          Expected{"scenes/object_guitar.compressed.ply", 90854, 0, "compressed.ply"},
          Expected{"scenes/person_biker.compressed.ply", 152746, 0, "compressed.ply"},
          Expected{"scenes/person_biker.v4.spz", 152746, 0, "spz"},
          Expected{"scenes/outdoor_luma-seal.splat", 101780, 0, "splat"},
          Expected{"scenes/plant_lastchance.splat", 14007, 0, "splat"},
          Expected{"scenes/tile_outdoor-far-from-origin.splat", 66822, 0, "splat"},
          Expected{"scenes/statue_st-peter.sog", 133618, 0, "sog"},
          Expected{"scenes/logo_sog_v1", 307128, 0, "sog"},
          Expected{"scenes/playbot_lod_sog/6_0/meta.json", 1873, 2, "sog"},
          Expected{"scenes/playbot_lod_sog/3_0", 31000, 2, "sog"},
          Expected{"scenes/playbot_lod_sog", 500000, 2, "sog"}})
        check_scene(expected);
    for (const char* name : {"scenes/object_lego-house_sh3.v2.spz", "scenes/room_kitchen.v2.spz"}) {
        if (!available(data_folder() / name)) continue;
        const Scene scene = load_scene(data_folder() / name);
        DOCTEST_CHECK(scene.gaussians.size() > 10000);
        DOCTEST_CHECK(compute_statistics(scene.gaussians).nan_rows == 0);
    }
}

DOCTEST_TEST_CASE("every fixture opens") {
    for (const Expected& expected :
         {Expected{"fixtures/gsplat-rs/minimal_ascii.ply", 3, 0, "ply"},
          Expected{"fixtures/gsplat-rs/minimal_binary.ply", 3, 0, "ply"},
          Expected{"fixtures/gsplat-rs/minimal_v4_degree0.spz", 8, 0, "spz"},
          Expected{"fixtures/playcanvas_64splats_sh3.compressed.ply", 64, 3, "compressed.ply"},
          Expected{"fixtures/adobe_SanitySplats.spz", 10, 3, "spz"},
          Expected{"fixtures/splat-transform/minimal-raw.spz", 4, 0, "spz"},
          Expected{"fixtures/splat-transform/minimal-v2.spz", 4, 0, "spz"},
          Expected{"fixtures/splat-transform/minimal-v3.spz", 4, 0, "spz"},
          Expected{"fixtures/splat-transform/minimal-v4.spz", 4, 0, "spz"},
          Expected{"fixtures/splat-transform/minimal.splat", 4, 0, "splat"},
          Expected{"fixtures/splat-transform/minimal.ksplat", 4, 0, "ksplat"},
          Expected{"fixtures/three_points_of_train/test-splat.3-points-from-train.ply", 3, 3, "ply"},
          Expected{"fixtures/three_points_of_train/test-splat.3-points-from-train.splat", 3, 0, "splat"},
          Expected{"fixtures/three_points_of_train/test-splat.3-points-from-train.spz", 3, 3, "spz"}})
        check_scene(expected);
}

DOCTEST_TEST_CASE("text and binary of the same splats agree bit for bit") {
    const auto folder = data_folder() / "fixtures/gsplat-rs";
    if (!available(folder)) return;
    DOCTEST_CHECK(same_bits(load_scene(folder / "minimal_ascii.ply").gaussians,
                            load_scene(folder / "minimal_binary.ply").gaussians));
}

namespace {

struct Refused {
    const char* file;
    ErrorCode code;
    const char* phrase;
};

}  // namespace

DOCTEST_TEST_CASE("odd and broken PLY files give one clear sentence") {
    const Refused refused[] = {
        {"assimp_empty.ply", ErrorCode::Malformed, "empty"},
        {"assimp_crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply", ErrorCode::Malformed, "PLY header"},
        {"lfs_pointer_cactus.ply", ErrorCode::Malformed, "Git LFS pointer"},
        {"pdal_no_vertex.ply", ErrorCode::Malformed, "no vertex"},
        {"trimesh_ply_empty_ascii.ply", ErrorCode::Unsupported, "not a Gaussian"},
        {"trimesh_ply_empty_bin.ply", ErrorCode::Unsupported, "not a Gaussian"},
        {"trimesh_empty.ply", ErrorCode::Unsupported, "not a Gaussian"},
        {"assimp_cube.ply", ErrorCode::Unsupported, "a mesh"},
        {"assimp_cube_binary_header_with_RN_newline.ply", ErrorCode::Unsupported, "a mesh"},
        {"assimp_cube_binary_starts_with_nl.ply", ErrorCode::Unsupported, "a mesh"},
        {"assimp_float-color.ply", ErrorCode::Unsupported, "a mesh"},
        {"assimp_points.ply", ErrorCode::Unsupported, "coloured point cloud"},
        {"assimp_issue623.ply", ErrorCode::Unsupported, "not a Gaussian"},
        {"happly_platonic_shelf.ply", ErrorCode::Unsupported, "a mesh"},
        {"happly_platonic_shelf_ascii.ply", ErrorCode::Unsupported, "a mesh"},
        {"happly_platonic_shelf_big_endian.ply", ErrorCode::Unsupported, "a mesh"},
        {"trimesh_metadata.ply", ErrorCode::Unsupported, "a mesh"},
        {"trimesh_multi.ply", ErrorCode::Unsupported, "a mesh"},
        {"trimesh_ply_points_bin.ply", ErrorCode::Unsupported, "a point cloud"},
        {"trimesh_points_ascii_with_lists.ply", ErrorCode::Unsupported, "a point cloud"},
        {"trimesh_points_emptyascii.ply", ErrorCode::Unsupported, "a point cloud"},
        {"pdal_mesh.ply", ErrorCode::Unsupported, "a mesh"},
        {"pdal_simple_binary.ply", ErrorCode::Unsupported, "a point cloud"},
        {"pdal_simple_text.ply", ErrorCode::Unsupported, "a point cloud"},
        {"pdal_sized_dims.ply", ErrorCode::Unsupported, "not a Gaussian"},
        {"pdal_unsized_dims.ply", ErrorCode::Unsupported, "not a Gaussian"},
        {"pdal_text_extradim.ply", ErrorCode::Unsupported, "coloured point cloud"},
        {"adobe_utf8_name_貝殻.ply", ErrorCode::Unsupported, "a mesh"},
        {"../cameras/3dgs_output_plush/input.ply", ErrorCode::Unsupported, "coloured point cloud"},
        {"../cameras/brush_tiny/init.ply", ErrorCode::Unsupported, "coloured point cloud"}};
    for (const Refused& expected : refused) {
        const auto path = data_folder() / "bad_ply" / expected.file;
        if (!available(path)) continue;
        DOCTEST_CAPTURE(expected.file);
        const auto error = error_of([&] { load_scene(path); });
        DOCTEST_REQUIRE(error.has_value());
        DOCTEST_CAPTURE(error->what());
        DOCTEST_CHECK(error->code() == expected.code);
        DOCTEST_CHECK(std::string(error->what()).find(expected.phrase) != std::string::npos);
        DOCTEST_CHECK(error->path() == path);
        DOCTEST_CHECK(std::string(error->what()).find('\n') == std::string::npos);
    }
}

DOCTEST_TEST_CASE("bytes after the last splat are ignored with a warning") {
    const auto path = data_folder() / "bad_ply/epfl_pc_short_trailing_bytes.ply";
    if (!available(path)) return;
    const Scene scene = load_scene(path);
    DOCTEST_CHECK(scene.gaussians.size() == 100);
    DOCTEST_CHECK(scene.gaussians.sh_degree() == 3);
    DOCTEST_REQUIRE(scene.info.warnings.size() == 1);
    DOCTEST_CHECK(scene.info.warnings[0].find("14029 bytes") != std::string::npos);
}

DOCTEST_TEST_CASE("the biker in compressed PLY and in SPZ is the same biker") {
    // Figures measured independently with a little room for float rounding.
    constexpr double PositionTolerance = 1.3e-4 * 1.05;
    constexpr double ColourTolerance = 0.0037 * 1.05;
    constexpr double LogScaleP99 = 0.031 * 1.05;
    constexpr double RotationP1 = 0.9999993 - 5e-8;
    const auto folder = data_folder() / "scenes";
    if (!available(folder / "person_biker.v4.spz")) return;
    const GaussianSet ply = load_scene(folder / "person_biker.compressed.ply").gaussians;
    const GaussianSet spz = load_scene(folder / "person_biker.v4.spz").gaussians;
    DOCTEST_REQUIRE(ply.size() == spz.size());
    DOCTEST_CHECK(largest_difference(ply.position(), spz.position()) <= PositionTolerance);
    DOCTEST_CHECK(same_bits(ply.opacity_logit(), spz.opacity_logit()));
    DOCTEST_CHECK(largest_difference(ply.sh(), spz.sh()) * ShC0 <= ColourTolerance);
    std::vector<double> scale, rotation;
    for (std::size_t i = 0; i < ply.size() * 3; ++i)
        scale.push_back(std::abs(static_cast<double>(ply.log_scale()[i]) - spz.log_scale()[i]));
    for (std::size_t i = 0; i < ply.size(); ++i)
        rotation.push_back(rotation_agreement(ply.rotation().data() + 4 * i, spz.rotation().data() + 4 * i));
    std::sort(scale.begin(), scale.end());
    std::sort(rotation.begin(), rotation.end());
    DOCTEST_CHECK(scale[scale.size() * 99 / 100] <= LogScaleP99);
    DOCTEST_CHECK(rotation[rotation.size() / 100] >= RotationP1);
}

DOCTEST_TEST_CASE("three splats of the train agree in PLY, .splat and SPZ") {
    const auto stem = data_folder() / "fixtures/three_points_of_train/test-splat.3-points-from-train";
    if (!available(stem.string() + ".ply")) return;
    const GaussianSet ply = load_scene(stem.string() + ".ply").gaussians;
    const GaussianSet splat = load_scene(stem.string() + ".splat").gaussians;
    const GaussianSet spz = load_scene(stem.string() + ".spz").gaussians;
    constexpr double SpzPositionStep = 0.5 / 4096 + 1e-6;
    constexpr double SpzScaleStep = 0.5 / 16 + 1e-6;
    constexpr double SpzShStep = 0.5 / 8 + 1.0 / 128;  // bands in 5 and 4 bits, and the last bit of the byte
    constexpr double ByteStep = 1.0 / 255;
    DOCTEST_CHECK(largest_difference(ply.position(), spz.position()) <= SpzPositionStep);
    DOCTEST_CHECK(largest_difference(ply.log_scale(), spz.log_scale()) <= SpzScaleStep);
    DOCTEST_CHECK(same_bits(ply.position(), splat.position()));
    DOCTEST_CHECK(largest_difference(ply.log_scale(), splat.log_scale()) < 1e-5);
    DOCTEST_CHECK(opacity_difference(ply, spz) <= ByteStep);
    DOCTEST_CHECK(opacity_difference(ply, splat) <= ByteStep);
    for (std::size_t i = 0; i < 3; ++i) {
        DOCTEST_CHECK(rotation_agreement(ply.rotation().data() + 4 * i, spz.rotation().data() + 4 * i) >
                      0.99999);
        DOCTEST_CHECK(rotation_agreement(ply.rotation().data() + 4 * i, splat.rotation().data() + 4 * i) >
                      0.9998);
    }
    for (std::size_t row = 0; row < 3;
         ++row)  // the sign of every SH band shows: stored values are up to 0.125
        DOCTEST_CHECK(largest_difference(ply.sh().subspan(row * 48 + 3, 45),
                                         spz.sh().subspan(row * 48 + 3, 45)) <= SpzShStep);
}

DOCTEST_TEST_CASE("the four minimal SPZ envelopes hold splats of one layout") {
    const auto folder = data_folder() / "fixtures/splat-transform";
    if (!available(folder)) return;
    const GaussianSet raw = load_scene(folder / "minimal-raw.spz").gaussians;
    const GaussianSet v2 = load_scene(folder / "minimal-v2.spz").gaussians;
    DOCTEST_CHECK(same_bits(raw, v2));
    const GaussianSet v3 = load_scene(folder / "minimal-v3.spz").gaussians;
    const GaussianSet v4 = load_scene(folder / "minimal-v4.spz").gaussians;
    DOCTEST_CHECK(same_bits(v3, v4));
}

}  // namespace shared_files_test
