// Random scenes around the origin, and what makes each of them hard.
#include "engine/laboratory/bench/raster/hostile_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"

namespace gse::bench {
namespace {

using Rows = std::size_t;

/// A scene in the making and where its numbers come from.
struct Draft {
    HostileScene scene;
    Random random;
    Vec3 direction;       // from the origin to the camera
    double distance = 4;  // of the camera
    double fov = 0.9;     // radians
    int width = 0, height = 0;

    explicit Draft(const Random& numbers) : random(numbers) {}
    double uniform(double low, double high) { return random.uniform(low, high); }
    int whole(int low, int high) {
        return low + static_cast<int>(random.below(static_cast<std::uint64_t>(high - low + 1)));
    }
    float normal(double mean, double spread) { return static_cast<float>(mean + spread * random.normal()); }
};

/// An ordinary splat: rotated, not round, mostly half opaque, coloured.
void fill_row(Draft& d, std::size_t row, double log_scale, double stretch, double opacity) {
    GaussianData& data = d.scene.data;
    const double size = log_scale + 0.6 * d.random.normal();
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i) {
        data.position[i] = static_cast<float>(d.uniform(-1.5, 1.5));
        data.log_scale[i] = d.normal(size, stretch);
    }
    for (std::size_t i = row * 4; i < row * 4 + 4; ++i) data.rotation[i] = d.normal(0, 1);
    data.opacity_logit[row] = d.normal(opacity, 2);
    const std::size_t stride = data.sh_stride();
    for (std::size_t k = 0; k < stride; ++k) data.sh[row * stride + k] = d.normal(0, k < 3 ? 1 : 0.25);
}

void begin(Draft& d, std::size_t count) {
    d.scene.data = {};
    d.scene.data.sh_degree = d.whole(0, MaxShDegree);
    d.scene.data.resize(count);
    const double log_scale = d.uniform(-4, -1.5), stretch = d.uniform(0.3, 1.2), opacity = d.uniform(-1, 3);
    for (std::size_t row = 0; row < count; ++row) fill_row(d, row, log_scale, stretch, opacity);
    d.width = d.whole(16, 80), d.height = d.whole(16, 64);
    d.fov = d.uniform(0.5, 1.2);
    d.direction = normalized({d.random.normal(), 0.5 * d.random.normal(), d.random.normal()});
    if (length(d.direction) == 0) d.direction = {0, 0, -1};
}

/// The camera that the draft asks for, with an off-centre principal point and two focal lengths.
void place_camera(Draft& d) {
    d.scene.camera = Camera::look_at(d.direction * d.distance, {}, {0, -1, 0}, d.fov, d.width, d.height);
    d.scene.camera.cx += d.uniform(-2, 2);
    d.scene.camera.cy += d.uniform(-2, 2);
    d.scene.camera.fy *= d.uniform(0.9, 1.1);
}

/// Each axis of a row: `is_long` of the three at `high`, the others at `low`; which is random.
void stretch_row(Draft& d, std::size_t row, std::size_t is_long, double high, double low) {
    const std::size_t first = d.random.below(3);
    for (std::size_t axis = 0; axis < 3; ++axis)
        d.scene.data.log_scale[row * 3 + (first + axis) % 3] =
            static_cast<float>(axis < is_long ? high : low);
}

void scale_world(Draft& d, double factor) {
    for (float& value : d.scene.data.position)
        value = static_cast<float>(factor * static_cast<double>(value));
    for (float& value : d.scene.data.log_scale) value += static_cast<float>(std::log(factor));
    d.scene.camera.translation = d.scene.camera.translation * factor;
}

/// Scene and camera move together.
void move_world(Draft& d, const Vec3& by) {
    GaussianData& data = d.scene.data;
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t axis = 0; axis < 3; ++axis)
            data.position[row * 3 + axis] = static_cast<float>(
                static_cast<double>(data.position[row * 3 + axis]) + by[static_cast<int>(axis)]);
    d.scene.camera.translation = d.scene.camera.translation - d.scene.camera.rotation * by;
}

