// Everything an edit is asked to be: words, views, thresholds, losses and rates, in one list of fields.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/fields.h"
#include "engine/base/image.h"
#include "engine/edit/request/field_use.h"
#include "engine/edit/words/rearrange_settings.h"
#include "engine/language/sentence.h"

namespace gse::edit {

/// Words of an edit.
struct EditWords {
    std::string source;
    std::string prompt;
    std::string target;
    std::string mode = "auto";
    std::string part_of;
    bool whole_scene = false;
    std::string description;
    std::string anchor;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("source", self.source,
          "Subject of the edit in the scene (\"bear\", \"teddy bear\"); empty = the target word.");
        f("prompt", self.prompt, "A sentence that describes the scene after the edit (\"a golden statue\").");
        f("target", self.target,
          "New words of the prompt (\"golden\", \"top hat\"). Empty = those that the pictures show least, if "
          "the "
          "model compares pictures with words, else those that the sentence says of the source.");
        f("mode", self.mode,
          "Kind of change: modify, replace, add, remove, transform or auto. Replace puts something else in "
          "its place. Add puts something new beside it. Remove heals the hole. Transform moves, turns, "
          "resizes or copies.");
        f("part_of", self.part_of,
          "Thing that the source is a part of (\"bear\" of \"ears\"): the thing is looked for, and the part "
          "within it. Empty = the source is a thing of its own.");
        f("whole_scene", self.whole_scene,
          "Change the look of everything at once (a style, the weather): nothing is looked for. For models "
          "of an open vocabulary.");
        f("description", self.description,
          "Sentence that describes the scene as it is (\"a bear wearing a hat\"), for modes remove and "
          "transform. Empty = the source alone.");
        f("anchor", self.anchor,
          "Other thing that a transform is relative to (\"statue\" of \"move behind\").");
    }
};

/// How it is looked for: with the words, everything that the networks are asked before the loop begins
/// follows from these.
struct SearchSettings {
    // Views
    int views = 24;
    int image_size = 96;
    double elevation = 12;
    std::string background = "black";
    bool reframe_views = true;
    bool sided_view_words = false;
    // Localization
    std::string competing_words = "auto";
    int attention_repeats = 1;
    int retry_passes = 3;
    double dbscan_eps = 2;
    int dbscan_min_samples = 4;
    double min_cluster_mass = 0.25;
    int positive_points = 5;
    int negative_points = 3;
    double min_segment_attention = 0.5;
    double label_smoothness = 1.5;
    double coverage_px = 0.5;
    double least_confidence = 0.2;  // measured: `gseditpro-lab bench search`
    // Adding
    int place_views = 12;
    int place_steps = 4;
    double add_room = 0.6;
    // METHOD.md, Drawing new things. Some noise is left: another seed is to draw something else.
    double add_noise = 0.3;
    int seed_splats = 400;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("views", self.views, "How many viewpoints the edit looks from.", Range{1, 512});
        f("image_size", self.image_size, "Side of the pictures the edit works on, in pixels.",
          Range{16, 1024});
        f("elevation", self.elevation,
          "Height of the lower ring of automatic views, degrees above the horizon.", Range{-60, 80});
        f("background", self.background, "Colour behind the scene: black, white, grey or #rrggbb.");
        f("reframe_views", self.reframe_views,
          "Move the automatic views in on what was found and look again.");
        f("sided_view_words", self.sided_view_words,
          "Tell the model left from right too (\"front left view\"): for models that learned such words.");
        f("competing_words", self.competing_words,
          "Other things the scene shows (\"hat grass\", \"top hat, grass\"; auto: those the sentence names; "
          "none): pixels that attend more to "
          "them are not taken for the source.");
        f("attention_repeats", self.attention_repeats, "Attention passes per view, each with fresh noise.",
          Range{1, 100});
        f("retry_passes", self.retry_passes,
          "Attention passes more for a view that is at odds with what all views say together; 0 = it is left "
          "at odds.",
          Range{0, 100});
        f("dbscan_eps", self.dbscan_eps, "DBSCAN radius in pixels of a 64-pixel map.", Range{1, 32});
        f("dbscan_min_samples", self.dbscan_min_samples, "DBSCAN neighbours that make a core pixel.",
          Range{1, 1000});
        f("min_cluster_mass", self.min_cluster_mass,
          "Clusters below this share of the largest one's attention are dropped.", Range{0, 1});
        f("positive_points", self.positive_points, "Clicks inside for the segmenter.", Range{1, 50});
        f("negative_points", self.negative_points, "Clicks outside for the segmenter.", Range{0, 50});
        f("min_segment_attention", self.min_segment_attention,
          "A segment that captures less of the attention than this gives way to the attention region.",
          Range{0, 1});
        f("label_smoothness", self.label_smoothness,
          "How much neighbouring splats of one colour share their label; 0 = every splat for itself.",
          Range{0, 100});
        f("coverage_px", self.coverage_px, "Splats seen over fewer pixels than this are not labelled.",
          Range{0, 1e6});
        f("least_confidence", self.least_confidence,
          "A search that is less sure than this labels nothing; 0 = what was found is labelled, whatever it "
          "is.",
          Range{0, 1});
        f("place_views", self.place_views,
          "Views into which an addition is drawn to find its place, by a model that is shown the scene (the "
          "bundled one is). 0, or with another model: the attention of its word tells the place.",
          Range{0, 64});
        f("place_steps", self.place_steps, "Denoising steps of such a view.", Range{1, 100});
        f("add_room", self.add_room,
          "Room around a thing in which what is added to it is drawn then, as a share of its size.",
          Range{0, 2});
        f("add_noise", self.add_noise,
          "Deviation of the noise that pictures of an addition begin from. Below 1 they come nearer to the "
          "mean of the model's possible pictures: fewer surprises, and another seed differs less.",
          Range{0, 1});
        f("seed_splats", self.seed_splats, "New splats placed where something is added.", Range{10, 1e6});
    }
};

