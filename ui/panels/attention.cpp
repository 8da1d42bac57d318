// Attention: per view the render, the map of the word, the pixels above the threshold and the view's vote.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ui/commands/guarded.h"
#include "ui/model/threshold_picture.h"
#include "ui/panels/panels.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"
#include "ui/widgets/sheet.h"

namespace gse::ui {
namespace {

constexpr float ThumbnailEm = 3, LargestThumbnailEm = 9;  // side of a view's thumbnail
constexpr float StripGapEm = 0.25f;                       // between thumbnails
constexpr float LeastPictureEm = 5;                       // side of a picture of the chosen view

bool left_out(const AttentionView& view) { return view.step == edit::ViewStep::LeftOut; }

std::string branch_words(const AttentionView& view) {
    if (left_out(view)) return "You left this view out: it does not vote.";
    if (view.failed) {
        const std::string step = edit::step_text(view.step), remedy = edit::step_remedy(view.step);
        return fmt::format("This view does not vote{}{}{}{}.", step.empty() ? "" : ": ", step,
                           remedy.empty() ? "" : "; ", remedy);
    }
    if (view.branch == "text") return "The mask was found from the word itself.";
    if (view.branch == "points") return "The mask was cut out from clicks placed on the attention.";
    if (view.branch == "attention") return "The mask is the attention above the threshold.";
    if (view.branch == "drawn")
        return "The model drew it into this view; the mask is where all views say it goes.";
    if (view.branch == "anchor") return "The mask is the place where the new thing goes.";
    if (view.branch == "label") return "The mask is your label, seen from here.";
    if (view.branch == "none") return "There is no mask.";
    return view.branch.empty() ? std::string() : fmt::format("The mask was made by \"{}\".", view.branch);
}

/// Caption of a mask that was cut out of the attention of its own view.
std::string captured_words(const AttentionView& view) {
    const bool of_all_views = view.branch == "drawn" || view.branch == "anchor" || view.branch == "label";
    return of_all_views ? std::string()
                        : fmt::format("The mask holds {} of the attention.", percent_text(view.captured));
}

ImU32 state_colour(const AttentionView& view) {
    if (left_out(view) || view.mask == nullptr) return palette::TextDim;
    if (view.failed) return palette::Bad;
    return view.captured >= 0.5 ? palette::Good : palette::Warning;
}

/// Slanted line through an excluded thumbnail.
void cross_out(Context& context, ImVec2 low, ImVec2 high) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float inset = context.em * 0.3f;
    const ImVec2 from(low.x + inset, high.y - inset), to(high.x - inset, low.y + inset);
    list->AddLine(from, to, palette::Shade, context.em * 0.3f);
    list->AddLine(from, to, palette::Text, std::max(1.5f, context.em * 0.12f));
}

std::string thumbnail_help(const Context& context, const AttentionView& view) {
    if (view.render == nullptr) return "This view has not been looked from yet.";
    const auto captured = captured_words(view);
    return fmt::format(
        "{}\n{}\n{}{}{}Click: look through it, with its map over the picture. Ctrl + click: {}.", view.name,
        branch_words(view), captured, captured.empty() ? "" : "\n",
        context.model.attention_corrected ? "It voted before your corrections.\n" : "",
        left_out(view) ? "let it vote again" : "leave it out, where its mask is wrong");
}

/// One thumbnail: the map over the render, a dot for the vote, a frame when chosen.
void draw_thumbnail(Context& context, int index, float side) {
    auto& state = context.state.attention;
    const auto& view = context.model.attention[static_cast<std::size_t>(index)];
    ImGui::PushID(index);
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("view", {side, side}))
        ImGui::GetIO().KeyCtrl ? toggle_vote(context, index) : look_through_attention(context, index);
    note(context, fmt::format("attention.view.{}", index));
    const ImVec2 high(low.x + side, low.y + side);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const bool mask = state.over == Over::Mask && view.mask_picture != nullptr;
    const auto& picture = mask                           ? view.mask_picture
                          : view.map_coloured != nullptr ? view.map_coloured
                                                         : view.render;
    const float round = context.em * 0.2f;
    list->AddRectFilled(low, high, palette::Sunken, round);
    if (ImGui::IsItemVisible() && picture != nullptr)
        list->AddImageRounded(imgui_texture(context.textures.texture(picture)), low, high, {0, 0}, {1, 1},
                              view.failed ? IM_COL32(255, 255, 255, 90) : IM_COL32_WHITE, round);
    const float r = context.em * 0.22f;
    if (left_out(view)) cross_out(context, low, high);
    if (view.mask != nullptr) {
        list->AddCircleFilled({high.x - 2 * r, low.y + 2 * r}, r * 1.35f, palette::Shade);
        list->AddCircleFilled({high.x - 2 * r, low.y + 2 * r}, r, state_colour(view));
    }
    if (index == state.chosen)
        list->AddRect(low, high, palette::Accent, round, 0, std::max(2.0f, context.em * 0.14f));
    tooltip(thumbnail_help(context, view));
    ImGui::PopID();
}

