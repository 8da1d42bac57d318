// Ranks a word among all words by the angle between sentence and picture.
#include "engine/edit/search/vocabulary_ranker.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/check.h"
#include "engine/edit/request/request.h"
#include "engine/language/grammar.h"
#include "engine/language/words.h"

namespace gse::edit {
namespace {

double cosine(const std::vector<float>& a, const std::vector<float>& b) {
    const double ab = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    const double aa = std::inner_product(a.begin(), a.end(), a.begin(), 0.0);
    const double bb = std::inner_product(b.begin(), b.end(), b.begin(), 0.0);
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

std::string with_other(const std::string& sentence, const std::string& phrase, const std::string& other) {
    auto terms = language::terms_of(language::words_of(sentence), {phrase});
    std::replace(terms.begin(), terms.end(), phrase, other);
    return language::joined(terms);
}

}  // namespace

VocabularyRanker::VocabularyRanker(std::unique_ptr<ImageTextEncoder> score, std::vector<std::string> known)
    : score_(std::move(score)) {
    for (auto& word : known)
        if (language::says_something(word)) known_.push_back(std::move(word));
}

const std::vector<float>& VocabularyRanker::vector_of(const std::string& sentence) {
    auto found = vectors_.find(sentence);
    if (found == vectors_.end()) found = vectors_.emplace(sentence, score_->text(sentence)).first;
    return found->second;
}

std::vector<float> VocabularyRanker::vector_of(const Image& picture) {
    return seen_.get(key_of(picture), [&] { return score_->image(picture); });
}

std::vector<float> VocabularyRanker::viewpoint(const Image& picture) {
    GSE_CHECK(compares());
    return viewpoints_.get(key_of(picture), [&] { return score_->viewpoint(picture); });
}

double VocabularyRanker::fit(const std::string& sentence, const std::vector<const Image*>& pictures) {
    GSE_CHECK(compares() && !pictures.empty());
    double sum = 0;
    for (const Image* picture : pictures)
        sum += cosine(vector_of(*picture), vector_of(language::normalised_prompt(sentence)));
    return sum / static_cast<double>(pictures.size());
}

std::vector<float> VocabularyRanker::mean_of(const std::vector<Image>& pictures) {
    GSE_CHECK(compares() && !pictures.empty());
    std::vector<float> mean;
    for (const auto& picture : pictures) {
        const auto seen = vector_of(picture);
        const double length = std::sqrt(std::inner_product(seen.begin(), seen.end(), seen.begin(), 0.0));
        mean.resize(seen.size(), 0.0f);
        const double share = length > 0 ? 1 / (length * static_cast<double>(pictures.size())) : 0;
        for (std::size_t i = 0; i < seen.size(); ++i) mean[i] += static_cast<float>(share * seen[i]);
    }
    return mean;
}

double VocabularyRanker::fit(const std::string& sentence, const std::vector<float>& mean) {
    GSE_CHECK(compares());
    const auto& words = vector_of(language::normalised_prompt(sentence));
    const double length = std::sqrt(std::inner_product(words.begin(), words.end(), words.begin(), 0.0));
    return length > 0 ? std::inner_product(words.begin(), words.end(), mean.begin(), 0.0) / length : 0;
}

double VocabularyRanker::likeness(const std::string& first, const std::string& second) {
    GSE_CHECK(compares());
    return cosine(vector_of(language::normalised_prompt(first)),
                  vector_of(language::normalised_prompt(second)));
}

double VocabularyRanker::of(const std::string& sentence, const std::string& word,
                            const std::vector<const Image*>& pictures) {
    if (!available() || pictures.empty()) return -1;
    double below = 0, all = 0;
    for (const Image* picture : pictures) {
        const auto seen = vector_of(*picture);
        const double own = cosine(seen, vector_of(language::normalised_prompt(sentence)));
        for (const auto& other : known_) {
            if (language::has_phrase(word, other)) continue;  // the word, or a part of the phrase
            below += cosine(seen, vector_of(with_other(sentence, word, other))) < own ? 1 : 0;
            all += 1;
        }
    }
    return all > 0 ? below / all : -1;
}

}  // namespace gse::edit
