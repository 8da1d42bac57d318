// Captions of the training worlds as token ids: every word is one token.
#pragma once

#include <string>
#include <unordered_map>

#include "engine/laboratory/starter/starter_data.h"

namespace gse::training {

/// Token ids of one-token words.
class WordTable {
public:
    explicit WordTable(const StarterVocabulary& vocabulary);
    /// Throws Error (InvalidArgument) for a word that is not in the vocabulary.
    int id(const std::string& word) const;
    int bos() const { return bos_; }
    int eos() const { return eos_; }

private:
    int bos_, eos_;
    std::unordered_map<std::string, int> ids_;
};

}  // namespace gse::training
