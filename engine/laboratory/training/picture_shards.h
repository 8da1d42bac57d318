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

/// Writes pictures `range` of a source that has pictures of before and outlines. Little-endian, one after the
/// other: int32 [6] ("GSH2", N, S, G, K, W); uint8 pictures after and before the edit [2,N,S,S,3], coverage
/// of ground, object, accessory [N,3,G,G], the room of the object before [N,G,G], outlines [N,S,S], words as
/// places in source.vocabulary(), which a comma follows, [N,K,2,W] (of the sentence, and of the next side's),
/// the part that is restyled [N] (255 = something new comes); float32 azimuth and elevation [N,2], shares of
/// the next side's sentence [N,K], and the azimuths at which the things show their fronts [N]. Throws Error
/// when it cannot be written or a caption is too long.
void write_picture_shard(const StarterSource& source, const ShardRange& range,
                         const std::filesystem::path& path, ThreadPool& pool);

/// All pictures of new shapes that a run of these parameters trains on (its seed, size, restyled_share,
/// more_share, number rounded up to whole files, threads): FOLDER/vocabulary.json (the words, a comma last)
/// and FOLDER/shard-0.bin, shard-1.bin, ... of `per_file` pictures each. Files that are there already stay.
/// Throws Error as above, and (Cancelled).
void write_picture_shards(const StarterTrainParameters& parameters, const std::filesystem::path& folder,
                          const JobControl& job, std::uint64_t per_file = 4096);

}  // namespace gse::training
