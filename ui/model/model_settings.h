// Parts of a recipe beside the request, as panels show and projects keep them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/fields.h"
#include "engine/neural/api/attention_parameters.h"
#include "engine/neural/api/dreambooth_parameters.h"
#include "engine/neural/api/sds_parameters.h"

namespace gse::ui {

/// Settings to run, ask and teach the model: the parts of a recipe beside the request. One list of fields for
/// each part.
struct ModelSettings {
    bool gate = true;
    bool review = false;
    bool learn_scene = false;
    std::string device = "cpu";
    std::string rasterizer = "auto";
    std::string precision = "auto";
    int threads = 1;
    std::string front;
    neural::SdsParameters guidance;
    neural::AttentionParameters attention;
    neural::DreamBoothParameters learning;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("gate", self.gate,
          "Method sds: before the edit, show what the model itself makes of four views, and warn when that "
          "is not what was asked. Redrawn views are judged as they are.");
        f("review", self.review,
          "Method views: before the scene is fitted to redrawn views, wait until you have looked at them.");
        f("learn_scene", self.learn_scene,
          "DreamBooth: the model learns this scene from renders of it first.");
        f("device", self.device, "Device of the networks: cpu, or cuda if there is one.");
        f("rasterizer", self.rasterizer,
          "Rasterizer of an edit: cpu, cuda if there is one, or auto, which is cpu.");
        f("precision", self.precision,
          "Numbers the UNet computes in: fp32, bf16, or auto: bf16 where a large model was measured to be "
          "faster with it.");
        f("threads", self.threads,
          "Threads of the networks; small ones gain nothing from more. Another number may round differently.",
          Range{1, 256});
        f("front", self.front,
          "Direction in degrees from which the scene shows its front (0, 90, -45.5); the model is then told "
          "which view is the front. Empty = read off the scene where the model can tell; none = not told.");
    }
    /// Calls f(name, part) for the parts with fields of their own.
    template <class Self, class F> static void visit_parts(Self& self, F&& f) {
        f("guidance", self.guidance);
        f("attention", self.attention);
        f("learning", self.learning);
    }
};

/// An object of the fields, with one more object for each part.
nlohmann::ordered_json model_settings_to_json(const ModelSettings& settings);
/// Reads known fields over `settings`, of older projects too. Throws Error for a field that is no setting or
/// out of its range.
ModelSettings model_settings_from_json(nlohmann::ordered_json json, ModelSettings settings);

}  // namespace gse::ui
