// Noise pictures and relative differences.
#include "engine/raster/bench_tools.h"

#include <cmath>

#include "engine/base/random.h"

namespace gse::raster {

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
