// Batches of twin pictures and sentences for the image-text encoder.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/random.h"
#include "engine/laboratory/starter/starter_stages.h"
#include "engine/laboratory/starter/starter_words.h"

namespace gse::training {

/// N = groups * members pictures, each with one sentence; all members of a group stand together, the first
/// first.
struct PairBatch {
    torch::Tensor pictures;  // [N,3,S,S] in [0,1], augmented; a group is augmented as one
    torch::Tensor ids;       // [N,T] long
    torch::Tensor
        blocked;  // [N,N] bool: sentence [column] also holds for picture [row], so is no counter-example
    torch::Tensor false_ids;  // [M,T] long: sentences that are not true of their picture
    torch::Tensor false_of;   // [M] long: the picture of each
    /// Changes of one picture and sentence to another of the group that can be seen.
    torch::Tensor from, to;     // [K] long
    torch::Tensor same_change;  // [K,K] bool, false on the diagonal: the two change the same words
    torch::Tensor unrelated;    // [K,K] bool: no word that one of them brings or takes is among the other's
};

class PairBatchMaker {
public:
    explicit PairBatchMaker(const ClipTraining& training);
    PairBatch make(Random& random) const;

private:
    struct Row {
        std::uint64_t picture = 0;
        StarterClaim claim;
        bool full = false;
        std::vector<std::string> false_texts;
    };
    std::vector<Row> draw_rows(Random& random) const;
    torch::Tensor pictures_of(const std::vector<Row>& rows, Random& random) const;
    torch::Tensor ids_of(const std::vector<std::string>& texts) const;
    void add_relations(const std::vector<Row>& rows, PairBatch& batch) const;
    bool look_alike(std::uint64_t a, std::uint64_t b) const;

    const ClipTraining& training_;
    WordTable table_;
    std::uint64_t members_;
};

}  // namespace gse::training
