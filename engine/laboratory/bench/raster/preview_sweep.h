// gseditpro-lab bench preview: error against time of a viewport picture, per renderer and setting.
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/fields.h"
#include "engine/base/progress.h"
#include "engine/laboratory/bench/charts/subject.h"

namespace gse::bench {

struct PreviewSweepParameters {
    int splats = 100000;
    std::uint64_t seed = 0;
    std::string backend = "both";
    std::string size = "1280x720";
    int frames = 16;
    std::string sh_degrees = "0 1 2 3";
    std::string scales = "0.25 0.35 0.5 0.71";

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("splats", self.splats, "Splats of the generated scene.", Range{1, 2e7});
        f("seed", self.seed, "Its seed.");
        f("backend", self.backend, "Renderers: vulkan, native or both.");
        f("size", self.size, "Picture size, WIDTHxHEIGHT.");
        f("frames", self.frames, "Pictures of a turn, per setting.", Range{1, 10000});
        f("sh_degrees", self.sh_degrees,
          "Degrees of the colours' spherical harmonics; 3 is always among them.");
        f("scales", self.scales,
          "Shares of the full width at which a moving picture is drawn; 1 is always among them.");
    }
};

/// Draws a turn around a generated scene (synth/timing_scene.h) with each setting, each picture from nothing.
/// Cost is the wall time, least of the turn. The error is the root mean square difference to the
/// double-precision picture of all colours at full size, with equal opacity compensation. A smaller picture
/// is enlarged as the window does it. Throws Error for wrong parameters, where there is no Vulkan device, and
/// when stopped.
Subject bench_preview_sweep(const PreviewSweepParameters& parameters, const JobControl& job);

}  // namespace gse::bench
