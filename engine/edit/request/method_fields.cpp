// Two lists of names; a test changes every one of them and asks that nothing else changes.
#include "engine/edit/request/method_fields.h"

#include <algorithm>
#include <array>

namespace gse::edit {
namespace {

using Names = std::string_view;

/// Of the gradient, its masks that follow the edit, and the pseudo ground truth. Growth comes once per round
/// instead.
constexpr std::array<Names, 22> GradientOnly{
    "iterations",     "guidance_weight", "gate_guidance", "preserve",      "l1",
    "ssim",           "dynamic_mask",    "dynamic_from",  "dynamic_every", "look_again",
    "look_again_tau", "densify_from",    "densify_until", "t_min",         "t_max_start",
    "t_max_end",      "guidance_scale",  "clamp",         "weight",        "sample_posterior",
    "delta",          "before_prompt"};
constexpr std::array<Names, 19> ViewsOnly{"quality",
                                          "edited_views",
                                          "rounds",
                                          "view_steps",
                                          "fit_steps",
                                          "view_strength",
                                          "view_guidance_scale",
                                          "shape_rounds",
                                          "shape_steps",
                                          "add_rounds",
                                          "shape_fit_steps",
                                          "shape_strength",
                                          "shape_again_strength",
                                          "shape_views",
                                          "shape_guided_until",
                                          "shape_guidance_scale",
                                          "restyle_steps",
                                          "restyle",
                                          "restyle_guidance_scale"};

template <std::size_t N> bool among(const std::array<Names, N>& names, std::string_view field) {
    return std::find(names.begin(), names.end(), field) != names.end();
}

}  // namespace

bool has_effect(std::string_view field, bool by_views) {
    return by_views ? !among(GradientOnly, field) : !among(ViewsOnly, field);
}

std::string_view why_unused(std::string_view field, bool by_views) {
    if (has_effect(field, by_views)) return {};
    return by_views ? "Has no effect now: views are redrawn and fitted to. It counts with method sds."
                    : "Has no effect now: the model pulls at every step. It counts with method views.";
}

}  // namespace gse::edit
