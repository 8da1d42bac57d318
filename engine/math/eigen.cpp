// Jacobi rotations until the off-diagonal entries are zero in double.
#include "engine/math/eigen.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/check.h"

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

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// Turns two columns in their plane until they are at right angles. False where they are so already.
bool make_orthogonal(Vec3& first, Vec3& second) {
    const double a = dot(first, first), b = dot(second, second), c = dot(first, second);
    if (std::abs(c) <= Epsilon * std::sqrt(a) * std::sqrt(b)) return false;
    const double zeta = (b - a) / (2 * c);
    const double t =
        std::isfinite(zeta) ? (zeta >= 0 ? 1 : -1) / (std::abs(zeta) + std::hypot(zeta, 1.0)) : 0;
    const double cosine = 1 / std::hypot(t, 1.0), sine = t * cosine;
    const Vec3 old = first;
    first = cosine * old - sine * second;
    second = sine * old + cosine * second;
    return t != 0;
}

/// Some direction at right angles to a unit vector.
Vec3 orthogonal_to(const Vec3& axis) {
    const Vec3 helper = std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return normalized(cross(axis, helper));
}

/// Fills in the axes of values that are zero, and makes the three a rotation.
void complete(LeftSingular& result) {
    std::size_t largest = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (result.value[k] > result.value[largest]) largest = k;
    if (!(result.value[largest] > 0)) {
        result.axis = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
        return;
    }
    const std::size_t next = (largest + 1) % 3, last = (largest + 2) % 3;
    if (!(result.value[next] > 0) && !(result.value[last] > 0))
        result.axis[next] = orthogonal_to(result.axis[largest]);
    else if (!(result.value[next] > 0)) result.axis[next] = cross(result.axis[last], result.axis[largest]);
    const Vec3 third = cross(result.axis[largest], result.axis[next]);
    const bool left_handed = result.value[last] > 0 && dot(third, result.axis[last]) < 0;
    if (!(result.value[last] > 0)) result.axis[last] = third;
    if (left_handed) result.axis[last] = -result.axis[last];
}

double frobenius(const Mat3& a) {
    double sum = 0;
    for (const double entry : a.rows()) sum += entry * entry;
    return std::sqrt(sum);
}

}  // namespace

LeftSingular left_singular(const Mat3& a) {
    std::array<Vec3, 3> columns{a.columns[0], a.columns[1], a.columns[2]};
    bool turned = true;
    for (int sweep = 0; sweep < MostSweeps && turned; ++sweep) {
        turned = false;
        for (std::size_t p = 0; p < 2; ++p)
            for (std::size_t q = p + 1; q < 3; ++q)
                turned = make_orthogonal(columns[p], columns[q]) || turned;
    }
    LeftSingular result;
    for (std::size_t k = 0; k < 3; ++k) {
        result.value[k] = length(columns[k]);
        result.axis[k] = normalized(columns[k]);
    }
    complete(result);
    return result;
}

Mat3 polar_factor(const Mat3& a) {
    constexpr int MostSteps = 60;  // quadratic convergence; scaling keeps the steps before it few
    Mat3 now = a;
    for (int step = 0; step < MostSteps; ++step) {
        const Mat3 inverse(glm::inverse(now.columns));
        const double size = frobenius(now), inverse_size = frobenius(inverse);
        GSE_CHECK(std::isfinite(inverse_size) && size > 0);
        const double gamma = std::sqrt(inverse_size / size);
        const Mat3 next(0.5 * (gamma * now.columns + glm::transpose(inverse.columns) / gamma));
        const double change = frobenius(Mat3(next.columns - now.columns));
        now = next;
        if (change <= 4 * Epsilon * frobenius(next)) break;
    }
    return now;
}

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