void put(Draft& d, std::size_t row, const Vec3& place) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        d.scene.data.position[row * 3 + axis] = static_cast<float>(place[static_cast<int>(axis)]);
}

/// Change of one row by a cause; used for a whole scene and, row by row, for mixtures.
using RowChange = void (*)(Draft&, std::size_t row);

constexpr RowChange Needle = [](Draft& d, std::size_t row) {
    stretch_row(d, row, 1, d.uniform(-1, 3), d.uniform(-14, -6));
};
constexpr RowChange Pancake = [](Draft& d, std::size_t row) {
    stretch_row(d, row, 2, d.uniform(-2, 1), d.uniform(-16, -8));
};
constexpr RowChange Giant = [](Draft& d, std::size_t row) {
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
        d.scene.data.log_scale[i] = static_cast<float>(d.uniform(1, 5));
    d.scene.data.opacity_logit[row] = static_cast<float>(d.uniform(-5, 1));
};
constexpr RowChange Speck = [](Draft& d, std::size_t row) {
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
        d.scene.data.log_scale[i] = static_cast<float>(d.uniform(-18, -7));
};
constexpr RowChange Faint = [](Draft& d, std::size_t row) {  // around the cut at 1/255, logit -5.54
    d.scene.data.opacity_logit[row] = static_cast<float>(d.uniform(-5.6, -4));
};
constexpr RowChange Opaque = [](Draft& d, std::size_t row) {
    d.scene.data.opacity_logit[row] = static_cast<float>(d.uniform(5, 30));
};
constexpr RowChange Bright = [](Draft& d, std::size_t row) {
    const auto factor = static_cast<float>(std::exp(d.uniform(0, 12)));
    const std::size_t stride = d.scene.data.sh_stride();
    for (std::size_t k = row * stride; k < (row + 1) * stride; ++k) d.scene.data.sh[k] *= factor;
};
constexpr RowChange OddTurn = [](Draft& d, std::size_t row) {
    const auto factor = static_cast<float>(std::pow(10.0, d.uniform(-14, 15)));
    for (std::size_t k = row * 4; k < row * 4 + 4; ++k) d.scene.data.rotation[k] *= factor;
};
/// On a coarse grid: many rows have the same depth.
constexpr RowChange Tie = [](Draft& d, std::size_t row) {
    for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
        d.scene.data.position[i] = std::round(2 * d.scene.data.position[i]) / 2;
};

template <RowChange change> void every_row(Draft& d) {
    for (std::size_t row = 0; row < d.scene.data.size(); ++row) change(d, row);
}

void nothing(Draft&) {}

void coincident(Draft& d) {
    begin(d, 10000);
    d.width = d.whole(8, 20), d.height = d.whole(8, 20);
    for (std::size_t row = 0; row < d.scene.data.size(); ++row) put(d, row, {0.1, -0.2, 0.3});
    if (d.random.below(2) == 0)  // faint enough that thousands are blended before the light ends
        for (float& logit : d.scene.data.opacity_logit) logit = static_cast<float>(d.uniform(-5.5, -4.8));
}

/// Thousands of faint splats behind each other.
void column(Draft& d) {
    begin(d, static_cast<Rows>(d.whole(1500, 3000)));
    d.width = d.whole(12, 32), d.height = d.whole(12, 32);
    for (std::size_t row = 0; row < d.scene.data.size(); ++row) {
        Faint(d, row);
        put(d, row, d.direction * d.uniform(-40, 3) + Vec3{d.uniform(-0.2, 0.2), d.uniform(-0.2, 0.2), 0});
    }
}

