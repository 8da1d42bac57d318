// Words that only what draws new things is trained on, and random specifications with them.
#include <algorithm>

#include "engine/laboratory/synth/words.h"

namespace gse::synth {
namespace {

using Words = std::vector<std::string>;

const std::string& one_of(const Words& words, Random& random) { return words[random.below(words.size())]; }

/// One of `more` with probability `share`, else one of `words`.
const std::string& one_of(const Words& words, const Words& more, double share, Random& random) {
    return one_of(random.uniform() < share ? more : words, random);
}

}  // namespace

const Words& more_object_words() {
    static const Words words{"rabbit",  "horse",  "elephant", "pig",      "lion",    "penguin",
                             "owl",     "frog",   "turtle",   "dinosaur", "snowman", "robot",
                             "pumpkin", "cactus", "teapot",   "rocket",   "castle",  "lamp"};
    return words;
}

const Words& more_material_words() {
    static const Words words{"pink",      "brown",   "gray",  "turquoise", "silver",
                             "bronze",    "marble",  "brick", "striped",   "spotted",
                             "checkered", "rainbow", "rusty", "lava",      "mossy"};
    return words;
}

const Words& more_accessory_words() {
    static const Words words{"cape", "beard",    "horns",      "helmet",
                             "halo", "backpack", "headphones", "necklace"};
    return words;
}

const Words& more_accessory_colour_words(const std::string& accessory) {
    static const Words cloth{"red",    "blue",  "green", "yellow", "purple",
                             "orange", "black", "white", "pink",   "brown"};
    static const Words hair{"white", "black", "brown", "red", "gray"};
    static const Words bone{"white", "black", "red", "golden", "brown"};
    static const Words shell{"silver", "golden", "red", "blue", "black", "bronze", "green"};
    static const Words cups{"black", "red", "blue", "white", "pink", "green"};
    static const Words beads{"golden", "silver", "red", "blue", "green", "white"};
    static const Words none;
    if (accessory == "beard") return hair;
    if (accessory == "horns") return bone;
    if (accessory == "helmet") return shell;
    if (accessory == "headphones") return cups;
    if (accessory == "necklace") return beads;
    return accessory == "cape" || accessory == "backpack" ? cloth : none;
}

const Words& more_ground_words() {
    static const Words words{"leaves", "mud", "gravel", "ice"};
    return words;
}

const Words& drawn_vocabulary() {
    static const Words words = [] {
        Words all = vocabulary();
        for (const auto& list : {more_object_words(), more_material_words(), more_accessory_words(),
                                 more_ground_words(), Words{"grey"}})
            all.insert(all.end(), list.begin(), list.end());
        return all;
    }();
    return words;
}

SceneSpec training_spec_of_more(Random& random, double with_accessory, bool looks) {
    constexpr double NewObject = 0.5, NewMaterial = 0.45, NewAccessory = 0.5, NewGround = 0.2, Natural = 0.15,
                     MoreColour = 0.35;
    static const Words more_colours{"pink",    "brown",   "gray",      "turquoise", "silver",
                                    "striped", "spotted", "checkered", "rainbow"};
    const auto is_more = [](const SceneSpec& spec) {
        return contains(more_object_words(), spec.object) || contains(more_material_words(), spec.material) ||
               contains(more_accessory_words(), spec.accessory) ||
               contains(more_colours, spec.accessory_colour) || contains(more_ground_words(), spec.ground);
    };
    SceneSpec spec;
    do {
        spec = random_spec(random, with_accessory);
        spec.object = one_of({spec.object}, more_object_words(), looks ? 0 : NewObject, random);
        spec.material = one_of({spec.material}, more_material_words(), NewMaterial, random);
        spec.ground = one_of({spec.ground}, more_ground_words(), NewGround, random);
        if (spec.accessory.empty()) continue;
        if (random.uniform() < (looks ? 0 : NewAccessory)) {
            spec.accessory = one_of(more_accessory_words(), random);
            spec.accessory_colour.clear();
        }
        const auto& colours = accessory_colour_words(spec.accessory);
        if (colours.empty() || random.uniform() < Natural) {
            spec.accessory_colour.clear();
            continue;
        }
        do {
            spec.accessory_colour = one_of(colours, more_colours, MoreColour, random);
        } while (spec.accessory_colour == spec.material);
    } while (held_out(spec) || !is_more(spec));
    return spec;
}

}  // namespace gse::synth
