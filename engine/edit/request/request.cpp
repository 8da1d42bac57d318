// Reading of settings, and the rounds and masks that follow from them.
#include "engine/edit/request/request.h"

#include <algorithm>
#include <cmath>

#include "engine/edit/request/scales.h"
#include "engine/localize/clusters.h"

namespace gse::edit {

namespace {

/// Tells whether a version before numbers could be unset has written the request: all of those had this
/// field.
bool of_earlier_version(const nlohmann::ordered_json& json) {
    return json.contains(LoopSettings::RetiredFields.front().name);
}

}  // namespace

void read_request(EditRequest& request, const nlohmann::ordered_json& json) {
    fields_from_json(request, json);
    if (!of_earlier_version(json)) return;
    EditRequest::visit_fields(request, [](const char*, auto& value, const char*, const auto&...) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Overridable>)
            if (value.is_standard()) value.unset();
    });
}

int RoundPlan::steps_of(int round) const {
    return std::max(1, static_cast<int>(std::ceil(view_steps * strength_of(round) / strength - 1e-9)));
}

double RoundPlan::guided_steps_of(int round) const {
    constexpr double unguided = 0.5;  // of the two passes of a guided step
    const int steps = steps_of(round);
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        sum += strength_of(round) * (steps - i) / steps > guided_until ? 1 : unguided;
    return sum;
}

int RoundPlan::view_steps_within(int steps) const {
    int sum = 0;
    for (int round = 0; round * fit_steps < steps; ++round) sum += steps_of(round);
    return sum;
}

namespace {

/// Work of the views and of their steps.
struct QualityShare {
    double views = 1, steps = 1;
};

QualityShare share_of(const std::string& quality) {
    if (quality == Qualities.front()) return {0.5, 0.75};
    if (quality == Qualities.back()) return {2, 1.5};
    return {};
}

}  // namespace

RoundPlan round_plan(const LoopSettings& settings, EditMode mode) {
    RoundPlan plan{mode == EditMode::Add ? settings.add_rounds : settings.shape_rounds,
                   settings.shape_fit_steps,
                   true,
                   settings.shape_steps,
                   settings.shape_strength,
                   settings.shape_again_strength,
                   settings.shape_views,
                   settings.shape_guided_until};
    if (mode == EditMode::Modify)
        plan = {settings.rounds,      settings.fit_steps,     false,
                settings.view_steps,  settings.view_strength, settings.view_strength,
                settings.edited_views};
    const auto share = share_of(settings.quality);
    const auto scaled = [](int count, double by) {
        return std::max(1, static_cast<int>(std::lround(count * by)));
    };
    plan.views = scaled(plan.views, share.views);
    plan.view_steps = scaled(plan.view_steps, share.steps);
    return plan;
}

double mask_growth(const LoopSettings& settings, EditMode mode, const Mask& mask) {
    const double px = settings.dilate_px * mask.width / ReferenceSide;
    if (mode != EditMode::Add) return px;
    const auto box = localize::bounds_of(mask);
    return std::max(2 * px, settings.add_margin * std::max(box.width, box.height));
}

}  // namespace gse::edit
