// Questions about masks as text, answers as bits.
#include "engine/pipeline/models/segmenters.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/content_hash.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/localize/clusters.h"
#include "engine/pipeline/models/model_identity.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/recipe_model.h"

namespace gse::pipeline {
namespace {

/// Weights that are loaded now, for as long as somebody has them: they may take gigabytes.
template <class Kind> class WeightsCache {
public:
    template <class Load>
    std::shared_ptr<Kind> get(const std::string& weights, const JobParameters& job, const Load& load) {
        std::error_code failure;
        const auto changed = std::filesystem::last_write_time(weights, failure).time_since_epoch().count();
        const auto key = fmt::format("{} {} {}", job.device, changed, weights);
        const std::lock_guard lock(mutex_);
        if (auto known = loaded_.lock(); known && loaded_key_ == key) return known;
        auto& api = neural_api();
        use_threads(job);
        try {
            std::shared_ptr<Kind> segmenter = load(api);
            loaded_ = segmenter;
            loaded_key_ = key;
            return segmenter;
        } catch (const Error& error) {
            throw Error(error.code(), "the segmenter cannot be used: " + error.message(), error.hint(),
                        error.path().empty() ? std::filesystem::path(weights) : error.path());
        }
    }

private:
    std::mutex mutex_;
    std::string loaded_key_;
    std::weak_ptr<Kind> loaded_;
};

std::shared_ptr<edit::Segmenter> load_clicks(const JobParameters& job) {
    static WeightsCache<edit::Segmenter> cache;
    return cache.get(job.segmenter, job,
                     [&](neural::Api& api) { return api.load_segmenter(job.segmenter, job.device); });
}

std::shared_ptr<edit::TextSegmenter> load_words(const JobParameters& job) {
    static WeightsCache<edit::TextSegmenter> cache;
    return cache.get(job.text_segmenter, job, [&](neural::Api& api) {
        return api.load_text_segmenter(job.text_segmenter, job.device);
    });
}

std::string bits_of(const Mask& mask) {
    std::string bytes((mask.data.size() + 7) / 8, '\0');
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0)
            bytes[i / 8] = static_cast<char>(static_cast<unsigned char>(bytes[i / 8]) | 1u << i % 8);
    return bytes;
}

std::optional<Mask> mask_in(const std::string& bytes, int width, int height) {
    Mask mask(width, height);
    if (bytes.size() != (mask.data.size() + 7) / 8) return std::nullopt;
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        mask.data[i] = static_cast<unsigned char>(bytes[i / 8]) >> i % 8 & 1u;
    return mask;
}

class CachedSegmenter final : public edit::Segmenter {
public:
    CachedSegmenter(JobParameters job, std::shared_ptr<DiskCache> cache, std::string identity)
        : job_(std::move(job)), cache_(std::move(cache)), identity_(std::move(identity)) {
        const auto question = "name of segmenter " + identity_;
        if (auto known = cache_->find(question)) {
            name_ = std::move(*known);
            return;
        }
        name_ = real().name();  // what is wrong with the weights is said now
        cache_->keep(question, name_);
    }

    Mask segment(const Image& image, const std::vector<edit::PointPrompt>& points,
                 const std::optional<edit::BoxPrompt>& box, const Image& hint) override {
        const auto asked = question(image, points, box);
        if (const auto known = cache_->find(asked))
            if (auto mask = mask_in(*known, image.width, image.height)) return std::move(*mask);
        auto mask = real().segment(image, points, box, hint);
        cache_->keep(asked, bits_of(mask));
        return mask;
    }
    bool trusted() const override { return true; }
    std::string name() const override { return name_; }

    edit::Segmenter& real() {
        const std::lock_guard lock(mutex_);
        if (!real_) real_ = load_clicks(job_);
        return *real_;
    }

private:
    std::string question(const Image& image, const std::vector<edit::PointPrompt>& points,
                         const std::optional<edit::BoxPrompt>& box) const {
        ContentHash hash;
        hash.image(image);
        hash.numbers(points.size(), box.has_value());
        for (const auto& point : points) hash.numbers(point.x, point.y, point.positive);
        if (box) hash.numbers(box->x0, box->y0, box->x1, box->y1);
        return fmt::format("mask by segmenter {}: {}", identity_, hash.key().hex());
    }

