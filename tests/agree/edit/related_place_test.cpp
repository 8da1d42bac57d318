// New things go where the sentence says, in scenes with a ground and with attention that knows the source.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "engine/base/log.h"
#include "engine/edit/placement/voxel_region.h"
#include "engine/edit/search/locate.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/localize/clusters.h"
#include "tests/unit/edit/requests.h"

namespace related_place_test {

namespace {

using namespace gse;

constexpr int Side = 64, Views = 12;
/// Share of the source's size by which a region's centre may pass its bounds. An object touches its
/// neighbour, and one at its foot lies on the ground's uneven surface.
constexpr double Touching = 0.08;
constexpr double Near = 0.15;  // of the source's height, between where all views look and where the region is

/// The bear of the synthetic world (up -y, front -z, feet at y = 0), its views and its bounds.
struct World {
    synth::SynthScene scene = synth::generate({.seed = 7});
    std::vector<View> views;
    std::vector<std::uint8_t> bear;
    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);

    World() {
        for (int i = 0; i < Views; ++i)
            views.push_back({"view", synth::scene_camera(scene, 2 * std::numbers::pi * i / Views,
                                                         i % 2 == 0 ? 0.25 : 0.5, 0.6, Side, Side)});
        const auto position = scene.scene.gaussians.position();
        for (std::size_t row = 0; row < scene.parts.size(); ++row) {
            bear.push_back(scene.parts[row] == synth::Part::Object ? 1 : 0);
            for (int axis = 0; bear.back() != 0 && axis < 3; ++axis) {
                const double p = position[row * 3 + static_cast<std::size_t>(axis)];
                low[axis] = std::min(low[axis], p);
                high[axis] = std::max(high[axis], p);
            }
        }
    }
    Vec3 size() const { return high - low; }
};

/// Knows where the bear is; of the new thing it knows a place, or nothing.
class KnowingAttention : public edit::AttentionSource {
public:
    KnowingAttention(const World& world, const Vec3* place) : world_(world), place_(place) {}
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        const Camera& camera = world_.views[calls_++ % world_.views.size()].camera;
        Image map(Side, Side, 1);
        if (!query.absent) {
            const std::vector<float> values(world_.bear.begin(), world_.bear.end());
            world_.rasterizer->forward_values(world_.scene.scene.gaussians.spans(), camera, {}, values, map);
        } else if (place_ != nullptr) {
            draw_place(camera, map);
        }
        std::vector<Image> maps{map};
        while (maps.size() < query.words.size()) maps.emplace_back(Side, Side, 1);
        return maps;
    }
    int image_size() const override { return Side; }

private:
    void draw_place(const Camera& camera, Image& map) const {
        const Vec3 p = camera.to_camera(*place_);
        const double radius = 0.2 * world_.size().y * camera.fx / p.z;
        for (int y = 0; y < Side; ++y)
            for (int x = 0; x < Side; ++x)
                map.at(x, y, 0) = std::hypot(x + 0.5 - (camera.fx * p.x / p.z + camera.cx),
                                             y + 0.5 - (camera.fy * p.y / p.z + camera.cy)) < radius
                                      ? 1.0f
                                      : 0.0f;
    }
    const World& world_;
    const Vec3* place_;
    std::size_t calls_ = 0;
};

edit::LocateResult locate(const World& world, const std::string& sentence, const Vec3* place) {
    const auto request = test::asked("bear", sentence, "ball");
    KnowingAttention attention(world, place);
    const std::vector<std::string> no_words;
    return edit::locate(
        {world.scene.scene.gaussians, world.views, no_words, request, {}, {0, -1, 0}, {0, 0, -1}},
        {*world.rasterizer, attention, nullptr, nullptr, {}});
}

Vec3 centre_of(const edit::VoxelRegion& region) {
    Vec3 mean;
    for (const auto& cell : region.centres) mean = mean + cell / static_cast<double>(region.centres.size());
    return mean;
}

