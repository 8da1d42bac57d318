// Settings of a server that draws the views of an edit.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/fields.h"

namespace gse::remote {

/// Server, and how it is used. Numbers that are 0 are the model family's own (METHOD.md, Views by a server).
struct ServerSettings {
    std::string url;
    std::string kind = "auto";
    std::string model;
    std::string workflow;
    std::string family = "auto";
    std::string agreement = "auto";
    std::string search = "auto";
    int side = 0;
    int steps = 0;
    double guidance = 0;
    double strength = 0;
    std::vector<std::string> lora;
    std::vector<std::string> option;
    std::vector<std::string> target_picture;
    std::string key_view;
    std::string ca;
    bool paid_nodes = false;
    std::vector<std::string> also;
    bool fit_partial = false;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("url", self.url,
          "Address of an image server that draws the views in place of the model here; \"none\" takes back "
          "the one of a recipe. Pictures of the scene, masks and the sentence go there.");
        f("kind", self.kind,
          "Protocol of the server: webui (A1111, Forge, SD.Next, koboldcpp), openai, sdcpp (sd-server), "
          "comfy; auto finds it out.");
        f("model", self.model, "Model that the server draws with; empty = the one that it has loaded.");
        f("workflow", self.workflow,
          "Workflow of ComfyUI: a file in API format, or \"edit\", the bundled one for models that follow "
          "instructions; empty = a bundled one that fits the model.");
        f("family", self.family,
          "Family of the model, which decides steps, guidance, strength and the form of the sentence; auto = "
          "by the model's name.");
        f("agreement", self.agreement,
          "Way to make views agree: none, sheet, reference, warp, or auto, as it suits the family. Sheet: "
          "several views in one picture. Reference: the first is shown beside the others. Warp: the first is "
          "carried over by depth.");
        f("search", self.search,
          "Search for the thing by what the server changes: differences, paint, none; auto = differences for "
          "a word that the model here lacks. Differences take two pictures of each of 8 views. Paint takes "
          "one: a model that follows instructions paints the thing in a flat colour.");
        f("side", self.side, "Side of the pictures that are sent, pixels; 0 = the family's.", Range{0, 2048});
        f("steps", self.steps, "Denoising steps at the server; 0 = the family's.", Range{0, 200});
        f("guidance", self.guidance, "Guidance scale at the server; 0 = the family's.", Range{0, 50});
        f("strength", self.strength, "Strength of redrawing at the server; 0 = the family's.", Range{0, 1});
        f("lora", self.lora,
          "LoRA of the server, as NAME or NAME:weight; may be given several times. With --server, --lora is "
          "the same.");
        f("option", self.option,
          "Setting of the server's own, as NAME=VALUE; may be given several times. NAME is a field of its "
          "request (\"scheduler\", \"sample_params.flow_shift\"), or with ComfyUI an input of a node "
          "(\"KSampler.sampler_name\"). force:NAME=VALUE sends a name that the program does not know.");
        f("target_picture", self.target_picture,
          "Picture of your own that a view shall look like, as VIEW=FILE; may be given several times. Other "
          "views follow it. --views-only writes the views to paint over.");
        f("key_view", self.key_view,
          "View that is drawn first and that others follow; empty = the one with the most to change.");
        f("ca", self.ca, "File of certificates to trust beside the system's.");
        f("paid_nodes", self.paid_nodes,
          "Let a workflow use nodes that send the pictures on and cost money.");
        f("also", self.also,
          "Further server with the same model, over which the views are spread; may be given several times.");
        f("fit_partial", self.fit_partial,
          "Fit the scene to the views that are there where the server fails after 60 % of them, and after 4. "
          "Views that are missing are left out.");
    }

    bool used() const { return !url.empty(); }
};

/// Searches for a thing by what a server changes.
enum class ServerSearch { Auto, Differences, None, Paint };

/// Search of that name. Throws Error (InvalidArgument) that lists the names.
ServerSearch server_search_of(const std::string& name);

/// True for a workflow of ComfyUI that comes with the program: "img2img", "inpainting", "edit" (a model that
/// takes instructions), "edit_reference". Others are files.
bool is_bundled_workflow(std::string_view name);

/// Picture of an artist's own for a view.
struct TargetPicture {
    std::string view;
    std::filesystem::path file;
};

/// Picture of a text "VIEW=FILE". Throws Error (InvalidArgument) for another form.
TargetPicture target_picture_of(const std::string& text);

/// Name of a view as files have it: letters, digits, ".", "-" and "_"; others become "_". Options take
/// either.
std::string file_name_of_view(const std::string& view);

/// Address without user name, password, query and fragment.
std::string without_secrets(std::string_view url);

}  // namespace gse::remote
