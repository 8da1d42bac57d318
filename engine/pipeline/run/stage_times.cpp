// Wall time per stage.
#include "engine/pipeline/run/stage_times.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/clock.h"
#include "engine/pipeline/models/neural_loader.h"

namespace gse::pipeline {
namespace {

nlohmann::ordered_json use_json(const neural::NetworkUse& use) {
    nlohmann::ordered_json json{
        {"unet", use.unet}, {"encoder", use.encoder}, {"decoder", use.decoder}, {"tflop", use.flop * 1e-12}};
    if (use.cached > 0) json["cached"] = use.cached;
    return json;
}

}  // namespace

std::string use_text(const neural::NetworkUse& use) {
    const auto text = fmt::format("{} UNet, {} encoder and {} decoder passes, {:.{}f} TFLOP", use.unet,
                                  use.encoder, use.decoder, use.flop * 1e-12,
                                  use.flop < 1e12   ? 3
                                  : use.flop < 1e14 ? 1
                                                    : 0);
    return use.cached > 0 ? text + fmt::format("; {} answers read from the cache", use.cached) : text;
}

void StageTimes::begin(const std::string& stage) {
    open_ = stage;
    start_ = wall_seconds();
    start_use_ = network_use();
}

void StageTimes::end() {
    add(open_, wall_seconds() - start_);
    const auto use = network_use() - start_use_;
    const auto found = std::find_if(networks_.begin(), networks_.end(),
                                    [&](const auto& entry) { return entry.first == open_; });
    if (found != networks_.end()) found->second += use;
    else if (use.flop > 0 || use.cached > 0) networks_.emplace_back(open_, use);
}

neural::NetworkUse StageTimes::networks() const {
    neural::NetworkUse total;
    for (const auto& [stage, use] : networks_) total += use;
    return total;
}

neural::NetworkUse StageTimes::networks(const std::string& wanted) const {
    neural::NetworkUse total;
    for (const auto& [stage, use] : networks_)
        if (stage == wanted) total += use;
    return total;
}

nlohmann::ordered_json StageTimes::networks_json() const {
    nlohmann::ordered_json json;
    for (const auto& [stage, use] : networks_) json[stage] = use_json(use);
    json["total"] = use_json(networks());
    return json;
}

void StageTimes::add(const std::string& stage, double seconds) {
    const auto found =
        std::find_if(stages_.begin(), stages_.end(), [&](const auto& entry) { return entry.first == stage; });
    if (found != stages_.end()) found->second += seconds;
    else stages_.emplace_back(stage, seconds);
}

double StageTimes::seconds(const std::string& stage) const {
    const auto found =
        std::find_if(stages_.begin(), stages_.end(), [&](const auto& entry) { return entry.first == stage; });
    return found == stages_.end() ? 0 : found->second;
}

nlohmann::ordered_json StageTimes::to_json() const {
    nlohmann::ordered_json json;
    double total = 0;
    for (const auto& [stage, seconds] : stages_) {
        json[stage] = seconds;
        total += seconds;
    }
    json["total"] = total;
    return json;
}

}  // namespace gse::pipeline
