// Identity of a model: contents of its files, how it is loaded, the code that computes.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/answer_cache.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::pipeline {

/// Raised when an answer changes that stays the same by files and settings: what is kept of earlier versions
/// is not found then.
constexpr int AnswersVersion = 5;

/// Hash over the contents of weights, configurations, vocabularies, LoRAs, tiny autoencoder and networks'
/// library. Device, precision, processor, `version` and the model's own name count, too. Contents of a file
/// are read once as long as its size and times stay; `cache` keeps their hash. Throws Error (NotFound,
/// Unreadable).
std::string model_identity(const JobParameters& job, AnswerCache& cache, int version = AnswersVersion);
/// Identity of a segmenter's weights: a file or a folder.
std::string segmenter_identity(const std::filesystem::path& weights, const std::string& device,
                               AnswerCache& cache, int version = AnswersVersion);

}  // namespace gse::pipeline