/// All views: a line that scrolls sideways, or (upright) as large as they all fit, else columns that scroll
/// down.
void draw_strip(Context& context, ImVec2 size, bool upright) {
    const float gap = context.em * StripGapEm;
    SheetPlan plan{1 << 20, context.em * ThumbnailEm};
    if (upright)
        plan = fitted_sheet({static_cast<int>(context.model.attention.size()), 1, 0, gap},
                            size.x - ImGui::GetStyle().ScrollbarSize, size.y, context.em * ThumbnailEm,
                            context.em * LargestThumbnailEm);
    const int columns = plan.columns;
    const float side = plan.side;
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(gap, gap));
    const auto flags = ImGuiWindowFlags_NavFlattened |
                       (upright ? ImGuiWindowFlags_None : ImGuiWindowFlags_HorizontalScrollbar);
    if (ImGui::BeginChild("strip", size, false, flags))
        for (int index = 0; index < static_cast<int>(context.model.attention.size()); ++index) {
            if (index % columns != 0) ImGui::SameLine();
            draw_thumbnail(context, index, side);
        }
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

void draw_points(Context& context, const AttentionView& view, ImVec2 low, float scale) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float r = std::max(2.5f, context.em * 0.22f);
    for (const auto& point : view.points) {
        const ImVec2 at(low.x + static_cast<float>(point.x) * scale,
                        low.y + static_cast<float>(point.y) * scale);
        list->AddCircleFilled(at, r + 1.5f, IM_COL32(0, 0, 0, 200));
        list->AddCircleFilled(at, r, point.positive ? palette::Good : palette::Bad);
    }
}

/// One picture with its caption, as wide as `side`.
void draw_picture(Context& context, const AttentionView& view, const std::shared_ptr<const Image>& picture,
                  const char* caption, float side) {
    ImGui::BeginGroup();
    ImGui::PushStyleColor(ImGuiCol_Text, palette::TextDim);
    ImGui::TextUnformatted(shortened(caption, side).c_str());
    ImGui::PopStyleColor();
    const ImVec2 low = ImGui::GetCursorScreenPos();
    ImDrawList* list = ImGui::GetWindowDrawList();
    float width = side, height = side;
    if (picture != nullptr && picture->width > 0 && picture->height > 0) {
        const float scale = side / static_cast<float>(std::max(picture->width, picture->height));
        width = static_cast<float>(picture->width) * scale;
        height = static_cast<float>(picture->height) * scale;
        list->AddImage(imgui_texture(context.textures.texture(picture)), low,
                       {low.x + width, low.y + height});
        if (context.state.attention.points) draw_points(context, view, low, scale);
    } else {
        list->AddRectFilled(low, {low.x + side, low.y + side}, palette::Sunken);
    }
    ImGui::Dummy({width, height});
    note(context, fmt::format("attention.picture.{}", caption));
    ImGui::EndGroup();
}

