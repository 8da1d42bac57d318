// gseditpro-lab bench heal: removed things of generated scenes against the true scenes without them.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/heal/heal.h"
#include "engine/laboratory/bench/charts/subject.h"

namespace gse::bench {

struct HealBenchParameters {
    std::string kinds = "all";
    int seeds = 3;
    std::uint64_t seed = 1;
    int splats = 12000;
    int capture_views = 60;
    int views = 6;
    int size = 256;
    double missed = 0;
    std::string scan, up = "0 -1 0", place = "0 0 0";
    double thing_size = 0.5;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("kinds", self.kinds, "Kinds of scenes, or all.");
        f("seeds", self.seeds, "Scenes of a kind.", Range{1, 1000});
        f("seed", self.seed, "Seed of the first scene.");
        f("splats", self.splats, "Splats of a scene.", Range{1000, 2e6});
        f("capture_views", self.capture_views,
          "Views that the scan was made from; what none shows is missing.", Range{4, 1000});
        f("views", self.views, "Other views that the figures are of.", Range{1, 100});
        f("size", self.size, "Side of the pictures, pixels.", Range{32, 2048});
        f("scan", self.scan, "Scene file that a thing is put into, instead of the generated kinds.");
        f("up", self.up, "Up direction of that scene.");
        f("place", self.place, "Place in that scene where the thing stands.");
        f("thing_size", self.thing_size, "Height of that thing, world units.", Range{1e-6, 1e6});
        f("missed", self.missed, "Share of the thing, in patches, that the label misses.", Range{0, 0.5});
    }
};

/// Figures of healing, of plain deletion and of one mean colour, over the pixels where deletion differs from
/// the truth. The picture shows a view per kind: with the thing, deleted, healed, truth. Throws Error for
/// wrong parameters, and when stopped.
Subject bench_heal(const HealBenchParameters& parameters, const heal::HealSettings& settings,
                   const JobControl& job);

}  // namespace gse::bench
