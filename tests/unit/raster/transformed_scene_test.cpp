// A scene under a map, seen by a camera that goes with it, gives the picture of before.
#include <doctest/doctest.h>

#include <cmath>

#include "engine/scene/transform/transformed.h"
#include "tests/agree/raster/scenes.h"

namespace transformed_scene_test {

using namespace gse;

namespace {

constexpr int Width = 96, Height = 72;
constexpr double LeastPsnr = 60;  // dB: roundings of single precision in positions and colours

Image picture(const GaussianData& data, const Camera& camera) {
    raster::ForwardOutput output;
    raster::make_plain_rasterizer()->forward(spans(data), camera, {}, output);
    return output.colour;
}

double psnr(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        sum += std::pow(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i]), 2);
    return sum == 0 ? 200 : -10 * std::log10(sum / static_cast<double>(a.data.size()));
}

/// Camera that sees a scene under a similarity as it saw the scene. `proper` is a turn.
Camera following(Camera camera, const Affine& proper) {
    const double factor = std::cbrt(proper.determinant());
    const Mat3 turn(proper.linear.columns / factor);
    const Vec3 centre = proper(camera.centre());
    camera.rotation = camera.rotation * turn.transposed();
    camera.translation = -(camera.rotation * centre);
    return camera;
}

}  // namespace

DOCTEST_TEST_CASE("a turned, moved and enlarged scene looks as before to a camera that goes with it") {
    for (int degree = 0; degree <= MaxShDegree; ++degree) {
        test::SceneRecipe recipe;
        recipe.sh_degree = degree;
        recipe.seed = static_cast<std::uint64_t>(degree) + 5;
        const GaussianData scene = test::random_scene(recipe);
        const Camera camera = test::test_camera(Width, Height);
        const Affine map = Affine::scale_about(1.7, {1, 0, 0}) *
                           Affine::turn_about({1, -2, 0.5}, 2.1, {0.3, 0.2, 0}) *
                           Affine::move_by({0.5, -1, 2});
        const Image before = picture(scene, camera);
        DOCTEST_CHECK(psnr(picture(transformed(scene, map), following(camera, map)), before) >= LeastPsnr);
        DOCTEST_CHECK(psnr(picture(transformed(scene, map), camera), before) < LeastPsnr);
    }
}

DOCTEST_TEST_CASE("a mirrored scene shows the mirrored picture") {
    for (int degree = 0; degree <= MaxShDegree; ++degree) {
        test::SceneRecipe recipe;
        recipe.sh_degree = degree;
        const GaussianData scene = test::random_scene(recipe);
        const Camera camera = test::test_camera(Width, Height);
        const Vec3 normal = normalized(Vec3{1, 0.4, -0.2});
        const Affine mirror = Affine::mirror_at(normal, {0.2, 0, 0.1});
        Camera seen = camera;  // its x axis points the other way, so that it is a camera again
        Mat3 flip = Mat3::identity();
        flip(0, 0) = -1;
        seen.rotation = flip * (camera.rotation * mirror.linear);
        seen.translation = -(seen.rotation * mirror(camera.centre()));
        seen.cx = Width - camera.cx;
        Image before = picture(scene, camera);
        const Image after = picture(transformed(scene, mirror), seen);
        for (int y = 0; y < Height; ++y)
            for (int x = 0; x < Width / 2; ++x)
                for (int c = 0; c < 3; ++c) std::swap(before.at(x, y, c), before.at(Width - 1 - x, y, c));
        DOCTEST_CHECK(psnr(after, before) >= LeastPsnr);
    }
}

}  // namespace transformed_scene_test
