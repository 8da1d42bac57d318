// Eigenvalues of symmetric 3x3 matrices; singular values and polar factor of others.
#pragma once

#include "engine/math/vec.h"

namespace gse {

/// a = sum over k of value[k] axis[k] axis[k]^T. Values descend; axes have length one and are at right
/// angles.
struct SymmetricEigen {
    std::array<double, 3> value{};
    std::array<Vec3, 3> axis{};
};

/// Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 8.5). Only the upper triangle is read.
/// Entries must be finite.
SymmetricEigen symmetric_eigen(const Mat3& a);

/// a a^T = sum over k of value[k]^2 axis[k] axis[k]^T. Axes have length one and are at right angles; they
/// form a rotation. Values are not negative. They stand in the order of the columns of `a` that they come
/// from.
struct LeftSingular {
    std::array<double, 3> value{};
    std::array<Vec3, 3> axis{};
};

/// One-sided Jacobi rotations (Hestenes 1958). Small values keep their digits beside large ones if the
/// columns of `a` differ in size only (Demmel and Veselic 1992). Entries must be finite.
LeftSingular left_singular(const Mat3& a);

/// Orthogonal factor U of a = U P, with P symmetric and positive definite; its determinant has the sign of
/// a's. Newton's iteration (Higham 1986). `a` must have an inverse.
Mat3 polar_factor(const Mat3& a);

}  // namespace gse
