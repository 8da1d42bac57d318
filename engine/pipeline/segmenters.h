// What cuts masks out of pictures: the one of a job, which remembers.
#pragma once

#include <memory>

#include "engine/base/disk_cache.h"
#include "engine/edit/interfaces.h"
#include "engine/pipeline/recipe.h"

namespace gse::pipeline {

/// SAM or MobileSAM where the job names weights, else null: the one that needs none. Its masks are kept in `cache` (may be null): what
/// is known is answered without loading the weights, which are shared by all who have them open. Throws Error for weights that cannot
/// be used.
std::shared_ptr<edit::Segmenter> open_segmenter(const JobParameters& job, std::shared_ptr<DiskCache> cache);

/// The one behind it, for pictures that are not seen twice.
edit::Segmenter& without_memory(edit::Segmenter& segmenter);

}  // namespace gse::pipeline
