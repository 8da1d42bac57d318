// What a model's answers follow from, as text: contents of its files, how it is loaded, the code that
// computes.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/answer_cache.h"
#include "engine/pipeline/run/recipe.h"

namespace gse::pipeline {

/// Raised when an answer changes that stays the same by files and settings: what is kept of earlier versions
/// is not found then.
constexpr int AnswersVersion = 4;

/// Changes with the contents of weights, configurations, vocabularies, LoRAs, the tiny autoencoder and the
/// networks' library, with device, precision and processor, and with `version`; of names, only the model's
/// own counts. The contents of a file are read once as long as its size and times stay (remembered in
/// `cache`). Throws Error (NotFound, Unreadable).
std::string model_identity(const JobParameters& job, AnswerCache& cache, int version = AnswersVersion);
/// The same of a segmenter's weights: a file or a folder.
std::string segmenter_identity(const std::filesystem::path& weights, const std::string& device,
                               AnswerCache& cache, int version = AnswersVersion);

}  // namespace gse::pipeline
