// The model of a recipe: loaded, or opened so that it is loaded only when it is asked something that no run
// asked before.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/disk_cache.h"
#include "engine/neural/api/api.h"
#include "engine/pipeline/recipe/recipe.h"

namespace gse::pipeline {

/// Weights of a recipe: the starter's when it names none.
std::filesystem::path model_path(const JobParameters& job);

/// The model a recipe names. Throws Error (Model, NotFound).
std::shared_ptr<neural::TextToImage> load_recipe_model(const JobParameters& job);

/// Sets how many threads the networks take from here on, loaded or not.
void use_threads(const JobParameters& job);

/// Opens the model of a job with a cache (CachedModel), under the contents of all files that it is made of
/// (model_identity.h). A model that was loaded before is loaded again only for an answer that the cache does
/// not hold. Without `cache` it is load_recipe_model(). Throws Error.
std::shared_ptr<neural::TextToImage> open_recipe_model(const JobParameters& job,
                                                       std::shared_ptr<DiskCache> cache);

/// Cost of loading a model; memory of the process in MB, or -1 where it is not known.
struct ModelLoad {
    double seconds = 0, before_mb = -1, after_mb = -1;
};

/// Cost of loading a model of open_recipe_model() that has been loaded by now; nothing for others.
std::optional<ModelLoad> load_of(const neural::TextToImage& model);

/// The networks themselves: for questions that are never asked twice. Loads them.
const neural::TextToImage& uncached(const neural::TextToImage& model);

/// Settings of the cache.
struct CacheSettings {
    int cache_mb = 512;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("cache_mb", self.cache_mb,
          "Most that answers of the networks take on the disk, MB; what was used least recently goes first; "
          "0 = none are kept.",
          Range{0, 1e6});
    }
};

/// The user's: "cache_mb" of settings.json.
CacheSettings load_cache_settings();

/// The cache of this user, in cache_folder() / "answers".
std::shared_ptr<DiskCache> open_answer_cache(const CacheSettings& settings);
std::uint64_t bytes_of(const CacheSettings& settings);

}  // namespace gse::pipeline