/// Thresholds that make a label of a search's views. Another threshold asks no network.
struct LabelThresholds {
    double attention_threshold = 0;
    double label_threshold = 0.4;
    std::string excluded_views;

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        f("attention_threshold", self.attention_threshold,
          "Attention above this share of the maximum counts; 0 = what the model states (0.5 in the paper).",
          Range{0, 1});
        f("label_threshold", self.label_threshold,
          "Splats of which the views say more than this are labelled: half a mask, half the attention, 0 to "
          "1.",
          Range{0, 1});
        f("excluded_views", self.excluded_views,
          "Views that do not vote, by their numbers from 0 (\"3, 17\"): those whose masks are seen to be "
          "wrong.");
    }
};

/// Noise level above which the steps of a new shape are guided unless a setting says otherwise. A search
/// draws with it whatever is set: its answer does not depend on the loop.
inline constexpr double UsualGuidedUntil = 0.5;

/// Help text of LoopSettings::method; edit_methods.cpp.
const char* method_help();

/// How the labelled rows are changed: nothing of it has to be looked for again.
struct LoopSettings {
    std::uint64_t seed = 0;
    bool localize = true;
    bool heal = true;
    std::string method = "auto";
    std::string quality = "normal";
    int iterations = 200;
    // View guidance
    std::string instruction;
    int edited_views = 8;
    int rounds = 1;
    // METHOD.md, Redrawn views.
    int view_steps = 3;
    int fit_steps = 40;
    Overridable view_strength{0.75};
    int restyle_steps = 2;
    // Shapes by views: a thing that becomes another, or is new
    int shape_views = 12;
    int shape_rounds = 1;
    int add_rounds = 1;
    int shape_steps = 4;
    int shape_fit_steps = 144;
    // METHOD.md, Drawing new things.
    double shape_strength = 1;
    double shape_again_strength = 0.6;
    double shape_guided_until = UsualGuidedUntil;
    double shape_room = 0.2;
    double add_margin = 0.4;
    double guidance_weight = 1;
    double strength = 1;
    bool gate_guidance = true;
    double dilate_px = 8;
    double preserve = 10;
    double l1 = 0.8;
    double ssim = 0.2;
    // Dynamic mask (METHOD.md, Dynamic masks); early stop (METHOD.md, Optimiser)
    bool dynamic_mask = true;
    double dynamic_from = 0.5;
    double dynamic_every = 0.125;
    bool prune_added = true;
    double prune_added_threshold = 0.75;
    bool early_stop = false;
    double early_stop_change = 0.5 / 255;
    // Anchors with generations (METHOD.md, Anchors)
    double anchor_first = 0.05;
    double anchor_start = 0.1;
    double anchor_growth = 1.3;
    double anchor_cap = 10;
    Overridable anchor_position{50};
    Overridable anchor_rotation{50};
    Overridable anchor_opacity{50};
    Overridable anchor_scale{50};
    double anchor_colour = 0;
    // Learning rates
    double rate_position = 4.8e-4;
    double rate_position_end = 3.2e-5;
    Overridable rate_colour{0.0375};
    double rate_sh = 0.001875;
    double rate_opacity = 0.1;
    double rate_scale = 0.01;
    double rate_rotation = 0.002;
    Overridable geometry_share{0.03};
    Overridable colour_coupling{0.9};
    // Densification
    int densify_from = 100;
    int densify_every = 100;
    double densify_until = 0.75;
    Overridable densify_percent{0.01};
    double densify_min_gradient = 1e-7;
    double percent_dense = 0.01;
    double min_opacity = 0.005;
    double prune_scale = 0.1;
    Overridable max_growth{1.5};
    Overridable max_aspect{20};
    int snapshot_every = 20;

