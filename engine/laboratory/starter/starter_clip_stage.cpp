// Trains the image-text encoder.
// Pictures and sentences: symmetric InfoNCE (Radford et al. 2021). Sentences that are true of another picture
// do not count against it.
// Changes: the difference of two twins' pictures points where the difference of their sentences points
// (directional CLIP loss, Gal et al. 2022), at right angles to changes of other things.
// Hard negatives: sentences with one word replaced count against a picture's own (Yuksekgonul et al. 2023).
#include <cmath>
#include <limits>

#include "engine/laboratory/starter/starter_clip_batch.h"

namespace gse::training {
namespace {

constexpr double LargestScale = 100;   // of cosines, as in CLIP
constexpr double UnrelatedWeight = 5;  // changes of other things are to be at right angles
constexpr double ChangeScale = 10;     // changes are few and alike: a sharper comparison does not settle

/// Cross-entropy of the diagonal over rows and over columns; blocked cells do not count.
torch::Tensor contrast(const torch::Tensor& scores, const torch::Tensor& blocked) {
    const auto open = scores.masked_fill(blocked, -std::numeric_limits<float>::infinity());
    const auto rows = torch::log_softmax(open, 1).diagonal().mean();
    const auto columns = torch::log_softmax(open, 0).diagonal().mean();
    return -0.5 * (rows + columns);
}

double share_right(const torch::Tensor& scores, const torch::Tensor& blocked) {
    const auto best = scores.masked_fill(blocked, -std::numeric_limits<float>::infinity()).argmax(1);
    return best.eq(torch::arange(best.size(0), best.options())).to(torch::kFloat).mean().item<double>();
}

/// Loss of the sentences with a word replaced, and the share of them that fit their picture less than its
/// own.
struct Told {
    torch::Tensor loss;
    double right = 0;
};

/// Cross-entropy of a picture's sentence beside each of its false ones; `own` [N] cosines of the true pairs.
Told tell_false(const torch::Tensor& pictures, const torch::Tensor& own, const torch::Tensor& sentences,
                const torch::Tensor& of, const torch::Tensor& scale) {
    const auto theirs = (pictures.index_select(0, of) * sentences).sum(1);
    const auto gap = theirs - own.index_select(0, of);
    return {torch::softplus(scale * gap).mean(), gap.detach().lt(0).to(torch::kFloat).mean().item<double>()};
}

std::pair<torch::Tensor, std::vector<double>> batch_loss(const ClipModel& clip,
                                                         const ClipPreprocessing& preprocessing,
                                                         const PairBatch& batch,
                                                         const StarterTrainParameters& weights) {
    const double direction_weight = weights.direction_weight;
    const auto device = clip->logit_scale.device();
    const auto pictures = clip->image_vectors(preprocessing.pixels(batch.pictures.to(device)));
    const auto sentences = clip->text_vectors(batch.ids.to(device));
    const auto scale = clip->logit_scale.clamp_max(std::log(LargestScale)).exp();
    const auto cosines = torch::mm(pictures, sentences.t());
    const auto blocked = batch.blocked.to(device);
    const auto agreement = contrast(scale * cosines, blocked);
    auto loss = agreement;
    Told told{torch::Tensor(), 1};
    if (batch.false_of.numel() > 0 && weights.false_weight > 0) {
        told = tell_false(pictures, cosines.diagonal(), clip->text_vectors(batch.false_ids.to(device)),
                          batch.false_of.to(device), scale);
        loss = loss + weights.false_weight * told.loss;
    }
    double direction = 0;
    if (batch.from.numel() > 0 && direction_weight > 0) {
        const auto from = batch.from.to(device), to = batch.to.to(device);
        const auto change = [&](const torch::Tensor& vectors) {
            return torch::nn::functional::normalize(vectors.index_select(0, to) -
                                                    vectors.index_select(0, from));
        };
        const auto changes = torch::mm(change(pictures), change(sentences).t());
        const auto unrelated = batch.unrelated.to(device).to(torch::kFloat);
        const auto mixed = (changes.square() * unrelated).sum() / unrelated.sum().clamp_min(1.0);
        loss = loss + direction_weight * (contrast(ChangeScale * changes, batch.same_change.to(device)) +
                                          (1 - changes.diagonal()).mean() + UnrelatedWeight * mixed);
        direction = changes.diagonal().mean().item<double>();
    }
    return {loss,
            {loss.item<double>(), agreement.item<double>(), share_right(cosines.detach(), blocked), direction,
             told.right}};
}

}  // namespace

void train_clip(ClipModel& clip, const ClipTraining& training, const std::filesystem::path& work,
                const JobControl& job) {
    const auto& parameters = training.parameters;
    const torch::Device device(parameters.device);
    ClipPreprocessing preprocessing;
    preprocessing.size = clip->config().vision.image_size;
    const PairBatchMaker batches(training);
    std::vector<ClipModel> replicas{clip};
    for (int r = 1; r < parameters.threads; ++r) replicas.emplace_back(clip->config());
    Stage stage;
    stage.name = "clip";
    stage.peak_lr = parameters.clip_lr;
    stage.columns = {"loss", "contrast", "right", "direction", "told"};
    for (auto& replica : replicas) {
        replica->to(device);
        stage.replicas.push_back(replica->parameters());
    }
    stage.loss = [&](std::size_t r, std::int64_t step) {
        Random random =
            Random::stream(parameters.seed * 3 + 4, static_cast<std::uint64_t>(step) * replicas.size() + r);
        return batch_loss(replicas[r], preprocessing, batches.make(random), parameters);
    };
    ClipModel averaged(clip->config());
    auto averaged_parameters = averaged->parameters();
    // The unfinished encoder can be tried while the training goes on.
    stage.checkpoint = [&](const Parameters& values) {
        copy_parameters(values, averaged_parameters);
        export_clip(averaged, work / "preview/clip");
    };
    run_stage(stage, StageClock(parameters.clip_steps, parameters.clip_minutes), work, job);
}

}  // namespace gse::training
