// What the next edit will take: time, arithmetic and memory, from what the last ones took.
#include <fmt/format.h>

#include <algorithm>

#include "app/session/application.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/process_memory.h"
#include "engine/edit/request/vocabulary.h"

namespace gse::app {
namespace {

constexpr double LikelyLabel = 0.25;  // share of the splats, while there is no label that says

}  // namespace

ui::NetworkCost cost_of(const neural::NetworkUse& use) {
    return {use.unet, use.encoder, use.decoder, use.flop * 1e-12};
}

std::string Application::measured_key() const {
    // A LoRA takes time to read, memory of its own where it is distilled, and another number of passes per
    // step.
    std::string key = fmt::format("{} at {} px", model_in_use(), model_.request.image_size);
    for (const auto& lora : loras_) key += fmt::format(" with {}", lora);
    for (const auto& segmenter : {segmenter_path_, text_segmenter_path_})
        if (!segmenter.empty()) key += " and masks by " + segmenter;
    if (const auto& precision = model_.model_settings.precision; precision != "auto")
        key += " in " + precision;
    return key;
}

Measured Application::measured_now() const {
    const auto found = measured_.find(measured_key());
    return found == measured_.end() ? Measured{} : found->second;
}

void Application::remember_measured(const std::string& key, const Measured& measured) {
    model_.cache_bytes = cached_bytes(cache_->folder());  // a job has ended
    Measured& known = measured_[key];
    nlohmann::ordered_json news = fields_to_json(measured);
    if (measured.raster < 0) news.erase("rows");
    for (auto entry = news.begin(); entry != news.end();)
        entry = *entry < 0 ? news.erase(entry) : std::next(entry);
    if (known.work_mb > measured.work_mb) news.erase("work_mb");  // the largest job counts
    fields_from_json(known, news);
    save_settings();
}

PlannedMemory Application::planned_memory() const {
    PlannedMemory memory;
    const auto& current = document_.state().current;
    memory.process = current_rss_mb();
    memory.loaded = text_model_ != nullptr && text_model_key_ == model_key() && model_load_.before_mb >= 0;
    memory.before_load = model_load_.before_mb;
    for (const auto& row : model_.models)
        if (row.path == model_in_use()) memory.weights = static_cast<double>(row.bytes) / 1e6;
    memory.scene = static_cast<double>(current.byte_size()) / 1e6;
    memory.labelled_share = model_.labelled > 0 && current.size() > 0
                                ? static_cast<double>(model_.labelled) / static_cast<double>(current.size())
                                : LikelyLabel;
    memory.snapshots = std::min(MostSnapshots * memory.scene * memory.labelled_share,
                                static_cast<double>(MostSnapshotBytes) / 1e6);
    return memory;
}

void Application::refresh_estimate() {
    PlannedWork work;
    work.loaded = text_model_ != nullptr && text_model_key_ == model_key();
    work.located = job_fits();
    work.shows_idea = model_.model_settings.gate && !edit::edits_by_views(model_.request);
    const bool learns = model_.model_settings.learn_scene && !work.located && !known_tuning(current_recipe());
    work.tune_steps = learns ? model_.model_settings.learning.steps : 0;
    work.rows = document_.state().current.size();
    work.words = edit::promptable_vocabulary(model_.known_words, model_.drawn_words);
    try {
        work.mode = edit::planned_mode(edit::validated(model_.request));
    } catch (const Error&) {  // not a sentence yet
    }
    const Measured measured = measured_now();
    const Cost cost = estimated_cost(measured, model_.request, work);
    model_.estimate.seconds = cost.seconds;
    model_.estimate.tflop = cost.tflop;
    const auto by_quality = costs_by_quality(measured, model_.request, work);
    for (std::size_t i = 0; i < by_quality.size(); ++i)
        model_.estimate.quality_seconds[i] = by_quality[i].seconds;
    model_.estimate.memory_mb = estimated_memory_mb(measured, planned_memory());
    model_.estimate.memory_free_mb = static_cast<double>(free_memory()) / (1 << 20);
}

}  // namespace gse::app
