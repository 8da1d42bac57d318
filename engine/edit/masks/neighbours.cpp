// Nine pixels, fewer at the rim.
#include "engine/edit/masks/neighbours.h"

#include <algorithm>

namespace gse::edit {

Image mean_of_neighbours(const Image& image) {
    Image result(image.width, image.height, 1);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            float sum = 0, all = 0;
            for (int v = std::max(0, y - 1); v <= std::min(image.height - 1, y + 1); ++v)
                for (int u = std::max(0, x - 1); u <= std::min(image.width - 1, x + 1); ++u, ++all)
                    sum += image.at(u, v, 0);
            result.at(x, y, 0) = sum / all;
        }
    return result;
}

}  // namespace gse::edit
