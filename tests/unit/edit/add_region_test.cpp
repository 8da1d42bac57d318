// Places of new objects: votes of masks, anchors, seeds.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/edit/placement/voxel_region.h"
#include "tests/unit/edit/edit_scenes.h"

#include "engine/language/grammar.h"

namespace add_region_test {

namespace {

using namespace gse;

constexpr int Side = 64;

/// Views of the two balls with their depths; masks are those of a small sphere at `centre`.
struct Search {
    test::BallScene scene = test::ball_scene(200);
    std::vector<View> views = test::ball_views(12, Side);
    std::vector<Mask> masks;
    std::vector<Image> depths;

    explicit Search(const Vec3& centre, double radius) {
        const auto rasterizer = raster::make_plain_rasterizer();
        raster::ForwardOutput output;
        for (const auto& view : views) {
            rasterizer->forward(scene.set.spans(), view.camera, {}, output);
            for (std::size_t i = 0; i < output.depth.data.size(); ++i)
                output.depth.data[i] =
                    output.alpha.data[i] > 0.5f ? output.depth.data[i] / output.alpha.data[i] : 0;
            depths.push_back(output.depth);
            Mask mask(Side, Side);
            const Vec3 p = view.camera.to_camera(centre);
            for (int y = 0; y < Side; ++y)
                for (int x = 0; x < Side; ++x) {
                    const double dx = x + 0.5 - (view.camera.fx * p.x / p.z + view.camera.cx);
                    const double dy = y + 0.5 - (view.camera.fy * p.y / p.z + view.camera.cy);
                    mask.at(x, y) = std::hypot(dx, dy) < radius * view.camera.fx / p.z ? 1 : 0;
                }
            masks.push_back(std::move(mask));
        }
    }
    edit::RegionSearch search() const {
        return {scene.set, scene.first, views, masks, depths, {0, -1, 0}, {0, 0, -1}};
    }
};

}  // namespace

DOCTEST_TEST_CASE("masks of one place vote for that place") {
    const Vec3 centre{-0.55, -0.55, 0.05};
    const Search setup(centre, 0.2);
    const auto region = edit::vote_region(setup.search());
    DOCTEST_REQUIRE_FALSE(region.empty());
    DOCTEST_CHECK(region.origin == "attention");
    DOCTEST_CHECK(region.agreement > 0.8);
    Vec3 mean;
    for (const auto& cell : region.centres) {
        mean = mean + cell / static_cast<double>(region.centres.size());
        DOCTEST_CHECK(length(cell - centre) < 0.2 * 1.6);  // the hull of twelve discs bulges a little
    }
    DOCTEST_CHECK(length(mean - centre) < 0.08);
    // Its picture covers the masks it came from.
    for (std::size_t v = 0; v < setup.views.size(); ++v) {
        const Mask seen = edit::region_mask(region, setup.views[v].camera);
        std::size_t both = 0;
        for (std::size_t i = 0; i < seen.data.size(); ++i)
            both += seen.data[i] != 0 && setup.masks[v].data[i] != 0 ? 1 : 0;
        DOCTEST_CHECK(static_cast<double>(both) > 0.7 * static_cast<double>(setup.masks[v].count()));
    }
}

DOCTEST_TEST_CASE("what is inside a place is hidden by its shell: its picture is the same without") {
    const Search setup({-0.55, -0.55, 0.05}, 0.2);
    const auto region = edit::vote_region(setup.search());
    DOCTEST_REQUIRE_FALSE(region.shell.empty());
    DOCTEST_CHECK(region.shell.size() < region.centres.size());
    auto whole = region;
    whole.shell.clear();
    for (const auto& view : setup.views)
        DOCTEST_CHECK(edit::region_mask(region, view.camera).data ==
                      edit::region_mask(whole, view.camera).data);
}

DOCTEST_TEST_CASE("a place is not seen where it lies behind the surface by more than one of its cubes") {
    const Search setup({-0.55, -0.55, 0.05}, 0.2);
    const auto region = edit::vote_region(setup.search());
    DOCTEST_REQUIRE_FALSE(region.empty());
    const Camera& camera = setup.views[0].camera;
    const Mask whole = edit::region_mask(region, camera);
    double nearest = 1e9, farthest = 0;
    for (const auto& centre : region.centres) {
        const double z = camera.to_camera(centre).z;
        nearest = std::min(nearest, z), farthest = std::max(farthest, z);
    }
    const auto seen_with = [&](double surface) {
        const Image depth(camera.width, camera.height, 1, static_cast<float>(surface));
        return edit::region_mask(region, camera, &depth);
    };
    DOCTEST_CHECK(seen_with(0).data == whole.data);  // nothing is there
    DOCTEST_CHECK(seen_with(farthest).data == whole.data);
    DOCTEST_CHECK(seen_with(nearest - 2 * region.side).count() == 0);
    const Mask half = seen_with(nearest - 0.5 * region.side);  // the cubes in front
    DOCTEST_CHECK(half.count() > 0);
    DOCTEST_CHECK(half.count() < whole.count());
}

DOCTEST_TEST_CASE("where no depth is known, nothing hides a place") {
    Search setup({-0.55, -0.55, 0.05}, 0.2);
    setup.depths.clear();
    const auto region = edit::vote_region(setup.search());
    DOCTEST_REQUIRE_FALSE(region.empty());
    DOCTEST_CHECK(region.agreement > 0.8);
}

DOCTEST_TEST_CASE("a place of several parts keeps all, also a small one; specks do not count") {
    const Vec3 left{-0.55, -0.55, 0.05}, right{0.1, -0.55, 0.05}, small{-0.95, -0.25, 0.05},
        speck{-0.2, -0.75, 0.05};
    Search setup(left, 0.2);
    for (const auto& [centre, radius] :
         {std::pair{right, 0.17}, std::pair{small, 0.13}, std::pair{speck, 0.06}}) {
        const Search other(centre, radius);
        for (std::size_t v = 0; v < setup.masks.size(); ++v)
            for (std::size_t i = 0; i < setup.masks[v].data.size(); ++i)
                setup.masks[v].data[i] |= other.masks[v].data[i];
    }
    const auto region = edit::vote_region(setup.search());
    const auto near = [&region](const Vec3& centre, double radius) {
        return std::count_if(region.centres.begin(), region.centres.end(),
                             [&](const Vec3& cell) { return length(cell - centre) < radius; });
    };
    DOCTEST_CHECK(near(left, 0.2) > 20);
    DOCTEST_CHECK(near(right, 0.17) > 20);
    DOCTEST_CHECK(near(small, 0.13) > 3);  // a quarter of the first
    DOCTEST_CHECK(near(speck, 0.06) == 0);
}

DOCTEST_TEST_CASE("a place may lie below a label that lacks what carries the thing: a scarf around a stem") {
    constexpr int Cap = 900, Stem = 150, Ground = 3000;
    const Vec3 scarf{0, 0.25, 0};  // up is -y, the ground y = 0.5
    const Search around(scarf, 0.2);
    Random random(11);
    GaussianData data;
    data.resize(Cap + Stem + Ground);
    std::vector<std::uint8_t> cap(data.size(), 0);
    for (std::size_t row = 0; row < data.size(); ++row) {
        const bool of_cap = row < Cap, of_stem = !of_cap && row < Cap + Stem;
        const double wide = of_cap    ? 0.4
                            : of_stem ? 0.1
                                      : 1.5,
                     low = of_cap    ? -0.5
                           : of_stem ? 0
                                     : 0.49,
                     high = of_cap    ? 0
                            : of_stem ? 0.5
                                      : 0.51;
        data.position[row * 3] = static_cast<float>(random.uniform(-wide, wide));
        data.position[row * 3 + 1] = static_cast<float>(random.uniform(low, high));
        data.position[row * 3 + 2] = static_cast<float>(random.uniform(-wide, wide));
        data.rotation[row * 4] = 1;
        data.opacity_logit[row] = 2;
        cap[row] = of_cap ? 1 : 0;
    }
    const GaussianSet set(std::move(data));
    const auto region = edit::vote_region({set, cap, around.views, around.masks, {}, {0, -1, 0}, {0, 0, -1}});
    DOCTEST_REQUIRE_FALSE(region.empty());
    Vec3 mean;
    for (const auto& cell : region.centres) mean = mean + cell / static_cast<double>(region.centres.size());
    DOCTEST_CHECK(length(mean - scarf) < 0.08);
}

DOCTEST_TEST_CASE("of all levels of agreement the one is taken whose silhouettes match the masks best") {
    // A third of the views sees only the middle of the thing: what nearly all views agree on would be that
    // middle.
    const Vec3 centre{-0.55, -0.55, 0.05};
    Search setup(centre, 0.2);
    const Search middle(centre, 0.08);
    for (std::size_t v = 0; v < setup.masks.size(); v += 3) setup.masks[v] = middle.masks[v];
    const auto region = edit::vote_region(setup.search());
    // The grid is that of the source, the same in both.
    const auto whole = edit::vote_region(Search(centre, 0.2).search());
    DOCTEST_REQUIRE_FALSE(whole.empty());
    const double share =
        static_cast<double>(region.centres.size()) / static_cast<double>(whole.centres.size());
    DOCTEST_CHECK(share > 0.6);
    DOCTEST_CHECK(share < 1.4);
}

DOCTEST_TEST_CASE("masks that disagree, cover everything or are hidden inside give no region") {
    Search apart({-0.55, -0.55, 0}, 0.2);
    for (std::size_t v = 0; v < apart.masks.size(); ++v) {  // one quarter of the picture each, going round
        apart.masks[v] = Mask(Side, Side);
        for (int y = 0; y < Side / 2; ++y)
            for (int x = 0; x < Side / 2; ++x)
                apart.masks[v].at(x + (v % 2 == 1 ? Side / 2 : 0), y + (v / 2 % 2 == 1 ? Side / 2 : 0)) = 1;
    }
    DOCTEST_CHECK(edit::vote_region(apart.search()).empty());
    Search all({-0.55, -0.55, 0}, 0.2);
    for (auto& mask : all.masks) mask = Mask(Side, Side, 1);
    DOCTEST_CHECK(edit::vote_region(all.search()).empty());
    const Search inside({-0.55, 0, 0}, 0.12);  // within the opaque ball: nobody could see it
    DOCTEST_CHECK(edit::vote_region(inside.search()).empty());
    Search blind({-0.55, -0.55, 0}, 0.2);
    for (auto& mask : blind.masks) mask = Mask();
    DOCTEST_CHECK(edit::vote_region(blind.search()).empty());
}

DOCTEST_TEST_CASE("anchors lie where their names say") {
    const Search setup({-0.55, -0.55, 0}, 0.2);
    const auto search = setup.search();
    for (const auto& cell : edit::anchor_region(search, "top").centres) DOCTEST_CHECK(cell.y < -0.25);
    for (const auto& cell : edit::anchor_region(search, "front").centres) DOCTEST_CHECK(cell.z < 0);
    for (const auto& cell : edit::anchor_region(search, "neck").centres) {
        DOCTEST_CHECK(std::hypot(cell.x + 0.55, cell.z) > 0.2);
        DOCTEST_CHECK(std::abs(cell.y) < 0.3);
    }
    for (const auto& cell : edit::anchor_region(search, "around").centres)
        DOCTEST_CHECK(length(cell - Vec3{-0.55, 0, 0}) > 0.3);
    for (const char* place : {"top", "front", "neck", "around"}) {
        const auto region = edit::anchor_region(search, place);
        DOCTEST_CHECK(region.centres.size() > 20);
        DOCTEST_CHECK(region.origin == place);
        DOCTEST_CHECK(region.side > 0);
    }
    DOCTEST_CHECK(language::usual_place("hat") == "top");
    DOCTEST_CHECK(language::usual_place("sunglasses") == "front");
    DOCTEST_CHECK(language::usual_place("scarf") == "neck");
    DOCTEST_CHECK(language::usual_place("flames") == "around");
    DOCTEST_CHECK(language::usual_place("horns") == "top");
    DOCTEST_CHECK(language::usual_place("white beard") == "neck");
}

DOCTEST_TEST_CASE("seeds lie in the region, are finite and repeatable") {
    edit::VoxelRegion region;
    region.side = 0.1;
    region.centres = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
    const auto seeds = edit::seed_splats(region, 350, 2, 9, 0.1);
    DOCTEST_REQUIRE(seeds.size() == 350);
    DOCTEST_CHECK(seeds.sh.size() == 350 * 27);
    for (std::size_t row = 0; row < seeds.size(); ++row) {
        bool inside = false;
        for (const auto& centre : region.centres) {
            bool here = true;
            for (int axis = 0; axis < 3; ++axis)
                here &= std::abs(seeds.position[row * 3 + static_cast<std::size_t>(axis)] - centre[axis]) <=
                        0.0501;
            inside |= here;
        }
        DOCTEST_CHECK(inside);
        DOCTEST_CHECK(1 / (1 + std::exp(-seeds.opacity_logit[row])) == doctest::Approx(0.1).epsilon(1e-4));
        DOCTEST_CHECK(std::isfinite(seeds.log_scale[row * 3]));
    }
    DOCTEST_CHECK(edit::seed_splats(region, 350, 2, 9, 0.1).position == seeds.position);
    DOCTEST_CHECK(edit::seed_splats(region, 350, 2, 10, 0.1).position != seeds.position);
    DOCTEST_CHECK(edit::seed_splats({}, 350, 0, 9).size() == 0);
}

DOCTEST_TEST_CASE("beside is the side with room, under is below what floats and at the foot of what stands") {
    const Search setup({-0.55, -0.55, 0}, 0.2);  // the red ball; the green one lies at its right
    auto search = setup.search();
    const auto middle = [](const edit::VoxelRegion& region) {
        Vec3 mean;
        for (const auto& cell : region.centres)
            mean = mean + cell / static_cast<double>(region.centres.size());
        return mean;
    };
    search.relation = language::Relation::Beside;
    // The sentence moves an accessory that usually sits on top.
    const auto beside = edit::usual_region(search, "hat");
    DOCTEST_CHECK(beside.origin == "beside");
    DOCTEST_CHECK(middle(beside).x < -0.95);
    search.relation = language::Relation::Right;
    DOCTEST_CHECK(middle(edit::usual_region(search, "ball")).x > -0.15);
    search.relation = language::Relation::Under;
    for (const auto& cell : edit::usual_region(search, "ball").centres)
        DOCTEST_CHECK(cell.y > 0.35);  // up is -y
    search.relation = language::Relation::Above;
    DOCTEST_CHECK(edit::usual_region(search, "scarf").origin == "neck");
    // On a floor of other splats nothing fits below: it lies at the foot.
    GaussianData data = setup.scene.set.to_data();
    std::vector<std::uint8_t> bits = setup.scene.first;
    for (std::size_t row = 0; row < 25; ++row) {
        data.append_row(setup.scene.set.to_data(), 0);
        float* p = &data.position[(data.size() - 1) * 3];
        p[0] = -0.85f + 0.15f * static_cast<float>(row % 5);
        p[1] = 0.41f;
        p[2] = -0.3f + 0.15f * static_cast<float>(row / 5);
        bits.push_back(0);
    }
    const GaussianSet standing(std::move(data));
    const edit::RegionSearch floor{standing,     bits,       setup.views, setup.masks,
                                   setup.depths, {0, -1, 0}, {0, 0, -1},  language::Relation::Under};
    const auto rug = edit::usual_region(floor, "rug");
    DOCTEST_REQUIRE_FALSE(rug.empty());
    for (const auto& cell : rug.centres) DOCTEST_CHECK(std::abs(cell.y - 0.4) < 0.08);
}

namespace {

/// Rows of one thing: square plates of points, level at a height, and upright walls. Up is -y.
class Furniture {
public:
    void plate(const Vec3& centre, double half) {
        for (double x = -half; x <= half; x += 0.04)
            for (double z = -half; z <= half; z += 0.04) point(centre + Vec3{x, 0, z});
    }
    void wall(const Vec3& low, double width, double height) {
        for (double x = 0; x <= width; x += 0.04)
            for (double y = 0; y <= height; y += 0.04) point(low + Vec3{x, -y, 0});
    }
    GaussianSet set() const {
        auto data = data_;
        data.resize(points_.size());
        for (std::size_t row = 0; row < points_.size(); ++row) {
            for (int axis = 0; axis < 3; ++axis)
                data.position[row * 3 + static_cast<std::size_t>(axis)] =
                    static_cast<float>(points_[row][axis]);
            data.opacity_logit[row] = 4;
        }
        return GaussianSet(std::move(data));
    }

private:
    void point(const Vec3& p) { points_.push_back(p); }
    std::vector<Vec3> points_;
    GaussianData data_;
};

edit::VoxelRegion put_on(const GaussianSet& set) {
    const std::vector<std::uint8_t> bits(set.size(), 1);
    const std::vector<View> views;
    const edit::RegionSearch search{set, bits,       views,      {},
                                    {},  {0, -1, 0}, {0, 0, -1}, language::Relation::Above};
    return edit::usual_region(search, "cat");
}

}  // namespace

DOCTEST_TEST_CASE("on a chair is on its seat, on a table its top, and a ball has no level place") {
    constexpr double SeatHeight = 0.5;
    Furniture chair;
    chair.plate({0, -SeatHeight, 0}, 0.4);
    chair.wall({-0.4, 0, 0.4}, 0.8, 1.2);  // the back, higher than the seat
    const auto cat = put_on(chair.set());
    DOCTEST_REQUIRE_FALSE(cat.empty());
    DOCTEST_CHECK(cat.origin == "on");
    double lowest = 1e9;
    for (const auto& cell : cat.centres) {
        lowest = std::min(lowest, -cell.y);
        DOCTEST_CHECK(std::max(std::abs(cell.x), std::abs(cell.z)) < 0.4);
    }
    DOCTEST_CHECK(std::abs(lowest - SeatHeight) < cat.side);  // it touches the seat
    Furniture table;
    table.plate({0, 0, 0}, 0.1);
    table.plate({0, -1, 0}, 0.6);
    const auto vase = put_on(table.set());
    DOCTEST_CHECK(vase.origin == "on");
    for (const auto& cell : vase.centres) DOCTEST_CHECK(cell.y < -1);
    const Search ball({-0.55, -0.55, 0}, 0.2);
    auto search = ball.search();
    search.relation = language::Relation::Above;
    DOCTEST_CHECK(edit::usual_region(search, "cat").origin == "top");
}

}  // namespace add_region_test
