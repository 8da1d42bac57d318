// Labels: weights are kept, the bits follow from the threshold.
#include <utility>

#include "engine/scene/scene.h"

namespace gse {

Label make_label(std::string name, std::vector<float> weight, float threshold) {
    std::vector<std::uint8_t> bits(weight.size());
    for (std::size_t row = 0; row < weight.size(); ++row) bits[row] = weight[row] > threshold ? 1 : 0;
    Label label;
    label.name = std::move(name);
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    label.bits = std::make_shared<const std::vector<std::uint8_t>>(std::move(bits));
    return label;
}

}  // namespace gse
