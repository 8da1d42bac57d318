// Clocks and noise.
#include "engine/raster/bench_tools.h"

#include <time.h>

#include <chrono>
#include <cmath>

#include "engine/base/random.h"

namespace gse::raster {

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Image noise_image(int width, int height) {
    Image image(width, height, 3);
    Random random(7);
    for (float& value : image.data) value = static_cast<float>(random.uniform(-1.0, 1.0));
    return image;
}

double relative_error(std::span<const float> found, std::span<const float> expected) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double d = static_cast<double>(found[i]) - static_cast<double>(expected[i]);
        difference += d * d;
        size += static_cast<double>(expected[i]) * static_cast<double>(expected[i]);
    }
    return size > 0 ? std::sqrt(difference / size) : std::sqrt(difference);
}

}  // namespace gse::raster
