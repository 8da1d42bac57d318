// Record of a training beside the weights: logs, curves, and a sheet of pictures drawn by the finished model.
#pragma once

#include <filesystem>

#include "engine/base/image.h"
#include "engine/base/progress.h"

namespace gse::training {

/// Copies work/*.tsv to model/log/ and draws model/log/curves.png and model/log/samples.png. A chart or sheet
/// that cannot be made is left out with a warning. Throws Error (Cancelled) on a stop request.
void write_training_record(const std::filesystem::path& work, const std::filesystem::path& model,
                           const JobControl& job);

/// Curves of one log: a chart per column behind the fourth, over the steps; logarithmic heights. Throws Error
/// (NotFound, Malformed).
Image training_curves(const std::filesystem::path& log);

}  // namespace gse::training