/// A sentence and the direction in which its ball lies from the bear: the axis and its sign; 0 = either.
struct Direction {
    std::string sentence;
    int axis;
    double sign;
};

// Up is -y and the front -z: who looks at the front from there has +x at the right.
const std::vector<Direction> Directions{
    {"a bear beside a ball", 0, 0},     {"a bear with a ball beside it", 0, 0},
    {"a ball left of the bear", 0, -1}, {"a ball right of the bear", 0, 1},
    {"a ball behind the bear", 2, 1},   {"a ball in front of the bear", 2, -1},
    {"a ball under the bear", 1, 1}};

/// How far the point lies beyond the bear's bounds in that direction; negative = within.
double beyond(const World& world, const Vec3& p, const Direction& direction) {
    const double above = p[direction.axis] - world.high[direction.axis],
                 below = world.low[direction.axis] - p[direction.axis];
    return direction.sign > 0 ? above : direction.sign < 0 ? below : std::max(above, below);
}

}  // namespace

DOCTEST_TEST_CASE("where nothing tells, a new thing goes where the preposition says") {
    log::set_level(log::Level::Off);
    const World world;
    const double height = world.size().y;
    for (const auto& direction : Directions) {
        DOCTEST_INFO(direction.sentence);
        const auto found = locate(world, direction.sentence, nullptr);
        DOCTEST_REQUIRE(found.mode == edit::EditMode::Add);
        DOCTEST_REQUIRE(found.problem == edit::SearchProblem::None);
        const Vec3 centre = centre_of(found.region);
        DOCTEST_CHECK(beyond(world, centre, direction) > -Touching * height);
        DOCTEST_CHECK(found.seeds.size() > 0);
        if (direction.axis == 1) continue;
        // It rests on the ground that the bear stands on.
        double lowest = -1e9;
        for (const auto& cell : found.region.centres)
            lowest = std::max(lowest, cell.y + 0.5 * found.region.side);
        DOCTEST_CHECK(std::abs(lowest - world.high.y) < Touching * height);
    }
    const auto on_screen = [&](const char* sentence) {
        const auto region = locate(world, sentence, nullptr).region;
        return synth::scene_camera(world.scene, 0, 0.25, 0.6, Side, Side).to_camera(centre_of(region)).x;
    };
    DOCTEST_CHECK(on_screen("a ball left of the bear") < on_screen("a ball right of the bear"));
    const auto on = locate(world, "a ball on the bear", nullptr);
    DOCTEST_CHECK(on.region.origin == "top");
    DOCTEST_CHECK(centre_of(on.region).y < world.low.y + 0.5 * height);
    log::set_level(log::Level::Info);
}

DOCTEST_TEST_CASE("attention is followed on the right side of the source, and nowhere else") {
    log::set_level(log::Level::Off);
    const World world;
    const Vec3 middle = (world.low + world.high) * 0.5;
    const double height = world.size().y;
    for (const auto& direction : Directions) {
        if (direction.axis == 1) continue;  // the ground leaves no room to look into
        DOCTEST_INFO(direction.sentence);
        Vec3 place = middle;
        const double sign = direction.sign == 0 ? -1 : direction.sign;
        place[direction.axis] += sign * (0.5 * world.size()[direction.axis] + 0.3 * height);
        place.y = world.high.y - 0.25 * height;
        const auto found = locate(world, direction.sentence, &place);
        DOCTEST_REQUIRE(!found.region.empty());
        DOCTEST_CHECK(found.region.origin == "attention");
        DOCTEST_CHECK(length(centre_of(found.region) - place) < Near * height);
        // Attention on its head says nothing of what stands beside it.
        const Vec3 head{middle.x, world.low.y - 0.1 * height, middle.z};
        DOCTEST_CHECK(beyond(world, centre_of(locate(world, direction.sentence, &head).region), direction) >
                      -Touching * height);
    }
    log::set_level(log::Level::Info);
}

}  // namespace related_place_test
