// Segmenters of a job, whose masks are cached.
#pragma once

#include <memory>

#include "engine/base/disk_cache.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::pipeline {

/// Both may be null: then the one that needs no weights follows clicks, and nouns are left to the attention.
struct Segmenters {
    std::shared_ptr<edit::Segmenter> clicks;  // SAM or MobileSAM
    std::shared_ptr<edit::TextSegmenter>
        words;  // CLIPSeg, whose masks `clicks` makes sharper where it is there
};

/// Opens the segmenters whose weights the job names. `cache` (may be null) keeps their masks; those are
/// answered without loading the weights. All who have them open share the weights. Throws Error for weights
/// that cannot be used.
Segmenters open_segmenters(const JobParameters& job, const std::shared_ptr<DiskCache>& cache);

/// Segmenter behind the cache, for pictures that are not seen twice.
edit::Segmenter& uncached(edit::Segmenter& segmenter);

/// Masks of `words` whose box `clicks` fills with nearly the same are what it makes of that box. Both outlive
/// the result.
std::shared_ptr<edit::TextSegmenter> sharpened(std::shared_ptr<edit::TextSegmenter> words,
                                               std::shared_ptr<edit::Segmenter> clicks);

}  // namespace gse::pipeline
