// Eigenvalues and axes give the matrix back.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include "engine/base/random.h"
#include "engine/math/eigen.h"

namespace eigen_test {

namespace {

using namespace gse;

constexpr double Tolerance = 1e-12;  // relative to the matrix: some dozen roundings of double

void check(const Mat3& a) {
    const SymmetricEigen eigen = symmetric_eigen(a);
    double size = 1e-300;
    for (const double entry : a.rows()) size = std::max(size, std::abs(entry));
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k)
                sum += eigen.value[k] * eigen.axis[k][row] * eigen.axis[k][column];
            DOCTEST_CHECK(std::abs(sum - a(row, column)) <= Tolerance * size);
        }
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            DOCTEST_CHECK(std::abs(dot(eigen.axis[i], eigen.axis[j]) - (i == j ? 1 : 0)) <= Tolerance);
    DOCTEST_CHECK(eigen.value[0] >= eigen.value[1]);
    DOCTEST_CHECK(eigen.value[1] >= eigen.value[2]);
}

}  // namespace

DOCTEST_TEST_CASE("symmetric matrices are the sum of their axes") {
    Random random(7);
    for (int trial = 0; trial < 200; ++trial) {
        Mat3 a;
        const double scale = std::exp(random.uniform(-200, 200));
        for (int row = 0; row < 3; ++row)
            for (int column = row; column < 3; ++column)
                a(row, column) = a(column, row) = scale * random.normal();
        check(a);
    }
}

DOCTEST_TEST_CASE("flat, round and empty matrices") {
    check(Mat3{});
    check(Mat3::identity());
    check(Mat3::from_rows({1, 1, 1, 1, 1, 1, 1, 1, 1}));                    // one axis only
    check(Mat3::from_rows({2, 0, 0, 0, 5, 0, 0, 0, 3}));                    // in the wrong order
    check(Mat3::from_rows({1, 1e-14, 0, 1e-14, 1, 1e-300, 0, 1e-300, 1}));  // nearly round
}

DOCTEST_TEST_CASE("left singular vectors give the square of a matrix, small values with all their digits") {
    Random random(9);
    for (int trial = 0; trial < 200; ++trial) {
        Mat3 a;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) a(row, column) = random.normal();
        Mat3 graded = a;
        const std::array<double, 3> sizes{1, std::exp(random.uniform(-60, 0)),
                                          std::exp(random.uniform(-60, 0))};
        for (int column = 0; column < 3; ++column)
            graded.columns[column] *= sizes[static_cast<std::size_t>(column)];
        const LeftSingular parts = left_singular(graded);
        double volume = 1;
        for (std::size_t k = 0; k < 3; ++k) volume *= parts.value[k] / sizes[k];
        const double expected = std::abs(glm::determinant(a.columns));
        DOCTEST_CHECK(std::abs(volume - expected) <= 100 * Tolerance * (1 + expected));
        const Mat3 axes = Mat3::from_columns(parts.axis[0], parts.axis[1], parts.axis[2]);
        DOCTEST_CHECK(glm::determinant(axes.columns) == doctest::Approx(1));
        const Mat3 square = graded * graded.transposed();
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) {
                double sum = 0;
                for (std::size_t k = 0; k < 3; ++k)
                    sum += parts.value[k] * parts.value[k] * parts.axis[k][row] * parts.axis[k][column];
                DOCTEST_CHECK(std::abs(sum - square(row, column)) <= 100 * Tolerance);
            }
    }
}

DOCTEST_TEST_CASE("axes of matrices with empty columns are completed to a rotation") {
    const Vec3 x{2, 0, 0}, y{0, 3, 0}, none{};
    for (const Mat3& a : {Mat3{}, Mat3::from_columns(x, none, none), Mat3::from_columns(none, y, none),
                          Mat3::from_columns(none, x, y), Mat3::from_columns(x, none, y),
                          Mat3::from_columns(x, y, none), Mat3::from_columns(y, x, Vec3{0, 0, 1})}) {
        const LeftSingular parts = left_singular(a);
        const Mat3 axes = Mat3::from_columns(parts.axis[0], parts.axis[1], parts.axis[2]);
        DOCTEST_CHECK(glm::determinant(axes.columns) == doctest::Approx(1));
        for (int k = 0; k < 3; ++k)
            DOCTEST_CHECK(parts.value[static_cast<std::size_t>(k)] == length(a.columns[k]));
    }
}

DOCTEST_TEST_CASE("the polar factor is orthogonal, and what is left is symmetric and positive") {
    Random random(11);
    for (int trial = 0; trial < 200; ++trial) {
        Mat3 a;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) a(row, column) = random.normal();
        if (std::abs(glm::determinant(a.columns)) < 0.01) continue;
        const Mat3 factor = polar_factor(a), unit = factor.transposed() * factor,
                   rest = factor.transposed() * a;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) {
                DOCTEST_CHECK(std::abs(unit(row, column) - (row == column ? 1 : 0)) <= Tolerance);
                DOCTEST_CHECK(std::abs(rest(row, column) - rest(column, row)) <= 100 * Tolerance);
            }
        DOCTEST_CHECK(symmetric_eigen(rest).value[2] > 0);
        DOCTEST_CHECK(glm::determinant(factor.columns) * glm::determinant(a.columns) > 0);
    }
}

}  // namespace eigen_test
