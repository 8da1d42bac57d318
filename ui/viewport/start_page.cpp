// Start page of the viewport: files to drop, recent scenes, the sample, recoverable work of a crash.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/io/formats/scene_formats.h"
#include "ui/commands/guarded.h"
#include "ui/model/glyphs.h"
#include "ui/state/state.h"
#include "ui/viewport/viewport.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"
#include "ui/widgets/sheet.h"

namespace gse::ui {
namespace {

constexpr std::size_t MostRecent = 8;
constexpr float RecentEm = 3;  // height of a recent file's row

/// An edit of the sample of each kind.
struct Example {
    const char* kind;
    const char* sentence;
};
constexpr Example Examples[] = {{"Another material", "a golden bear on the grass"},
                                {"Something added", "a bear wearing a blue hat on the grass"},
                                {"Another thing", "a yellow mushroom on the grass"}};
constexpr const char* SampleSource = "bear";

void draw_recoverable(Context& context) {
    for (std::size_t index = 0; index < context.model.recoverable.size(); ++index) {
        begin_notice(context, fmt::format("start.recovery.{}", index), palette::Warning);
        draw_recovery(context, "start", index, false);
        end_notice();
        ImGui::Spacing();
    }
}

/// Picture of a recent file, its name and its folder; a click opens it.
void draw_recent_file(Context& context, std::size_t index) {
    const auto& recent = context.model.recent[index];
    const auto& pictures = context.model.recent_pictures;
    const auto picture = index < pictures.size() ? pictures[index] : nullptr;
    const auto path = path_of(recent);
    const float height = context.em * RecentEm, width = std::round(height * 4 / 3);
    ImGui::PushID(static_cast<int>(index));
    const ImVec2 low = ImGui::GetCursorScreenPos();
    if (ImGui::Selectable("##recent", false, 0, {0, height})) open_path(context, recent);
    note(context, fmt::format("start.recent.{}", index));
    tooltip(recent);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 high(low.x + width, low.y + height);
    list->AddRectFilled(low, high, palette::Sunken, context.em * 0.2f);
    if (picture != nullptr) {
        add_filling_picture(context, picture, low, high, context.em * 0.2f);
        note_rect(context, fmt::format("start.recent.picture.{}", index), low, high);
    }
    const float left = high.x + context.em * 0.6f, room = ImGui::GetItemRectMax().x - left;
    list->AddText({left, low.y + height * 0.5f - context.em * 1.1f}, palette::Text,
                  shortened(utf8_of(path.filename()), room).c_str());
    list->AddText({left, low.y + height * 0.5f + context.em * 0.1f}, palette::TextDim,
                  shortened(utf8_of(path.parent_path()), room).c_str());
    ImGui::PopID();
}

void draw_recent(Context& context) {
    if (context.model.recent.empty()) return;
    heading(context, "Recent");
    const std::size_t count = std::min(MostRecent, context.model.recent.size());
    for (std::size_t index = 0; index < count; ++index) draw_recent_file(context, index);
}

/// Sentences to begin with. They open the sample and fill the panel Prompt.
void draw_examples(Context& context) {
    heading(context, "Try it on the sample");
    std::size_t index = 0;
    for (const auto& example : Examples) {
        if (button(context,
                   {.name = fmt::format("start.try.{}", index++),
                    .text = fmt::format("\"{}\"", example.sentence),
                    .tooltip = "Opens the sample with this sentence; then press Locate, and Edit"})) {
            context.request.source = SampleSource;
            context.request.prompt = example.sentence;
            context.request.target.clear();
            context.request.mode = "auto";
            context.request_changed = true;
            open_sample(context);
        }
        ImGui::SameLine();
        ImGui::AlignTextToFramePadding();
        dim_text(example.kind);
    }
    ImGui::Spacing();
}

void draw_loading(Context& context) {
    const auto& job = context.model.file_job;
    wrapped_text(job.title.empty() ? "Opening" : job.title);
    const float share = job.total > 0 ? static_cast<float>(job.step) / static_cast<float>(job.total) : 0;
    ImGui::ProgressBar(std::clamp(share, 0.0f, 1.0f), {-1, 0}, job.stage.c_str());
    if (button(context, {.name = "start.cancel", .text = "Cancel"})) context.emit(command::CancelFileJob{});
}

}  // namespace

void draw_start_page(Context& context) {
    const ImVec2 space = ImGui::GetContentRegionAvail();
    const float width = std::min(context.em * 32, space.x - context.em * 2);
    const float lines = 15.0f + 2.0f * static_cast<float>(std::min(MostRecent, context.model.recent.size())) +
                        7.0f * static_cast<float>(context.model.recoverable.size());
    const float top = std::max(context.em, (space.y - lines * ImGui::GetTextLineHeightWithSpacing()) * 0.4f);
    ImGui::SetCursorPos({std::max(0.0f, (space.x - width) * 0.5f), top});
    ImGui::BeginChild("page", {width, std::max(context.em * 3, space.y - top)}, false,
                      ImGuiWindowFlags_NavFlattened);
    if (context.model.file_job.running) {
        draw_loading(context);
        return ImGui::EndChild();
    }
    draw_recoverable(context);
    heading(context, "Drop a scene here");
    wrapped_text(
        fmt::format("{} files; a folder with a scene and its cameras; a project "
                    "(.gsep); or a screenshot that this program saved.",
                    in_words(readable_names(), "or")));
    ImGui::Spacing();
    if (button(context, {.name = "start.open",
                         .text = "Open...",
                         .tooltip = keys_of(context, Shortcut::Open),
                         .look = Look::Primary}))
        ask_open(context);
    flow(button_width("Open sample"));
    if (button(context, {.name = "start.sample",
                         .text = "Open sample",
                         .tooltip = "A small scene that comes with the program"}))
        open_sample(context);
    ImGui::Spacing();
    draw_examples(context);
    draw_recent(context);
    if (context.model.recent.empty())
        dim_text(
            "Then: type what to change on the right, press Locate, correct the label, press Edit. F1 "
            "opens the guide, Shift + F1 lists the keys.");
    ImGui::EndChild();
}

}  // namespace gse::ui
