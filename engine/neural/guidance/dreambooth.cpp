// DreamBooth's trainer: loss, gradients, AdamW, low-rank factors.
#include "engine/neural/guidance/dreambooth.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "engine/base/random.h"

namespace gse::neural {
namespace {

/// Network of equal structure with the parameters of `source`, in fp32, another type, or each as it is
/// (nullopt). Memory is shared where the type stays and no copy is asked for.
template <class Holder>
Holder twin_of(const Holder& source, bool copy, std::optional<torch::Dtype> dtype = torch::kFloat32) {
    const torch::NoGradGuard no_grad;
    Holder twin(source->config(), WeightOptions{torch::kCPU, torch::kFloat32, false});
    auto to = twin->parameters();
    const auto from = source->parameters();
    for (std::size_t i = 0; i < to.size(); ++i) {
        to[i].set_data(
            from[i].detach().to(dtype.value_or(from[i].scalar_type()), /*non_blocking=*/false, copy));
        to[i].set_requires_grad(false);
    }
    twin->eval();
    return twin;
}

}  // namespace

struct DreamBoothTrainer::Replica {
    /// A layer whose weight is put together from base and factors before every pass.
    struct Adapted {
        Linear linear{nullptr};
        torch::Tensor base, down, up;
        double scale = 1;
    };
    UNet unet{nullptr};
    ClipTextEncoder text{nullptr};
    bool text_is_trained = false;
    std::vector<Adapted> adapted;
    std::vector<torch::Tensor> leaves;

