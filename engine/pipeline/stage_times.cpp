// Wall time per stage.
#include "engine/pipeline/stage_times.h"

#include <algorithm>
#include <chrono>

namespace gse::pipeline {
namespace {

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void StageTimes::begin(const std::string& stage) {
    open_ = stage;
    start_ = now_seconds();
}

void StageTimes::end() { add(open_, now_seconds() - start_); }

void StageTimes::add(const std::string& stage, double seconds) {
    const auto found = std::find_if(stages_.begin(), stages_.end(), [&](const auto& entry) { return entry.first == stage; });
    if (found != stages_.end()) found->second += seconds;
    else stages_.emplace_back(stage, seconds);
}

double StageTimes::seconds(const std::string& stage) const {
    const auto found = std::find_if(stages_.begin(), stages_.end(), [&](const auto& entry) { return entry.first == stage; });
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