double shown_threshold(const Context& context) {
    const auto& state = context.state.attention;
    return state.threshold >= 0 ? state.threshold : context.model.attention_threshold;
}

/// The thresholded picture of the chosen view, made anew only when view or threshold changed.
void update_picture(Context& context, const AttentionView& view) {
    auto& state = context.state.attention;
    const double threshold = shown_threshold(context);
    if (view.map == nullptr || view.render == nullptr) {
        state.picture = nullptr;
        state.picture_of = nullptr;
        return;
    }
    if (state.picture_of == view.map && state.picture_threshold == threshold) return;
    auto result = threshold_picture(*view.render, *view.map, threshold);
    state.picture = std::make_shared<const Image>(std::move(result.picture));
    state.above = result.share;
    state.picture_of = view.map;
    state.picture_threshold = threshold;
}

/// Buttons of the chosen view.
void draw_view_row(Context& context) {
    auto& state = context.state.attention;
    draw_vote(context, "attention.votes", state.chosen);
    flow(context.em * 5);
    checkbox(context, "attention.points", "Points", state.points,
             "Green: clicks inside, red: clicks outside");
    flow(button_width("Look through"));
    if (button(context, {.name = "attention.look",
                         .text = "Look through",
                         .tooltip = with_key(
                             context, "Puts the camera where this view is, with its map over the picture",
                             Shortcut::Evidence)}))
        look_through_attention(context, state.chosen);
}

void draw_controls(Context& context, const AttentionView& view) {
    auto& state = context.state.attention;
    dim_text("Threshold of the attention");
    double threshold = shown_threshold(context);
    const double low = 0, high = 1;
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    if (ImGui::SliderScalar("##attention.threshold", ImGuiDataType_Double, &threshold, &low, &high, "%.3f",
                            ImGuiSliderFlags_AlwaysClamp)) {
        state.threshold = threshold;
        context.emit(command::SetAttentionThreshold{threshold, false});
    }
    note(context, "attention.threshold");
    tooltip("Attention above this share of the maximum counts. All views and the label follow.");
    if (ImGui::IsItemDeactivatedAfterEdit()) context.emit(command::SetAttentionThreshold{threshold, true});
    if (ImGui::IsItemDeactivated()) state.threshold = -1;
    wrapped_text(fmt::format("{} of this view is above it.", percent_text(state.above)));
    ImGui::Spacing();
    bullet_dot(state_colour(view));
    wrapped_text(view.name);
    dim_text(branch_words(view));
    if (!view.failed && view.mask != nullptr)
        if (const auto words = captured_words(view); !words.empty()) dim_text(words);
}

/// Outcome of a search that labelled nothing, and the ways on.
void draw_problem(Context& context) {
    const auto& search = context.model.search;
    if (search.problem == edit::SearchProblem::None) return;
    coloured_text(palette::Warning, fmt::format("Nothing was labelled: {}.", search.message));
    dim_text(fmt::format("What helps: {}.", search.remedy));
    const std::string why = why_not_work(context);
    if (button(
            context,
            {.name = "attention.by_hand",
             .text = "Label it by hand",
             .why_off = why,
             .tooltip = "Makes a label and gives you Cut out: click on the thing, or drag a box around it"}))
        label_by_hand(context, context.model.attention_word);
    if (search.problem != edit::SearchProblem::Unsure) return;
    constexpr const char* anyway = "Label this all the same";
    flow(button_width(anyway));
    if (button(context,
               {.name = "attention.anyway",
                .text = anyway,
                .why_off = why,
                .tooltip = "The pictures show what was found. If it is what you mean, it can be labelled."}))
        context.emit(command::LabelAnyway{});
}

