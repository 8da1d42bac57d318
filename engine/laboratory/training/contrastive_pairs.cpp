// Groups of four pictures: a scene, one in another material, one with or without its accessory, and one with
// another thing changed (ground, object, accessory or its colour).
#include "engine/laboratory/training/contrastive_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "engine/base/check.h"
#include "engine/base/thread_pool.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/laboratory/synth/words.h"
#include "engine/laboratory/training/starter_source.h"
#include "engine/raster/rasterizer.h"

namespace gse::training {
namespace {

using synth::SceneSpec;

constexpr int GroupSize = 4;
constexpr double TwinAccessoryShare = 0.65;  // groups whose first picture has an accessory
constexpr double HeadShare = 0.15;           // groups seen from near the head
constexpr double ViewShare = 0.3;            // full sentences that end with view words
constexpr double PlainShare = 0.35;          // full sentences that do not tell the accessory's colour

/// Facts that a sentence may state, numbered.
class FactTable {
public:
    FactTable() {
        add("object", synth::object_words());
        add("material", synth::material_words());
        add("accessory", synth::accessory_words());
        add("accessory", {""});  // there is none
        add("accessory colour", synth::material_words());
        add("ground", synth::ground_words());
        add("view", {"front view", "side view", "back view"});
    }
    /// 0 for what is no fact.
    std::uint64_t bit(const std::string& kind, const std::string& word) const {
        const auto found = bits_.find(kind + ' ' + word);
        return found == bits_.end() ? 0 : std::uint64_t{1} << found->second;
    }

private:
    void add(const std::string& kind, const std::vector<std::string>& words) {
        for (const auto& word : words) bits_.emplace(kind + ' ' + word, bits_.size());
        GSE_CHECK(bits_.size() <= 64);
    }
    std::unordered_map<std::string, std::size_t> bits_;
};

const FactTable& fact_table() {
    static const FactTable table;
    return table;
}

std::uint64_t facts_of(const SceneSpec& spec, double azimuth) {
    const auto& table = fact_table();
    std::uint64_t facts = table.bit("object", spec.object) | table.bit("material", spec.material) |
                          table.bit("accessory", spec.accessory) | table.bit("ground", spec.ground) |
                          table.bit("view", synth::view_words(azimuth));
    if (!spec.accessory.empty() && !synth::accessory_colour_words(spec.accessory).empty())
        facts |= table.bit("accessory colour", synth::accessory_material(spec));
    return facts;
}

/// Facts that a sentence of the synthetic world states.
std::uint64_t claimed_by(const synth::Caption& caption) {
    const auto& table = fact_table();
    std::uint64_t facts = 0;
    for (const auto& grounding : caption.groundings) {
        const std::string word = synth::canonical_word(grounding.word);
        switch (grounding.part) {
            case synth::Part::Ground: facts |= table.bit("ground", word); break;
            case synth::Part::Object: facts |= table.bit("object", word) | table.bit("material", word); break;
            case synth::Part::Accessory:
                facts |= table.bit("accessory", word) | table.bit("accessory colour", word);
                break;
        }
    }
    for (const char* view : {"front view", "side view", "back view"})
        if (caption.text.ends_with(view)) facts |= table.bit("view", view);
    return facts;
}

const std::string& other(const std::vector<std::string>& words, const std::string& than, Random& random) {
    while (true) {
        const auto& word = words[random.below(words.size())];
        if (word != than) return word;
    }
}

/// Another accessory than the spec's, as often as random specs have it, in a colour of its own.
void change_accessory(SceneSpec& spec, Random& random) {
    while (true) {
        const SceneSpec drawn = synth::random_spec(random, 1.0);
        if (drawn.accessory == spec.accessory || drawn.accessory_colour == spec.material) continue;
        spec.accessory = drawn.accessory;
        spec.accessory_colour = drawn.accessory_colour;
        return;
    }
}

void change_one_thing(SceneSpec& spec, Random& random) {
    const auto& colours = synth::accessory_colour_words(spec.accessory);
    const double kind = random.uniform();
    if (!spec.accessory.empty() && kind < 0.2 && !colours.empty()) {
        spec.accessory_colour = other(colours, spec.accessory_colour, random);
    } else if (!spec.accessory.empty() && kind < 0.45) {
        change_accessory(spec, random);
    } else if (kind < 0.55) {
        spec.ground = other(synth::ground_words(), spec.ground, random);
    } else {
        spec.object = other(synth::object_words(), spec.object, random);
    }
}

void change_member(int member, SceneSpec& spec, Random& random) {
    if (member == 1) spec.material = other(synth::material_words(), spec.material, random);
    if (member == 2) {
        if (spec.accessory.empty() || random.uniform() < 0.1) change_accessory(spec, random);
        else spec.accessory = spec.accessory_colour = "";
    }
    if (member == 3) change_one_thing(spec, random);
}

/// Scene and place of one picture; a function of seed and index alone.
struct TwinShot {
    SceneSpec spec;
    double azimuth = 0, elevation = 0, zoom = 1;
    bool head = false;
    std::array<float, 3> background{};
};

TwinShot make_twin_shot(std::uint64_t seed, std::uint64_t index) {
    Random random = Random::stream(seed ^ 0x7477696e73ULL, index / GroupSize);
    TwinShot shot;
    shot.spec = synth::training_spec(random, TwinAccessoryShare);
    const double pi = std::numbers::pi;
    shot.azimuth = random.uniform() < 0.5 ? random.uniform(-1.2, 1.2) : random.uniform(-pi, pi);
    shot.elevation = random.uniform(0.05, 0.75);
    shot.zoom = random.uniform(0.8, 1.6);
    shot.head = random.uniform() < HeadShare;
    shot.background = random_background(random);
    const int member = static_cast<int>(index % GroupSize);
    Random changes = Random::stream(random.next(), static_cast<std::uint64_t>(member));
    const SceneSpec first = shot.spec;
    do {
        shot.spec = first;
        change_member(member, shot.spec, changes);
    } while (synth::held_out(shot.spec) || shot.spec.accessory_colour == shot.spec.material);
    return shot;
}

StarterClaim claim_of(const SceneSpec& spec, double azimuth, std::uint64_t seed, bool full) {
    Random random(seed);
    if (!full) {
        const auto caption = synth::random_caption(spec, azimuth, random);
        return {caption.text, claimed_by(caption)};
    }
    SceneSpec told = spec;
    if (random.uniform() < PlainShare) told.accessory_colour.clear();
    auto caption = synth::full_caption(told);
    if (random.uniform() < ViewShare) caption.text += ", " + synth::view_words(azimuth);
    // A full sentence that names no accessory says that there is none.
    const std::uint64_t none = spec.accessory.empty() ? fact_table().bit("accessory", "") : 0;
    return {caption.text, claimed_by(caption) | none};
}

class SyntheticTwins : public ContrastivePairs {
public:
    explicit SyntheticTwins(std::uint64_t seed) : seed_(seed) {}

