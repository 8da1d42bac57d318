// Synthetic world: procedural, captioned Gaussian scenes with a part label on every Gaussian and true edited
// scenes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/random.h"
#include "engine/laboratory/synth/placing.h"
#include "engine/scene/scene.h"

namespace gse::synth {

/// Part labels of the Gaussians.
enum class Part : std::uint8_t { Ground = 0, Object = 1, Accessory = 2 };

/// Everything that defines a scene in words and numbers; the same spec gives the same scene, bit for bit.
struct SceneSpec {
    std::string object = "bear";     // see object_words()
    std::string material = "red";    // see material_words(); colour or material of the object
    std::string accessory{};         // see accessory_words(); empty = none
    std::string accessory_colour{};  // colour of the accessory; empty = its natural look
    std::string ground = "grass";    // see ground_words()
    std::uint64_t seed = 0;          // shape, pose, texture and light variation
    int gaussian_budget = 6000;      // about this many Gaussians in all
    double heading = 0;         // radians about the vertical, beyond the seed's own pose; the ground stays
    double size = 1;            // factor of the object's and the accessory's size
    std::uint64_t variant = 0;  // others: another thing of the same words in the same light on the same
                                // ground, in pose, proportions and texture
};

/// A generated scene: up is -y as in COLMAP worlds, object standing on y = 0, front towards -z, about 1 unit
/// tall.
struct SynthScene {
    SceneSpec spec;
    Scene scene;
    std::vector<Part> parts;  // [N]
    Vec3 head{};              // world position where hats and sunglasses belong: middle of the "face"
};

const std::vector<std::string>& object_words();     // at least 8
const std::vector<std::string>& material_words();   // at least 8
const std::vector<std::string>& accessory_words();  // at least 5: hat crown sunglasses scarf flames ...
const std::vector<std::string>& ground_words();     // at least 4

/// More words of each list that generate() knows. The network that finds objects was not trained on them; the
/// one that draws was. Random specs and suites keep to the lists above unless these are asked for.
const std::vector<std::string>& more_object_words();
const std::vector<std::string>& more_material_words();
const std::vector<std::string>& more_accessory_words();
const std::vector<std::string>& more_ground_words();

/// Colours an accessory is made in (random specs choose among them); empty when it has its natural look only.
const std::vector<std::string>& accessory_colour_words(const std::string& accessory);

/// Every word of any caption and every word apply_edit() understands but those of more_*_words(), without
/// punctuation (captions use commas).
const std::vector<std::string>& vocabulary();

/// vocabulary(), then every word that only captions of more_*_words() have.
const std::vector<std::string>& drawn_vocabulary();

/// Generates the scene of a spec. Ground, object and accessory have random streams of their own. Taking the
/// accessory away leaves the other rows bit-identical; another material or colour changes nothing but
/// colours. Row order: ground, object, accessory. Throws Error for a word that is not in the lists.
SynthScene generate(const SceneSpec& spec);

/// Ground of a spec's scene with the shadows of its object at some places: maps of the scene's space. Without
/// any it is the ground alone. Rows are those of generate(), but for their colours.
GaussianSet ground_under(const SceneSpec& spec, std::span<const Placing> places);

/// True for about a tenth of all combinations of object, material and accessory: kept out of training.
bool held_out(const SceneSpec& spec);

/// Random spec. `with_accessory`: probability of an accessory.
SceneSpec random_spec(Random& random, double with_accessory = 0.5);
/// Random spec that is never held out.
SceneSpec training_spec(Random& random, double with_accessory = 0.5);
/// Random spec that is always held out.
SceneSpec held_out_spec(Random& random, double with_accessory = 0.5);

/// Random spec with at least one of more_*_words(), never held out. `looks`: of these only materials, colours
/// and grounds.
SceneSpec training_spec_of_more(Random& random, double with_accessory = 0.5, bool looks = false);

/// Radians by which the scene's thing is turned about the vertical: the camera at this azimuth sees its
/// front.
double turn_of(const SceneSpec& spec);

/// Camera around the scene at `azimuth` (0 = front, but for turn_of()) and `elevation` radians, 45 degrees
/// field of view over the shorter side. `zoom` 1 frames the object with ground and leaves room for an
/// accessory on top. The framing depends on the angles only: one camera sees a scene and its edited twin.
Camera scene_camera(const SynthScene& scene, double azimuth, double elevation, double zoom, int width,
                    int height);

/// Camera aimed at the head, for close-ups of small accessories (zoom about 1.5 to 2).
Camera head_camera(const SynthScene& scene, double azimuth, double elevation, double zoom, int width,
                   int height);

/// "front view", "side view" or "back view" of an azimuth.
std::string view_words(double azimuth);
/// One of eight, of 45 degrees each: "front view", "front left view", "left side view", ... "front right
/// view"; the camera of positive azimuths is on the left.
std::string sided_view_words(double azimuth);

/// Azimuth between the middles of two of the eight sides: their words, and its place between the first and
/// the second, in [0,1).
struct SideBlend {
    std::string words, next_words;
    double share = 0;
};
SideBlend side_blend(double azimuth);

/// A caption and, for every word of it that names something visible, which part it names.
struct Caption {
    std::string text;
    struct Grounding {
        std::string word;
        Part part;
        int occurrence = 0;  // which one of this word's occurrences in the text, from 0
    };
    std::vector<Grounding> groundings;
};

/// Full caption "a red bear wearing a blue hat on the grass".
Caption full_caption(const SceneSpec& spec);

/// Random template with words left out (each kind 10-20 % of the time) and view words appended half of the
/// time.
Caption random_caption(const SceneSpec& spec, double azimuth, Random& random);
/// Caption without a word about the side it is seen from.
Caption random_caption(const SceneSpec& spec, Random& random);

/// Applies an edit sentence to a spec: words that it names replace those of the spec (the last of two for one
/// part counts), the rest stays. Examples: "a blue bear", "a bear wearing a red hat", "a golden statue on the
/// sand", "turn the bear into a wooden dog", "remove the hat". Throws Error if no known word is found.
SceneSpec apply_edit(const SceneSpec& spec, const std::string& sentence);

}  // namespace gse::synth