/// How sure the search is, with what the figure is made of.
void draw_confidence(Context& context) {
    const auto& search = context.model.search;
    if (search.number == 0 || search.confidence.value < 0) return;
    const bool unsure = search.problem != edit::SearchProblem::None;
    const std::string text = fmt::format("{} sure", percent_text(search.confidence.value));
    flow(ImGui::CalcTextSize(text.c_str()).x + context.em);
    badge(context, text, unsure ? palette::Warning : palette::Good);
    note(context, "attention.confidence");
    std::string parts = "How sure the search is.";
    for (const auto& part : search.confidence.parts)
        parts += "\n" + fmt::format(fmt::runtime(part.sentence), percent_text(part.value));
    tooltip(parts);
}

/// Side of the scene that the model takes for its front, if it was read off the scene.
void draw_front(Context& context) {
    const auto& front = context.model.search.front;
    if (!front) return;
    const std::string text = fmt::format("front at {:.0f}°", *front);
    flow(ImGui::CalcTextSize(text.c_str()).x + context.em);
    badge(context, text, palette::TextDim);
    note(context, "attention.front");
    tooltip(
        "The side from which the scene shows its front, as the pictures have it or, where the model is not "
        "sure of it, the side that you "
        "had turned to: the model is told which view is a front, side or back view.\nWhere that is wrong, "
        "turn the scene to its front "
        "before Locate, or set Front in Settings, in degrees, or none.");
}

/// Note about pictures that show more than the scene.
void draw_ground(Context& context) {
    if (!context.model.search.on_ground) return;
    const char* text = "on a plain ground";
    flow(ImGui::CalcTextSize(text).x + context.em);
    badge(context, text, palette::TextDim);
    note(context, "attention.ground");
    tooltip(
        "The scene was cut out of its surroundings. The model knows things on a ground: it was shown one "
        "below this scene, and a sky behind it.\n"
        "None of that becomes part of the scene.");
}

/// How far the search is that the views come from.
void draw_arriving(Context& context) {
    const auto& views = context.model.attention;
    const auto here = std::count_if(views.begin(), views.end(),
                                    [](const AttentionView& view) { return view.render != nullptr; });
    badge(context, "looking", palette::Accent);
    ImGui::SameLine();
    const std::string text = fmt::format("{} of {} views so far", here, views.size());
    ImGui::TextUnformatted(shortened(text, ImGui::GetContentRegionAvail().x).c_str());
    note(context, "attention.arriving");
    tooltip(context.model.job.stage);
}

/// Word, mode, how many views vote, and how sure the search is.
void draw_summary(Context& context) {
    const auto& views = context.model.attention;
    if (context.model.attention_arriving) return draw_arriving(context);
    const auto voting =
        std::count_if(views.begin(), views.end(), [](const AttentionView& view) { return !view.failed; });
    badge(context, context.model.attention_word, palette::Accent);
    ImGui::SameLine();
    const std::string votes = fmt::format("{} of {} views vote", voting, views.size());
    ImGui::TextUnformatted(shortened(votes, ImGui::GetContentRegionAvail().x).c_str());
    tooltip(context.model.attention_mode);
    draw_confidence(context);
}

/// Front and ground that the search saw.
void draw_findings(Context& context) {
    if (context.model.attention_arriving) return;
    ImGui::Dummy({0, 0});
    draw_front(context);
    draw_ground(context);
    if (!context.model.attention_corrected) return;
    bullet_dot(palette::Warning);
    wrapped_text("The masks are from before your corrections: the label on the splats counts.");
    note(context, "attention.corrected");
}

