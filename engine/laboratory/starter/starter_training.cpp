// The training loop: single-threaded replicas on their own threads, gradients averaged in a fixed order.
#include "engine/laboratory/starter/starter_training.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <barrier>
#include <cmath>
#include <exception>
#include <mutex>
#include <numbers>
#include <sstream>
#include <thread>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"

namespace gse::training {
namespace {

constexpr double CheckpointSeconds = 180;
constexpr int LogEvery = 50;
constexpr double GradientNormLimit = 1.0;

struct RunState {
    std::int64_t step = 0;
    double seconds = 0;
};

void save_checkpoint(const std::filesystem::path& path, const Stage& stage, torch::optim::AdamW& optimizer,
                     Ema& ema, const RunState& state) {
    torch::serialize::OutputArchive archive;
    archive.write("step", torch::tensor(state.step));
    archive.write("seconds", torch::tensor(state.seconds, torch::kDouble));
    for (std::size_t i = 0; i < stage.replicas[0].size(); ++i) {
        archive.write(fmt::format("p{}", i), stage.replicas[0][i].detach());
        archive.write(fmt::format("e{}", i), ema.values()[i]);
    }
    torch::serialize::OutputArchive moments;
    optimizer.save(moments);
    archive.write("optimizer", moments);
    std::ostringstream bytes;  // an archive that writes its own file does not say why it failed
    archive.save_to(bytes);
    write_file(path, bytes.view());
}

bool load_checkpoint(const std::filesystem::path& path, Stage& stage, torch::optim::AdamW& optimizer,
                     Ema& ema, RunState& state) {
    if (!std::filesystem::exists(path)) return false;
    torch::NoGradGuard no_grad;
    torch::serialize::InputArchive archive;
    archive.load_from(path.string());
    // A tensor per read: reading into one that holds data of another file's tensor fails.
    const auto read = [&](const std::string& name) {
        torch::Tensor value;
        archive.read(name, value);
        return value;
    };
    state.step = read("step").item<std::int64_t>();
    state.seconds = read("seconds").item<double>();
    for (std::size_t i = 0; i < stage.replicas[0].size(); ++i) {
        stage.replicas[0][i].copy_(read(fmt::format("p{}", i)));
        ema.values()[i].copy_(read(fmt::format("e{}", i)));
    }
    torch::serialize::InputArchive moments;
    archive.read("optimizer", moments);
    optimizer.load(moments);
    ema.set_count(state.step);
    return true;
}

/// Adds up the replicas' gradients in replica 0 and divides; the order is fixed, so runs repeat.
void average_gradients(Stage& stage) {
    const double share = 1.0 / static_cast<double>(stage.replicas.size());
    for (std::size_t i = 0; i < stage.replicas[0].size(); ++i) {
        auto& first = stage.replicas[0][i].mutable_grad();
        for (std::size_t r = 1; r < stage.replicas.size(); ++r) {
            auto& other = stage.replicas[r][i].mutable_grad();
            if (!other.defined()) continue;
            if (first.defined()) first.add_(other);
            else first = other.clone();
        }
        if (first.defined() && stage.replicas.size() > 1) first.mul_(share);
    }
}

/// OpenBLAS has its own threads; the replicas are the parallelism here.
void single_thread_blas() {
    at::set_num_threads(1);
    using SetThreads = void (*)(int);
    if (auto* set = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
}

class LogFile {
public:
    LogFile(const std::filesystem::path& path, const std::vector<std::string>& columns) {
        const bool fresh = !std::filesystem::exists(path);
        stream_.open(path, std::ios::app);
        if (!fresh) return;
        stream_ << "step\tseconds\tlr\tgrad_norm";
        for (const auto& column : columns) stream_ << '\t' << column;
        stream_ << std::endl;
    }
    void write(std::int64_t step, double seconds, double lr, double norm, const std::vector<double>& means) {
        stream_ << fmt::format("{}\t{:.1f}\t{:.3g}\t{:.3g}", step, seconds, lr, norm);
        for (const double mean : means) stream_ << fmt::format("\t{:.5g}", mean);
        stream_ << std::endl;
    }

private:
    std::ofstream stream_;
};

/// The state the replica threads share between barriers.
struct Team {
    Stage& stage;
    StageClock& clock;
    const JobControl& job;
    const std::filesystem::path& work;
    torch::optim::AdamW optimizer;
    Ema ema;
    RunState state;
    LogFile log;
    std::vector<std::vector<double>> numbers;  // last numbers of each replica
    std::vector<double> sums;
    int summed = 0;
    double last_checkpoint = 0;
    bool finished = false;
    bool stopped = false;
    std::exception_ptr failure;

    Team(Stage& stage_in, StageClock& clock_in, const JobControl& job_in,
         const std::filesystem::path& work_in)
        : stage(stage_in), clock(clock_in), job(job_in), work(work_in),
          optimizer(stage_in.replicas[0], torch::optim::AdamWOptions(stage_in.peak_lr)
                                              .betas({0.9, 0.98})
                                              .weight_decay(stage_in.weight_decay)),
          ema(stage_in.replicas[0], stage_in.ema_limit),
          log(work_in / (stage_in.name + ".tsv"), stage_in.columns), numbers(stage_in.replicas.size()),
          sums(stage_in.columns.size(), 0.0) {}

    std::filesystem::path checkpoint_path() const { return work / (stage.name + ".ckpt"); }

    void save() {
        state.seconds = clock.seconds();
        save_checkpoint(checkpoint_path(), stage, optimizer, ema, state);
        last_checkpoint = clock.seconds();
    }

    /// One optimizer step on replica 0 and its copy to the others; runs on one thread while the rest wait.
    void step() {
        if (failure) {
            finished = true;
            return;
        }
        torch::NoGradGuard no_grad;
        average_gradients(stage);
        const double lr = clock.learning_rate(stage.peak_lr, state.step);
        for (auto& group : optimizer.param_groups())
            static_cast<torch::optim::AdamWOptions&>(group.options()).lr(lr);
        const double norm = torch::nn::utils::clip_grad_norm_(stage.replicas[0], GradientNormLimit);
        if (std::isfinite(norm)) {
            optimizer.step();
            ema.update(stage.replicas[0]);
        } else {
            log::warning("{}: a non-finite gradient at step {} was skipped", stage.name, state.step);
        }
        for (auto& replica : stage.replicas) {
            if (&replica != &stage.replicas[0]) copy_parameters(stage.replicas[0], replica);
            for (auto& parameter : replica) parameter.mutable_grad().reset();
        }
        ++state.step;
        tell(lr, norm);
    }

    void step_or_fail() {
        try {
            step();
        } catch (...) {
            failure = std::current_exception();
            finished = true;
        }
    }

    void tell(double lr, double norm) {
        for (const auto& values : numbers)
            for (std::size_t i = 0; i < sums.size(); ++i)
                sums[i] += values[i] / static_cast<double>(numbers.size());
        ++summed;
        const double progress = clock.progress(state.step);
        job.report("training " + stage.name, static_cast<int>(progress * 1000), 1000);
        finished = progress >= 1.0;
        stopped = job.stop_requested();
        if (state.step % LogEvery == 0 || finished) {
            for (auto& sum : sums) sum /= summed;
            log.write(state.step, clock.seconds(), lr, norm, sums);
            std::fill(sums.begin(), sums.end(), 0.0);
            summed = 0;
        }
        if (finished || stopped || clock.seconds() - last_checkpoint > CheckpointSeconds) {
            save();
            if (stage.checkpoint) stage.checkpoint(ema.values());
        }
    }
};

}  // namespace

void StageClock::start(double seconds_before) {
    before_ = seconds_before;
    start_ = std::chrono::steady_clock::now();
}

double StageClock::seconds() const {
    return before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double StageClock::progress(std::int64_t step) const {
    const double done =
        steps_ > 0 ? static_cast<double>(step) / steps_ : seconds() / std::max(seconds_, 1e-9);
    return std::min(done, 1.0);
}

double StageClock::learning_rate(double peak, std::int64_t step) const {
    constexpr double warm_up = 0.02;
    const double done = progress(step);
    if (done < warm_up) return peak * std::max(done, 1e-4) / warm_up;
    return peak * 0.5 * (1 + std::cos(std::numbers::pi * (done - warm_up) / (1 - warm_up)));
}

void copy_parameters(const Parameters& from, Parameters& to) {
    torch::NoGradGuard no_grad;
    for (std::size_t i = 0; i < from.size(); ++i) to[i].copy_(from[i]);
}

Ema::Ema(const Parameters& parameters, double limit) : limit_(limit) {
    for (const auto& parameter : parameters) values_.push_back(parameter.detach().clone());
}

void Ema::update(const Parameters& parameters) {
    ++count_;
    const double n = static_cast<double>(count_);
    const double decay = std::min(limit_, (1 + n) / (10 + n));
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i].lerp_(parameters[i].detach(), 1 - decay);
}

void run_stage(Stage& stage, StageClock clock, const std::filesystem::path& work, const JobControl& job) {
    Team team(stage, clock, job, work);
    if (load_checkpoint(team.checkpoint_path(), stage, team.optimizer, team.ema, team.state))
        log::info("{}: resuming at step {}", stage.name, team.state.step);
    for (std::size_t r = 1; r < stage.replicas.size(); ++r)
        copy_parameters(stage.replicas[0], stage.replicas[r]);
    clock.start(team.state.seconds);
    team.last_checkpoint = clock.seconds();
    team.finished = clock.progress(team.state.step) >= 1.0;
    std::barrier barrier(static_cast<std::ptrdiff_t>(stage.replicas.size()));
    std::mutex failure_mutex;
    const auto serve = [&](std::size_t replica) {
        single_thread_blas();
        while (!team.finished && !team.stopped) {
            try {
                auto [loss, values] = stage.loss(replica, team.state.step);
                loss.backward();
                team.numbers[replica] = std::move(values);
            } catch (...) {
                const std::lock_guard lock(failure_mutex);
                if (!team.failure) team.failure = std::current_exception();
            }
            barrier.arrive_and_wait();
            if (replica == 0) team.step_or_fail();
            barrier.arrive_and_wait();
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t replica = 1; replica < stage.replicas.size(); ++replica)
        threads.emplace_back(serve, replica);
    serve(0);
    for (auto& thread : threads) thread.join();
    if (team.failure) std::rethrow_exception(team.failure);
    if (team.stopped && !team.finished)
        throw Error(ErrorCode::Cancelled, "training was stopped", "run the same command again to go on",
                    work);
    copy_parameters(team.ema.values(), stage.replicas[0]);
}

}  // namespace gse::training
