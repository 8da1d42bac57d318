// Settings of the SDS guidance (score distillation, GSEditPro eq. 3), without any torch type.
#pragma once

#include <string>

#include "engine/base/fields.h"
#include "engine/edit/request/field_use.h"

namespace gse::neural {

/// Timesteps are shares of the training schedule: 0 = clean, 1 = pure noise.
struct SdsParameters {
    double t_min = 0.02;
    double t_max_start = 0.98;
    double t_max_end = 0.8;
    double guidance_scale = 4;
    double view_guidance_scale = 3;
    double shape_guidance_scale = 2;
    bool restyle = true;
    bool plain_ground = true;
    double restyle_guidance_scale = 1.5;
    double image_guidance_scale = 1;
    double clamp = 1.0;
    double weight = 1.0;
    bool sample_posterior = true;
    bool view_words = true;
    std::string negative_prompt;
    std::string before_prompt;
    double delta = 0.5;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("t_min", self.t_min, edit::of_gradient("Lowest noise level, as a share of the schedule."),
          Range{0, 1});
        f("t_max_start", self.t_max_start, edit::of_gradient("Highest noise level at the first iteration."),
          Range{0, 1});
        f("t_max_end", self.t_max_end, edit::of_gradient("Highest noise level at the last iteration."),
          Range{0, 1});
        f("guidance_scale", self.guidance_scale,
          edit::of_gradient("Classifier-free guidance: 1 = none, higher follows the prompt harder. Stable "
                            "Diffusion works best "
                            "from "
                            "7.5 on."),
          Range{0, 200});
        f("view_guidance_scale", self.view_guidance_scale,
          edit::of_views("Classifier-free guidance of redrawn views (method views)."), Range{0, 200});
        f("shape_guidance_scale", self.shape_guidance_scale,
          edit::of_views("Classifier-free guidance of redrawn views that show a new shape."), Range{0, 200});
        f("restyle", self.restyle,
          edit::of_views("Draw another colour, material or ground with the network that is shown the scene, "
                         "if the model "
                         "has "
                         "one. If its pictures hardly show the edit, the model itself draws them."));
        f("plain_ground", self.plain_ground,
          "Show objects in empty space to that network on a plain ground. Objects that stand alone there "
          "follow, if pictures of the scene hardly show the edit.");
        f("restyle_guidance_scale", self.restyle_guidance_scale,
          edit::of_views(
              "Classifier-free guidance of a model that is shown the scene, for another colour, material or "
              "ground."),
          Range{0, 200});
        f("image_guidance_scale", self.image_guidance_scale,
          "InstructPix2Pix: how closely the picture is kept to the unedited one. 1 = fast, with two thirds "
          "of the work; 1.5 is usual "
          "with it; below 1 turns all guidance off.",
          Range{0, 20});
        f("clamp", self.clamp, edit::of_gradient("Largest absolute gradient per latent value; 0 = no limit."),
          Range{0, 1e6});
        f("weight", self.weight, edit::of_gradient("Factor of the whole guidance gradient."), Range{0, 1e6});
        f("sample_posterior", self.sample_posterior,
          edit::of_gradient("Sample the VAE's latent distribution instead of taking its mean."));
        f("view_words", self.view_words,
          "Append \"front view\", \"side view\" or \"back view\" to the prompt.");
        f("negative_prompt", self.negative_prompt, "Things that the picture should not show.");
        f("before_prompt", self.before_prompt,
          edit::of_gradient("Sentence about the scene before the edit; follows from the prompt when empty."));
        f("delta", self.delta,
          edit::of_gradient(
              "Share of the pull on the unedited scene under its own sentence that is subtracted. It holds "
              "changes "
              "that the model would make anyway, and noise. 0 = plain score distillation, at half the cost."),
          Range{0, 1});
    }
};

}  // namespace gse::neural
