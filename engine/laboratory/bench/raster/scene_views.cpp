// The named cameras, or an orbit.
#include "engine/laboratory/bench/raster/scene_views.h"

#include <algorithm>

#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::bench {

std::vector<Camera> spread_cameras(const Scene& scene, const std::filesystem::path& scene_file,
                                   const std::string& cameras, int count, int width, int height) {
    std::vector<View> views;
    if (cameras != "none")
        views = pipeline::views_of_scene(pipeline::scene_cameras(scene_file, cameras), scene.gaussians,
                                         scene.info.offset);
    if (views.empty()) views = orbit_views(pipeline::scene_orbit(scene, {}), count, width, height);
    std::vector<Camera> chosen;
    const auto kept = std::min(views.size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < kept; ++i) chosen.push_back(views[i * views.size() / kept].camera);
    return chosen;
}

}  // namespace gse::bench
