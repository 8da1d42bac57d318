// Settings and report of DreamBooth (Ruiz et al. 2023; GSEditPro 3.2), without any torch type.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/fields.h"

namespace gse::neural {

/// Defaults suit the starter model and a minute on two cores. A Stable Diffusion model wants the values in
/// brackets.
struct DreamBoothParameters {
    int steps = 200;
    int batch = 2;
    int class_images = 24;
    int class_steps = 20;
    double class_guidance = 5;
    double prior_weight = 1;
    int rank = 0;
    double learning_rate = 2e-4;
    double lora_learning_rate = 2e-3;
    bool train_text_encoder = true;
    double max_grad_norm = 1;
    double weight_decay = 0.01;
    int threads = 0;
    std::uint64_t seed = 0;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("steps", self.steps,
          "Optimisation steps (SD: 400 with prior preservation; more than 800 overfits).", Range{0, 1e6});
        f("batch", self.batch,
          "Pictures of the scene per step, and as many of the class (SD: 4, or 1 on small machines).",
          Range{1, 256});
        f("class_images", self.class_images,
          "Pictures drawn from the untouched model with the edit prompt, to keep what it knows; 0 = none "
          "(SD: 200).",
          Range{0, 1e5});
        f("class_steps", self.class_steps, "Sampling steps of each of them (SD: 50).", Range{1, 1000});
        f("class_guidance", self.class_guidance, "Classifier-free guidance of each of them (SD: 7.5).",
          Range{0, 100});
        f("prior_weight", self.prior_weight, "Weight of keeping them; 0 = no prior preservation (paper: 1).",
          Range{0, 1e3});
        f("rank", self.rank,
          "0 = tune all weights; above: LoRA of this rank on the attention projections (SD: 4 to 16).",
          Range{0, 1024});
        f("learning_rate", self.learning_rate, "Learning rate when all weights are tuned (SD: 5e-6).",
          Range{0, 1});
        f("lora_learning_rate", self.lora_learning_rate, "Learning rate of a LoRA (SD: 5e-4).", Range{0, 1});
        f("train_text_encoder", self.train_text_encoder,
          "Tune the text encoder too, which a noun the model does not know needs (SD: off in the paper's "
          "sources).");
        f("max_grad_norm", self.max_grad_norm,
          "Longest gradient; longer ones are scaled down to it, 0 = no limit.", Range{0, 1e6});
        f("weight_decay", self.weight_decay, "Weight decay of AdamW.", Range{0, 1});
        f("threads", self.threads,
          "Scene and class pictures side by side on the CPU: 2, one after the other: 1, 0 = by the "
          "number of cores. The result is the same.",
          Range{0, 2});
        f("seed", self.seed, "Seed of class pictures, noise and order.");
    }
};

/// Report of a tuning. Losses are mean squared errors of the prediction, "before" and "after" over equal
/// noise.
struct TuneReport {
    int steps = 0;
    int skipped = 0;  // of them: those whose loss or gradient was not finite, which were left out
    double class_seconds = 0, seconds = 0;  // drawing the class pictures; all together
    double instance_before = 0, instance_after = 0;
    double prior_before = 0, prior_after = 0;           // 0 without class pictures
    std::vector<double> instance_losses, prior_losses;  // per step
};

}  // namespace gse::neural
