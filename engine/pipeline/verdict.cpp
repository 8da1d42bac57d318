// Directions between pictures and between sentences.
#include "engine/pipeline/verdict.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/edit/words.h"
#include "engine/evaluate/direction.h"

namespace gse::pipeline {
namespace {

/// Below it the pictures count as not showing the edit: pictures in which something else has changed score about 0.2 with
/// the starter's encoder, unchanged ones about 0, those of true edits 0.4 to 0.95 (`bench clip`).
constexpr double LeastScore = 0.25;

/// Whether the sentence got a word that the model draws and its encoder does not know.
bool says_what_is_drawn_only(const neural::TextToImage& model, const std::string& before, const std::string& told) {
    const auto drawn = model.drawn_words();
    const auto said = edit::words_of(before);
    const auto is_new = [&](const auto& word) { return std::find(said.begin(), said.end(), word) == said.end() && std::find(drawn.begin(), drawn.end(), word) != drawn.end(); };
    return std::ranges::any_of(edit::words_of(told), is_new);
}

}  // namespace

Verdict judge(const neural::TextToImage& model, const edit::EditRequest& request, const std::string& told,
              const std::vector<PicturePair>& pictures) {
    Verdict result;
    const auto encoder = model.text_image_score();
    if (!encoder || pictures.empty()) return result;
    const auto said_before = edit::sentence_before(request);
    if (says_what_is_drawn_only(model, said_before, told)) return result;
    const auto words_before = encoder->text(said_before);
    const auto words_after = encoder->text(told);
    if (words_before == words_after) return result;   // nothing the encoder knows is new
    double sum = 0;
    for (const auto& [before, after] : pictures)
        sum += evaluate::direction_score({encoder->image(*before), encoder->image(*after), words_before, words_after});
    result.score = sum / static_cast<double>(pictures.size());
    result.warns = *result.score < LeastScore;
    result.verdict = result.warns ? fmt::format("The model's pictures hardly show \"{}\" (score {:.2f}): the edit may not either.",
                                                told, *result.score)
                                  : fmt::format("The model's pictures show the edit (score {:.2f}).", *result.score);
    return result;
}

Verdict judge_targets(const neural::TextToImage& model, const edit::EditRequest& request, const std::string& told,
                      const edit::ViewTargets& round) {
    std::vector<PicturePair> pictures;
    for (const auto& view : round.views)
        if (!view.dropped) pictures.emplace_back(view.before.get(), view.after.get());
    return judge(model, request, told, pictures);
}

nlohmann::ordered_json verdict_to_json(const Verdict& verdict) {
    nlohmann::ordered_json json;
    if (verdict.score) json["score"] = *verdict.score;
    else json["score"] = nullptr;
    json["verdict"] = verdict.verdict;
    json["warns"] = verdict.warns;
    return json;
}

}  // namespace gse::pipeline
