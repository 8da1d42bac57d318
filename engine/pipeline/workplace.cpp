// Remembers renders and answers.
#include "engine/pipeline/workplace.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/grabcut_segmenter.h"

namespace gse::pipeline {

Workplace::Workplace(Scene scene, std::shared_ptr<neural::TextToImage> model, const JobParameters& job)
    : scene_(std::move(scene)), model_(std::move(model)), segmenter_(edit::make_default_segmenter()) {
    const auto statistics = compute_statistics(scene_.gaussians);
    if (statistics.visible_rows == 0)
        throw Error(ErrorCode::InvalidArgument, "the scene has no splat that can be seen", "open another scene", job.scene);
    drawn_ = drawable(scene_.gaussians);
    unusable_ = statistics.nan_rows + statistics.infinite_rows;
    if (unusable_ > 0)
        log::warning("{} of {} splats hold values that cannot be drawn ({} NaN, {} infinite or absurd); they stay as they are "
                     "and count nowhere",
                     unusable_, statistics.count, statistics.nan_rows, statistics.infinite_rows);
    scene_.info.up = parse_up(job.up, scene_.info);
}

void Workplace::take_model(std::shared_ptr<neural::TextToImage> model) {
    model_ = std::move(model);
    attention_ = nullptr;
    recognition_ = nullptr;
}

void Workplace::ask_anew(const neural::AttentionParameters& attention) {
    attention_ = std::make_unique<edit::CachedAttention>(model_->attention(attention));
    recognition_ = std::make_unique<edit::Recognition>(model_->text_image_score(), model_->known_words());
    renders_.asked_again.clear();
    renders_.drawn.clear();
}

void Workplace::ask(const neural::AttentionParameters& attention) {
    if (attention_ == nullptr) ask_anew(attention);
}

edit::LocateTools Workplace::tools(const Views& views, const JobControl& control) {
    if (renders_key_ != views.key) renders_ = {};
    renders_key_ = views.key;
    edit::LocateTools tools{painter_.rasterizer(), *attention_, segmenter_.get(), nullptr, control};
    tools.memory = &renders_;
    tools.threads = &threads_;
    tools.recognition = recognition_.get();
    return tools;
}

std::vector<Image> Workplace::pictures(const std::vector<View>& views, const raster::Settings& settings, const JobControl& control) {
    std::vector<Image> pictures;
    for (const auto& view : views) {
        if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
        pictures.push_back(painter_.paint(drawn_.spans(), view.camera, settings).colour);
        for (auto& value : pictures.back().data) value = std::clamp(value, 0.0f, 1.0f);
    }
    return pictures;
}

}  // namespace gse::pipeline
