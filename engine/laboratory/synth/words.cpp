// Word lists, random and held-out specifications, view words.
#include "engine/laboratory/synth/words.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "engine/base/check.h"
#include "engine/base/error.h"

namespace gse::synth {
namespace {

using Words = std::vector<std::string>;

void require_known(const Words& words, const Words& more, const std::string& word, const char* what) {
    if (contains(words, word) || contains(more, word)) return;
    std::string hint = "known words:";
    for (const auto& list : {words, more})
        for (const auto& known : list) hint += " " + known;
    throw Error(ErrorCode::NotFound, "the synthetic world has no " + std::string(what) + " \"" + word + "\"",
                hint);
}

const std::string& pick(const Words& words, Random& random) { return words[random.below(words.size())]; }

constexpr double SectorWidth = std::numbers::pi / 4;

/// Words for one of the eight sides, counted from the front to the left.
const std::string& sector(long index) {
    static const std::array<std::string, 8> sectors{"front view",      "front left view", "left side view",
                                                    "back left view",  "back view",       "back right view",
                                                    "right side view", "front right view"};
    return sectors[static_cast<std::size_t>((index % 8 + 8) % 8)];
}

/// Accessories with few pixels come more often.
const std::string& pick_accessory(Random& random) {
    static const Words weighted{"hat",        "hat",        "hat",        "crown",      "crown", "crown",
                                "sunglasses", "sunglasses", "sunglasses", "sunglasses", "scarf", "scarf",
                                "scarf",      "scarf",      "flames",     "flames",     "wings", "wings"};
    return pick(weighted, random);
}

}  // namespace

bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

const Words& object_words() {
    static const Words words{"bear", "dog",      "cat",   "duck", "statue", "ball",
                             "vase", "mushroom", "chair", "car",  "house",  "tree"};
    return words;
}

const Words& material_words() {
    static const Words words{"red",   "blue",  "green",  "yellow", "purple", "orange",
                             "black", "white", "wooden", "stone",  "golden"};
    return words;
}

const Words& accessory_words() {
    static const Words words{"hat", "crown", "sunglasses", "scarf", "flames", "wings"};
    return words;
}

const Words& ground_words() {
    static const Words words{"grass", "sand", "snow", "water", "tiles"};
    return words;
}

const Words& accessory_colour_words(const std::string& accessory) {
    static const Words cloth{"red", "blue", "green", "yellow", "purple", "orange", "black", "white"};
    static const Words crown{"golden", "red", "blue", "green", "purple", "white"};
    static const Words glasses{"black", "red", "blue", "white", "yellow"};
    static const Words wings{"white", "black", "red", "blue", "golden"};
    static const Words none;
    if (accessory == "hat" || accessory == "scarf") return cloth;
    if (accessory == "crown") return crown;
    if (accessory == "sunglasses") return glasses;
    if (accessory == "wings") return wings;
    return contains(more_accessory_words(), accessory) ? more_accessory_colour_words(accessory) : none;
}

const std::vector<Synonym>& synonyms() {
    static const std::vector<Synonym> list{{"wood", "wooden"},        {"gold", "golden"}, {"fire", "flames"},
                                           {"glasses", "sunglasses"}, {"lake", "water"},  {"tiled", "tiles"}};
    return list;
}

const Words& vocabulary() {
    static const Words words = [] {
        Words all{"a",    "an",      "the",     "of",       "on",    "in",      "with",
                  "and",  "wearing", "made",    "standing", "photo", "picture", "front",
                  "side", "back",    "view",    "turn",     "make",  "into",    "it",
                  "add",  "remove",  "without", "no",       "floor", "left",    "right"};
        for (const auto& list : {object_words(), material_words(), accessory_words(), ground_words()})
            all.insert(all.end(), list.begin(), list.end());
        for (const auto& synonym : synonyms()) all.emplace_back(synonym.typed);
        return all;
    }();
    return words;
}

void require_known_words(const SceneSpec& spec) {
    require_known(object_words(), more_object_words(), spec.object, "object");
    require_known(material_words(), more_material_words(), spec.material, "material");
    require_known(ground_words(), more_ground_words(), spec.ground, "ground");
    if (!spec.accessory.empty())
        require_known(accessory_words(), more_accessory_words(), spec.accessory, "accessory");
    if (!spec.accessory_colour.empty())
        require_known(material_words(), more_material_words(), spec.accessory_colour, "colour");
}

std::uint64_t word_index(const Words& words, const Words& more, const std::string& word) {
    const auto found = std::find(words.begin(), words.end(), word);
    if (found != words.end()) return static_cast<std::uint64_t>(found - words.begin());
    const auto other = std::find(more.begin(), more.end(), word);
    GSE_CHECK(other != more.end());
    return words.size() + static_cast<std::uint64_t>(other - more.begin());
}

std::string accessory_material(const SceneSpec& spec) {
    if (!spec.accessory_colour.empty()) return spec.accessory_colour;
    static const std::map<std::string, std::string> natural{
        {"crown", "golden"},   {"scarf", "red"},      {"wings", "white"},   {"cape", "red"},
        {"beard", "white"},    {"horns", "white"},    {"helmet", "silver"}, {"halo", "golden"},
        {"backpack", "brown"}, {"necklace", "golden"}};
    const auto found = natural.find(spec.accessory);
    return found == natural.end() ? "black" : found->second;
}

std::string canonical_word(const std::string& typed) {
    for (const auto& synonym : synonyms())
        if (typed == synonym.typed) return synonym.meant;
    return typed;
}

bool held_out(const SceneSpec& spec) {
    std::uint64_t hash = 1469598103934665603ULL;  // FNV-1a
    for (const char letter : spec.object + '|' + spec.material + '|' + spec.accessory)
        hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
    return Random(hash).below(10) == 0;
}

SceneSpec random_spec(Random& random, double with_accessory) {
    SceneSpec spec;
    spec.object = pick(object_words(), random);
    spec.material = pick(material_words(), random);
    spec.ground = pick(ground_words(), random);
    spec.seed = random.next();
    if (random.uniform() >= with_accessory) return spec;
    spec.accessory = pick_accessory(random);
    const auto& colours = accessory_colour_words(spec.accessory);
    constexpr double NaturalShare = 0.15;
    if (colours.empty() || random.uniform() < NaturalShare) return spec;
    do {
        spec.accessory_colour = pick(colours, random);
    } while (spec.accessory_colour == spec.material);  // to be told apart
    return spec;
}

SceneSpec training_spec(Random& random, double with_accessory) {
    SceneSpec spec = random_spec(random, with_accessory);
    while (held_out(spec)) spec = random_spec(random, with_accessory);
    return spec;
}

SceneSpec held_out_spec(Random& random, double with_accessory) {
    SceneSpec spec = random_spec(random, with_accessory);
    while (!held_out(spec)) spec = random_spec(random, with_accessory);
    return spec;
}

std::string view_words(double azimuth) {
    constexpr double Pi = std::numbers::pi;
    const double turn = std::abs(std::remainder(azimuth, 2 * Pi));  // 0 = front, pi = back
    if (turn <= Pi / 4) return "front view";
    return turn >= 3 * Pi / 4 ? "back view" : "side view";
}

std::string sided_view_words(double azimuth) {
    const double turn = std::remainder(azimuth, 2 * std::numbers::pi) / SectorWidth;
    return sector(std::lround(turn));
}

SideBlend side_blend(double azimuth) {
    const double turn = std::remainder(azimuth, 2 * std::numbers::pi) / SectorWidth, first = std::floor(turn);
    const auto index = static_cast<long>(first);
    return {sector(index), sector(index + 1), turn - first};
}

}  // namespace gse::synth
