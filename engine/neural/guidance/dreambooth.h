// DreamBooth with prior preservation (Ruiz et al. 2023) on a loaded model: all weights, or a LoRA.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/answer_cache.h"
#include "engine/base/image.h"
#include "engine/base/progress.h"
#include "engine/base/thread_pool.h"
#include "engine/neural/api/dreambooth_parameters.h"
#include "engine/neural/diffusion/model_bundle.h"
#include "engine/neural/weights/lora.h"
#include "engine/neural/weights/safetensors.h"

namespace gse::neural {

/// Threads that a tuning uses: one for the scene's half of a batch, one for the class's.
unsigned tuning_threads(const DreamBoothParameters& parameters, const torch::Device& device);
/// body(i) for i in [0, count) on the pool. With several threads each operation of torch stays on one.
void side_by_side(ThreadPool& pool, std::size_t count, const std::function<void(std::size_t)>& body);

/// Half of a step's batch: the pictures of the scene, or those of the class.
struct TuningBatch {
    torch::Tensor ids;        // [1 or B,T] int64
    torch::Tensor latents;    // [B,C,h,w] scaled
    torch::Tensor noise;      // [B,C,h,w]
    torch::Tensor timesteps;  // [B] int64
};

struct TuningStep {
    double loss = 0, instance_loss = 0, prior_loss = 0;
    double gradient_norm = 0;  // before it is limited
    bool skipped = false;      // something was not finite: the weights stay as they were
};

/// Optimises a copy of a model's UNet and text encoder; the model itself is never written to.
class DreamBoothTrainer {
public:
    DreamBoothTrainer(const ModelBundle& bundle, const DreamBoothParameters& parameters);
    ~DreamBoothTrainer();

    /// Losses and gradients of mean squared error(instance) + prior weight * mean squared error(prior);
    /// `prior` may be null.
    TuningStep accumulate(const TuningBatch& instance, const TuningBatch* prior);
    /// Limits the gradient and takes one AdamW step, or marks the step as skipped.
    void apply(TuningStep& step);
    TuningStep step(const TuningBatch& instance, const TuningBatch* prior);
    /// Loss of one batch without a graph.
    double loss_of(const TuningBatch& batch);

    /// Trained parameters by name: "unet.conv_in.weight", "text.text_model...", "lora.unet.<layer>.down".
    NamedTensors trained() const;
    /// The model with the weights reached so far. With all weights tuned it shares them with the trainer.
    ModelBundle tuned() const;
    /// The low-rank factors; none when all weights are tuned.
    std::optional<LoraWeights> lora() const;

private:
    struct Replica;
    torch::Tensor batch_loss(Replica& replica, const TuningBatch& batch) const;

    const ModelBundle bundle_;
    DreamBoothParameters parameters_;
    LoraWeights lora_;
    // One per half of the batch: the same weights, gradients of its own.
    std::vector<std::unique_ptr<Replica>> replicas_;
    std::unique_ptr<torch::optim::AdamW> optimizer_;
    ThreadPool pool_;
};

/// Counts a step in the report. Throws Error (Model) as soon as most of the `planned` steps were not finite:
/// what little was learned from the others is of no use.
void count_step(TuneReport& report, const TuningStep& step, int planned);

/// Pictures and prompts that a model learns from.
struct TuningTask {
    std::span<const Image> instance;
    std::string instance_prompt, class_prompt;
    AnswerCache* cache = nullptr;  // of pictures of the class that this model drew before; may be null
};

struct TuningResult {
    std::shared_ptr<const ModelBundle> bundle;
    std::optional<LoraWeights> lora;
    TuneReport report;
};

/// Draws the class pictures, then tunes. Throws Error (Cancelled) on a stop request, (InvalidArgument)
/// without pictures. One seed gives one set of weights, whatever the number of threads.
TuningResult run_dreambooth(const ModelBundle& bundle, const DreamBoothParameters& parameters,
                            const TuningTask& task, const JobControl& job);

/// A copy of the model with a LoRA merged in.
ModelBundle with_lora(const ModelBundle& bundle, const LoraWeights& weights, double strength);

/// All weights of the UNet and the text encoder, as they are; and a copy of the model with such weights. A
/// file that lacks one is refused: throws Error (Model).
NamedTensors tuned_weights(const ModelBundle& bundle);
ModelBundle with_weights(const ModelBundle& bundle, const SafetensorsFile& file);

}  // namespace gse::neural
