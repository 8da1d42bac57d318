// Training pictures as files, for a trainer that runs elsewhere (packaging/train_shapes).
#pragma once

#include <cstdint>
#include <filesystem>

#include "engine/base/progress.h"
#include "engine/base/thread_pool.h"
#include "engine/laboratory/starter/starter_trainer.h"

namespace gse::training {

struct ShardRange {
    std::uint64_t first = 0, count = 0;  // pictures, whole scenes
    int size = 64;                       // S, pixels
    int wordings = 4;                    // K captions of each picture
};
inline constexpr int ShardWords = 30;  // W words of a caption; 255 = none

/// Writes pictures `range` of a source that has pictures of before and outlines. Arrays follow one another,
/// little-endian:
/// int32 [6]: "GSH2", N, S, G, K, W;
/// uint8 [2,N,S,S,3]: pictures after and before the edit;
/// uint8 [N,3,G,G]: coverage of ground, object, accessory;
/// uint8 [N,G,G]: placement volume of the object before;
/// uint8 [N,S,S]: outlines;
/// uint8 [N,K,2,W]: words of the sentence and of the next side's, as places in source.vocabulary(), which a
/// comma follows;
/// uint8 [N]: restyled part (255 = something new comes);
/// float32 [N,2]: azimuth and elevation; float32 [N,K]: shares of the next side's sentence; float32 [N]:
/// azimuths of the fronts.
/// Throws Error when it cannot be written or a caption is too long.
void write_picture_shard(const StarterSource& source, const ShardRange& range,
                         const std::filesystem::path& path, ThreadPool& pool);

/// Writes the pictures of new shapes that a run of these parameters trains on: seed, size, restyled_share,
/// more_share, threads, and the number rounded up to whole files. FOLDER/vocabulary.json holds the words, a
/// comma last; FOLDER/shard-0.bin, shard-1.bin, ... hold `per_file` pictures each. Files that are there
/// already stay. Throws Error as above, and (Cancelled).
void write_picture_shards(const StarterTrainParameters& parameters, const std::filesystem::path& folder,
                          const JobControl& job, std::uint64_t per_file = 4096);

}  // namespace gse::training
