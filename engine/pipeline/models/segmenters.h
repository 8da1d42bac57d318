// What cuts masks out of pictures: the segmenters of a job, which remember.
#pragma once

#include <memory>

#include "engine/base/disk_cache.h"
#include "engine/edit/interfaces/interfaces.h"
#include "engine/pipeline/run/recipe.h"

namespace gse::pipeline {

/// Both may be null: then the one that needs no weights follows clicks, and nouns are left to the attention.
struct Segmenters {
    std::shared_ptr<edit::Segmenter> clicks;  // SAM or MobileSAM
    std::shared_ptr<edit::TextSegmenter>
        words;  // CLIPSeg, whose masks `clicks` makes sharper where it is there
};

/// Those whose weights the job names. Their masks are kept in `cache` (may be null): what is known is
/// answered without loading the weights, which are shared by all who have them open. Throws Error for weights
/// that cannot be used.
Segmenters open_segmenters(const JobParameters& job, const std::shared_ptr<DiskCache>& cache);

/// The one behind it, for pictures that are not seen twice.
edit::Segmenter& uncached(edit::Segmenter& segmenter);

/// Masks of `words` whose box `clicks` fills with nearly the same are what it makes of that box. Both outlive
/// the result.
std::shared_ptr<edit::TextSegmenter> sharpened(std::shared_ptr<edit::TextSegmenter> words,
                                               std::shared_ptr<edit::Segmenter> clicks);

}  // namespace gse::pipeline
