// Places of panels, tabs in front and sizes of the areas; saved as JSON in the project.
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace gse::ui {

enum class PanelId {
    Prompt,
    Labels,
    Scene,
    Models,
    History,
    Views,
    Export,
    Settings,
    Attention,
    Targets,
    Progress,
    Log
};

/// Place of a tab. The right column is split in two; the bottom area runs below the viewport.
enum class Area { RightTop, RightBottom, Bottom };
inline constexpr std::size_t AreaCount = 3;
inline constexpr std::array<const char*, AreaCount> AreaNames{"right, top", "right, bottom", "bottom"};

/// A panel's name and its place in the standard layout.
struct PanelRow {
    const char* name;
    Area area;
};
/// Rows by PanelId. The functions that draw the panels are in panels.h, in this order.
inline constexpr std::array PanelTable{
    PanelRow{"Prompt", Area::RightTop},     PanelRow{"Labels", Area::RightTop},
    PanelRow{"Scene", Area::RightTop},      PanelRow{"Models", Area::RightTop},
    PanelRow{"History", Area::RightBottom}, PanelRow{"Views", Area::RightBottom},
    PanelRow{"Export", Area::RightBottom},  PanelRow{"Settings", Area::RightBottom},
    PanelRow{"Attention", Area::Bottom},    PanelRow{"Targets", Area::Bottom},
    PanelRow{"Progress", Area::Bottom},     PanelRow{"Log", Area::Bottom}};
inline constexpr std::size_t PanelCount = PanelTable.size();

/// Sizes in font sizes, so that they fit every scale.
struct Layout {
    struct Place {
        Area area = Area::RightTop;
        bool open = true;
    };
    std::array<Place, PanelCount> places{};
    std::array<int, AreaCount> front{};         // PanelId in front of each area
    float right_em = 25;                        // width of the right column
    float right_split = 0.62f;                  // share of its height that the upper area takes
    static constexpr float AskingShare = 0.4f;  // of the height, for a panel that the artist has to answer
    float bottom_share = 0.19f;     // of the height, taken by the bottom area; the picture has two thirds
    float share_before_asking = 0;  // bottom_share to go back to when nothing asks any more; 0 = none
    bool panels_hidden = false;

    static Layout standard();
    std::string to_json() const;
    /// Reads a layout. Unknown names and values out of range are passed over. A text that is no JSON gives
    /// the standard layout.
    static Layout from_json(const std::string& text);

    Place& place(PanelId panel) { return places[static_cast<std::size_t>(panel)]; }
    const Place& place(PanelId panel) const { return places[static_cast<std::size_t>(panel)]; }
    /// True when at least one open panel lives there.
    bool used(Area area) const;
    /// Opens the panel and brings it to the front of its area.
    void show(PanelId panel);
    void move(PanelId panel, Area area);
    void close(PanelId panel);
};

}  // namespace gse::ui
