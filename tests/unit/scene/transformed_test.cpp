// Gaussians under affine maps, against plain double formulas.
#include "engine/scene/transform/transformed.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/base/random.h"
#include "engine/math/spherical_harmonics.h"
#include "engine/scene/transform/transform_edits.h"
#include "tests/unit/scene/random_sets.h"

namespace transformed_test {

using namespace gse;

namespace {

constexpr double Single = 4e-7;   // a few roundings of float, relative
constexpr double Double = 1e-12;  // some dozen roundings of double, relative
constexpr double Turn = 2 * std::numbers::pi;

Vec3 random_vector(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

GaussianData ordinary(std::size_t count, int degree, std::uint64_t seed) {
    Random random(seed);
    GaussianData data;
    data.sh_degree = degree;
    data.resize(count);
    for (auto* column : {&data.position, &data.log_scale, &data.rotation, &data.opacity_logit, &data.sh})
        for (float& value : *column) value = static_cast<float>(random.normal());
    return data;
}

struct NamedMap {
    const char* name;
    Affine affine;
};

std::vector<NamedMap> similarities(Random& random) {
    const Vec3 axis = random_vector(random), point = random_vector(random);
    const Affine turn = Affine::turn_about(axis, random.uniform(-Turn, Turn), point);
    const Affine scale = Affine::scale_about(std::exp(random.normal()), point);
    const Affine mirror = Affine::mirror_at(random_vector(random), point);
    return {{"move", Affine::move_by(random_vector(random))},
            {"turn", turn},
            {"scale", scale},
            {"mirror", mirror},
            {"all", turn * mirror * scale}};
}

std::vector<NamedMap> all_maps(Random& random) {
    auto maps = similarities(random);
    const Affine stretch = Affine::stretch_along(random_vector(random), 1.7, random_vector(random));
    maps.push_back({"stretch", stretch});
    maps.push_back({"stretch of all", stretch * maps[4].affine * stretch});
    return maps;
}

Vec3 position_of(const GaussianData& data, std::size_t row) {
    return {data.position[row * 3], data.position[row * 3 + 1], data.position[row * 3 + 2]};
}

Mat3 covariance_of(const GaussianData& data, std::size_t row) {
    const float* q = &data.rotation[row * 4];
    Mat3 root = rotation_matrix(Quat(q[0], q[1], q[2], q[3]));
    for (int axis = 0; axis < 3; ++axis)
        root.columns[axis] *=
            std::exp(static_cast<double>(data.log_scale[row * 3 + static_cast<std::size_t>(axis)]));
    return root * root.transposed();
}

double largest(const Mat3& a) {
    double size = 0;
    for (const double entry : a.rows()) size = std::max(size, std::abs(entry));
    return size;
}

void check_close(const Mat3& a, const Mat3& b, double tolerance) {
    DOCTEST_CHECK(largest(Mat3(a.columns - b.columns)) <= tolerance * largest(b));
}

/// Colour without the constant, of channel 1, towards a direction.
double colour_towards(const GaussianData& data, std::size_t row, const Vec3& direction) {
    std::array<double, MaxShCoefficients> basis{};
    sh_basis(direction, data.sh_degree, basis.data());
    double sum = 0;
    for (std::size_t k = 0; k < data.sh_stride() / 3; ++k)
        sum += basis[k] * static_cast<double>(data.sh[row * data.sh_stride() + k * 3 + 1]);
    return sum;
}

}  // namespace

DOCTEST_TEST_CASE("maps are put together and taken back") {
    Random random(5);
    for (int trial = 0; trial < 20; ++trial)
        for (const auto& [name, affine] : all_maps(random)) {
            DOCTEST_CAPTURE(name);
            const Vec3 p = random_vector(random);
            DOCTEST_CHECK(length(inverse(affine)(affine(p)) - p) <= 100 * Double);
            const Affine twice = affine * affine;
            DOCTEST_CHECK(length(twice(p) - affine(affine(p))) <= 100 * Double * (1 + length(twice(p))));
            DOCTEST_CHECK(affine.is_similarity() == (std::string(name).find("stretch") == std::string::npos));
        }
    const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    DOCTEST_CHECK(length(Affine::turn_about(z, Turn / 4, {})(x) - y) <= Double);
    DOCTEST_CHECK(length(Affine::mirror_at(x, {2, 0, 0})({3, 1, 1}) - Vec3{1, 1, 1}) <= Double);
    DOCTEST_CHECK(length(Affine::stretch_along(y, 3, {0, 1, 0})({5, 2, 5}) - Vec3{5, 4, 5}) <= Double);
    for (const Vec3& to : {x, -x, y, normalized(Vec3{1, 1e-9, 0})})
        DOCTEST_CHECK(length(Affine::turn_towards(x, to, {}).linear * x - to) <= Double);
}

DOCTEST_TEST_CASE("positions and covariances follow the map, colours its orthogonal factor") {
    Random random(7);
    for (int degree = 0; degree <= MaxShDegree; ++degree)
        for (const auto& [name, affine] : all_maps(random)) {
            DOCTEST_CAPTURE(name);
            const GaussianData before = ordinary(30, degree, random.next());
            const GaussianData after = transformed(before, affine);
            for (std::size_t row = 0; row < before.size(); ++row) {
                const Vec3 expected = affine(position_of(before, row));
                DOCTEST_CHECK(length(position_of(after, row) - expected) <= Single * (1 + length(expected)));
                const Mat3 covariance =
                    affine.linear * covariance_of(before, row) * affine.linear.transposed();
                check_close(covariance_of(after, row), covariance, 8 * Single);
                if (!affine.is_similarity()) continue;
                const Vec3 direction = normalized(random_vector(random));
                const double factor = std::cbrt(std::abs(affine.determinant()));
                const Vec3 back = affine.linear.transposed() * direction / factor;
                DOCTEST_CHECK(std::abs(colour_towards(after, row, direction) -
                                       colour_towards(before, row, back)) <= 16 * Single);
            }
            DOCTEST_CHECK(test::bits_equal(after.opacity_logit, before.opacity_logit));
        }
}

DOCTEST_TEST_CASE("a stretch turns colours by its orthogonal factor, which is none along one axis") {
    Random random(9);
    const GaussianData before = ordinary(10, 3, 3);
    const GaussianData after = transformed(before, Affine::stretch_along({1, 2, 3}, 1.4, {}));
    DOCTEST_CHECK(test::bits_equal(after.sh, before.sh));
    const Affine turn = Affine::turn_about({3, 1, 0}, 1.1, {});
    const GaussianData both = transformed(before, turn * Affine::stretch_along({1, 2, 3}, 1.4, {}));
    const GaussianData turned = transformed(before, turn);
    for (std::size_t i = 0; i < both.sh.size(); ++i)
        DOCTEST_CHECK(std::abs(both.sh[i] - turned.sh[i]) <= 4 * Single);
}

DOCTEST_TEST_CASE("a very flat splat stays as flat along its normal when it is stretched") {
    GaussianData data = ordinary(1, 0, 4);
    data.log_scale = {0, -1, -20};  // its variances differ by more digits than a double has
    const GaussianData after = transformed(data, Affine::stretch_along({0.3, 1, 0.2}, 2, {}));
    const double volume = data.log_scale[0] + data.log_scale[1] + data.log_scale[2] + std::log(2.0);
    DOCTEST_CHECK(std::abs(after.log_scale[0] + after.log_scale[1] + after.log_scale[2] - volume) <=
                  40 * Single);
    data.log_scale[2] = -std::numeric_limits<float>::infinity();
    const GaussianData flat = transformed(data, Affine::stretch_along({0.3, 1, 0.2}, 2, {}));
    DOCTEST_CHECK(flat.log_scale[2] == -std::numeric_limits<float>::infinity());
    check_close(covariance_of(flat, 0), covariance_of(after, 0), 8 * Single);
}

DOCTEST_TEST_CASE("a map and its inverse give the Gaussians back") {
    Random random(11);
    for (const auto& [name, affine] : all_maps(random)) {
        DOCTEST_CAPTURE(name);
        const GaussianData before = ordinary(30, 3, random.next());
        const GaussianData after = transformed(transformed(before, affine), inverse(affine));
        for (std::size_t row = 0; row < before.size(); ++row) {
            DOCTEST_CHECK(length(position_of(after, row) - position_of(before, row)) <= 40 * Single);
            check_close(covariance_of(after, row), covariance_of(before, row), 40 * Single);
        }
        for (std::size_t i = 0; i < before.sh.size(); ++i)
            DOCTEST_CHECK(std::abs(after.sh[i] - before.sh[i]) <= 40 * Single);
    }
}

DOCTEST_TEST_CASE("the identity changes no bit, and unmarked rows keep theirs") {
    const GaussianSet set = test::random_set(40, 3, 21);
    std::vector<std::uint8_t> rows(set.size(), 0);
    DOCTEST_CHECK(transformed(set, Affine{}).shares_all_with(set));
    Random random(3);
    for (const auto& [name, affine] : all_maps(random)) {
        DOCTEST_CAPTURE(name);
        DOCTEST_CHECK(transformed(set, rows, affine).shares_all_with(set));
        std::vector<std::uint8_t> some(set.size(), 0);
        for (std::size_t row = 0; row < some.size(); row += 3) some[row] = 1;
        const GaussianSet after = transformed(set, some, affine);
        DOCTEST_CHECK(after.size() == set.size());
        for (std::size_t row = 0; row < some.size(); ++row)
            if (some[row] == 0) DOCTEST_CHECK(same_row(set.spans(), row, after.spans(), row));
    }
}

DOCTEST_TEST_CASE("attributes that a map leaves alone are shared") {
    const GaussianSet set(ordinary(10, 2, 2));
    const std::vector<std::uint8_t> all(set.size(), 1);
    const auto before = set.buffers();
    const auto move = transformed(set, all, Affine::move_by({1, 2, 3})).buffers();
    DOCTEST_CHECK(move.position != before.position);
    DOCTEST_CHECK(move.log_scale == before.log_scale);
    DOCTEST_CHECK(move.rotation == before.rotation);
    DOCTEST_CHECK(move.sh == before.sh);
    const auto scale = transformed(set, all, Affine::scale_about(1.3, {1, 0, 0})).buffers();
    DOCTEST_CHECK(scale.log_scale != before.log_scale);
    DOCTEST_CHECK(scale.rotation == before.rotation);
    DOCTEST_CHECK(scale.sh == before.sh);
    const auto turn = transformed(set, all, Affine::turn_about({1, 1, 0}, 0.3, {})).buffers();
    DOCTEST_CHECK(turn.log_scale == before.log_scale);
    DOCTEST_CHECK(turn.sh != before.sh);
    DOCTEST_CHECK(turn.opacity_logit == before.opacity_logit);
}

DOCTEST_TEST_CASE("a quaternion of zero length counts as not turned") {
    GaussianData data = ordinary(1, 0, 4);
    GaussianData plain = data;
    data.rotation = {0, 0, 0, 0};
    plain.rotation = {1, 0, 0, 0};
    for (const Affine& affine :
         {Affine::turn_about({1, 2, 3}, 1, {}), Affine::stretch_along({1, 2, 3}, 1.5, {})})
        check_close(covariance_of(transformed(data, affine), 0), covariance_of(transformed(plain, affine), 0),
                    Single);
}

DOCTEST_TEST_CASE("an edit moves rows that keep their identity, and its switch brings them back") {
    Scene scene;
    scene.gaussians = GaussianSet(ordinary(6, 1, 8));
    const DocumentState state = initial_state(scene, {});
    const std::vector<std::uint8_t> rows{0, 1, 0, 0, 1, 0};
    const Affine turn = Affine::turn_about({0, 1, 0}, 1, {1, 0, 0});
    EditNode node = transform_of(state, rows, turn, 4);
    DOCTEST_CHECK(node.delta->changed == std::vector<RowId>{1, 4});
    DOCTEST_CHECK(node.delta->removed.empty());
    DOCTEST_CHECK(node.delta->added.empty());
    const DocumentState after = with_stack(state, {node});
    DOCTEST_CHECK(test::bits_equal(after.current, transformed(state.current, rows, turn)));
    DOCTEST_CHECK(*after.row_ids == *state.row_ids);
    node.enabled = false;
    DOCTEST_CHECK(test::bits_equal(with_stack(state, {node}).current, state.current));
    DOCTEST_CHECK(transform_of(state, rows, Affine{}, 4).delta->changed.empty());
}

DOCTEST_TEST_CASE("two parts that change places are one edit") {
    Scene scene;
    scene.gaussians = GaussianSet(ordinary(4, 0, 8));
    const DocumentState state = initial_state(scene, {});
    const std::vector<std::uint8_t> first{1, 0, 0, 0}, second{0, 0, 1, 0};
    const Affine there = Affine::move_by({1, 0, 0}), back = Affine::move_by({-1, 0, 0});
    const std::vector<PlacedRows> parts{{first, there}, {second, back}};
    const EditNode node = transform_of(state, parts, 2);
    DOCTEST_CHECK(node.delta->changed == std::vector<RowId>{0, 2});
    DOCTEST_CHECK(test::bits_equal(with_stack(state, {node}).current,
                                   transformed(transformed(state.current, first, there), second, back)));
}

DOCTEST_TEST_CASE("copies are rows of the edit, one set behind the other") {
    Scene scene;
    scene.gaussians = GaussianSet(ordinary(5, 2, 8));
    const DocumentState state = initial_state(scene, {});
    const std::vector<std::uint8_t> rows{0, 1, 1, 0, 0};
    const std::vector<Affine> places{Affine::move_by({2, 0, 0}), Affine::turn_about({0, 1, 0}, 1, {})};
    const EditNode node = copies_of(state, rows, places, 3);
    const DocumentState after = with_stack(state, {node});
    DOCTEST_REQUIRE(after.current.size() == 9);
    const RowId first = RowId{3} << EditIdShift;
    DOCTEST_CHECK(node.delta->added == std::vector<RowId>{first, first + 1, first + 2, first + 3});
    const GaussianSet one = state.current.filtered(rows);
    const std::vector<std::uint8_t> second{0, 0, 0, 0, 0, 0, 0, 1, 1};
    DOCTEST_CHECK(test::bits_equal(after.current.filtered(second), transformed(one, places[1])));
    DOCTEST_CHECK(test::bits_equal(after.current.position().subspan(0, 15), state.current.position()));
    DOCTEST_CHECK(copies_of(state, rows, {}, 3).delta->added.empty());
}

}  // namespace transformed_test
