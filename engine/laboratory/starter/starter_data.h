// Training pictures in memory, cached on disk, and the batches made of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "engine/laboratory/starter/starter_trainer.h"

namespace gse::training {

/// All pictures of a run, kept as bytes.
struct StarterPictures {
    int size = 0;   // S
    int cells = 0;  // G
    std::size_t count = 0;
    std::vector<std::uint8_t> rgb;        // [N,S,S,3]
    std::vector<std::uint8_t> coverage;   // [N,3,G,G]
    std::vector<std::uint8_t> bare_twin;  // [N]
};

/// Reads the pictures from the cache in `work`, or renders them on all cores and writes the cache.
StarterPictures load_or_render_pictures(const StarterTrainParameters& parameters, const StarterSource& source,
                                        const std::filesystem::path& work, const JobControl& job);

/// Text of vocab.json and merges.txt in which every given word is one token. CLIP's byte-level BPE is trained
/// until no word is left in pieces. The last two ids are the start and end tokens.
struct StarterVocabulary {
    std::string vocab_json;
    std::string merges_txt;
    int size = 0;
    int bos = 0;
    int eos = 0;
};
StarterVocabulary build_vocabulary(const std::vector<std::string>& words);

}  // namespace gse::training
