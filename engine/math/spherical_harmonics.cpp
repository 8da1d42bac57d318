// Spherical harmonics basis as polynomials of the direction (signs and order of the 3DGS files).
#include "engine/math/spherical_harmonics.h"

namespace gse {
namespace {

constexpr double C1 = 0.4886025119029199;
constexpr double C2a = 1.0925484305920792, C2b = 0.31539156525252005, C2c = 0.5462742152960396;
constexpr double C3a = 0.5900435899266435, C3b = 2.890611442640554, C3c = 0.4570457994644658;
constexpr double C3d = 0.3731763325901154, C3e = 1.445305721320277;

}  // namespace

void sh_basis(const Vec3& d, int degree, double* basis) {
    const double x = d.x, y = d.y, z = d.z;
    basis[0] = ShC0;
    if (degree < 1) return;
    basis[1] = -C1 * y;
    basis[2] = C1 * z;
    basis[3] = -C1 * x;
    if (degree < 2) return;
    const double xx = x * x, yy = y * y, zz = z * z;
    basis[4] = C2a * x * y;
    basis[5] = -C2a * y * z;
    basis[6] = C2b * (2 * zz - xx - yy);
    basis[7] = -C2a * x * z;
    basis[8] = C2c * (xx - yy);
    if (degree < 3) return;
    basis[9] = -C3a * y * (3 * xx - yy);
    basis[10] = C3b * x * y * z;
    basis[11] = -C3c * y * (4 * zz - xx - yy);
    basis[12] = C3d * z * (2 * zz - 3 * xx - 3 * yy);
    basis[13] = -C3c * x * (4 * zz - xx - yy);
    basis[14] = C3e * z * (xx - yy);
    basis[15] = -C3a * x * (xx - 3 * yy);
}

void sh_basis_gradient(const Vec3& d, int degree, Vec3* g) {
    const double x = d.x, y = d.y, z = d.z;
    g[0] = {};
    if (degree < 1) return;
    g[1] = {0, -C1, 0};
    g[2] = {0, 0, C1};
    g[3] = {-C1, 0, 0};
    if (degree < 2) return;
    g[4] = Vec3{y, x, 0} * C2a;
    g[5] = Vec3{0, z, y} * -C2a;
    g[6] = Vec3{-2 * x, -2 * y, 4 * z} * C2b;
    g[7] = Vec3{z, 0, x} * -C2a;
    g[8] = Vec3{2 * x, -2 * y, 0} * C2c;
    if (degree < 3) return;
    const double xx = x * x, yy = y * y, zz = z * z;
    g[9] = Vec3{6 * x * y, 3 * (xx - yy), 0} * -C3a;
    g[10] = Vec3{y * z, x * z, x * y} * C3b;
    g[11] = Vec3{-2 * x * y, 4 * zz - xx - 3 * yy, 8 * y * z} * -C3c;
    g[12] = Vec3{-6 * x * z, -6 * y * z, 6 * zz - 3 * xx - 3 * yy} * C3d;
    g[13] = Vec3{4 * zz - 3 * xx - yy, -2 * x * y, 8 * x * z} * -C3c;
    g[14] = Vec3{2 * x * z, -2 * y * z, xx - yy} * C3e;
    g[15] = Vec3{3 * (xx - yy), -6 * x * y, 0} * -C3a;
}

}  // namespace gse
