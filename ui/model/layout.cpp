// Places of panels, tabs in front and sizes of the areas; saved as JSON in the project.
#include "ui/model/layout.h"

#include <algorithm>

#include "engine/base/json.h"

namespace gse::ui {
namespace {

using Json = nlohmann::ordered_json;

constexpr float LeastRightEm = 14, MostRightEm = 80;

int index_of_panel(const std::string& name) {
    const auto found = std::find_if(PanelTable.begin(), PanelTable.end(),
                                    [&](const PanelRow& panel) { return panel.name == name; });
    return found == PanelTable.end() ? -1 : static_cast<int>(found - PanelTable.begin());
}

float number_or(const Json& json, const char* name, float fallback) {
    const auto found = json.find(name);
    return found != json.end() && found->is_number() ? found->get<float>() : fallback;
}

void read_places(const Json& json, Layout& layout) {
    const auto panels = json.find("panels");
    if (panels == json.end() || !panels->is_object()) return;
    for (const auto& [name, value] : panels->items()) {
        const int index = index_of_panel(name);
        if (index < 0 || !value.is_object()) continue;
        auto& place = layout.places[static_cast<std::size_t>(index)];
        const int area = static_cast<int>(number_or(value, "area", static_cast<float>(place.area)));
        if (area >= 0 && area < static_cast<int>(AreaCount)) place.area = static_cast<Area>(area);
        if (value.contains("open") && value["open"].is_boolean()) place.open = value["open"].get<bool>();
    }
}

void read_front(const Json& json, Layout& layout) {
    const auto front = json.find("front");
    if (front == json.end() || !front->is_array()) return;
    for (std::size_t area = 0; area < std::min(AreaCount, front->size()); ++area) {
        if (!(*front)[area].is_string()) continue;
        const int index = index_of_panel((*front)[area].get<std::string>());
        if (index >= 0) layout.front[area] = index;
    }
}

}  // namespace

Layout Layout::standard() {
    Layout layout;
    for (std::size_t panel = 0; panel < PanelCount; ++panel)
        layout.places[panel].area = PanelTable[panel].area;
    layout.front = {static_cast<int>(PanelId::Prompt), static_cast<int>(PanelId::History),
                    static_cast<int>(PanelId::Attention)};
    return layout;
}

std::string Layout::to_json() const {
    Json json;
    json["right_em"] = right_em;
    json["right_split"] = right_split;
    json["bottom_share"] = share_before_asking > 0 ? share_before_asking : bottom_share;
    for (std::size_t panel = 0; panel < PanelCount; ++panel)
        json["panels"][PanelTable[panel].name] = {{"area", static_cast<int>(places[panel].area)},
                                                  {"open", places[panel].open}};
    json["front"] = Json::array();
    for (const int panel : front) json["front"].push_back(PanelTable[static_cast<std::size_t>(panel)].name);
    return json.dump();
}

Layout Layout::from_json(const std::string& text) {
    Layout layout = standard();
    const Json json = try_parse_json(text);
    if (json.is_discarded() || !json.is_object()) return layout;
    layout.right_em = std::clamp(number_or(json, "right_em", layout.right_em), LeastRightEm, MostRightEm);
    layout.right_split = std::clamp(number_or(json, "right_split", layout.right_split), 0.1f, 0.9f);
    layout.bottom_share = std::clamp(number_or(json, "bottom_share", layout.bottom_share), 0.08f, 0.9f);
    read_places(json, layout);
    read_front(json, layout);
    return layout;
}

bool Layout::used(Area area) const {
    return std::any_of(places.begin(), places.end(),
                       [area](const Place& place) { return place.open && place.area == area; });
}

void Layout::show(PanelId panel) {
    place(panel).open = true;
    front[static_cast<std::size_t>(place(panel).area)] = static_cast<int>(panel);
    panels_hidden = false;
}

void Layout::move(PanelId panel, Area area) {
    place(panel).area = area;
    show(panel);
}

void Layout::close(PanelId panel) { place(panel).open = false; }

}  // namespace gse::ui
