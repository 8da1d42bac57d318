// Measures a model's image-text encoder on held-out synthetic scenes: does it tell words apart, and do
// picture changes point where sentence changes point?
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/edit/interfaces/image_text_encoder.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::bench {

struct ClipBenchParameters {
    int scenes = 60;
    int views = 6;
    int image_size = 96;
    std::uint64_t seed = 2000;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("scenes", self.scenes, "Held-out scenes.", Range{1, 100000});
        f("views", self.views, "Views all around over which a change is averaged.", Range{1, 360});
        f("image_size", self.image_size, "Side of the pictures.", Range{16, 2048});
        f("seed", self.seed, "Seed of the scenes.");
    }
};

/// Report of the bench:
/// "retrieval": share of pictures whose true word ranks first, per kind of word;
/// "direction": cosines of true changes, wrong changes and no change;
/// "fronts": distance of the front that was read off each scene from the true one.
nlohmann::ordered_json bench_clip(edit::ImageTextEncoder& score, const ClipBenchParameters& parameters,
                                  const JobControl& job);

}  // namespace gse::bench
