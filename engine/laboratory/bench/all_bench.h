// gseditpro-lab bench all: every subject on one page, with the machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/fields.h"
#include "engine/pipeline/run/edit_job.h"

namespace gse::bench {

struct AllBenchParameters {
    std::string subjects = "raster stability preview locate edit scale";
    std::uint64_t seed = 1;
    int locate_scenes = 4;
    int edits = 6;
    int raster_splats = 100000;
    int preview_splats = 50000;
    double scale_most_splats = 1e6;
    double scale_most_side = 1024;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("subjects", self.subjects,
          "Subjects to measure: some of raster stability preview locate edit scale.");
        f("seed", self.seed, "Seed of scenes and suites.");
        f("locate_scenes", self.locate_scenes, "Scenes of `bench locate` here.", Range{1, 10000});
        f("edits", self.edits, "Edits of `bench edit` here.", Range{1, 10000});
        f("raster_splats", self.raster_splats, "Splats of `bench raster` here.", Range{1, 2e7});
        f("preview_splats", self.preview_splats, "Splats of `bench preview` here.", Range{1, 2e7});
        f("scale_most_splats", self.scale_most_splats, "`bench scale` leaves out more splats here.",
          Range{1, 2e7});
        f("scale_most_side", self.scale_most_side,
          "`bench scale` leaves out larger pictures here, pixels a side.", Range{16, 8192});
    }
};

/// Writes index.html (which refers to no other file), all.json and a picture per subject into `folder`.
/// Returns the contents of all.json: {"machine", "parameters", "subjects": {...}, "seconds": {...}}. A
/// subject that fails is named with its reason; the others go on. The page says where a parameter is not the
/// subject's own default. Throws Error for wrong parameters, and when stopped.
nlohmann::ordered_json bench_all(const AllBenchParameters& parameters, const pipeline::EditRecipe& settings,
                                 const std::filesystem::path& folder, const JobControl& job);

/// Names of the files that bench_all() leaves where all subjects ran.
std::vector<std::string> all_bench_files();

}  // namespace gse::bench