    void adapt(const torch::nn::Module& network, std::vector<LoraFactor>& factors) {
        const auto targets = lora_targets(network);
        for (std::size_t i = 0; i < targets.size(); ++i) {
            // The factors' memory is shared by all replicas; each has leaves, and so gradients, of its own.
            const auto leaf = [&](const torch::Tensor& shared) {
                leaves.push_back(shared.detach().set_requires_grad(true));
                return leaves.back();
            };
            const auto& linear = targets[i].linear;
            const auto down = leaf(factors[i].down);
            adapted.push_back({linear, linear->weight, down, leaf(factors[i].up), factors[i].scale()});
        }
    }
    void assemble() {
        for (auto& layer : adapted) layer.linear->weight = layer.base + layer.up.mm(layer.down) * layer.scale;
    }
    void release() {
        for (auto& layer : adapted) layer.linear->weight = layer.base;
    }
};

DreamBoothTrainer::DreamBoothTrainer(const ModelBundle& bundle, const DreamBoothParameters& parameters)
    : bundle_(bundle), parameters_(parameters), pool_(tuning_threads(parameters, bundle.device)) {
    const bool full = parameters.rank == 0;
    if (!full) {
        lora_.unet =
            new_lora(lora_targets(*bundle.unet), parameters.rank, Random::stream(parameters.seed, 1).next());
        if (parameters.train_text_encoder)
            lora_.text = new_lora(lora_targets(*bundle.text_encoder), parameters.rank,
                                  Random::stream(parameters.seed, 2).next());
    }
    for (unsigned i = 0; i < 2; ++i) {
        auto replica = std::make_unique<Replica>();
        const bool first = i == 0;
        replica->unet = twin_of(first ? bundle.unet : replicas_[0]->unet, first && full);
        replica->text = twin_of(first ? bundle.text_encoder : replicas_[0]->text,
                                first && full && parameters.train_text_encoder);
        replica->text_is_trained = parameters.train_text_encoder;
        if (full) {
            for (const auto& parameter : replica->unet->parameters()) replica->leaves.push_back(parameter);
            if (parameters.train_text_encoder)
                for (const auto& parameter : replica->text->parameters())
                    replica->leaves.push_back(parameter);
            for (auto& leaf : replica->leaves) leaf.set_requires_grad(true);
        } else {
            replica->adapt(*replica->unet, lora_.unet);
            if (parameters.train_text_encoder) replica->adapt(*replica->text, lora_.text);
        }
        replicas_.push_back(std::move(replica));
    }
    optimizer_ = std::make_unique<torch::optim::AdamW>(
        replicas_[0]->leaves,
        torch::optim::AdamWOptions(full ? parameters.learning_rate : parameters.lora_learning_rate)
            .betas({0.9, 0.999})
            .eps(1e-8)
            .weight_decay(parameters.weight_decay));
}

DreamBoothTrainer::~DreamBoothTrainer() = default;

torch::Tensor DreamBoothTrainer::batch_loss(Replica& replica, const TuningBatch& batch) const {
    const auto context = [&] {
        const torch::AutoGradMode recorded(replica.text_is_trained && torch::GradMode::is_enabled());
        return replica.text->forward(batch.ids).last_hidden;
    }();
    const auto size = batch.latents.size(0);
    const auto& schedule = bundle_.schedule;
    const auto noisy = schedule.add_noise(batch.latents, batch.noise, batch.timesteps);
    const auto predicted = replica.unet->forward(noisy, batch.timesteps, context.expand({size, -1, -1}));
    return torch::mse_loss(predicted.to(torch::kFloat32),
                           schedule.target(batch.latents, batch.noise, batch.timesteps));
}

TuningStep DreamBoothTrainer::accumulate(const TuningBatch& instance, const TuningBatch* prior) {
    TuningStep step;
    const std::size_t halves = prior != nullptr ? 2 : 1;
    side_by_side(pool_, halves, [&](std::size_t half) {
        const torch::AutoGradMode recorded(true);
        auto& replica = *replicas_[half];
        for (auto& leaf : replica.leaves) leaf.mutable_grad().reset();
        replica.assemble();
        auto loss = batch_loss(replica, half == 0 ? instance : *prior);
        (half == 0 ? step.instance_loss : step.prior_loss) = loss.item<double>();
        if (half == 1) loss = loss * parameters_.prior_weight;
        loss.backward();
        replica.release();
    });
    step.loss = step.instance_loss + parameters_.prior_weight * step.prior_loss;
    const torch::NoGradGuard no_grad;
    for (std::size_t i = 0; halves == 2 && i < replicas_[0]->leaves.size(); ++i) {
        auto& sum = replicas_[0]->leaves[i].mutable_grad();
        const auto& other = replicas_[1]->leaves[i].grad();
        if (!other.defined()) continue;
        sum = sum.defined() ? sum.add_(other) : other;
    }
    return step;
}

void DreamBoothTrainer::apply(TuningStep& step) {
    const torch::NoGradGuard no_grad;
    auto& leaves = replicas_[0]->leaves;
    const double limit =
        parameters_.max_grad_norm > 0 ? parameters_.max_grad_norm : std::numeric_limits<double>::max();
    step.gradient_norm = torch::nn::utils::clip_grad_norm_(leaves, limit);
    step.skipped = !std::isfinite(step.loss) || !std::isfinite(step.gradient_norm);
    if (!step.skipped) optimizer_->step();
}

TuningStep DreamBoothTrainer::step(const TuningBatch& instance, const TuningBatch* prior) {
    auto result = accumulate(instance, prior);
    apply(result);
    return result;
}

double DreamBoothTrainer::loss_of(const TuningBatch& batch) {
    const torch::NoGradGuard no_grad;
    auto& replica = *replicas_[0];
    replica.assemble();
    const double loss = batch_loss(replica, batch).item<double>();
    replica.release();
    return loss;
}

NamedTensors DreamBoothTrainer::trained() const {
    NamedTensors result;
    const auto& replica = *replicas_[0];
    for (const auto* part : {"unet", "text"}) {
        const bool unet = std::string_view(part) == "unet";
        for (const auto& factor : unet ? lora_.unet : lora_.text) {
            const std::size_t i = result.size();
            result.emplace_back(fmt::format("lora.{}.{}.down", part, factor.layer), replica.leaves[i]);
            result.emplace_back(fmt::format("lora.{}.{}.up", part, factor.layer), replica.leaves[i + 1]);
        }
    }
    if (!result.empty()) return result;
    for (const auto& item : replica.unet->named_parameters())
        result.emplace_back("unet." + item.key(), item.value());
    if (replica.text_is_trained)
        for (const auto& item : replica.text->named_parameters())
            result.emplace_back("text." + item.key(), item.value());
    return result;
}

ModelBundle DreamBoothTrainer::tuned() const {
    if (parameters_.rank > 0) return with_lora(bundle_, lora_, 1);
    ModelBundle result = bundle_;
    result.unet = twin_of(replicas_[0]->unet, false);
    result.text_encoder = twin_of(replicas_[0]->text, false);
    return result;
}

std::optional<LoraWeights> DreamBoothTrainer::lora() const {
    if (parameters_.rank == 0) return std::nullopt;
    return lora_;
}

NamedTensors tuned_weights(const ModelBundle& bundle) {
    NamedTensors tensors;
    for (const auto& weight : bundle.unet->named_parameters())
        tensors.emplace_back("unet." + weight.key(), weight.value());
    for (const auto& weight : bundle.text_encoder->named_parameters())
        tensors.emplace_back("text." + weight.key(), weight.value());
    return tensors;
}

ModelBundle with_weights(const ModelBundle& bundle, const SafetensorsFile& file) {
    ModelBundle result = bundle;
    result.unet = twin_of(bundle.unet, true);
    result.text_encoder = twin_of(bundle.text_encoder, true);
    const torch::NoGradGuard no_grad;
    for (const auto& [name, weight] : tuned_weights(result)) file.copy_to(name, weight);
    return result;
}

ModelBundle with_lora(const ModelBundle& bundle, const LoraWeights& weights, double strength) {
    ModelBundle result = bundle;
    result.unet = twin_of(bundle.unet, false, std::nullopt);
    result.text_encoder = twin_of(bundle.text_encoder, false, std::nullopt);
    merge_lora(*result.unet, weights.unet, strength);
    merge_lora(*result.text_encoder, weights.text, strength);
    return result;
}

}  // namespace gse::neural
