// Measurement of one edit: where it was found, how near the truth it came, what else it changed.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/edit/interfaces/image_text_encoder.h"
#include "engine/edit/optimise/edit_loop.h"
#include "engine/edit/request/scales.h"
#include "engine/edit/search/locate.h"
#include "engine/laboratory/eval/eval_suite.h"
#include "engine/pipeline/scene/scene_tools.h"

namespace gse::bench {

constexpr double PartShare = 0.5;    // a pixel shows a part, or a label, when more than half of it is its
constexpr double TraceShare = 0.02;  // splats that make up less of a pixel hardly show

/// A row of cameras with the view words of each.
struct EvalViews {
    std::vector<View> views;
    std::vector<std::string> words;
};

/// A case with its scenes and cameras.
struct EvalSetting {
    EvalCase edit;
    synth::SynthScene source;
    synth::SynthScene target;  // what a new thing's heading and size are is for settle_pose() to say
    EvalViews seen;            // the edit's views
    EvalViews held_out;        // between them
    edit::EditRequest request;
};

/// Rendering and the optional encoder; both outlive the figures.
struct EvalTools {
    pipeline::Painter& painter;
    edit::ImageTextEncoder* score = nullptr;  // null = the figures of direction are null
};

/// The scenes and views of a case. `held_out_views` cameras stand between the request's.
EvalSetting make_setting(const EvalCase& edit, const edit::EditRequest& settings, int held_out_views);

/// The kind of edit that the case's sentence asks for.
edit::EditMode right_mode(const EvalCase& edit);

/// Takes the true scene that is nearest to the edited one on the held-out views, out of eight headings, then
/// three sizes. The sentence leaves both open. Nothing changes for edits in which no object is replaced.
void settle_pose(EvalSetting& setting, const GaussianSet& edited, const EvalTools& tools);

/// [rows] 1 where a row belongs to the part.
std::vector<std::uint8_t> rows_of(const synth::SynthScene& scene, synth::Part part);

/// Mask of a part of a scene as a camera sees it: where its splats make up more than `share` of the pixel.
Mask part_mask(pipeline::Painter& painter, const synth::SynthScene& scene, synth::Part part,
               const Camera& camera, double share);

/// Localization against the truth, over the edit's views. Existing things: Gaussian IoU, masks, label
/// renders; added ones: how much of the true place the masks cover.
nlohmann::ordered_json located_figures(const EvalSetting& setting, const edit::LocateResult& located,
                                       const EvalTools& tools);

/// The edited scene against the true one and the source, over the held-out views, and outside the plan's own
/// masks over the edit's views.
nlohmann::ordered_json edited_figures(const EvalSetting& setting, const edit::EditPlan& plan,
                                      const edit::EditResult& result, const EvalTools& tools);

/// PSNR, SSIM and leak outside masks, pooled over pictures.
class OutsideFigures {
public:
    void add(const Image& before, const Image& after, const Mask& mask);
    double psnr_db() const;
    double ssim() const;
    double leak_rate() const;
    std::size_t pixels() const { return pixels_; }

private:
    double squared_error_ = 0, ssim_ = 0, leaked_ = 0;
    std::size_t pixels_ = 0;
};

}  // namespace gse::bench
