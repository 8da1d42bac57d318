// Directions between pictures and between sentences.
#include "engine/pipeline/run/edit_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "engine/evaluate/direction.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"

namespace gse::pipeline {
namespace {

/// Score below which the pictures count as not showing the edit. It lies between those of other changes and
/// those of true edits (`gseditpro-lab bench clip`).
constexpr double LeastScore = 0.25;

/// Threshold for the largest of a dozen scores. It lies above those of lumps drawn into a scan and below
/// those of most edits of synthetic scenes.
constexpr double LeastLikeness = 0.4;

/// Tells whether the sentence got a word that the model draws and its encoder does not know.
bool says_what_is_drawn_only(const neural::TextToImage& model, const std::string& before,
                             const std::string& told) {
    const auto drawn = model.generated_vocabulary();
    const auto said = language::words_of(before);
    const auto is_new = [&](const auto& word) {
        return std::find(said.begin(), said.end(), word) == said.end() &&
               std::find(drawn.begin(), drawn.end(), word) != drawn.end();
    };
    return std::ranges::any_of(language::words_of(told), is_new);
}

/// Things of many shapes; colours and grounds tell nothing of shapes.
constexpr std::string_view Things[] = {"bear", "dog",      "cat",   "duck", "statue", "ball",
                                       "vase", "mushroom", "chair", "car",  "house",  "tree"};

using EncodedPair = std::pair<std::vector<float>, std::vector<float>>;

std::vector<EncodedPair> encoded(edit::ImageTextEncoder& encoder, const std::vector<PicturePair>& pictures) {
    std::vector<EncodedPair> pairs;
    for (const auto& [before, after] : pictures)
        pairs.emplace_back(encoder.image(*before), encoder.image(*after));
    return pairs;
}

double mean_score(const std::vector<EncodedPair>& pairs, const std::vector<float>& words_before,
                  const std::vector<float>& words_after) {
    double sum = 0;
    for (const auto& [before, after] : pairs)
        sum += evaluate::direction_score({before, after, words_before, words_after});
    return sum / static_cast<double>(pairs.size());
}

/// Score of the known thing that the pictures of `thing` are most like. None if the model has no word for a
/// thing.
std::optional<double> likeness_of(const neural::TextToImage& model, edit::ImageTextEncoder& encoder,
                                  const std::string& said_before, const std::string& told,
                                  const std::string& thing, const std::vector<PicturePair>& pictures) {
    std::optional<double> most;
    const auto known = model.known_words();
    const auto words_before = encoder.text(said_before);
    const auto pairs = encoded(encoder, pictures);
    for (const auto other : Things) {
        auto words = language::words_of(told);
        std::replace(words.begin(), words.end(), thing, std::string(other));
        const auto words_after = language::vocabulary_contains(known, std::string(other))
                                     ? encoder.text(language::joined(words))
                                     : words_before;
        if (words_after != words_before)
            most = std::max(most.value_or(-1), mean_score(pairs, words_before, words_after));
    }
    return most;
}

}  // namespace

bool EditQuality::is_poor() const {
    if (look) return *look < LeastLook;
    return score ? *score < LeastScore : likeness && *likeness < LeastLikeness;
}

EditQuality judge(const neural::TextToImage& model, const language::EditSentence& sentence,
                  const std::string& told, const std::vector<PicturePair>& pictures) {
    EditQuality result;
    const auto encoder = model.image_text_encoder();
    if (!encoder || pictures.empty()) return result;
    const auto& said_before = sentence.before();
    if (says_what_is_drawn_only(model, said_before, told)) {
        const auto& thing = sentence.replacement();
        if (!thing.empty() && says_what_is_drawn_only(model, said_before, thing))
            result.likeness = likeness_of(model, *encoder, said_before, told, thing, pictures);
        return result;
    }
    const auto words_before = encoder->text(said_before);
    const auto words_after = encoder->text(told);
    if (words_before == words_after) return result;  // nothing the encoder knows is new
    result.score = mean_score(encoded(*encoder, pictures), words_before, words_after);
    result.warns = result.is_poor();
    result.verdict =
        result.warns
            ? fmt::format("The model's pictures hardly show \"{}\" (score {:.2f}): the edit may not either.",
                          told, *result.score)
            : fmt::format("The model's pictures show the edit (score {:.2f}).", *result.score);
    return result;
}

EditQuality judge_targets(const neural::TextToImage& model, const language::EditSentence& sentence,
                          const edit::ViewTargets& round) {
    std::vector<PicturePair> pictures;
    for (const auto& view : round.views)
        if (!view.dropped) pictures.emplace_back(view.before.get(), view.after.get());
    return judge(model, sentence, sentence.prompt(), pictures);
}

nlohmann::ordered_json verdict_to_json(const EditQuality& verdict) {
    nlohmann::ordered_json json;
    if (verdict.score) json["score"] = *verdict.score;
    else json["score"] = nullptr;
    json["verdict"] = verdict.verdict;
    json["warns"] = verdict.warns;
    if (verdict.likeness) json["likeness"] = *verdict.likeness;
    if (verdict.look) json["look"] = *verdict.look;
    return json;
}

}  // namespace gse::pipeline
