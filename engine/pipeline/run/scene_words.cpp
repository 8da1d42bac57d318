// Reading of a scene's words off pictures of it.
#include "engine/pipeline/run/scene_words.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/log.h"
#include "engine/language/lexicon.h"
#include "engine/language/words.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::pipeline {
namespace {

constexpr std::size_t ReadingViews = 6;  // of all sides

/// The entry whose sentence fits the pictures best, and its lead over the next one.
struct Reading {
    std::string word;
    double lead = 0;
};

Reading best_of(edit::VocabularyRanker& ranker, const std::vector<std::string>& words,
                const std::vector<const Image*>& pictures, const auto& sentence_with) {
    Reading best;
    double most = -2, next = -2;  // cosines
    for (const auto& word : words) {
        const double fit = ranker.fit(sentence_with(word), pictures);
        if (fit > most) next = std::exchange(most, fit), best.word = word;
        else next = std::max(next, fit);
    }
    best.lead = most - next;
    return best;
}

std::vector<std::string> of_class(const std::vector<std::string>& known, language::WordClass classes) {
    std::vector<std::string> result;
    for (const auto& word : known)
        if (language::is_a(word, classes)) result.push_back(word);
    return result;
}

/// Thing that the scene's first thing wears, with its look; nothing where the sentence without fits best.
std::optional<language::plan::SceneThing> worn_shown(edit::VocabularyRanker& ranker,
                                                     const std::vector<std::string>& known,
                                                     const language::plan::SceneWords& scene,
                                                     const std::vector<const Image*>& pictures) {
    const auto& subject = scene.things.front();
    if (subject.is_ground || subject.attributes.empty()) return std::nullopt;
    const auto place = scene.ground();
    const std::string thing = "a " + subject.attributes.front() + " " + subject.noun;
    const std::string on = place ? " on the " + scene.things[*place].noun : std::string();
    double most = ranker.fit(thing + on, pictures);
    std::optional<language::plan::SceneThing> best;
    for (const auto& worn : known)
        if (language::listed_place(worn))
            for (const auto& look :
                 of_class(known, language::WordClass::Colour | language::WordClass::Material)) {
                const double fit = ranker.fit(thing + " wearing a " + look + " " + worn + on, pictures);
                if (fit > most) most = fit, best = {worn, {look}, false, true};
            }
    return best;
}

}  // namespace

language::plan::SceneWords scene_words_shown(RunContext& context, const CheckedRecipe& recipe,
                                             const Views& views, language::plan::SceneWords scene,
                                             const JobControl& control) {
    auto& ranker = context.recognition();
    const auto known = context.model().known_words();
    if (!ranker.available() || scene.things.empty()) return scene;
    context.look_for_ground(views.views);
    const auto ground = context.ground(recipe.request.sentence().before());
    const auto some = farthest_views(views.views, ReadingViews);
    const auto images =
        context.pictures(some, render_settings(context.scene(), recipe.request), ground, control);
    std::vector<const Image*> pictures;
    for (const auto& image : images) pictures.push_back(&image);
    auto& thing = scene.things.front();
    if (!ground && !thing.is_ground) {  // a thing that was cut out stands on none
        const auto best = best_of(ranker, of_class(known, language::WordClass::Ground), pictures,
                                  [&](const auto& word) { return "a " + thing.noun + " on the " + word; });
        const auto place = scene.ground();
        if (place) scene.things[*place].noun = best.word;
        else if (!best.word.empty()) scene.things.push_back({best.word, {}, true, false});
    }
    auto& subject = scene.things.front();
    if (subject.attributes.empty() && !subject.is_ground) {
        const auto place = scene.ground();
        const std::string on = place ? " on the " + scene.things[*place].noun : std::string();
        const auto look =
            best_of(ranker, of_class(known, language::WordClass::Colour | language::WordClass::Material),
                    pictures, [&](const auto& word) { return "a " + word + " " + subject.noun + on; });
        if (!look.word.empty()) subject.attributes = {look.word};
        log::info("the scene shows \"{} {}\"{} (lead {:.4f})", look.word, subject.noun, on, look.lead);
    }
    if (const auto worn = worn_shown(ranker, known, scene, pictures)) {
        log::info("it wears \"{}\"", worn->noun);
        scene.things.push_back(*worn);
    }
    return scene;
}

}  // namespace gse::pipeline
