// Finds, loads or opens the model of a recipe.
#include "engine/pipeline/models/recipe_model.h"

#include <utility>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/io/files/user_files.h"
#include "engine/pipeline/models/cached_model.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_identity.h"
#include "engine/pipeline/models/neural_loader.h"

namespace gse::pipeline {

std::filesystem::path model_path(const JobParameters& job) {
    return job.model.empty() ? starter_model_path() : std::filesystem::path(job.model);
}

void use_threads(const JobParameters& job) { set_network_threads(job.threads); }

namespace {

std::shared_ptr<neural::TextToImage> load_networks(const JobParameters& job) {
    auto& api = neural_api();
    use_threads(job);
    return api.load_model(model_path(job),
                          {job.device, neural::find_loras(job.lora), job.taesd, job.precision});
}

void say_notes(const neural::TextToImage& model) {
    for (const auto& note : model.notes()) log::warning("{}", note);
}

}  // namespace

std::shared_ptr<neural::TextToImage> load_recipe_model(const JobParameters& job) {
    auto model = load_networks(job);
    say_notes(*model);
    return model;
}

std::shared_ptr<neural::TextToImage> open_recipe_model(const JobParameters& job,
                                                       std::shared_ptr<DiskCache> cache) {
    if (!cache) return load_recipe_model(job);
    use_threads(job);
    std::string identity;
    try {
        if (cache->most_bytes() > 0) identity = model_identity(job, *cache);
    } catch (const std::exception& failure) {  // loading says better what is wrong
        log::debug("the model's files cannot be compared: {}", failure.what());
        return load_recipe_model(job);
    }
    auto model = std::make_shared<CachedModel>(
        std::move(cache), std::move(identity), [job = JobParameters(job)]() mutable {
            job.threads = network_threads();  // they may have been set since
            return load_networks(job);
        });
    if (!model->known()) model->real();  // what is wrong with it is said now
    say_notes(*model);
    return model;
}

std::optional<ModelLoad> load_of(const neural::TextToImage& model) {
    const auto* cached = dynamic_cast<const CachedModel*>(&model);
    return cached != nullptr ? cached->load() : std::nullopt;
}

const neural::TextToImage& uncached(const neural::TextToImage& model) {
    const auto* cached = dynamic_cast<const CachedModel*>(&model);
    return cached != nullptr ? cached->real() : model;
}

CacheSettings load_cache_settings() {
    CacheSettings settings;
    try {
        const auto json = load_settings();
        if (json.contains("cache_mb")) fields_from_json(settings, {{"cache_mb", json["cache_mb"]}});
    } catch (const Error& error) { log::warning("{}; the default is used", error.what()); }
    return settings;
}

std::uint64_t bytes_of(const CacheSettings& settings) {
    return static_cast<std::uint64_t>(settings.cache_mb) << 20;
}

std::shared_ptr<DiskCache> open_answer_cache(const CacheSettings& settings) {
    return std::make_shared<DiskCache>(cache_folder() / "answers", bytes_of(settings));
}

}  // namespace gse::pipeline