    static constexpr std::array RetiredFields{RetiredField{"polish_steps", 0}};

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        visit_loop(self, f);
        visit_shapes(self, f);
        visit_masks(self, f);
        visit_anchors(self, f);
        visit_rates(self, f);
        visit_growth(self, f);
    }

private:
    template <class Self, class F> static void visit_loop(Self& self, F&& f) {
        f("seed", self.seed, "Seed of everything random.");
        f("localize", self.localize,
          "Let only the splats that were found change; off = every splat may (an ablation of the paper).");
        f("heal", self.heal, "Fill the hole that a removed or moved thing leaves with what is around it.");
        f("method", self.method, method_help());
        f("quality", self.quality,
          of_views("How much work redrawing takes: draft (half of the views below, three quarters of their "
                   "steps), "
                   "normal, or fine (twice the "
                   "views, half again as many steps)."));
        f("iterations", self.iterations, of_gradient("Optimisation steps of method sds."), Range{0, 1e6});
        f("instruction", self.instruction,
          "Instruction for a model that edits pictures by instructions (InstructPix2Pix): \"make the bear "
          "golden\". Empty = to turn the source into the sentence.");
        f("edited_views", self.edited_views, of_views("Views that the model redraws in a round."),
          Range{1, 64});
        f("rounds", self.rounds,
          of_views("How often they are redrawn, each time from what the scene has become."), Range{1, 20});
        f("view_steps", self.view_steps, of_views("Denoising steps of a redrawn view."), Range{1, 100});
        f("fit_steps", self.fit_steps, of_views("Optimisation steps after each round."), Range{1, 1e5});
        f("restyle_steps", self.restyle_steps,
          of_views(
              "Denoising steps of a redrawn view, for another colour, material or ground by a model that "
              "is shown the scene (the bundled one is)."),
          Range{1, 100});
        f("view_strength", self.view_strength,
          of_views(
              "How far from the render a view is redrawn: 0 = not at all, 1 = from nothing. A model that is "
              "shown the scene beside it (the bundled model is) "
              "begins from nothing unless another value is set."),
          Range{0.02, 1});
    }
    template <class Self, class F> static void visit_masks(Self& self, F&& f) {
        f("guidance_weight", self.guidance_weight,
          of_gradient("How hard the model pulls, against keeping the rest."), Range{0, 1e6});
        f("strength", self.strength,
          "How much of the result is kept: 0 = none, below 1 = between before and after, above 1 = colours "
          "go beyond it.",
          Range{0, 2});
        f("gate_guidance", self.gate_guidance,
          of_gradient("Let the model pull inside the dilated mask only."));
        f("dilate_px", self.dilate_px,
          "Growth of the mask, in pixels of a 512-pixel picture (doubled when adding).", Range{0, 256});
        f("preserve", self.preserve,
          of_gradient(
              "Weight of keeping pictures outside the mask as they were (pseudo ground truth; method sds)."),
          Range{0, 1e6});
        f("l1", self.l1, of_gradient("Share of the absolute difference in it (method sds)."), Range{0, 10});
        f("ssim", self.ssim, of_gradient("Share of the structural difference in it (method sds)."),
          Range{0, 10});
        f("dynamic_mask", self.dynamic_mask,
          of_gradient("From some iteration on, let the masks follow what the edit has become."));
        f("dynamic_from", self.dynamic_from,
          of_gradient("Share of the iterations after which masks are refreshed."), Range{0, 1});
        f("dynamic_every", self.dynamic_every,
          of_gradient("Share of the iterations between two refreshes of a view's mask."), Range{0, 1});
        f("prune_added", self.prune_added,
          of_gradient("When adding: from time to time look where the new thing is seen, and drop new splats "
                      "outside it."));
        f("prune_added_threshold", self.prune_added_threshold,
          of_gradient("New splats seen inside it for less than this share are dropped."), Range{0, 1});
        f("early_stop", self.early_stop, "Stop when no view changes any more.");
        f("early_stop_change", self.early_stop_change,
          "Mean change of a view between two visits that counts as none.", Range{0, 1});
    }
    template <class Self, class F> static void visit_anchors(Self& self, F&& f) {
        f("anchor_first", self.anchor_first, "Anchor weight of the original splats at the start.",
          Range{0, 100});
        f("anchor_start", self.anchor_start, "Anchor weight a generation gets when the next one is born.",
          Range{0, 100});
        f("anchor_growth", self.anchor_growth, "Factor of all anchor weights at each densification.",
          Range{1, 10});
        f("anchor_cap", self.anchor_cap, "Largest anchor weight.", Range{0, 1e4});
        f("anchor_position", self.anchor_position, "Anchor loss weight of positions.", Range{0, 1e6});
        f("anchor_rotation", self.anchor_rotation, "Anchor loss weight of rotations.", Range{0, 1e6});
        f("anchor_opacity", self.anchor_opacity, "Anchor loss weight of opacities.", Range{0, 1e6});
        f("anchor_scale", self.anchor_scale, "Anchor loss weight of scales.", Range{0, 1e6});
        f("anchor_colour", self.anchor_colour, "Anchor loss weight of colours.", Range{0, 1e6});
    }
    template <class Self, class F> static void visit_shapes(Self& self, F&& f) {
        f("shape_views", self.shape_views,
          of_views("Views that the model redraws in a round, where a thing becomes another or is new."),
          Range{1, 64});
        f("shape_rounds", self.shape_rounds, of_views("Rounds when an object becomes another."),
          Range{1, 20});
        f("add_rounds", self.add_rounds, of_views("Rounds when something is added."), Range{1, 20});
        f("shape_steps", self.shape_steps,
          of_views("Denoising steps of a view in its first round there; later rounds take fewer, by their "
                   "strength."),
          Range{1, 100});
        f("shape_fit_steps", self.shape_fit_steps, of_views("Optimisation steps after each round there."),
          Range{1, 1e5});
        f("shape_strength", self.shape_strength,
          of_views("How far from the render the first round redraws there."), Range{0.02, 1});
        f("shape_again_strength", self.shape_again_strength, of_views("How far the later rounds do."),
          Range{0.02, 1});
        f("shape_guided_until", self.shape_guided_until,
          of_views("There the steps above this noise level (share of the schedule) are guided against the "
                   "negative "
                   "prompt; below it the sentence alone "
                   "leads, at half the cost."),
          Range{0, 1});
        f("shape_room", self.shape_room,
          "Room around the old thing for one that takes its place, as a share of its size.", Range{0, 2});
        f("add_margin", self.add_margin,
          "Room around the place of something that is added, as a share of its longer side in each view.",
          Range{0, 2});
    }
    template <class Self, class F> static void visit_rates(Self& self, F&& f) {
        f("rate_position", self.rate_position,
          "Learning rate of positions at the start, times the scene extent.", Range{0, 1});
        f("rate_position_end", self.rate_position_end,
          "Learning rate of positions at the end, times the scene extent.", Range{0, 1});
        f("rate_colour", self.rate_colour, "Learning rate of the base colour.", Range{0, 10});
        f("rate_sh", self.rate_sh, "Learning rate of view-dependent colour.", Range{0, 10});
        f("rate_opacity", self.rate_opacity, "Learning rate of opacities.", Range{0, 10});
        f("rate_scale", self.rate_scale, "Learning rate of scales.", Range{0, 10});
        f("rate_rotation", self.rate_rotation, "Learning rate of rotations.", Range{0, 10});
        f("geometry_share", self.geometry_share,
          "Factor of the position, scale, rotation and opacity rates of splats that were there before "
          "(modify mode).",
          Range{0, 1});
        f("colour_coupling", self.colour_coupling,
          "How much of a colour change is common to the whole label, which keeps texture and shading; 0 = "
          "every splat for "
          "itself.",
          Range{0, 1});
    }
    template <class Self, class F> static void visit_growth(Self& self, F&& f) {
        f("densify_from", self.densify_from, of_gradient("First iteration that may add splats."),
          Range{0, 1e6});
        f("densify_every", self.densify_every, "Iterations between densifications; 0 = never.",
          Range{0, 1e6});
        f("densify_until", self.densify_until,
          of_gradient("Share of the iterations after which none are added."), Range{0, 1});
        f("densify_percent", self.densify_percent,
          "Share of the labelled splats that may be cloned or split at once.", Range{0, 1});
        f("densify_min_gradient", self.densify_min_gradient, "Screen gradient below which nothing is added.",
          Range{0, 1});
        f("percent_dense", self.percent_dense,
          "Splats smaller than this share of the extent are cloned, others split.", Range{0, 1});
        f("min_opacity", self.min_opacity, "Labelled splats fainter than this are removed.", Range{0, 1});
        f("prune_scale", self.prune_scale,
          "Labelled splats that grew beyond this share of the extent are removed.", Range{0, 10});
        f("max_growth", self.max_growth, "Largest number of labelled splats, relative to the start.",
          Range{1, 100});
        f("max_aspect", self.max_aspect, "Largest ratio of the axes of new splats.", Range{1, 1e6});
        f("snapshot_every", self.snapshot_every, "Iterations between snapshots of a running edit.",
          Range{1, 1e6});
    }
};

