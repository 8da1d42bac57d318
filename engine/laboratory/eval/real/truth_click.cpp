// City-block distances within the mask of the thing.
#include "engine/laboratory/eval/real/truth_click.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "engine/pipeline/select/named_picture.h"
#include "engine/pipeline/select/point_out.h"

namespace gse::bench {
namespace {

constexpr double ClickElevation = 15;  // degrees, where no box names a picture

std::string picture_text(const RealScene& scene, const RealTask& task) {
    if (const auto named = pipeline::named_picture(task.cut_out, 4, {3}))
        return fmt::format("{},{},{}", named->parameters.azimuth, named->parameters.elevation,
                           named->parameters.zoom);
    return fmt::format("{},{},1", scene.front.value_or(0), ClickElevation);
}

/// Steps from each pixel of a mask to the nearest outside of it or of the picture, [W*H].
std::vector<int> steps_to_outline(const Mask& mask) {
    const int width = mask.width, height = mask.height;
    std::vector<int> steps(mask.data.size());
    const auto at = [&](int x, int y) {
        const bool within = x >= 0 && y >= 0 && x < width && y < height;
        return within ? steps[static_cast<std::size_t>(y) * width + x] : 0;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y) * width + x;
            steps[pixel] = mask.data[pixel] == 0 ? 0 : std::min(at(x - 1, y), at(x, y - 1)) + 1;
        }
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x) {
            auto& here = steps[static_cast<std::size_t>(y) * width + x];
            here = std::min(here, std::min(at(x + 1, y), at(x, y + 1)) + 1);
        }
    return steps;
}

}  // namespace

std::optional<std::string> truth_click(pipeline::Painter& painter, const RealScene& scene,
                                       const RealTask& task, const Scene& splats, const Rows& thing) {
    const auto picture = picture_text(scene, task);
    const auto camera = pipeline::click_request("0.5,0.5," + picture, splats, scene.up).camera;
    const Mask seen = seen_rows(painter, splats.gaussians, thing, {{}, camera}).front();
    const auto steps = steps_to_outline(seen);
    const auto most = std::max_element(steps.begin(), steps.end());
    if (most == steps.end() || *most == 0) return std::nullopt;
    const auto pixel = static_cast<int>(most - steps.begin());
    return fmt::format("{:.4f},{:.4f},{}", (pixel % seen.width + 0.5) / seen.width,
                       (pixel / seen.width + 0.5) / seen.height, picture);
}

}  // namespace gse::bench