/// Pictures of the chosen view, `columns` beside each other. The first is left out where they would get too
/// small.
void draw_pictures(Context& context, const AttentionView& view, ImVec2 space, int columns) {
    const std::array<std::pair<const std::shared_ptr<const Image>*, const char*>, 4> all{
        {{&view.render, view.drawn ? "As drawn" : "Render"},
         {&view.map_coloured, "Attention"},
         {&context.state.attention.picture, "Above threshold"},
         {&view.mask_picture, context.model.attention_corrected ? "Older mask" : "Voted mask"}}};
    const float gap = ImGui::GetStyle().ItemSpacing.x, line = ImGui::GetTextLineHeightWithSpacing();
    const auto side_of = [&](int count) {
        return (space.x - gap * static_cast<float>(count - 1)) / static_cast<float>(count);
    };
    const bool row = columns > 2;
    int first = 0;
    if (row && side_of(4) < std::min(context.em * 10, space.y - line)) first = 1;
    const int in_row = row ? 4 - first : columns;
    float side = side_of(in_row);
    if (row) side = std::min(side, std::max(context.em * LeastPictureEm, space.y - line));
    for (int at = first; at < 4; ++at) {
        if ((at - first) % in_row != 0) ImGui::SameLine();
        draw_picture(context, view, *all[static_cast<std::size_t>(at)].first,
                     all[static_cast<std::size_t>(at)].second, std::floor(side));
    }
}

/// Thumbnails, pictures and controls beside each other.
void draw_wide(Context& context, const AttentionView& view) {
    const ImVec2 space = ImGui::GetContentRegionAvail();
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const float columns = space.y < context.em * 18 ? 2 : 3, line = ImGui::GetTextLineHeightWithSpacing();
    const float least_strip =
        context.em * (ThumbnailEm + StripGapEm) * columns + ImGui::GetStyle().ScrollbarSize;
    const float controls = std::clamp(space.x * 0.26f, context.em * 13, context.em * 22);
    // The pictures are as high as the panel; the views take the rest of its width.
    const float pictures = std::min(space.x - least_strip - controls - 2 * gap,
                                    4 * std::max(context.em * LeastPictureEm, space.y - line) + 3 * gap);
    const float strip = space.x - pictures - controls - 2 * gap;
    draw_strip(context, {strip, space.y}, true);
    ImGui::SameLine();
    if (ImGui::BeginChild("pictures", {pictures, space.y}, false,
                          ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NavFlattened))
        draw_pictures(context, view, {pictures, space.y}, 4);
    ImGui::EndChild();
    ImGui::SameLine();
    if (ImGui::BeginChild("controls", {0, space.y}, false, ImGuiWindowFlags_NavFlattened)) {
        draw_summary(context);
        draw_problem(context);
        draw_view_row(context);
        draw_controls(context, view);
        draw_findings(context);
    }
    ImGui::EndChild();
}

/// One below the other, for a narrow place.
void draw_narrow(Context& context, const AttentionView& view) {
    draw_summary(context);
    draw_strip(context, {0, context.em * 3.1f + ImGui::GetStyle().ScrollbarSize}, false);
    draw_problem(context);
    draw_view_row(context);
    draw_controls(context, view);
    draw_findings(context);
    draw_pictures(context, view, ImGui::GetContentRegionAvail(), 2);
}

}  // namespace

void draw_attention_panel(Context& context) {
    const auto& views = context.model.attention;
    auto& state = context.state.attention;
    if (views.empty()) {
        dim_text(context.model.job.running ? "Views appear here while Locate works."
                                           : "Type what the edit is about and press Locate: every view then "
                                             "shows where the word landed and what it voted for.");
        if (!context.model.job.running &&
            button(context,
                   {.name = "attention.locate", .text = "Locate", .why_off = why_not_locate(context)}))
            run_locate(context);
        return;
    }
    state.chosen = std::clamp(state.chosen, 0, static_cast<int>(views.size()) - 1);
    const auto& view = views[static_cast<std::size_t>(state.chosen)];
    update_picture(context, view);
    const ImVec2 space = ImGui::GetContentRegionAvail();
    if (space.x > context.em * 42) draw_wide(context, view);
    else draw_narrow(context, view);
}

}  // namespace gse::ui
