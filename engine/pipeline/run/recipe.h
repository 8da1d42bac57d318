// Everything that decides what a run does and what comes of it.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/edit/request/request.h"
#include "engine/neural/api/attention_parameters.h"
#include "engine/neural/api/dreambooth_parameters.h"
#include "engine/neural/api/sds_parameters.h"

namespace gse::pipeline {

/// Files and machine of a run; with the request and the guidance's settings this is the whole recipe.
struct JobParameters {
    std::string scene;
    std::string cameras;
    std::string model;
    std::vector<std::string> lora;
    std::string taesd;
    std::string segmenter;
    std::string text_segmenter;
    std::string device = "cpu";
    std::string rasterizer = "auto";
    std::string precision = "auto";
    int threads = 1;
    std::string up = "auto";
    std::string front;
    bool use_label = false;
    std::string cut_out;
    std::string looked_from;
    int turntable_size = 480;
    int turntable_frames = 60;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("scene", self.scene, "Scene file or folder.");
        f("cameras", self.cameras,
          "COLMAP folder, transforms.json or cameras.json; found beside the scene when empty, \"none\" for "
          "an orbit.");
        f("model", self.model, "Diffusers folder or .safetensors checkpoint; empty = the starter model.");
        f("lora", self.lora,
          "LoRA that is merged into the model, as FILE or FILE:strength; of kohya, LyCORIS (LoCon), PEFT or "
          "diffusers. May be given "
          "several times.");
        f("taesd", self.taesd,
          "Folder of a tiny autoencoder (TAESD), for all pictures but the last; empty = \"taesd\" beside the "
          "weights, \"none\" = not used.");
        f("segmenter", self.segmenter,
          "Weights of SAM or MobileSAM (.safetensors, .pth or .pt) that cut out what the attention finds; "
          "empty = GrabCut, which needs none.");
        f("text_segmenter", self.text_segmenter,
          "Folder of CLIPSeg, which finds a noun in a picture by itself; where it agrees with the attention, "
          "its mask counts. Empty = none.");
        f("device", self.device, "Where the networks run: cpu or cuda.");
        f("rasterizer", self.rasterizer,
          "What draws the splats and differentiates their pictures: cpu, cuda (a device that draws a test "
          "scene otherwise is refused), or "
          "auto: cpu.");
        f("precision", self.precision,
          "Numbers the UNet computes in: fp32, bf16 (AVX-512 BF16 or AMX), or auto: bf16 where a large model "
          "was measured to be faster with it.");
        f("threads", self.threads,
          "Threads of the networks; small ones gain nothing from more. Another number may round differently.",
          Range{1, 256});
        f("up", self.up, "World up: auto, x, y, z, -x, -y or -z.");
        f("front", self.front,
          "Azimuth in degrees from which the scene shows its front; the model is told \"front view\" and so "
          "on. Empty = read off the "
          "scene where the model's encoder can tell; \"none\" = not told.");
        f("use_label", self.use_label,
          "What the scene's label column marks may change; nothing is looked for, and the source may be any "
          "word.");
        f("cut_out", self.cut_out,
          "Box around the thing that may change, LEFT,TOP,RIGHT,BOTTOM as shares of the picture that "
          "\"render\" makes, and where that is not "
          "the one of its defaults ,AZIMUTH,ELEVATION,ZOOM behind it: the thing is cut out of it, all its "
          "sides, and nothing is looked for.");
        f("looked_from", self.looked_from,
          "Azimuth in degrees from which whoever asks looks at the thing, or made its label by hand; a box "
          "of cut_out tells its own. That "
          "side is the front where none is given and the model's encoder is not sure of one. Empty = not "
          "known.");
        f("turntable_size", self.turntable_size, "Side of each half of the before/after film in pixels.",
          Range{16, 4096});
        f("turntable_frames", self.turntable_frames, "Frames of the before/after film.", Range{1, 10000});
    }

    /// The source may be any word: what may change is known without it.
    bool brings_label() const { return use_label || !cut_out.empty(); }
};

/// Everything that decides the result.
struct EditRecipe {
    JobParameters job;
    edit::EditRequest request;
    neural::SdsParameters guidance;
    neural::AttentionParameters attention;
    bool use_dreambooth = false;  // the model learns the scene first (method S2)
    neural::DreamBoothParameters dreambooth;
    // Not written: "request.image_size" and so on.
    std::set<std::string> given;  // what the file that was read names
    std::map<std::string, std::string>
        sources;  // where values come from that are not the program's; see model_settings.h
};

/// {"version", "job", "request", "guidance"}, "attention" where it is not as usual and "dreambooth" where it
/// is used; reading throws Error for unknown or wrong entries. A relative scene path is taken relative to the
/// recipe's folder.
nlohmann::ordered_json recipe_to_json(const EditRecipe& recipe);
/// A recipe.json, or what a picture (.png) of an edit carries. Throws Error (NotFound, Malformed,
/// InvalidArgument).
nlohmann::ordered_json read_recipe_json(const std::filesystem::path& path);
EditRecipe read_recipe(const std::filesystem::path& path);
/// The same of what was read already; relative files are those of `folder`.
EditRecipe recipe_from_json(const nlohmann::ordered_json& json, const std::filesystem::path& folder);

/// What the networks are asked before the loop begins follows from this and the scene: recipes with the same
/// key find the same. Of a recipe whose request is validated.
std::string search_key(const EditRecipe& recipe);
/// The key of what the recipe means once its words are completed; empty where they cannot be.
std::string valid_search_key(EditRecipe recipe);

/// What a tuning learns of a scene follows from this and the scene.
std::string tuning_key(const EditRecipe& recipe);

}  // namespace gse::pipeline
