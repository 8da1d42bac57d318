// Camera and settings, widened and with derived limits.
#include "engine/raster/viewpoint.h"

#include <algorithm>

#include "engine/base/check.h"
#include "engine/raster/conventions.h"

namespace gse::raster {

std::size_t sh_floats(const GaussianSpans& gaussians) {
    return static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3;
}

void check_inputs(const GaussianSpans& g, const Camera& camera) {
    GSE_CHECK_EQ(g.position.size(), g.size * 3);
    GSE_CHECK_EQ(g.log_scale.size(), g.size * 3);
    GSE_CHECK_EQ(g.rotation.size(), g.size * 4);
    GSE_CHECK_EQ(g.opacity_logit.size(), g.size);
    GSE_CHECK_EQ(g.sh.size(), g.size * sh_floats(g));
    GSE_CHECK(camera.width > 0 && camera.height > 0 && camera.fx > 0 && camera.fy > 0);
}

Viewpoint viewpoint_of(const Camera& camera, const Settings& settings, int scene_degree) {
    Viewpoint view{};
    std::ranges::copy(camera.rotation.rows(), view.rotation);
    const Vec3 eye = camera.centre();
    for (int axis = 0; axis < 3; ++axis) {
        view.translation[axis] = camera.translation[axis];
        view.eye[axis] = eye[axis];
    }
    view.fx = camera.fx;
    view.fy = camera.fy;
    view.cx = camera.cx;
    view.cy = camera.cy;
    const double margin_x = FrustumMargin * 0.5 * camera.width / camera.fx;
    const double margin_y = FrustumMargin * 0.5 * camera.height / camera.fy;
    view.ratio_low[0] = -(camera.cx / camera.fx + margin_x);
    view.ratio_low[1] = -(camera.cy / camera.fy + margin_y);
    view.ratio_high[0] = (camera.width - camera.cx) / camera.fx + margin_x;
    view.ratio_high[1] = (camera.height - camera.cy) / camera.fy + margin_y;
    view.near_plane = settings.near_plane;
    view.far_plane = settings.far_plane;
    view.blur = settings.blur_px2;
    view.width = camera.width;
    view.height = camera.height;
    view.sh_count = sh_coefficient_count(std::clamp(settings.sh_degree, 0, scene_degree));
    view.negative_slope = settings.negative_colour_slope;
    view.antialiased = settings.antialiased;
    return view;
}

}  // namespace gse::raster
