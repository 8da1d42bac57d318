// Jacobi rotations until the off-diagonal entries are zero in double.
#include "engine/math/eigen.h"

#include <algorithm>
#include <cmath>

namespace gse {
namespace {

constexpr int MostSweeps = 20;  // convergence is quadratic: five or six are enough

/// Turns the plane of the axes p < q so that a(p,q) becomes zero.
void rotate(Mat3& a, Mat3& vectors, int p, int q) {
    if (a(p, q) == 0) return;
    const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
    const double t =
        std::isfinite(theta) ? (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::hypot(theta, 1.0)) : 0;
    const double c = 1 / std::hypot(t, 1.0), s = t * c;
    const auto mix = [&](double& first, double& second) {
        const double old = first;
        first = c * old - s * second;
        second = s * old + c * second;
    };
    for (int k = 0; k < 3; ++k) mix(a(k, p), a(k, q));
    for (int k = 0; k < 3; ++k) mix(a(p, k), a(q, k));
    for (int k = 0; k < 3; ++k) mix(vectors(k, p), vectors(k, q));
    a(p, q) = a(q, p) = 0;
}

}  // namespace

SymmetricEigen symmetric_eigen(const Mat3& symmetric) {
    Mat3 a = symmetric, vectors = Mat3::identity();
    for (int row = 1; row < 3; ++row)
        for (int column = 0; column < row; ++column) a(row, column) = a(column, row);
    for (int sweep = 0; sweep < MostSweeps; ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) rotate(a, vectors, p, q);
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(),
                     [&](int left, int right) { return a(left, left) > a(right, right); });
    SymmetricEigen result;
    for (std::size_t k = 0; k < 3; ++k) {
        const int column = order[k];
        result.value[k] = a(column, column);
        result.axis[k] = vectors.columns[column];
    }
    return result;
}

}  // namespace gse
