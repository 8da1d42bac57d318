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

}  // namespace eigen_test
