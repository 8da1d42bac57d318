// The gate before the long loop of score distillation (METHOD.md, The check before score distillation). It
// holds the model's pictures of the scene under the edit's prompt. Redrawn views are judged as they are
// (edit_quality.h).
#pragma once

#include <filesystem>
#include <vector>

#include "engine/pipeline/run/edit_job.h"
#include "engine/pipeline/run/edit_quality.h"

namespace gse::pipeline {

struct GateParameters {
    int views = 4;
    double strength = 0.75;  // of the image-to-image run
    int steps = 8;           // six are run: as telling as 23, for a quarter of the passes
    double guidance_scale = 5;
};

/// One view before, and as the model paints it over with the edit's prompt. Both have the model's picture
/// size.
struct GatePicture {
    std::size_t view = 0;  // index into the job's views
    Image before, after;
};

struct PreviewCheck : EditQuality {
    std::vector<GatePicture> pictures;
};

/// Views spread over the job's, each painted over by the model (tuned, if it is). Throws Error (Cancelled) on
/// a stop request.
PreviewCheck look_through_gate(EditJob& job, const GateParameters& parameters = {});

/// Writes gate_0.png and so on: before and after beside each other.
void write_gate(const std::filesystem::path& folder, const PreviewCheck& gate);
/// JSON {"score", "verdict", "warns", "views"}.
nlohmann::ordered_json gate_to_json(const PreviewCheck& gate);

}  // namespace gse::pipeline
