// The whole window: menu, tools, viewport and panels. A frame is a function of the view model; it returns the
// commands that the artist gave.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ui/model/command.h"
#include "ui/model/context.h"
#include "ui/model/layout.h"
#include "ui/model/view_model.h"

namespace gse::ui {

class Shell {
public:
    Shell();
    ~Shell();
    Shell(const Shell&) = delete;
    Shell& operator=(const Shell&) = delete;

    /// Draws a frame. Call it between ImGui::NewFrame() and ImGui::Render(). The style follows the font size
    /// by itself; the fonts are those of build_fonts() (theme.h). Returns the commands of the frame in their
    /// order.
    [[nodiscard]] std::vector<Command> draw(const ViewModel& model, Textures& textures);

    /// True when the next frame will look different even without input: a camera glides, a key is held.
    bool animating() const;
    /// True when a text field has the focus, whose caret blinks.
    bool takes_text() const;

    /// Sizes, places and front tabs of the panels as JSON. Unknown parts are passed over.
    std::string layout() const;
    void set_layout(const std::string& json);
    void reset_layout();
    /// Brings a panel to the front.
    void show(PanelId panel);

    /// Opens as if chosen from the menu: asks when there is unsaved work. For the window's close button and
    /// for dropped files.
    void request_quit();
    /// Opens the path; of several, the one that the artist chooses.
    void request_open(const std::vector<std::filesystem::path>& paths);

    /// Places of the important widgets of the last frame, in window coordinates: "prompt.edit", "tool.brush",
    /// "viewport"...
    const WidgetMap& widgets() const { return widgets_; }
    /// Control that has the keyboard's focus and shows it; empty = none.
    std::string focused() const;
    /// Widget map as a JSON file, for scripts that click.
    void write_widgets(const std::filesystem::path& path) const;

    /// Characters of the window's texts beyond its fonts (theme.h).
    ForeignGlyphs& glyphs() { return glyphs_; }

    UiState& state() { return *state_; }

private:
    void draw_window(Context& context);
    void draw_areas(Context& context);
    void draw_area(Context& context, Area area);
    void draw_tab_menu(Context& context, PanelId panel);
    void answer_requests(Context& context);
    void follow_document(std::uint64_t opened);

    std::unique_ptr<UiState> state_;
    CommandSink commands_;
    WidgetMap widgets_;
    ForeignGlyphs glyphs_;
    float styled_em_ = 0;
};

}  // namespace gse::ui