void inside(Draft& d) {
    d.scene.settings.near_plane = static_cast<float>(std::pow(10.0, d.uniform(-6, -3)));
    const double spread = std::pow(10.0, d.uniform(-3, 0));
    for (std::size_t row = 0; row < d.scene.data.size(); ++row)
        put(d, row,
            d.direction * d.distance +
                Vec3{d.random.normal(), d.random.normal(), d.random.normal()} * spread);
}

void near_cut(Draft& d) {
    d.scene.settings.near_plane = static_cast<float>(d.uniform(3, 4.5));
    d.scene.settings.far_plane = static_cast<float>(d.uniform(4.5, 6));
    for (std::size_t row = 0; row < d.scene.data.size(); row += 3) Giant(d, row);
}

void far_camera(Draft& d) { d.distance = std::pow(10.0, d.uniform(2, 5)); }

void telephoto(Draft& d) {
    d.distance = std::pow(10.0, d.uniform(2, 5));
    d.fov = 3 / d.distance;
}

void fisheye(Draft& d) {
    d.fov = d.uniform(2.4, 3.1);
    d.distance = d.uniform(0.5, 3);
}

void few_pixels(Draft& d) { d.width = d.whole(1, 3), d.height = d.whole(1, 3); }

/// Picture as wide or as high as a 4k picture, and a few pixels across: coordinates are as large at a small
/// price.
void strip(Draft& d) {
    const bool wide = d.random.below(2) == 0;
    d.width = wide ? 4096 : d.whole(1, 5), d.height = wide ? d.whole(1, 5) : 4096;
    d.fov = wide ? d.uniform(0.3, 0.8) : 1e-3;
    for (std::size_t row = 0; row < d.scene.data.size(); ++row) {
        Vec3 place{d.uniform(-1.5, 1.5), d.uniform(-1.5, 1.5), d.uniform(-1.5, 1.5)};
        (wide ? place.y : place.x) *= 0.01;  // rows lie on the strip
        put(d, row, place);
        for (std::size_t i = row * 3; i < row * 3 + 3; ++i) d.scene.data.log_scale[i] = d.normal(-6, 0.8);
    }
    d.direction = {0, 0, -1};
}

void compensated(Draft& d) {
    d.scene.settings.antialiased = true;
    for (std::size_t row = 0; row < d.scene.data.size(); ++row)
        for (std::size_t i = row * 3; i < row * 3 + 3; ++i)
            d.scene.data.log_scale[i] += static_cast<float>(d.uniform(-5, 0));
}

void little_blur(Draft& d) {
    d.scene.settings.blur_px2 = static_cast<float>(std::pow(10.0, d.uniform(-2, -0.6)));
    for (std::size_t row = 0; row < d.scene.data.size(); row += 2) Needle(d, row);
}

void no_blur(Draft& d) {
    d.scene.settings.blur_px2 =
        d.random.below(2) == 0 ? 0.0f : static_cast<float>(std::pow(10.0, d.uniform(-6, -3)));
    for (std::size_t row = 0; row < d.scene.data.size(); row += 2) Needle(d, row);
}

void dark(Draft& d) {
    d.scene.settings.negative_colour_slope = static_cast<float>(d.uniform(0, 1));
    d.scene.settings.background = {static_cast<float>(d.uniform(0, 1)), 1.0f, 0.0f};
    const std::size_t stride = d.scene.data.sh_stride();
    for (std::size_t row = 0; row < d.scene.data.size(); ++row)
        for (std::size_t c = 0; c < 3; ++c)
            d.scene.data.sh[row * stride + c] -= 1.8f;  // about 0 after the offset
}

void mixture(Draft& d) {
    constexpr std::array<RowChange, 8> changes{Needle, Pancake, Giant, Speck, Faint, Opaque, OddTurn, Tie};
    for (std::size_t row = 0; row < d.scene.data.size(); ++row)
        if (const std::size_t which = d.random.below(changes.size() + 2); which < changes.size())
            changes[which](d, row);
    d.scene.settings.antialiased = d.random.below(3) == 0;
    d.scene.settings.sh_degree = d.whole(0, MaxShDegree);
    if (d.random.below(4) == 0) d.distance = d.uniform(0.3, 1.5);
    if (d.random.below(6) == 0) few_pixels(d);
}

