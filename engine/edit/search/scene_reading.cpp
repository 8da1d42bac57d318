// The best pair of distance and sentence before the edit.
#include "engine/edit/search/scene_reading.h"

#include <algorithm>

#include "engine/base/check.h"
#include "engine/language/vocabulary.h"

namespace gse::edit {
namespace {

/// Difference of fits (a cosine) up to which distances are told apart by attention. With pictures that a
/// model does not know, the fit hardly follows the distance. By judgement.
constexpr double FitSlack = 0.05;

/// Least gain of fit without a known word for that to be new, rather than one that the encoder is not told.
/// Chosen on scenes with and without the addition (`gseditpro-lab eval --kinds add`).
constexpr double Doubt = 0.04;

/// How well a sentence fits the pictures of each distance.
std::vector<double> fits_of(VocabularyRanker& recognition, const std::string& sentence,
                            const std::vector<std::vector<Image>>& pictures) {
    std::vector<double> fits;
    for (const auto& group : pictures) {
        std::vector<const Image*> some;
        for (const auto& picture : group) some.push_back(&picture);
        fits.push_back(recognition.fit(sentence, some));
    }
    return fits;
}

double best_of(const std::vector<double>& fits) { return *std::max_element(fits.begin(), fits.end()); }

}  // namespace

SceneReading read_scene(VocabularyRanker& recognition, const CheckedRequest& request,
                        const std::vector<std::string>& targets,
                        const std::vector<std::vector<Image>>& pictures,
                        const std::vector<std::string>& known) {
    GSE_CHECK(!targets.empty() && !pictures.empty());
    std::vector<std::vector<double>> fits;
    for (const auto& target : targets)
        fits.push_back(fits_of(recognition, request.sentence().with_target(target).before(), pictures));
    std::size_t chosen = 0;
    const auto worth = [&](std::size_t i) {
        return best_of(fits[i]) + (language::vocabulary_contains(known, targets[i]) ? 0 : Doubt);
    };
    for (std::size_t i = 1; i < targets.size(); ++i)
        if (worth(i) > worth(chosen)) chosen = i;
    // The scene shows the whole sentence: nothing is new, and the sentence alone says what it is about.
    if (targets.size() > 1 && best_of(fits_of(recognition, request.prompt(), pictures)) > worth(chosen))
        chosen = 0;
    SceneReading reading{targets[chosen], best_of(fits[chosen]), {}};
    for (std::size_t i = 0; i < pictures.size(); ++i)
        if (fits[chosen][i] >= reading.fit - FitSlack) reading.distances.push_back(i);
    return reading;
}

}  // namespace gse::edit
