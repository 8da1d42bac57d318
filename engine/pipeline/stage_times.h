// How long the parts of a run took.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace gse::pipeline {

/// Seconds per stage, in order of first use.
class StageTimes {
public:
    void begin(const std::string& stage);
    void end();
    void add(const std::string& stage, double seconds);
    nlohmann::ordered_json to_json() const;
    double seconds(const std::string& stage) const;   // 0 = it did not run

private:
    std::vector<std::pair<std::string, double>> stages_;
    std::string open_;
    double start_ = 0;
};

}  // namespace gse::pipeline