    const JobParameters job_;
    const std::shared_ptr<DiskCache> cache_;
    const std::string identity_;
    std::string name_;
    std::mutex mutex_;
    std::shared_ptr<edit::Segmenter> real_;
};

/// An entry is the score and the mask's bits.
class CachedTextSegmenter final : public edit::TextSegmenter {
public:
    CachedTextSegmenter(JobParameters job, std::shared_ptr<DiskCache> cache, std::string identity)
        : job_(std::move(job)), cache_(std::move(cache)), identity_(std::move(identity)) {
        const auto question = "text segmenter works: " + identity_;
        if (cache_->find(question)) return;
        real();  // what is wrong with the weights is said now
        cache_->keep(question, "yes");
    }

    std::pair<Mask, double> segment(const Image& image, const std::string& noun) override {
        const auto asked =
            fmt::format("mask by text segmenter {} in {} of {}", identity_, key_of(image).hex(), noun);
        double score = 0;
        if (const auto known = cache_->find(asked); known && known->size() > sizeof score) {
            std::memcpy(&score, known->data(), sizeof score);
            if (auto mask = mask_in(known->substr(sizeof score), image.width, image.height);
                mask && score >= 0 && score <= 1)
                return {std::move(*mask), score};
        }
        auto found = real().segment(image, noun);
        cache_->keep(asked, std::string(reinterpret_cast<const char*>(&found.second), sizeof found.second) +
                                bits_of(found.first));
        return found;
    }

private:
    edit::TextSegmenter& real() {
        const std::lock_guard lock(mutex_);
        if (!real_) real_ = load_words(job_);
        return *real_;
    }

    const JobParameters job_;
    const std::shared_ptr<DiskCache> cache_;
    const std::string identity_;
    std::mutex mutex_;
    std::shared_ptr<edit::TextSegmenter> real_;
};

class SharpenedWords final : public edit::TextSegmenter {
public:
    SharpenedWords(std::shared_ptr<edit::TextSegmenter> words, std::shared_ptr<edit::Segmenter> clicks)
        : words_(std::move(words)), clicks_(std::move(clicks)) {}

    std::pair<Mask, double> segment(const Image& image, const std::string& noun) override {
        // IoU from which both are taken to mean the same thing; by judgement.
        constexpr double least_agreement = 0.5;
        auto found = words_->segment(image, noun);
        if (found.second < edit::LeastTextScore || found.first.count() == 0) return found;
        auto sharp = clicks_->segment(image, {}, edit::bounds_of(found.first), {});
        if (localize::mask_iou(sharp, found.first) >= least_agreement) found.first = std::move(sharp);
        return found;
    }

private:
    const std::shared_ptr<edit::TextSegmenter> words_;
    const std::shared_ptr<edit::Segmenter> clicks_;
};

/// A segmenter with its cache, or the weights themselves where nothing is to be kept.
template <class Cached, class Kind>
std::shared_ptr<Kind> open(const std::string& weights, const JobParameters& job,
                           const std::shared_ptr<DiskCache>& cache,
                           std::shared_ptr<Kind> (*load)(const JobParameters&)) {
    if (weights.empty()) return nullptr;
    if (!cache || cache->most_bytes() == 0) return load(job);
    std::string identity;
    try {
        identity = segmenter_identity(weights, job.device, *cache);
    } catch (const std::exception& failure) {  // loading says better what is wrong
        log::debug("the segmenter's weights cannot be compared: {}", failure.what());
        return load(job);
    }
    return std::make_shared<Cached>(job, cache, std::move(identity));
}

}  // namespace

std::shared_ptr<edit::TextSegmenter> sharpened(std::shared_ptr<edit::TextSegmenter> words,
                                               std::shared_ptr<edit::Segmenter> clicks) {
    return words && clicks ? std::make_shared<SharpenedWords>(std::move(words), std::move(clicks)) : words;
}

Segmenters open_segmenters(const JobParameters& job, const std::shared_ptr<DiskCache>& cache) {
    Segmenters opened;
    opened.clicks = open<CachedSegmenter>(job.segmenter, job, cache, load_clicks);
    opened.words =
        sharpened(open<CachedTextSegmenter>(job.text_segmenter, job, cache, load_words), opened.clicks);
    return opened;
}

edit::Segmenter& uncached(edit::Segmenter& segmenter) {
    auto* cached = dynamic_cast<CachedSegmenter*>(&segmenter);
    return cached != nullptr ? cached->real() : segmenter;
}

}  // namespace gse::pipeline
