// Recipe of a run: everything that decides its work and its result.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/edit/request/checked_request.h"
#include "engine/io/scene/reading_options.h"
#include "engine/neural/api/attention_parameters.h"
#include "engine/neural/api/dreambooth_parameters.h"
#include "engine/neural/api/sds_parameters.h"
#include "engine/remote/api/server_settings.h"

namespace gse::pipeline {

/// Files and machine of a run. With the request and the guidance's settings this is the whole recipe.
struct JobParameters {
    std::string scene;
    bool activated = false;
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
    std::string at;
    bool the_thing = false;
    std::string looked_from;
    int turntable_size = 480;
    int turntable_frames = 60;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("scene", self.scene, "Scene file or folder.");
        f("activated", self.activated, ReadingOptions::ActivatedHelp);
        f("cameras", self.cameras,
          "COLMAP folder, transforms.json or cameras.json; found beside the scene when empty, \"none\" for "
          "an orbit.");
        f("model", self.model, "Diffusers folder or .safetensors checkpoint; empty = the starter model.");
        f("lora", self.lora,
          "LoRA that is merged into the model, as FILE or FILE:strength; of kohya, LyCORIS (LoCon), PEFT or "
          "diffusers. May be given several times. With --server, a LoRA of the server, as NAME or "
          "NAME:weight.");
        f("taesd", self.taesd,
          "Folder of a tiny autoencoder (TAESD), for all pictures but the last; empty = \"taesd\" beside the "
          "weights, \"none\" = not used.");
        f("segmenter", self.segmenter,
          "Weights of SAM or MobileSAM (.safetensors, .pth or .pt) that cut out what the attention finds; "
          "empty = GrabCut, which needs none.");
        f("text_segmenter", self.text_segmenter,
          "Folder of CLIPSeg, which finds a noun in a picture by itself; where it agrees with the attention, "
          "its mask counts. Empty = none.");
        f("device", self.device, "Device of the networks: cpu or cuda.");
        f("rasterizer", self.rasterizer,
          "Rasterizer of the splats, drawing and derivative: cpu, cuda, or auto, which is cpu. A CUDA device "
          "that draws a test scene otherwise is refused.");
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
          "Let the splats change that a label of the scene marks: the one named like the source, else the "
          "first. Nothing is looked for, and the source may be any word.");
        f("cut_out", self.cut_out,
          "Box around the object that may change, LEFT,TOP,RIGHT,BOTTOM as shares of the picture that "
          "\"render\" makes. Another picture than its default one is named by ,AZIMUTH,ELEVATION,ZOOM behind "
          "it. The object is cut out of it with all its sides, and nothing is looked for.");
        f("at", self.at,
          "Place of the object that may change, X,Y as shares of the picture that \"render\" makes, as if it "
          "were clicked. Another picture is named by ,AZIMUTH,ELEVATION or ,AZIMUTH,ELEVATION,ZOOM behind "
          "it. "
          "What is linked with that place and apart from what it stands on changes; nothing is looked for.");
        f("the_thing", self.the_thing,
          "Let the largest thing that stands alone change. Nothing is looked for, and the source may be any "
          "word.");
        f("looked_from", self.looked_from,
          "Azimuth in degrees from which the artist looks at the object, or made its label by hand. cut_out "
          "and at tell their own. That side is the front if none is given and the model's encoder is not "
          "sure of one. Empty = not known.");
        f("turntable_size", self.turntable_size, "Side of each half of the before/after film in pixels.",
          Range{16, 4096});
        f("turntable_frames", self.turntable_frames, "Frames of the before/after film; 0 = no film.",
          Range{0, 10000});
    }

    /// True when the source may be any word, since the label is known without it.
    bool brings_label() const { return use_label || the_thing || !cut_out.empty() || !at.empty(); }
};

/// Settings of a run beside its request.
struct RunSettings {
    JobParameters job;
    neural::SdsParameters guidance;
    neural::AttentionParameters attention;
    bool use_dreambooth = false;  // the model learns the scene first (METHOD.md, DreamBooth)
    neural::DreamBoothParameters dreambooth;
    remote::ServerSettings server;  // that draws the views; its url is empty where the model here does
    // Not written: "request.image_size" and so on.
    std::set<std::string> given;  // what the file that was read names
    std::map<std::string, std::string>
        sources;  // where values come from that are not the program's; see model_settings.h
};

/// All settings that decide the result, as they are typed and written.
struct EditRecipe : RunSettings {
    edit::EditRequest request;
};

/// The recipe of a run, as its stages take it: its request is checked, its sentence parsed.
struct CheckedRecipe : RunSettings {
    edit::CheckedRequest request;

    EditRecipe plain() const { return {*this, request.plain()}; }
};

/// Checks the request alone. Throws as edit::check() does.
CheckedRecipe check(EditRecipe recipe, const edit::News& news = {});

/// JSON {"version", "job", "request", "guidance"}, with "attention" if it is not as usual and "dreambooth" if
/// it is used, and "server" with an address without secrets where one draws. Reading throws Error for unknown
/// or wrong entries. A relative scene path is taken relative to the recipe's folder.
nlohmann::ordered_json recipe_to_json(const EditRecipe& recipe);
/// Reads a recipe.json, or the recipe in a picture (.png) of an edit. Throws Error (NotFound, Malformed,
/// InvalidArgument).
nlohmann::ordered_json read_recipe_json(const std::filesystem::path& path);
EditRecipe read_recipe(const std::filesystem::path& path);
/// Recipe of a text that was read already. Relative files are those of `folder`.
EditRecipe recipe_from_json(const nlohmann::ordered_json& json, const std::filesystem::path& folder);
/// Files of a server's settings become absolute.
void make_files_absolute(remote::ServerSettings& settings);

/// Key of all requests to the networks before the loop begins, for a scene. Recipes with equal keys find
/// equal labels.
std::string search_key(const CheckedRecipe& recipe);
/// Key of the recipe once its words are completed. Empty if they cannot be.
std::string valid_search_key(EditRecipe recipe);

/// Key of a tuning on a scene.
std::string tuning_key(const EditRecipe& recipe);

}  // namespace gse::pipeline
