// How long the parts of a run took, and what they asked of the networks.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/neural/api/network_use.h"

namespace gse::pipeline {

/// "144 UNet, 16 encoder and 16 decoder passes, 0.17 TFLOP", and how many answers were read from the cache
/// instead.
std::string use_text(const neural::NetworkUse& use);

/// Seconds and network passes per stage, in order of first use. A stage begins and ends on one thread.
class StageTimes {
public:
    void begin(const std::string& stage);
    void end();
    void add(const std::string& stage, double seconds);
    nlohmann::ordered_json to_json() const;
    double seconds(const std::string& stage) const;  // 0 = it did not run
    /// Passes over single pictures and 10^12 operations, per stage that asked for any and in total; "cached":
    /// answers read from the disk instead, where there were any.
    nlohmann::ordered_json networks_json() const;
    neural::NetworkUse networks() const;  // of all stages
    neural::NetworkUse networks(const std::string& stage) const;

private:
    std::vector<std::pair<std::string, double>> stages_;
    std::vector<std::pair<std::string, neural::NetworkUse>> networks_;
    std::string open_;
    double start_ = 0;
    neural::NetworkUse start_use_;
};

}  // namespace gse::pipeline
