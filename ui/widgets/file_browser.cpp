// File dialog inside the window: folders first, typed paths with completion, recent places, keyboard.
#include "ui/widgets/file_browser.h"

#include <fmt/format.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <set>

#include "ui/keys/keyboard.h"
#include "ui/keys/keys.h"
#include "ui/widgets/controls.h"
#include "ui/widgets/icons.h"

namespace gse::ui {
namespace {

/// Completes the typed text on Tab.
int complete(ImGuiInputTextCallbackData* data) {
    const std::string longer =
        completed_path(std::string(data->Buf, static_cast<std::size_t>(data->BufTextLen)));
    data->DeleteChars(0, data->BufTextLen);
    data->InsertChars(0, longer.c_str());
    return 0;
}

bool is_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

bool is_there(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

/// Keeps the list clear of the controls below it.
float footer_height(Context& context, bool saves) {
    return ImGui::GetFrameHeightWithSpacing() * (saves ? 2.0f : 1.0f) + context.em * 0.2f;
}

}  // namespace

void FileBrowser::ask(FileQuestion question) {
    question_ = std::move(question);
    std::error_code ignored;
    std::filesystem::path start = expanded_path(question_.start);
    if (start.is_relative() && !start.empty())
        start = (folder_.empty() ? std::filesystem::current_path(ignored) : folder_) / start;
    name_ = question_.saves && !is_folder(start) ? utf8_of(start.filename()) : std::string();
    if (!is_folder(start)) start = start.parent_path();
    if (!is_folder(start)) start = folder_.empty() ? std::filesystem::current_path(ignored) : folder_;
    pending_ = true;
    all_files_ = done_ = overwrite_asked_ = false;
    enter(start);
}

void FileBrowser::enter(const std::filesystem::path& folder) {
    std::error_code error;
    const auto whole = std::filesystem::weakly_canonical(folder, error);
    folder_ = error ? folder : whole;
    typed_ = utf8_of(folder_);
    if (!typed_.ends_with('/')) typed_ += '/';
    listing_ = list_folder(folder_, all_files_ ? std::vector<std::string>() : question_.extensions);
    selected_ = -1;
    scroll_ = true;
    type_ahead_.clear();
}

/// Name as it will be written: with the ending that the files have.
std::string FileBrowser::full_name() const {
    const bool ends = question_.extensions.empty() || has_extension(name_, question_.extensions);
    return ends || name_.empty() ? name_ : name_ + question_.extensions.front();
}

std::filesystem::path FileBrowser::chosen() const {
    if (question_.saves) return name_.empty() ? std::filesystem::path() : folder_ / path_of(full_name());
    if (selected_ >= 0) return folder_ / path_of(listing_.entries[static_cast<std::size_t>(selected_)].name);
    return question_.folder_allowed ? folder_ : std::filesystem::path();
}

std::string FileBrowser::why_not() const {
    if (!chosen().empty()) return {};
    return question_.saves ? "Type a name for the file" : "Choose a file";
}

void FileBrowser::finish(const std::filesystem::path& path) {
    if (question_.saves && question_.replaces && is_there(path) && !overwrite_asked_) {
        overwrite_asked_ = true;
        return;
    }
    done_ = true;
    const auto answer = std::move(question_.answer);
    if (answer) answer(path);
}

void FileBrowser::activate(int index) {
    if (index < 0 || index >= static_cast<int>(listing_.entries.size())) return;
    const auto& entry = listing_.entries[static_cast<std::size_t>(index)];
    const auto path = folder_ / path_of(entry.name);
    if (entry.is_folder) return enter(path);
    if (!question_.saves) return finish(path);
    name_ = entry.name;
    overwrite_asked_ = false;
}

void FileBrowser::keys(bool elsewhere) {
    if (ImGui::GetIO().WantTextInput || elsewhere) return;
    const int count = static_cast<int>(listing_.entries.size());
    const auto step_to = [&](int index) {
        selected_ = std::clamp(index, 0, std::max(0, count - 1));
        scroll_ = true;
        follow_ = entry_focused_;
        keep_focus();
    };
    if (count > 0 && ImGui::IsKeyPressed(key::Down)) step_to(selected_ + 1);
    if (count > 0 && ImGui::IsKeyPressed(key::Up)) step_to(selected_ < 0 ? count - 1 : selected_ - 1);
    if (count > 0 && ImGui::IsKeyPressed(key::Home)) step_to(0);
    if (count > 0 && ImGui::IsKeyPressed(key::End)) step_to(count - 1);
    if (ImGui::IsKeyPressed(key::Backspace)) return enter(folder_.parent_path());
    if (ImGui::IsKeyPressed(key::Enter, false) || ImGui::IsKeyPressed(key::KeypadEnter, false)) {
        if (selected_ >= 0) return activate(selected_);
        if (why_not().empty()) return finish(chosen());
    }
    // Typed letters jump to the first name that begins with them.
    const double now = ImGui::GetTime();
    for (const ImWchar letter : ImGui::GetIO().InputQueueCharacters) {
        if (letter < 33 || letter > 126) continue;
        if (now - typed_at_ > 1.0) type_ahead_.clear();
        typed_at_ = now;
        type_ahead_ += static_cast<char>(std::tolower(static_cast<int>(letter)));
        for (int index = 0; index < count; ++index) {
            std::string name =
                listing_.entries[static_cast<std::size_t>(index)].name.substr(0, type_ahead_.size());
            std::transform(name.begin(), name.end(), name.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
            if (name != type_ahead_) continue;
            step_to(index);
            break;
        }
    }
}

void FileBrowser::draw_path(Context& context) {
    if (icon_button(context,
                    {.name = "files.parent", .icon = Icon::Up, .tooltip = "Parent folder (Backspace)"}))
        enter(folder_.parent_path());
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
    const bool entered = ImGui::InputText(
        "##files.path", &typed_,
        ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion, complete);
    note(context, "files.path");
    takes_letters(context);
    tooltip("Type a path; Tab completes it, Enter goes there");
    if (!entered || typed_.empty()) return;
    const auto path = expanded_path(typed_);
    if (is_folder(path)) return enter(path);
    if (question_.saves && is_folder(path.parent_path())) {
        enter(path.parent_path());
        name_ = utf8_of(path.filename());
    } else if (is_there(path)) {
        finish(path);
    } else {
        listing_.problem = fmt::format("There is no \"{}\".", typed_);
    }
}

void FileBrowser::draw_places(Context& context) {
    const auto place = [&](const char* text, const std::filesystem::path& folder) {
        if (folder.empty() || !is_folder(folder)) return;
        if (ImGui::Selectable(text, folder == folder_)) enter(folder);
        note(context, fmt::format("files.place.{}", text));
    };
    dim_text("Places");
    place("Home", home_folder());
    place("Documents", home_folder() / "Documents");
    place("Downloads", home_folder() / "Downloads");
    place("Root", "/");
    if (context.model.recent.empty()) return;
    ImGui::Spacing();
    dim_text("Recent");
    std::set<std::string> seen;
    for (const auto& recent : context.model.recent) {
        const auto folder = path_of(recent).parent_path();
        if (!seen.insert(utf8_of(folder)).second || !is_folder(folder)) continue;
        ImGui::PushID(recent.c_str());
        const std::string text = shortened(utf8_of(folder.filename()), ImGui::GetContentRegionAvail().x);
        if (ImGui::Selectable(text.c_str(), folder == folder_)) enter(folder);
        tooltip(utf8_of(folder));
        ImGui::PopID();
    }
}

void FileBrowser::draw_entry(Context& context, int index) {
    const auto& entry = listing_.entries[static_cast<std::size_t>(index)];
    ImGui::PushID(index);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float line = ImGui::GetTextLineHeight();
    // To Tab and arrows the list is one control: its chosen entry.
    const bool reached = index == std::max(0, selected_);
    ImGui::PushItemFlag(ImGuiItemFlags_NoNav, !reached);
    const bool pressed =
        ImGui::Selectable("##entry", selected_ == index,
                          ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowDoubleClick |
                              ImGuiSelectableFlags_DontClosePopups);
    note(context, fmt::format("files.entry.{}", entry.name));
    ImGui::PopItemFlag();
    if (reached && follow_) {
        focus_last_item(context);
        follow_ = false;
    }
    entry_focused_ |= reached && has_focus();
    draw_icon(ImGui::GetWindowDrawList(), entry.is_folder ? Icon::Folder : Icon::File,
              {at.x + context.em * 0.6f, at.y + line * 0.5f}, context.em * 0.85f,
              entry.is_folder ? palette::Accent : palette::TextDim);
    ImGui::SetCursorScreenPos({at.x + context.em * 1.5f, at.y});
    plain_text(entry.name);
    ImGui::TableNextColumn();
    if (!entry.is_folder) ImGui::TextUnformatted(bytes_text(static_cast<double>(entry.bytes)).c_str());
    if (selected_ == index && scroll_) {
        ImGui::SetScrollHereY();
        scroll_ = false;
    }
    ImGui::PopID();
    if (!pressed) return;
    selected_ = index;
    if (question_.saves && !entry.is_folder) name_ = entry.name;
    overwrite_asked_ = false;
    if (ImGui::IsMouseDoubleClicked(0)) activate(index);
}

void FileBrowser::draw_entries(Context& context) {
    if (!listing_.problem.empty()) coloured_text(palette::Warning, listing_.problem);
    if (listing_.entries.empty() && listing_.problem.empty())
        dim_text(all_files_ || question_.extensions.empty() ? "Empty folder."
                                                            : "No folder and no file of a known kind here.");
    if (!ImGui::BeginTable("entries", 2, ImGuiTableFlags_RowBg)) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("size", ImGuiTableColumnFlags_WidthFixed, context.em * 5);
    // Entering a folder replaces the list: stop at once.
    const auto folder = folder_;
    for (int index = 0; index < static_cast<int>(listing_.entries.size()) && folder == folder_ && !done_;
         ++index)
        draw_entry(context, index);
    ImGui::EndTable();
    if (listing_.truncated) dim_text("There is more; type a path above.");
}

void FileBrowser::draw_footer(Context& context) {
    if (question_.saves) {
        const bool entered = text_input(context, "files.name", name_, "name of the file",
                                        ImGuiInputTextFlags_EnterReturnsTrue);
        if (ImGui::IsItemEdited()) overwrite_asked_ = false;
        if (entered && why_not().empty()) finish(chosen());
    } else if (!question_.extensions.empty()) {
        if (checkbox(context, "files.all", "All files", all_files_)) enter(folder_);
        ImGui::SameLine();
    }
    const std::string why = why_not();
    const std::string text = overwrite_asked_                            ? "Overwrite"
                             : selected_ < 0 && question_.folder_allowed ? "Open this folder"
                                                                         : question_.confirm;
    const float width = button_width(text) + button_width("Cancel") + ImGui::GetStyle().ItemSpacing.x;
    if (question_.saves && full_name() != name_ && !overwrite_asked_) {
        ImGui::AlignTextToFramePadding();
        dim_text(fmt::format("Written as {}", full_name()));
        ImGui::SameLine();
    }
    if (overwrite_asked_) {
        ImGui::AlignTextToFramePadding();
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(palette::Warning), "The file exists.");
        ImGui::SameLine();
    }
    ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetWindowContentRegionMax().x - width));
    if (button(context, {.name = "files.cancel", .text = "Cancel"})) done_ = true;
    ImGui::SameLine();
    if (button(context, {.name = "files.confirm",
                         .text = text,
                         .why_off = why,
                         .look = overwrite_asked_ ? Look::Danger : Look::Primary})) {
        const auto path = chosen();
        if (!question_.saves && selected_ >= 0 && is_folder(path) && !question_.folder_allowed) enter(path);
        else finish(path);
    }
}

