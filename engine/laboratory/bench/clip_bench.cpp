// Held-out scenes and their true edits, seen through the encoder.
#include "engine/laboratory/bench/clip_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "engine/base/error.h"
#include "engine/edit/search/front_reading.h"
#include "engine/evaluate/direction.h"
#include "engine/laboratory/synth/synth.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using synth::SceneSpec;
using Vector = std::vector<float>;

constexpr double FrontLimit = 1.2;  // radians: views on which faces and accessories are seen
constexpr int FrontViews = 12;      // in which a front is looked for
constexpr float NoiseOfNoChange = 2.0f / 255;

const std::string& other(const std::vector<std::string>& words, const std::string& than, Random& random) {
    while (true) {
        const auto& word = words[random.below(words.size())];
        if (word != than) return word;
    }
}

/// Right answers of questions of one kind.
struct Tally {
    int asked = 0, right = 0;
    Json to_json() const {
        return {{"asked", asked}, {"right", asked > 0 ? right / static_cast<double>(asked) : 0}};
    }
};

/// Cosines of changes of one kind.
struct Directions {
    std::vector<double> values;
    Json to_json() const {
        if (values.empty()) return nullptr;
        double sum = 0;
        int positive = 0;
        for (const double value : values) {
            sum += value;
            positive += value > 0 ? 1 : 0;
        }
        const double count = static_cast<double>(values.size());
        return {{"count", values.size()},
                {"mean", sum / count},
                {"least", *std::min_element(values.begin(), values.end())},
                {"positive", positive / count}};
    }
};

/// The score for somebody who wants to own one.
class Borrowed final : public edit::ImageTextEncoder {
public:
    explicit Borrowed(edit::ImageTextEncoder& score) : score_(score) {}
    std::vector<float> image(const Image& image) override { return score_.image(image); }
    std::vector<float> text(const std::string& sentence) override { return score_.text(sentence); }
    std::vector<float> viewpoint(const Image& image) override { return score_.viewpoint(image); }

private:
    edit::ImageTextEncoder& score_;
};

class ClipBench {
public:
    ClipBench(edit::ImageTextEncoder& score, const ClipBenchParameters& parameters, const JobControl& job)
        : score_(score), recognition_(std::make_unique<Borrowed>(score), {}), parameters_(parameters),
          job_(job) {}

    Json run() {
        for (int i = 0; i < parameters_.scenes; ++i) {
            if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
            Random random = Random::stream(parameters_.seed, static_cast<std::uint64_t>(i));
            ask_words(random);
            compare_changes(random);
            ask_front(random);
            job_.report("measuring the encoder", i + 1, parameters_.scenes);
        }
        Json report;
        for (const auto& [kind, tally] : tallies_) report["retrieval"][kind] = tally.to_json();
        for (const auto& [kind, directions] : directions_) report["direction"][kind] = directions.to_json();
        report["fronts"] = fronts_;
        return report;
    }

private:
    Image paint(const SceneSpec& spec, double azimuth, double elevation) {
        const auto scene = synth::generate(spec);
        const int side = parameters_.image_size;
        const Camera camera = synth::scene_camera(scene, azimuth, elevation, 1, side, side);
        return painter_.paint(scene.scene.gaussians.spans(), camera, {}).colour;
    }
    Vector words(const SceneSpec& spec) { return score_.text(synth::full_caption(spec).text); }

    /// The sentence with the true word against the sentences with each other word.
    void ask(const std::string& kind, const Vector& seen, const SceneSpec& truth,
             const std::vector<SceneSpec>& others) {
        const double right = evaluate::cosine(seen, words(truth));
        const bool first = std::all_of(others.begin(), others.end(), [&](const SceneSpec& spec) {
            return evaluate::cosine(seen, words(spec)) < right;
        });
        ++tallies_[kind].asked;
        tallies_[kind].right += first ? 1 : 0;
    }
    void ask_member(const std::string& kind, const Vector& seen, const SceneSpec& truth,
                    std::string SceneSpec::*member, const std::vector<std::string>& list) {
        std::vector<SceneSpec> others;
        for (const auto& word : list) {
            if (word == truth.*member) continue;
            others.push_back(truth);
            others.back().*member = word;
        }
        ask(kind, seen, truth, others);
    }

    void ask_words(Random& random) {
        SceneSpec spec = synth::held_out_spec(random, 0.5);
        const Vector seen =
            score_.image(paint(spec, random.uniform(-FrontLimit, FrontLimit), random.uniform(0.1, 0.6)));
        ask_member("material", seen, spec, &SceneSpec::material, synth::material_words());
        ask_member("object", seen, spec, &SceneSpec::object, synth::object_words());
        ask_member("ground", seen, spec, &SceneSpec::ground, synth::ground_words());
        if (spec.accessory.empty()) {
            SceneSpec worn = spec;
            worn.accessory = synth::accessory_words()[random.below(synth::accessory_words().size())];
            ask("accessory absent", seen, spec, {worn});
            return;
        }
        SceneSpec bare = spec;
        bare.accessory = bare.accessory_colour = "";
        ask("accessory present", seen, spec, {bare});
        std::vector<SceneSpec> others, plain_others;
        SceneSpec plain = spec;
        plain.accessory_colour.clear();
        for (const auto& word : synth::accessory_words()) {
            if (word == spec.accessory) continue;
            plain_others.push_back(plain);
            plain_others.back().accessory = word;
            others.push_back(plain_others.back());
            if (!synth::accessory_colour_words(word).empty())
                others.back().accessory_colour = spec.accessory_colour;
        }
        ask("accessory word", seen, spec, others);
        ask("accessory word without a colour", seen, plain, plain_others);
        if (!spec.accessory_colour.empty())
            ask_member("accessory colour", seen, spec, &SceneSpec::accessory_colour,
                       synth::accessory_colour_words(spec.accessory));
    }

