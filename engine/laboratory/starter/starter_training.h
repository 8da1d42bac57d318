// Loop of all training stages: progress by steps or by the clock, averaged replicas, EMA and checkpoints.
#pragma once

#include <torch/torch.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "engine/laboratory/starter/starter_data.h"

namespace gse::neural {}

namespace gse::training {

using namespace neural;

/// Progress of a stage in [0,1], by steps when their number is given and by training time otherwise.
class StageClock {
public:
    StageClock(int steps, double minutes) : steps_(steps), seconds_(minutes * 60) {}
    /// `seconds_before`: training time of earlier, interrupted runs.
    void start(double seconds_before);
    double seconds() const;
    double progress(std::int64_t step) const;
    /// Cosine from `peak` to zero after a linear warm-up over the first 2 %.
    double learning_rate(double peak, std::int64_t step) const;

private:
    int steps_;
    double seconds_;
    double before_ = 0;
    std::chrono::steady_clock::time_point start_{};
};

/// The trainable parts of a stage; every replica holds modules of the same structure.
using Parameters = std::vector<torch::Tensor>;

/// Copies values of `from` into `to`.
void copy_parameters(const Parameters& from, Parameters& to);

/// Exponential moving average of parameters, warmed up: decay = min(limit, (1 + n) / (10 + n)).
class Ema {
public:
    Ema(const Parameters& parameters, double limit);
    void update(const Parameters& parameters);
    Parameters& values() { return values_; }
    void set_count(std::int64_t count) { count_ = count; }

private:
    Parameters values_;
    double limit_;
    std::int64_t count_ = 0;
};

/// One training stage: `replicas` own modules; loss(replica, step) builds the loss of that replica's share of
/// the batch and returns numbers for the log.
struct Stage {
    std::string name;
    std::vector<Parameters> replicas;
    double peak_lr = 1e-3;
    double weight_decay = 0.01;
    double ema_limit = 0.999;
    std::function<std::pair<torch::Tensor, std::vector<double>>(std::size_t replica, std::int64_t step)> loss;
    std::vector<std::string> columns;  // names of the numbers
    /// Called with the averaged weights whenever a checkpoint has been written; may be empty.
    std::function<void(const Parameters& averaged)> checkpoint;
};

/// Runs the stage to its end, resuming from work/<name>.ckpt; leaves the EMA weights in replica 0.
void run_stage(Stage& stage, StageClock clock, const std::filesystem::path& work, const JobControl& job);

}  // namespace gse::training
