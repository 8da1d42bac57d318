// A turn of the camera at the pace of a hand, pictures counted as they come.
#include "app/laboratory/bench_moving.h"

#include <chrono>
#include <thread>

#include "app/window/preview_native.h"

namespace gse::app {

nlohmann::ordered_json bench_moving(const Scene& scene, int width, int height) {
    using Clock = std::chrono::steady_clock;
    constexpr double warm_up = 0.5, measured = 3, step_ms = 5, turns_per_second = 0.2;
    const OrbitParameters orbit = scene_orbit(scene, {});
    NativePreview preview([] {});
    PictureRequest request;
    request.set = scene.gaussians;
    request.antialiased = scene.info.antialiased;
    request.moving = true;
    const auto start = Clock::now();
    int pictures = 0;
    double widths = 0;
    for (double time = 0; time < warm_up + measured;) {
        request.camera = orbit_camera(orbit, time * turns_per_second * 6.283185307179586, width, height);
        preview.want(request);
        std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(step_ms));
        time = std::chrono::duration<double>(Clock::now() - start).count();
        const auto picture = preview.take();
        if (!picture || time < warm_up) continue;
        ++pictures;
        widths += picture->width;
    }
    nlohmann::ordered_json json;
    json["pictures_per_second"] = pictures / measured;
    json["scale"] = pictures > 0 ? widths / pictures / width : 0.0;
    return json;
}

}  // namespace gse::app
