// Questions about masks as text, answers as bits.
#include "engine/pipeline/segmenters.h"

#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/digest.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/pipeline/model_identity.h"
#include "engine/pipeline/neural_loader.h"
#include "engine/pipeline/recipe_model.h"

namespace gse::pipeline {
namespace {

/// The weights that are loaded now, for as long as somebody has them: they may take gigabytes.
std::shared_ptr<edit::Segmenter> load_shared(const JobParameters& job) {
    static std::mutex mutex;
    static std::string loaded_key;
    static std::weak_ptr<edit::Segmenter> loaded;
    std::error_code failure;
    const auto changed = std::filesystem::last_write_time(job.segmenter, failure).time_since_epoch().count();
    const auto key = fmt::format("{} {} {}", job.device, changed, job.segmenter);
    const std::lock_guard lock(mutex);
    if (auto known = loaded.lock(); known && loaded_key == key) return known;
    auto& api = neural_api();
    use_threads(job);
    std::shared_ptr<edit::Segmenter> segmenter;
    try {
        segmenter = api.load_segmenter(job.segmenter, job.device);
    } catch (const Error& error) {
        throw Error(error.code(), "the segmenter cannot be used: " + error.message(), error.hint(),
                    error.path().empty() ? std::filesystem::path(job.segmenter) : error.path());
    }
    loaded = segmenter;
    loaded_key = key;
    log::info("masks are cut out by {}", segmenter->name());
    return segmenter;
}

std::string bits_of(const Mask& mask) {
    std::string bytes((mask.data.size() + 7) / 8, '\0');
    for (std::size_t i = 0; i < mask.data.size(); ++i)
        if (mask.data[i] != 0) bytes[i / 8] = static_cast<char>(static_cast<unsigned char>(bytes[i / 8]) | 1u << i % 8);
    return bytes;
}

std::optional<Mask> mask_in(const std::string& bytes, int width, int height) {
    Mask mask(width, height);
    if (bytes.size() != (mask.data.size() + 7) / 8) return std::nullopt;
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = static_cast<unsigned char>(bytes[i / 8]) >> i % 8 & 1u;
    return mask;
}

class RememberingSegmenter final : public edit::Segmenter {
public:
    RememberingSegmenter(JobParameters job, std::shared_ptr<DiskCache> cache, std::string identity)
        : job_(std::move(job)), cache_(std::move(cache)), identity_(std::move(identity)) {
        const auto question = "name of segmenter " + identity_;
        if (auto known = cache_->find(question)) {
            name_ = std::move(*known);
            return;
        }
        name_ = real().name();   // what is wrong with the weights is said now
        cache_->keep(question, name_);
    }

    Mask segment(const Image& image, const std::vector<edit::PointPrompt>& points, const std::optional<edit::BoxPrompt>& box,
                 const Image& hint) override {
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
        if (!real_) real_ = load_shared(job_);
        return *real_;
    }

private:
    std::string question(const Image& image, const std::vector<edit::PointPrompt>& points, const std::optional<edit::BoxPrompt>& box) const {
        Digest digest;
        digest.image(image);
        auto text = fmt::format("mask by segmenter {} in {}:", identity_, digest.hex());
        for (const auto& point : points) text += fmt::format(" {} {} {}", point.x, point.y, point.positive ? "in" : "out");
        if (box) text += fmt::format(" box {} {} {} {}", box->x0, box->y0, box->x1, box->y1);
        return text;
    }

    const JobParameters job_;
    const std::shared_ptr<DiskCache> cache_;
    const std::string identity_;
    std::string name_;
    std::mutex mutex_;
    std::shared_ptr<edit::Segmenter> real_;
};

}  // namespace

std::shared_ptr<edit::Segmenter> open_segmenter(const JobParameters& job, std::shared_ptr<DiskCache> cache) {
    if (job.segmenter.empty()) return nullptr;
    if (!cache || cache->most_bytes() == 0) return load_shared(job);
    std::string identity;
    try {
        identity = segmenter_identity(job, *cache);
    } catch (const std::exception& failure) {   // loading says better what is wrong
        log::debug("the segmenter's weights cannot be compared: {}", failure.what());
        return load_shared(job);
    }
    return std::make_shared<RememberingSegmenter>(job, std::move(cache), std::move(identity));
}

edit::Segmenter& without_memory(edit::Segmenter& segmenter) {
    auto* remembering = dynamic_cast<RememberingSegmenter*>(&segmenter);
    return remembering != nullptr ? remembering->real() : segmenter;
}

}  // namespace gse::pipeline
