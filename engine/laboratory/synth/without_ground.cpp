// Keeps the rows of all other parts.
#include "engine/laboratory/synth/without_ground.h"

#include <vector>

namespace gse::synth {

SynthScene without_ground(SynthScene scene) {
    std::vector<unsigned char> kept;
    for (const auto part : scene.parts) kept.push_back(part == Part::Ground ? 0 : 1);
    scene.scene.gaussians = scene.scene.gaussians.filtered(kept);
    std::erase(scene.parts, Part::Ground);
    return scene;
}

}  // namespace gse::synth