    /// Vectors of the views all around.
    std::vector<Vector> look_around(const SceneSpec& spec, float noise = 0) {
        std::vector<Vector> seen;
        Random random(parameters_.seed);
        for (int v = 0; v < parameters_.views; ++v) {
            Image image = paint(spec, 2 * std::numbers::pi * (v + 0.5) / parameters_.views, 0.35);
            if (noise > 0)
                for (auto& value : image.data) value += noise * static_cast<float>(random.normal());
            seen.push_back(score_.image(image));
        }
        return seen;
    }
    double direction(const std::vector<Vector>& before, const std::vector<Vector>& after,
                     const SceneSpec& from, const SceneSpec& to) {
        const auto words_from = words(from), words_to = words(to);
        double sum = 0;
        for (std::size_t v = 0; v < before.size(); ++v)
            sum += evaluate::direction_score({before[v], after[v], words_from, words_to});
        return sum / static_cast<double>(before.size());
    }

    /// A true change of each kind, and what must not look like it. Every target is a held-out combination.
    void compare_changes(Random& random) {
        const SceneSpec bare = [&] {
            SceneSpec spec = synth::held_out_spec(random, 1.0);
            spec.accessory = spec.accessory_colour = "";
            return spec;
        }();
        SceneSpec worn = bare;
        do {
            const SceneSpec drawn = synth::random_spec(random, 1.0);
            worn.accessory = drawn.accessory;
            worn.accessory_colour = drawn.accessory_colour;
        } while (worn.accessory_colour == worn.material);
        SceneSpec painted = bare, repainted = bare, moved = bare;
        painted.material = other(synth::material_words(), bare.material, random);
        do {
            repainted.material = other(synth::material_words(), bare.material, random);
        } while (repainted.material == painted.material);
        moved.ground = other(synth::ground_words(), bare.ground, random);
        const auto seen = look_around(bare), with = look_around(worn), other_colour = look_around(painted);
        const bool substance =
            painted.material == "wooden" || painted.material == "stone" || painted.material == "golden";
        const auto note = [&](const std::string& kind, double value) {
            directions_[kind].values.push_back(value);
        };
        note(substance ? "material" : "recolour", direction(seen, other_colour, bare, painted));
        note("accessory", direction(seen, with, bare, worn));
        note("accessory " + worn.accessory, direction(seen, with, bare, worn));
        note("ground", direction(seen, look_around(moved), bare, moved));
        note("wrong: recoloured, asked for an accessory", direction(seen, other_colour, bare, worn));
        note("wrong: accessory, asked for a colour", direction(seen, with, bare, painted));
        note("wrong: recoloured, asked for another colour", direction(seen, other_colour, bare, repainted));
        note("wrong: opposite recolouring", direction(other_colour, seen, bare, painted));
        const auto noisy = look_around(bare, NoiseOfNoChange);
        note("no change: noise, asked for a colour", direction(seen, noisy, bare, painted));
        note("no change: noise, asked for an accessory", direction(seen, noisy, bare, worn));
    }

    /// Finds the front of a scene from views all around that begin anywhere.
    void ask_front(Random& random) {
        const SceneSpec spec = synth::held_out_spec(random, 0.5);
        const double begin = random.uniform(-std::numbers::pi, std::numbers::pi);
        std::vector<Image> pictures;
        std::vector<double> azimuths;
        for (int v = 0; v < FrontViews; ++v) {
            azimuths.push_back(2 * std::numbers::pi * v / FrontViews);
            pictures.push_back(paint(spec, azimuths.back() - begin, 0.35));
        }
        const auto read = edit::read_front(recognition_, synth::full_caption(spec).text, pictures, azimuths);
        const double error =
            std::abs(std::remainder(read.azimuth - begin - synth::turn_of(spec), 2 * std::numbers::pi));
        for (const int degrees : {15, 45}) {
            auto& tally = tallies_[fmt::format("front within {} degrees", degrees)];
            ++tally.asked;
            tally.right += error < degrees * std::numbers::pi / 180 ? 1 : 0;
        }
        fronts_.push_back({{"sentence", synth::full_caption(spec).text},
                           {"off_degrees", error * 180 / std::numbers::pi},
                           {"lead", read.lead}});
    }

    edit::ImageTextEncoder& score_;
    edit::VocabularyRanker recognition_;
    const ClipBenchParameters& parameters_;
    const JobControl& job_;
    pipeline::Painter painter_{1};
    Json fronts_ = Json::array();
    std::map<std::string, Tally> tallies_;
    std::map<std::string, Directions> directions_;
};

}  // namespace

Json bench_clip(edit::ImageTextEncoder& score, const ClipBenchParameters& parameters, const JobControl& job) {
    return ClipBench(score, parameters, job).run();
}

}  // namespace gse::bench