/// Everything of an edit beside its words. Defaults suit the bundled model on two processor cores. All values
/// of the full-size method can be set. A stage depends on the structs it is given.
struct EditSettings : SearchSettings, LabelThresholds, LoopSettings, RearrangeSettings {
    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        SearchSettings::visit_fields(self, f);
        LabelThresholds::visit_fields(self, f);
        LoopSettings::visit_fields(self, f);
        RearrangeSettings::visit_fields(self, f);
    }
};

/// Request of an artist, as it is typed and written. Stages of a run take a CheckedRequest.
struct EditRequest : EditWords, EditSettings {
    /// Names of before, which recipes, projects and command lines may still use.
    static constexpr std::array<RenamedField, 10> Renamed{{{"rivals", "competing_words"},
                                                           {"second_look", "retry_passes"},
                                                           {"keep_mass", "min_cluster_mass"},
                                                           {"fallback_mass", "min_segment_attention"},
                                                           {"evidence_px", "coverage_px"},
                                                           {"focus", "reframe_views"},
                                                           {"tau", "label_threshold"},
                                                           {"left_out", "excluded_views"},
                                                           {"look_again", "prune_added"},
                                                           {"look_again_tau", "prune_added_threshold"}}};

    template <class Self, class F> static void visit_fields(Self& self, F&& f) {
        EditWords::visit_fields(self, f);
        EditSettings::visit_fields(self, f);
    }
};

