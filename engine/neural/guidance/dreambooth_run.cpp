// A DreamBooth run: class pictures from the untouched model, order of pictures, noise, report.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <thread>

#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/neural/api/network_use.h"
#include "engine/neural/diffusion/pipelines.h"
#include "engine/neural/guidance/dreambooth.h"
#include "engine/neural/layers/images.h"

namespace gse::neural {
namespace {

// Class pictures sampled at once; fixed, so that threads change nothing.
constexpr std::int64_t ClassBatch = 4;
constexpr std::int64_t ProbeCount = 16;  // noise levels of the losses before and after
constexpr std::int64_t ProbeBatch = 4;

// Streams of the tuning's seed; 1 and 2 belong to the low-rank factors.
constexpr std::uint64_t ClassStream = 3, InstanceStream = 4, PriorStream = 5, ProbeStream = 6;

/// Puts the calling thread's number of operation threads back.
class OperationThreads {
public:
    OperationThreads() : before_(at::get_num_threads()) {}
    ~OperationThreads() {
        if (at::get_num_threads() != before_) at::set_num_threads(before_);
    }
    OperationThreads(const OperationThreads&) = delete;
    OperationThreads& operator=(const OperationThreads&) = delete;

private:
    int before_;
};

/// Pictures as the VAE sees them: a distribution each, and the prompt they share.
struct EncodedPictures {
    torch::Tensor ids;              // [1,T]
    torch::Tensor mean, deviation;  // [N,C,h,w] scaled

    std::int64_t count() const { return mean.size(0); }
};

EncodedPictures encode_instance(const ModelBundle& bundle, const TuningTask& task) {
    const torch::NoGradGuard no_grad;
    std::vector<torch::Tensor> means, deviations;
    for (const auto& picture : task.instance) {
        const auto image = resize_square(to_tensor(picture, bundle.device), bundle.image_size());
        const auto moments = bundle.vae->encode_moments(image * 2 - 1);
        means.push_back(moments.mean * bundle.scaling_factor());
        deviations.push_back((moments.logvar * 0.5).exp() * bundle.scaling_factor());
    }
    return {bundle.token_ids({task.instance_prompt}), torch::cat(means), torch::cat(deviations)};
}

[[noreturn]] void stop_here() { throw Error(ErrorCode::Cancelled, "the tuning was stopped"); }

/// The class pictures stay latents: decoding and encoding them again would only blur them.
class ClassPictures {
public:
    /// `cache` may be null.
    ClassPictures(const ModelBundle& bundle, const DreamBoothParameters& parameters,
                  const std::string& prompt, AnswerCache* cache)
        : bundle_(bundle), parameters_(parameters), sampler_steps_(parameters.class_steps), prompt_(prompt),
          cache_(cache), context_(bundle.encode_prompts({"", prompt})), ids_(bundle.token_ids({prompt})) {}

    EncodedPictures draw(ThreadPool& pool, const JobControl& job) {
        const std::int64_t batches = (parameters_.class_images + ClassBatch - 1) / ClassBatch;
        std::vector<torch::Tensor> latents(static_cast<std::size_t>(batches));
        const auto team = static_cast<std::int64_t>(pool.thread_count());
        for (std::int64_t first = 0; first < batches; first += team) {
            job.report("class pictures", static_cast<int>(first * ClassBatch), parameters_.class_images);
            const auto count = std::min(team, batches - first);
            side_by_side(pool, static_cast<std::size_t>(count), [&](std::size_t i) {
                const auto index = first + static_cast<std::int64_t>(i);
                latents[static_cast<std::size_t>(index)] = cached_sample(index, job);
            });
            if (job.stop_requested()) stop_here();
        }
        job.report("class pictures", parameters_.class_images, parameters_.class_images);
        thread_use().cached += found_;
        auto all = torch::cat(latents);
        if (!torch::isfinite(all).all().item<bool>())
            throw Error(ErrorCode::Model, "a picture drawn from the model is not finite",
                        "its weights are damaged", bundle_.path);
        return {ids_, all, torch::zeros_like(all)};
    }

private:
    /// Pictures in the batch with this number.
    std::int64_t size_of(std::int64_t index) const {
        return std::min(ClassBatch, parameters_.class_images - index * ClassBatch);
    }

    torch::Tensor cached_sample(std::int64_t index, const JobControl& job) {
        if (cache_ == nullptr) return sample(index, job);
        const auto side = bundle_.latent_size();
        const auto question =
            fmt::format("pictures of the class\n{}\n{} steps, guidance {}, seed {}, batch {} of {}", prompt_,
                        sampler_steps_, parameters_.class_guidance, parameters_.seed, index, size_of(index));
        auto latents = torch::empty({size_of(index), bundle_.latent_channels(), side, side}, torch::kFloat32);
        if (const auto answer = cache_->find(question); answer && answer->size() == latents.nbytes()) {
            std::copy(answer->begin(), answer->end(), static_cast<char*>(latents.data_ptr()));
            ++found_;
            return latents.to(bundle_.device);
        }
        const auto drawn = sample(index, job);
        if (job.stop_requested()) return drawn;  // it is not finished
        latents.copy_(drawn);
        if (torch::isfinite(latents).all().item<bool>())
            cache_->keep(question, {static_cast<const char*>(latents.data_ptr()), latents.nbytes()});
        return drawn;
    }

