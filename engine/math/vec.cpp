// Conversions between quaternions and rotation matrices.
#include "engine/math/vec.h"

namespace gse {

Mat3 rotation_matrix(const Quat& q) {
    const double norm = length(q);
    return norm > 0 ? Mat3(glm::mat3_cast(q / norm)) : Mat3::identity();
}

Quat quaternion(const Mat3& rotation) {
    const Quat q = glm::quat_cast(rotation.columns);
    return q.w < 0 ? -q : q;
}

}  // namespace gse