/// Sets the fields named in `json`, as fields_from_json() does. Earlier versions wrote every field, set or
/// not: numbers that such a request has at their default are left unset. Throws Error.
void read_request(EditRequest& request, const nlohmann::ordered_json& json);

using language::EditMode;
using language::is_drawn;

/// "modify", "add" and so on, as `EditWords::mode` has it.
const char* mode_name(EditMode mode);
/// The mode of that name; nothing for others, "auto" among them.
std::optional<EditMode> mode_named(const std::string& name);

/// The values of LoopSettings::quality, from quick to thorough.
inline constexpr std::array<const char*, 3> Qualities{"draft", "normal", "fine"};

/// Rounds of redrawn views as an edit of a mode needs them: what has a new shape needs more than what is
/// recoloured.
struct RoundPlan {
    int rounds = 1;
    int fit_steps = 40;                             // after each round
    bool anew = false;                              // the inside of the masks becomes something else
    int view_steps = 4;                             // of the first round
    double strength = 0.75, again_strength = 0.75;  // of the first round and of the later ones
    int views = 8;                                  // redrawn in a round
    double guided_until = 0;  // noise level above which steps are guided against the negative prompt

    double strength_of(int round) const { return round == 0 ? strength : again_strength; }
    /// Denoising steps of a round: as many per strength as the first has.
    int steps_of(int round) const;
    /// Work in guided steps. One below `guided_until` counts half.
    double guided_steps_of(int round) const;
    /// Denoising steps of a view in the rounds that begin within the first `steps` steps of the loop.
    int view_steps_within(int steps) const;
};
/// With the quality in it; at least one view and one step.
RoundPlan round_plan(const LoopSettings& settings, EditMode mode);

/// How far a mask is grown, in its own pixels: what is new needs room.
double mask_growth(const LoopSettings& settings, EditMode mode, const Mask& mask);

}  // namespace gse::edit
