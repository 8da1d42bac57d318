// Settings of the attention maps (GSEditPro 3.2; DAAM), without any torch type.
#pragma once

#include <string>

#include "engine/base/fields.h"

namespace gse::neural {

struct AttentionParameters {
    std::string method = "probes";
    std::string levels;
    int refinement = 0;
    double strength = 0.75;
    int steps = 50;
    double guidance_scale = 7.5;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("method", self.method,
          "probes: noise the image to a few levels and look once at each; img2img: the paper's way, look at "
          "every step of "
          "an image-to-image run (some hundred times slower).");
        f("levels", self.levels,
          "probes: noise levels looked at, as shares of the schedule (\"0.3 0.5 0.7\"); empty = what the "
          "model states. For what "
          "the "
          "scene shows: where something is added, the model's own count.");
        f("refinement", self.refinement,
          "How often the maps are spread along the self-attention of the same passes, which keeps to what "
          "looks alike; 0 = "
          "never.",
          Range{0, 4});
        f("strength", self.strength, "img2img: share of the steps that are run.", Range{0.02, 1});
        f("steps", self.steps, "img2img: sampling steps.", Range{1, 1000});
        f("guidance_scale", self.guidance_scale, "img2img: classifier-free guidance.", Range{0, 100});
    }
};

}  // namespace gse::neural
