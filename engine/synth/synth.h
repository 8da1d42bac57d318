// Synthetic world: procedural, captioned Gaussian scenes with a part label on every Gaussian and true edited scenes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/random.h"
#include "engine/scene/scene.h"

namespace gse::synth {

/// Part labels of the Gaussians.
enum class Part : std::uint8_t { Ground = 0, Object = 1, Accessory = 2 };

/// Everything that defines a scene in words and numbers; the same spec gives the same scene, bit for bit.
struct SceneSpec {
    std::string object = "bear";     // see object_words()
    std::string material = "red";    // see material_words(); colour or material of the object
    std::string accessory;           // see accessory_words(); empty = none
    std::string accessory_colour;    // colour of the accessory; empty = its natural look
    std::string ground = "grass";    // see ground_words()
    std::uint64_t seed = 0;          // shape, pose, texture and light variation
    int gaussian_budget = 6000;      // about this many Gaussians in all
};

/// A generated scene: up is -y as in COLMAP worlds, object standing on y = 0, front towards -z, about 1 unit tall.
struct SynthScene {
    SceneSpec spec;
    Scene scene;
    std::vector<Part> parts;         // [N]
};

const std::vector<std::string>& object_words();     // at least 8
const std::vector<std::string>& material_words();   // at least 8
const std::vector<std::string>& accessory_words();  // at least 5: hat crown sunglasses scarf flames ...
const std::vector<std::string>& ground_words();     // at least 4

SynthScene generate(const SceneSpec& spec);

/// Random spec. `with_accessory`: probability of an accessory.
SceneSpec random_spec(Random& random, double with_accessory = 0.5);

/// Camera around the scene at `azimuth` (0 = front) and `elevation` radians. `zoom` 1 frames the object with ground.
Camera scene_camera(const SynthScene& scene, double azimuth, double elevation, double zoom, int width, int height);

/// "front view", "side view" or "back view" of an azimuth.
std::string view_words(double azimuth);

/// A caption and, for every word of it that names something visible, which part it names.
struct Caption {
    std::string text;
    struct Grounding {
        std::string word;
        Part part;
    };
    std::vector<Grounding> groundings;
};

/// Full caption "a red bear wearing a blue hat on the grass".
Caption full_caption(const SceneSpec& spec);

/// Random template with words left out (each kind 10-20 % of the time) and view words appended half of the time.
Caption random_caption(const SceneSpec& spec, double azimuth, Random& random);

/// Applies an edit sentence ("a blue bear", "a bear wearing a red hat", "a golden statue on the sand") to a spec:
/// words the sentence names replace those of the spec, the rest stays. Throws Error if no known word is found.
SceneSpec apply_edit(const SceneSpec& spec, const std::string& sentence);

}  // namespace gse::synth