template <int power> void world(Draft& d) { scale_world(d, std::pow(10.0, power)); }

void far_origin(Draft& d) {
    const double size = std::pow(10.0, d.uniform(2, 5));
    move_world(d, {size, -size * d.uniform(0, 1), size * d.uniform(0, 1)});
}

/// `change` acts before the camera is placed, `then` on what the camera sees.
struct Recipe {
    HostileCause cause;
    void (*change)(Draft&);
    void (*then)(Draft&) = nothing;
};

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all{
        {{"ordinary", "nothing is special"}, nothing},
        {{"needles", "one axis a million times as long as the others"}, every_row<Needle>},
        {{"pancakes", "one axis next to nothing"}, every_row<Pancake>},
        {{"giants", "splats larger than the scene"}, every_row<Giant>},
        {{"specks", "splats far smaller than a pixel"}, every_row<Speck>},
        {{"faint", "opacity around 1/255, where a pair is cut"}, every_row<Faint>},
        {{"opaque", "opacity at its upper end"}, every_row<Opaque>},
        {{"bright", "colours up to 100,000"}, every_row<Bright>},
        {{"dark", "colours about the clamp at 0, with a slope below it, on a background"}, dark},
        {{"odd rotations", "quaternions of length 1e-14 to 1e15"}, every_row<OddTurn>},
        {{"equal depths", "rows on a grid: ties in the depth order"}, every_row<Tie>},
        {{"coincident", "10,000 splats in one place"}, coincident},
        {{"column", "thousands of faint splats behind each other"}, column},
        {{"camera inside", "the camera is inside of splats, the near plane at 1e-6 to 1e-3"}, inside},
        {{"plane cuts", "the near and far planes cut through the scene and its giants"}, near_cut},
        {{"far camera", "100 to 100,000 times as far as the scene is large"}, far_camera},
        {{"telephoto", "as far, with a field of view that the scene fills"}, telephoto},
        {{"fisheye", "a field of view of 140 to 178 degrees"}, fisheye},
        {{"few pixels", "pictures of 1 to 3 pixels a side"}, few_pixels},
        {{"4k strip", "pictures of 4096 pixels on one side"}, strip},
        {{"world 1e-3", "a thousandth as large"}, nothing, world<-3>},
        {{"world 1e6", "a million times as large"}, nothing, world<6>},
        {{"far origin", "100 to 100,000 units from the origin"}, nothing, far_origin},
        {{"compensated", "opacity compensation of splats that are small in the picture"}, compensated},
        {{"little blur", "needles with a blur of 0.01 to 0.25 square pixels (0.3 is usual)"}, little_blur},
        {{"no blur", "needles with a blur of 0 to 0.001"}, no_blur},
        {{"mixture", "rows of all kinds, with settings of all kinds"}, mixture}};
    return all;
}

}  // namespace

const std::vector<HostileCause>& hostile_causes() {
    static const std::vector<HostileCause> causes = [] {
        std::vector<HostileCause> list;
        for (const auto& recipe : recipes()) list.push_back(recipe.cause);
        return list;
    }();
    return causes;
}

HostileScene hostile_scene(const std::string& cause, std::uint64_t seed) {
    const auto& all = recipes();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Recipe& recipe) { return recipe.cause.name == cause; });
    if (found == all.end())
        throw Error(ErrorCode::InvalidArgument, "there is no kind of scene \"" + cause + "\"",
                    "use all, or one of the table's names");
    Draft draft(Random::stream(seed, static_cast<std::uint64_t>(found - all.begin())));
    begin(draft, static_cast<Rows>(draft.whole(30, 300)));
    found->change(draft);
    place_camera(draft);
    found->then(draft);
    return std::move(draft.scene);
}

}  // namespace gse::bench