    torch::Tensor sample(std::int64_t index, const JobControl& job) const {
        const torch::NoGradGuard no_grad;
        const auto side = bundle_.latent_size();
        const auto size = size_of(index);
        const auto sampler = make_sampler(SamplerKind::Ddim, bundle_.schedule, sampler_steps_);
        auto latents = seeded_noise({size, bundle_.latent_channels(), side, side},
                                    Random::stream(Random::stream(parameters_.seed, ClassStream).next(),
                                                   static_cast<std::uint64_t>(index))
                                        .next())
                           .to(bundle_.device);
        const auto context = torch::cat({context_.narrow(0, 0, 1).expand({size, -1, -1}),
                                         context_.narrow(0, 1, 1).expand({size, -1, -1})});
        for (std::int64_t i = 0; i < sampler->step_count() && !job.stop_requested(); ++i) {
            const auto t = torch::full({1}, sampler->timestep(i), torch::kFloat32);
            const auto output = bundle_.unet->forward(torch::cat({latents, latents}), t, context);
            latents = sampler->step(guided(output, parameters_.class_guidance), latents, i, {});
        }
        return latents;
    }

    const ModelBundle& bundle_;
    const DreamBoothParameters& parameters_;
    std::int64_t sampler_steps_;
    std::string prompt_;
    AnswerCache* cache_;
    std::atomic<std::uint64_t> found_ = 0;  // batches that were drawn before
    torch::Tensor context_, ids_;
};

/// All pictures in a random order, then all again in another.
class Order {
public:
    Order(std::int64_t count, std::uint64_t seed) : random_(seed), rows_(static_cast<std::size_t>(count)) {
        std::iota(rows_.begin(), rows_.end(), std::int64_t{0});
    }
    std::int64_t next() {
        if (at_ == 0)
            for (std::size_t i = rows_.size(); i > 1; --i) std::swap(rows_[i - 1], rows_[random_.below(i)]);
        const auto row = rows_[at_];
        at_ = (at_ + 1) % rows_.size();
        return row;
    }

private:
    Random random_;
    std::vector<std::int64_t> rows_;
    std::size_t at_ = 0;
};

/// The batches of one half, all from one seed.
class BatchSource {
public:
    BatchSource(const ModelBundle& bundle, EncodedPictures pictures, std::uint64_t seed)
        : bundle_(bundle), pictures_(std::move(pictures)), seed_(seed), order_(pictures_.count(), seed) {}

    TuningBatch batch(int step, std::int64_t size) {
        Random random = Random::stream(seed_, static_cast<std::uint64_t>(step) + 1);
        std::vector<std::int64_t> rows, timesteps;
        for (std::int64_t i = 0; i < size; ++i) {
            rows.push_back(order_.next());
            timesteps.push_back(static_cast<std::int64_t>(
                random.below(static_cast<std::uint64_t>(bundle_.schedule.steps()))));
        }
        return make(rows, timesteps, random);
    }

    /// Losses for the report: fixed pictures and noise at evenly spaced levels.
    std::vector<TuningBatch> probes() const {
        std::vector<TuningBatch> batches;
        Random random(seed_ ^ ProbeStream);
        for (std::int64_t first = 0; first < ProbeCount; first += ProbeBatch) {
            std::vector<std::int64_t> rows, timesteps;
            for (std::int64_t i = first; i < first + ProbeBatch; ++i) {
                rows.push_back(i % pictures_.count());
                timesteps.push_back((2 * i + 1) * bundle_.schedule.steps() / (2 * ProbeCount));
            }
            batches.push_back(make(rows, timesteps, random));
        }
        return batches;
    }

private:
    TuningBatch make(const std::vector<std::int64_t>& rows, const std::vector<std::int64_t>& timesteps,
                     Random& random) const {
        const auto index = torch::tensor(rows, torch::kInt64).to(bundle_.device);
        const auto mean = pictures_.mean.index_select(0, index);
        const auto noise = [&] { return seeded_noise(mean.sizes(), random.next()).to(bundle_.device); };
        const auto latents = mean + pictures_.deviation.index_select(0, index) * noise();
        return {pictures_.ids, latents, noise(), torch::tensor(timesteps, torch::kInt64)};
    }

