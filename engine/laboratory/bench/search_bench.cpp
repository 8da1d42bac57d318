// Words that are there, words that are not, and words nobody knows.
#include "engine/laboratory/bench/search_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "engine/base/error.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/eval/eval_figures.h"
#include "engine/laboratory/synth/without_ground.h"
#include "engine/language/vocabulary.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;
using synth::Part;
using synth::SceneSpec;

constexpr std::array<double, 9> Thresholds{0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6};
constexpr double AccessoryShare = 0.6;  // of the scenes have one

/// Words that no synthetic scene shows and no starter model knows.
const std::vector<std::string>& unknown_words() {
    static const std::vector<std::string> words{"sign",  "zebra",  "sofa",   "lamp",
                                                "train", "guitar", "violin", "laptop"};
    return words;
}

const std::string& other_than(const std::vector<std::string>& words, Random& random,
                              const std::vector<std::string>& taken) {
    while (true) {
        const auto& word = words[random.below(words.size())];
        if (std::find(taken.begin(), taken.end(), word) == taken.end()) return word;
    }
}

/// Words as they are typed, and the object of the scene that they name.
struct Question {
    std::string kind, source, prompt, target;
    bool present = false;
    Part part = Part::Object;
};

std::string sentence(const SceneSpec& spec) { return synth::full_caption(spec).text; }

/// A sentence about the scene's accessory, or one that it does not have.
std::string worn(const SceneSpec& spec, const std::string& colour, const std::string& accessory) {
    return fmt::format("a {} {} wearing a {} {}", spec.material, spec.object, colour, accessory);
}

std::vector<Question> present_words(const SceneSpec& spec, const std::string& material, Random& random) {
    std::vector<Question> list;
    SceneSpec changed = spec;
    changed.material = material;
    list.push_back({"object", spec.object, sentence(changed), material, true, Part::Object});
    changed = spec;
    changed.ground = other_than(synth::ground_words(), random, {spec.ground});
    list.push_back({"ground", spec.ground, sentence(changed), changed.ground, true, Part::Ground});
    if (spec.accessory.empty()) return list;
    const auto& colours = synth::accessory_colour_words(spec.accessory);
    const auto& colour =
        other_than(colours.empty() ? synth::material_words() : colours, random, {spec.accessory_colour});
    list.push_back(
        {"accessory", spec.accessory, worn(spec, colour, spec.accessory), colour, true, Part::Accessory});
    return list;
}

std::vector<Question> wrong_words(const SceneSpec& spec, const std::string& material, Random& random) {
    std::vector<Question> list;
    SceneSpec changed = spec;
    changed.material = material;
    changed.object = other_than(synth::object_words(), random, {spec.object});
    list.push_back({"absent object", changed.object, sentence(changed), material});
    const auto& ground = other_than(synth::ground_words(), random, {spec.ground});
    changed = spec;
    changed.ground = other_than(synth::ground_words(), random, {spec.ground, ground});
    list.push_back({"absent ground", ground, sentence(changed), changed.ground});
    const auto& accessory = other_than(synth::accessory_words(), random, {spec.accessory});
    list.push_back({"absent accessory", accessory, worn(spec, material, accessory), material});
    const auto& unknown = other_than(unknown_words(), random, {});
    list.push_back(
        {"unknown", unknown, fmt::format("a {} {} on the {}", material, unknown, spec.ground), material});
    return list;
}

class SearchBench {
public:
    SearchBench(const SearchBenchParameters& parameters, const pipeline::EditRecipe& settings,
                const JobControl& job)
        : parameters_(parameters), settings_(settings), job_(job),
          model_(pipeline::load_recipe_model(settings.job)) {
        settings_.request.least_confidence = 0;  // what is found is compared, however unsure
        settings_.request.mode = "modify";
    }

    Json run() {
        Json searches = Json::array();
        for (int i = 0; i < parameters_.scenes; ++i) {
            Random random = Random::stream(parameters_.seed, 70000 + static_cast<std::uint64_t>(i));
            const SceneSpec spec = synth::held_out_spec(random, AccessoryShare);
            const auto scene =
                parameters_.ground ? synth::generate(spec) : synth::without_ground(synth::generate(spec));
            const auto material =
                other_than(synth::material_words(), random, {spec.material, spec.accessory_colour});
            auto questions = present_words(spec, material, random);
            for (auto& question : wrong_words(spec, material, random))
                questions.push_back(std::move(question));
            for (const auto& question : questions)
                if (parameters_.ground || question.part != Part::Ground)
                    searches.push_back(ask(scene, question));
            job_.report("searching", i + 1, parameters_.scenes);
        }
        return {{"model", model_->name()}, {"summary", summary(searches)}, {"searches", searches}};
    }

private:
    /// The search as a user begins it: scene and words, automatic views.
    Json ask(const synth::SynthScene& scene, const Question& question) {
        if (job_.stop_requested()) throw Error(ErrorCode::Cancelled, "the measurement was stopped");
        pipeline::EditRecipe recipe = settings_;
        recipe.request.source = question.source;
        recipe.request.prompt = question.prompt;
        recipe.request.target = question.target;
        Json entry{{"kind", question.kind},     {"scene", sentence(scene.spec)}, {"source", question.source},
                   {"prompt", question.prompt}, {"present", question.present},   {"confidence", 0.0}};
        if (!language::vocabulary_contains(model_->known_words(),
                                           question.source)) {  // refused before any work
            entry["overlap"] = 0.0;
            return entry;
        }
        pipeline::EditJob job(recipe, {scene.scene, {}, model_}, {{}, job_.stop});
        job.locate();
        const auto& found = job.located();
        const auto& confidence = found.confidence;
        entry["confidence"] = confidence.value;
        for (const char* key : {"agreement", "attention_inside", "labelled_share", "recognition",
                                "first_look", "second_witness", "border_cut"})
            entry[key] = confidence.part(key);
        entry["networks"] = job.times().networks_json()["total"];
        if (question.present)
            entry["overlap"] = evaluate::row_overlap(*found.label.bits, rows_of(scene, question.part),
                                                     found.found.field.coverage)
                                   .iou;
        return entry;
    }

    /// Per threshold: share of the words found right that would be refused, and of the wrong ones that would
    /// be labelled.
    Json summary(const Json& searches) const {
        Json table = Json::array();
        for (const double threshold : Thresholds) {
            std::map<std::string, std::pair<int, int>> kinds;  // below the threshold, all
            int right = 0, refused = 0;
            for (const auto& entry : searches) {
                const bool below = entry["confidence"].get<double>() < threshold;
                auto& [count, all] = kinds[entry["kind"].get<std::string>()];
                count += below ? 1 : 0;
                ++all;
                if (!entry["present"].get<bool>() ||
                    entry["overlap"].get<double>() < parameters_.least_overlap)
                    continue;
                ++right;
                refused += below ? 1 : 0;
            }
            Json line{{"threshold", threshold},
                      {"false_rejects", right > 0 ? refused / static_cast<double>(right) : 0}};
            for (const auto& [kind, counts] : kinds)
                line[kind] = {{"refused", counts.first}, {"of", counts.second}};
            table.push_back(std::move(line));
        }
        return table;
    }

    SearchBenchParameters parameters_;
    pipeline::EditRecipe settings_;
    JobControl job_;
    std::shared_ptr<neural::TextToImage> model_;
};

}  // namespace

Json bench_search(const SearchBenchParameters& parameters, const pipeline::EditRecipe& settings,
                  const JobControl& job) {
    return SearchBench(parameters, settings, job).run();
}

}  // namespace gse::bench
