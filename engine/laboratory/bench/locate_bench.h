// gseditpro-lab bench locate: how well searches find the true splats, against what they ask of the networks
// and how long they take.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/fields.h"
#include "engine/laboratory/bench/charts/subject.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

struct LocateBenchParameters {
    int scenes = 10;
    std::uint64_t seed = 1;
    std::string kinds = "recolour material ground";
    std::string views = "6 12 48";
    std::string repeats = "2 4";
    std::string levels = "0.1; 0.2; 0.5; 0.3 0.6; 0.3 0.5 0.7";
    std::string img2img = "4 12";
    bool parts = true;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("scenes", self.scenes, "Held-out scenes with a sentence each, searched once per point.",
          Range{1, 10000});
        f("seed", self.seed, "Seed of the suite: which sentences, and the scenes' shapes.");
        f("kinds", self.kinds,
          "Kinds of sentences about things that are there, in turn: recolour material ground replace.");
        f("views", self.views, "Points with that many viewpoints.");
        f("repeats", self.repeats, "Points with that many attention passes per view.");
        f("levels", self.levels,
          "Points with other noise levels, shares of the schedule; sets of them with ; between.");
        f("img2img", self.img2img,
          "Points that look the paper's way, in an image-to-image run of that many steps; empty = none.");
        f("parts", self.parts,
          "Points without the second look, without moving in on what was found, and with refined maps.");
    }
};

/// Searches every scene as a user begins (scene and words; automatic views): once with the settings as they
/// are, and once per point with one of them changed. The error is 1 - IoU of the labelled splats with the
/// true ones, weighted by how much each is seen, mean over the scenes. A search that labels nothing has an
/// IoU of 0. Throws Error for wrong parameters, a model that cannot be read, and when stopped.
Subject bench_locate(const LocateBenchParameters& parameters, const pipeline::EditRecipe& settings,
                     const JobControl& job);

}  // namespace gse::bench