void FileBrowser::draw(Context& context) {
    const std::string id = question_.title + "###files";
    if (pending_) {
        ImGui::OpenPopup("###files");
        pending_ = false;
        open_ = true;
    }
    if (!open_) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const ImVec2 size(std::min(context.em * 52, screen.x * 0.94f),
                      std::min(context.em * 34, screen.y * 0.9f));
    ImGui::SetNextWindowSize(size);
    ImGui::SetNextWindowPos({screen.x * 0.5f, screen.y * 0.5f}, ImGuiCond_Always, {0.5f, 0.5f});
    bool stays = true;
    if (!ImGui::BeginPopupModal(id.c_str(), &stays, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
        open_ = false;
        return;
    }
    draw_path(context);
    const float height = ImGui::GetContentRegionAvail().y - footer_height(context, question_.saves);
    const float places = std::min(context.em * 10, ImGui::GetContentRegionAvail().x * 0.3f);
    if (ImGui::BeginChild("places", {places, height}, true, ImGuiWindowFlags_NavFlattened))
        draw_places(context);
    ImGui::EndChild();
    ImGui::SameLine();
    entry_focused_ = false;
    if (ImGui::BeginChild("entries", {0, height}, true, ImGuiWindowFlags_NavFlattened)) draw_entries(context);
    ImGui::EndChild();
    if (!done_) keys(context.keyboard.on && !entry_focused_);
    draw_footer(context);
    if (done_ || !stays || ImGui::IsKeyPressed(key::Escape, false)) {
        open_ = false;
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

}  // namespace gse::ui
