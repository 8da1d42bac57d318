// Facts of a model by its files, above all its words; no network is loaded.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/language/plan/step_sentence.h"

namespace gse::pipeline {

/// A small JSON file of a model (gseditpro.json, unet/config.json); null where there is none, discarded where
/// it is damaged.
nlohmann::json model_json(const std::filesystem::path& path);

/// Words of the model in `folder` (gseditpro.json), empty for an open vocabulary; no network is loaded.
std::vector<std::string> model_words(const std::filesystem::path& folder);

/// Words that it draws besides and does not look for (neural::TextToImage::generated_vocabulary()), and
/// colours that it is dyed in (edit::dye_words()); empty for an open vocabulary.
std::vector<std::string> generated_vocabulary(const std::filesystem::path& folder);

/// Ability of the model in `folder` to do steps of a plan, by its files.
language::plan::ModelAbility model_ability(const std::filesystem::path& folder);

/// Counts the words of a sentence that the model's text encoder reads; all of them where that is not known.
/// Words that a model of a fixed vocabulary is not told take no room. Reads the model's tokenizer when it is
/// another model than last time.
std::size_t words_read(const std::filesystem::path& model, const std::vector<std::string>& words);

}  // namespace gse::pipeline
