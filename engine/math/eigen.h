// Eigenvalues of symmetric 3x3 matrices.
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

}  // namespace gse
