// Costs of past work with each model on this machine, and estimates for the next edit.
#include "app/session/cost_book.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/session/edit/snapshots.h"
#include "engine/base/error.h"
#include "engine/base/fields.h"
#include "engine/base/memory.h"
#include "engine/base/process_memory.h"

namespace gse::app {
namespace {

constexpr double LikelyLabel = 0.25;  // share of the splats, while there is no label that says

}  // namespace

/// A LoRA takes time to read, memory of its own where it is distilled, and another number of passes per step.
std::string CostBook::key(const edit::EditRequest& request) const {
    std::string key = fmt::format("{} at {} px", models_.in_use(), request.image_size);
    for (const auto& lora : models_.loras()) key += fmt::format(" with {}", lora);
    for (const auto role : {ui::SegmenterRole::Clicks, ui::SegmenterRole::Words})
        if (const auto& segmenter = models_.segmenter_path(role); !segmenter.empty())
            key += " and masks by " + segmenter;
    if (const auto& precision = models_.settings().precision; precision != "auto") key += " in " + precision;
    return key;
}

CostProfile CostBook::profile(const edit::EditRequest& request) const {
    const auto found = profiles_.find(key(request));
    return found == profiles_.end() ? CostProfile{} : found->second;
}

void CostBook::remember(const std::string& key, const CostProfile& measured) {
    CostProfile& known = profiles_[key];
    nlohmann::ordered_json news = fields_to_json(measured);
    if (measured.raster < 0) news.erase("rows");
    for (auto entry = news.begin(); entry != news.end();)
        entry = *entry < 0 ? news.erase(entry) : std::next(entry);
    if (known.work_mb > measured.work_mb) news.erase("work_mb");  // the largest job counts
    fields_from_json(known, news);
    workspace_.settings_changed = stale_ = true;
}

PlannedMemory CostBook::memory() const {
    PlannedMemory memory;
    const auto& current = workspace_.document.state().current;
    memory.process = current_rss_mb();
    memory.loaded = models_.loaded_fits() && models_.load().before_mb >= 0;
    memory.before_load = models_.load().before_mb;
    if (const auto* row = models_.list().find(models_.in_use()))
        memory.weights = static_cast<double>(row->bytes) / 1e6;
    memory.scene = static_cast<double>(current.byte_size()) / 1e6;
    memory.labelled_share =
        workspace_.labelled > 0 && current.size() > 0
            ? static_cast<double>(workspace_.labelled) / static_cast<double>(current.size())
            : LikelyLabel;
    memory.snapshots = std::min(Snapshots::Most * memory.scene * memory.labelled_share,
                                static_cast<double>(Snapshots::MostBytes) / 1e6);
    return memory;
}

void CostBook::estimate(const std::vector<PlannedEdit>& edits, const ServerCost& server) {
    ui::Estimate sum;
    sum.seconds = sum.tflop = 0;
    sum.quality_seconds.fill(0);
    const CostProfile measured = profile(edits.front().request);
    const auto add = [](double& total, double part) {
        total = total < 0 || part < 0 ? -1 : total + part;  // a part that is not known: neither is the sum
    };
    for (const auto& [request, work, made] : edits) {
        const Cost cost = made ? estimated_cost(measured, request, work) : Cost{};
        if (edits.size() > 1) sum.step_seconds.push_back(cost.seconds);
        if (!made) continue;
        add(sum.seconds, cost.seconds);
        add(sum.tflop, cost.tflop);
        const auto by_quality = costs_by_quality(measured, request, work);
        for (std::size_t i = 0; i < by_quality.size(); ++i)
            add(sum.quality_seconds[i], by_quality[i].seconds);
    }
    if (server.pictures > 0) {
        sum = {};
        sum.server_pictures = server.pictures;
        sum.server_seconds = server.seconds;
    }
    sum.memory_mb = estimated_memory_mb(measured, memory());
    sum.memory_free_mb = static_cast<double>(free_memory()) / (1 << 20);
    estimate_ = std::move(sum);
    stale_ = false;
}

void CostBook::settings_to_json(nlohmann::json& json) const {
    for (const auto& [key, measured] : profiles_) json["measured"][key] = fields_to_json(measured);
}

void CostBook::settings_from_json(const nlohmann::json& json) {
    if (!json.contains("measured") || !json["measured"].is_object()) return;
    for (const auto& [key, measured] : json["measured"].items()) {
        try {
            fields_from_json(profiles_[key], measured);
        } catch (const Error&) {  // of another version: it is measured anew
            profiles_.erase(key);
        }
    }
}

}  // namespace gse::app