    StarterPicture picture(std::uint64_t index, int size) const override {
        thread_local ThreadPool pool{1};
        thread_local const auto rasterizer = raster::make_fast_rasterizer(pool);
        thread_local raster::ForwardOutput output;
        const TwinShot shot = make_twin_shot(seed_, index);
        const synth::SynthScene scene = synth::generate(shot.spec);
        const auto camera_of = shot.head ? synth::head_camera : synth::scene_camera;
        const Camera camera = camera_of(scene, shot.azimuth, shot.elevation, shot.zoom, size, size);
        raster::Settings settings;
        settings.background = shot.background;
        rasterizer->forward(scene.scene.gaussians.spans(), camera, settings, output);
        StarterPicture picture;
        picture.rgb = to_bytes(output.colour);
        const auto cells =
            static_cast<std::size_t>(size / LatentCell) * static_cast<std::size_t>(size / LatentCell);
        picture.coverage.assign(StarterPartCount * cells, 0);
        return picture;
    }
    StarterCaption caption(std::uint64_t index, std::uint64_t seed, bool) const override {
        return {claim(index, seed, false).text, {}};
    }
    std::vector<std::string> vocabulary() const override { return synth::vocabulary(); }
    std::string identity() const override { return "synthetic-twins-2 " + std::to_string(seed_); }

    int group_size() const override { return GroupSize; }
    std::uint64_t facts(std::uint64_t index) const override {
        const TwinShot shot = make_twin_shot(seed_, index);
        return facts_of(shot.spec, shot.azimuth);
    }
    StarterClaim claim(std::uint64_t index, std::uint64_t seed, bool full) const override {
        const TwinShot shot = make_twin_shot(seed_, index);
        return claim_of(shot.spec, shot.azimuth, seed, full);
    }
    std::vector<std::string> false_claims(std::uint64_t index, std::uint64_t seed, bool full) const override {
        const TwinShot shot = make_twin_shot(seed_, index);
        const std::uint64_t truth = facts_of(shot.spec, shot.azimuth);
        const std::string own = claim_of(shot.spec, shot.azimuth, seed, full).text;
        Random random = Random::stream(seed, index);
        std::vector<std::string> texts;
        const auto take = [&](const SceneSpec& spec, double azimuth) {
            if (synth::held_out(spec)) return;  // never said to be false: it is to be known
            auto claim = claim_of(spec, azimuth, seed, full);
            if ((claim.facts & ~truth) != 0 && claim.text != own) texts.push_back(std::move(claim.text));
        };
        SceneSpec spec = shot.spec;
        spec.object = other(synth::object_words(), shot.spec.object, random);
        take(spec, shot.azimuth);
        spec = shot.spec;
        change_accessory(spec, random);
        take(spec, shot.azimuth);
        take(shot.spec,
             shot.azimuth + std::numbers::pi * random.uniform(0.4, 1.6));  // seen from another side
        return texts;
    }

private:
    std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<ContrastivePairs> make_contrastive_pairs(std::uint64_t seed) {
    return std::make_unique<SyntheticTwins>(seed);
}

}  // namespace gse::training
