// Evidence of a search in one view, over the picture. Shown while the camera stands at that view.
#include <algorithm>
#include <cmath>
#include <string>

#include "engine/scene/viewpoints.h"
#include "ui/commands/guarded.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"

namespace gse::ui {
namespace {

constexpr double SameTurn = 1e-4;   // of an axis, 0.006 degrees: a camera that is sent glides no nearer
constexpr double SamePlace = 1e-4;  // of the home radius

/// True when the picture is seen from there, whatever its size.
bool stands_at(const Context& context, const Camera& camera) {
    const Camera& shown = context.model.camera;
    if (shown.width <= 0 || camera.width <= 0 || !(camera.fx > 0) || !(shown.fx > 0)) return false;
    if (length(shown.centre() - camera.centre()) > SamePlace * context.model.orbit.radius) return false;
    for (int axis = 0; axis < 3; ++axis)
        if (length(shown.rotation.row(axis) - camera.rotation.row(axis)) > SameTurn) return false;
    return true;
}

/// Picture [H,W,4]: attention in false colour, pixels without any darkened.
Image attention_layer(const Image& map) {
    Image layer(map.width, map.height, 4);
    for (std::size_t i = 0; i < layer.pixel_count(); ++i) {
        const float m = std::clamp(map.data[i], 0.0f, 1.0f);
        float* out = &layer.data[i * 4];
        out[0] = std::min(1.0f, 1.7f * m), out[1] = m * m, out[2] = 0.3f * (1 - m), out[3] = 0.42f + 0.3f * m;
    }
    return layer;
}

/// Picture [H,W,4]: the mask tinted, the rest darkened.
Image mask_layer(const Mask& mask) {
    Image layer(mask.width, mask.height, 4);
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        const bool in = mask.data[i] != 0;
        float* out = &layer.data[i * 4];
        out[0] = in ? 1.0f : 0, out[1] = in ? 0.55f : 0, out[2] = in ? 0.1f : 0, out[3] = in ? 0.5f : 0.45f;
    }
    return layer;
}

void make_layer(AttentionState& state, const AttentionView& view) {
    const std::shared_ptr<const void> of =
        state.over == Over::Mask ? std::shared_ptr<const void>(view.mask) : view.map;
    if (state.layer_of == of) return;
    state.layer_of = of;
    state.layer = nullptr;
    if (of == nullptr) return;
    const bool made = state.over != Over::Mask || !view.mask->data.empty();
    if (made)
        state.layer = std::make_shared<const Image>(state.over == Over::Mask ? mask_layer(*view.mask)
                                                                             : attention_layer(*view.map));
}

}  // namespace

const AttentionView* view_looked_through(const Context& context) {
    const auto& state = context.state.attention;
    const auto& views = context.model.attention;
    if (state.over == Over::Nothing || context.model.comparison != Comparison::None || !context.scene_open())
        return nullptr;
    if (state.chosen < 0 || state.chosen >= static_cast<int>(views.size())) return nullptr;
    const auto& view = views[static_cast<std::size_t>(state.chosen)];
    return stands_at(context, view.camera) ? &view : nullptr;
}

void look_through_attention(Context& context, int index) {
    const auto& views = context.model.attention;
    if (index < 0 || index >= static_cast<int>(views.size())) return;
    auto& state = context.state.attention;
    state.chosen = index;
    if (state.over == Over::Nothing) state.over = Over::Attention;
    const Camera& camera = views[static_cast<std::size_t>(index)].camera;
    const Camera& shown = context.model.camera;
    if (camera.width <= 0 || shown.width <= 0) return;  // it has not come yet
    context.emit(command::SetCamera{fitted(camera, shown.width, shown.height)});
}

void draw_vote(Context& context, const char* name, int index) {
    const auto& view = context.model.attention[static_cast<std::size_t>(index)];
    const bool left_out = view.step == edit::ViewStep::LeftOut;
    std::string why = why_not_vote(context);
    if (why.empty() && view.failed && !left_out) why = "Nothing was found in this view";
    bool votes = !view.failed;
    ImGui::BeginDisabled(!why.empty());
    if (checkbox(context, name, "Votes", votes)) toggle_vote(context, index);
    ImGui::EndDisabled();
    tooltip(!why.empty() ? why
                         : "Whether this view has a say in what is labelled. Untick it where its mask is "
                           "wrong (Ctrl + click on its thumbnail); "
                           "undo brings it back.");
}

void draw_evidence(Context& context, ImDrawList* list) {
    const AttentionView* view = view_looked_through(context);
    if (view == nullptr) return;
    auto& state = context.state.attention;
    make_layer(state, *view);
    const Camera &from = view->camera, &shown = context.model.camera;
    const auto at = [&](double x, double y) {
        return to_screen(context, (x - from.cx) / from.fx * shown.fx + shown.cx,
                         (y - from.cy) / from.fy * shown.fy + shown.cy);
    };
    const ImVec2 low = at(0, 0), high = at(from.width, from.height);
    if (state.layer != nullptr)
        list->AddImage(imgui_texture(context.textures.texture(state.layer)), low, high);
    list->AddRect(low, high, with_alpha(palette::Text, 0.35f));
    note_rect(context, "viewport.evidence", low, high);
}

}  // namespace gse::ui
