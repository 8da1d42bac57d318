// Tells whether pictures show what a word means, by the model's own picture encoder.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/memory_cache.h"
#include "engine/edit/interfaces/image_text_encoder.h"

namespace gse::edit {

/// Compares a word with all others that a model with a fixed vocabulary knows. Sentences and pictures are
/// encoded once.
class VocabularyRanker {
public:
    /// `score` null or an empty list of words: nobody can tell.
    VocabularyRanker(std::unique_ptr<ImageTextEncoder> score, std::vector<std::string> known);
    bool available() const { return compares() && !known_.empty(); }
    /// Tells whether the model can compare pictures with sentences at all.
    bool compares() const { return score_ != nullptr; }
    /// ImageTextEncoder::viewpoint(); needs compares().
    std::vector<float> viewpoint(const Image& picture);
    /// Mean cosine of the sentence with the pictures, in [-1,1]; needs compares() and a picture.
    double fit(const std::string& sentence, const std::vector<const Image*>& pictures);
    /// Mean of the unit vectors of the pictures; needs compares() and a picture.
    std::vector<float> mean_of(const std::vector<Image>& pictures);
    /// Mean cosine of the sentence with the pictures of mean_of(), in [-1,1]; needs compares().
    double fit(const std::string& sentence, const std::vector<float>& mean);
    /// Cosine of two sentences, in [-1,1]; needs compares().
    double likeness(const std::string& first, const std::string& second);
    /// Words of the vocabulary that name or describe something.
    const std::vector<std::string>& known() const { return known_; }
    /// Share of the other words that fit the pictures less in the place that the word (or phrase) has in the
    /// sentence, in [0,1]; negative when nobody can tell.
    double of(const std::string& sentence, const std::string& word,
              const std::vector<const Image*>& pictures);

private:
    static constexpr std::size_t MostPictures = 4096;  // a few kilobytes each
    const std::vector<float>& vector_of(const std::string& sentence);
    std::vector<float> vector_of(const Image& picture);

    std::unique_ptr<ImageTextEncoder> score_;
    std::vector<std::string> known_;
    std::map<std::string, std::vector<float>> vectors_;  // of sentences
    MemoryCache<std::vector<float>> seen_{MostPictures}, viewpoints_{MostPictures};
};

}  // namespace gse::edit