    const ModelBundle& bundle_;
    EncodedPictures pictures_;
    std::uint64_t seed_;
    Order order_;
};

double mean_loss(DreamBoothTrainer& trainer, const std::vector<TuningBatch>& batches) {
    double sum = 0;
    for (const auto& batch : batches) sum += trainer.loss_of(batch);
    return sum / static_cast<double>(batches.size());
}

void check_task(const ModelBundle& bundle, const TuningTask& task) {
    if (task.instance.empty())
        throw Error(ErrorCode::InvalidArgument, "there are no pictures to learn from",
                    "render at least one view");
    for (const auto& picture : task.instance)
        if (picture.channels != 3 || picture.pixel_count() == 0 ||
            std::any_of(picture.data.begin(), picture.data.end(), [](float v) { return !std::isfinite(v); }))
            throw Error(ErrorCode::InvalidArgument,
                        "a picture to learn from is empty or holds values that are not finite", {},
                        bundle.path);
}

/// Steps, report and stop requests; `prior` may be null.
void run_steps(DreamBoothTrainer& trainer, BatchSource& instance, BatchSource* prior, TuneReport& report,
               const DreamBoothParameters& parameters, const JobControl& job) {
    for (int step = 0; step < parameters.steps; ++step) {
        if (job.stop_requested()) stop_here();
        const auto scene_half = instance.batch(step, parameters.batch);
        const auto class_half = prior != nullptr ? prior->batch(step, parameters.batch) : TuningBatch{};
        const auto result = trainer.step(scene_half, prior != nullptr ? &class_half : nullptr);
        report.instance_losses.push_back(result.instance_loss);
        if (prior != nullptr) report.prior_losses.push_back(result.prior_loss);
        count_step(report, result, parameters.steps);
        job.report("tuning", step + 1, parameters.steps);
    }
    if (report.skipped > 0)
        log::warning("{} of {} tuning steps were not finite and were left out", report.skipped, report.steps);
}

}  // namespace

void count_step(TuneReport& report, const TuningStep& step, int planned) {
    ++report.steps;
    report.skipped += step.skipped ? 1 : 0;
    if (2 * report.skipped <= planned) return;
    throw Error(ErrorCode::Model,
                fmt::format("{} of the first {} tuning steps were not finite: the model learns nothing",
                            report.skipped, report.steps),
                "use a lower learning rate, or train_text_encoder off");
}

unsigned tuning_threads(const DreamBoothParameters& parameters, const torch::Device& device) {
    if (!device.is_cpu()) return 1;
    if (parameters.threads > 0) return static_cast<unsigned>(parameters.threads);
    return std::thread::hardware_concurrency() > 1 ? 2 : 1;
}

void side_by_side(ThreadPool& pool, std::size_t count, const std::function<void(std::size_t)>& body) {
    const OperationThreads restore;
    pool.parallel_for(count, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        if (pool.thread_count() > 1 && at::get_num_threads() != 1) at::set_num_threads(1);
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

TuningResult run_dreambooth(const ModelBundle& bundle, const DreamBoothParameters& parameters,
                            const TuningTask& task, const JobControl& job) {
    if (bundle.kind != BundleKind::Plain)
        throw Error(ErrorCode::Unsupported,
                    fmt::format("a model of the kind \"{}\" cannot learn a scene", kind_name(bundle.kind)),
                    is_few_step(bundle.kind)
                        ? "let the plain model learn it, with the few steps as a LoRA (--lora)"
                        : "leave DreamBooth off: it sees the scene",
                    bundle.path);
    check_task(bundle, task);
    const double start = wall_seconds();
    TuneReport report;
    BatchSource instance(bundle, encode_instance(bundle, task),
                         Random::stream(parameters.seed, InstanceStream).next());
    std::optional<BatchSource> prior;
    if (parameters.prior_weight > 0 && parameters.class_images > 0) {
        ThreadPool pool(tuning_threads(parameters, bundle.device));
        prior.emplace(bundle,
                      ClassPictures(bundle, parameters, task.class_prompt, task.cache).draw(pool, job),
                      Random::stream(parameters.seed, PriorStream).next());
        report.class_seconds = wall_seconds() - start;
    }
    DreamBoothTrainer trainer(bundle, parameters);
    const auto instance_probes = instance.probes();
    const auto prior_probes = prior ? prior->probes() : std::vector<TuningBatch>{};
    const auto measure = [&](double& instance_loss, double& prior_loss) {
        instance_loss = mean_loss(trainer, instance_probes);
        if (prior) prior_loss = mean_loss(trainer, prior_probes);
    };
    measure(report.instance_before, report.prior_before);
    run_steps(trainer, instance, prior ? &*prior : nullptr, report, parameters, job);
    measure(report.instance_after, report.prior_after);
    if (!std::isfinite(report.instance_after) || !std::isfinite(report.prior_after))
        throw Error(ErrorCode::Model, "the tuning ended in values that are not finite",
                    "use a lower learning rate", bundle.path);
    report.seconds = wall_seconds() - start;
    return {std::make_shared<const ModelBundle>(trainer.tuned()), trainer.lora(), report};
}

}  // namespace gse::neural
