// Fronts and panels of measured settings.
#include "engine/laboratory/bench/charts/setting_points.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

/// The figure; not a number where there is none.
double figure_of(const SettingPoint& point, const std::string& name) {
    const auto found = point.figures.find(name);
    return found != point.figures.end() && found->is_number() ? found->get<double>()
                                                              : std::numeric_limits<double>::quiet_NaN();
}

std::string full_name(const SettingPoint& point) {
    return point.curve.empty() ? point.name : point.curve + ", " + point.name;
}

ChartPoint chart_point(const SettingPoint& point, const Facet& facet) {
    return {figure_of(point, facet.x), figure_of(point, facet.y), point.name, point.standard};
}

bool beats(const ChartPoint& one, const ChartPoint& other, bool less_is_better) {
    const bool better = less_is_better ? one.y < other.y : one.y > other.y;
    if (better) return one.x <= other.x * (1 + CostNoise);
    return !(one.y < other.y || one.y > other.y) && one.x < other.x * (1 - CostNoise);
}

std::vector<double> cases_of(const SettingPoint& point, const std::string& figure) {
    const auto cases = point.figures.find("per_case");
    if (cases == point.figures.end() || !cases->contains(figure)) return {};
    return cases->at(figure).get<std::vector<double>>();
}

/// By how much one point is better than another over the same cases.
struct Lead {
    double mean = 0, standard_error = 0;
};

/// None where the cases of the two cannot be compared one by one.
std::optional<Lead> lead_of(const SettingPoint& one, const SettingPoint& other, const Facet& facet) {
    const auto a = cases_of(one, facet.y), b = cases_of(other, facet.y);
    if (a.size() != b.size() || a.size() < 2) return std::nullopt;
    const auto count = static_cast<double>(a.size());
    const auto better_by = [&](std::size_t i) { return facet.less_is_better ? b[i] - a[i] : a[i] - b[i]; };
    Lead lead;
    for (std::size_t i = 0; i < a.size(); ++i) lead.mean += better_by(i) / count;
    double squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        squares += (better_by(i) - lead.mean) * (better_by(i) - lead.mean);
    lead.standard_error = std::sqrt(squares / (count - 1) / count);
    return lead;
}

/// Place of the default; null where no point is it.
Json default_of(const std::vector<SettingPoint>& points, const Facet& facet) {
    for (const auto& point : points) {
        if (!point.standard) continue;
        const auto own = chart_point(point, facet);
        Json beaten = Json::array(), within = Json::array();
        for (const auto& other : points) {
            if (&other == &point || !beats(chart_point(other, facet), own, facet.less_is_better)) continue;
            const auto lead = lead_of(other, point, facet);
            if (lead && lead->mean > 0 && lead->mean < LeadErrors * lead->standard_error)
                within.push_back({{"name", full_name(other)},
                                  {"lead", lead->mean},
                                  {"standard_error", lead->standard_error}});
            else beaten.push_back(full_name(other));
        }
        const bool measured = std::isfinite(own.x) && std::isfinite(own.y);
        return {{"name", full_name(point)},
                {"on_front", measured && beaten.empty()},
                {"beaten_by", beaten},
                {"within_scatter", within}};
    }
    return nullptr;
}

}  // namespace

Json fronts_of(const std::vector<SettingPoint>& points, const std::vector<Facet>& facets) {
    Json fronts = Json::array();
    for (const auto& facet : facets) {
        std::vector<ChartPoint> drawn;
        for (const auto& point : points) drawn.push_back(chart_point(point, facet));
        Json front = Json::array();
        for (const auto index : pareto_front(drawn, facet.less_is_better))
            front.push_back(full_name(points[index]));
        fronts.push_back(
            {{"x", facet.x}, {"y", facet.y}, {"front", front}, {"default", default_of(points, facet)}});
    }
    return fronts;
}

Json points_json(const std::vector<SettingPoint>& points) {
    Json list = Json::array();
    for (const auto& point : points) {
        Json entry{{"curve", point.curve},
                   {"name", point.name},
                   {"default", point.standard},
                   {"settings", point.settings}};
        entry.update(point.figures);
        list.push_back(std::move(entry));
    }
    return list;
}

ChartPanel panel_of(const std::vector<SettingPoint>& points, const Facet& facet) {
    ChartPanel panel{facet.x_title, facet.y_title,        {},          ChartLine::CommonFront,
                     facet.y_scale, facet.less_is_better, facet.title, {}};
    for (const auto& point : points) {
        auto curve = panel.curves.begin();
        while (curve != panel.curves.end() && curve->name != point.curve) ++curve;
        if (curve == panel.curves.end())
            curve = panel.curves.insert(curve, {point.curve, curve_colour(panel.curves.size()), {}});
        curve->points.push_back(chart_point(point, facet));
    }
    return panel;
}

DrawColour curve_colour(std::size_t index) {
    static constexpr std::array<DrawColour, 8> colours{{{0.10f, 0.40f, 0.75f},
                                                        {0.80f, 0.33f, 0.10f},
                                                        {0.13f, 0.52f, 0.22f},
                                                        {0.52f, 0.22f, 0.62f},
                                                        {0.70f, 0.50f, 0.02f},
                                                        {0.76f, 0.14f, 0.32f},
                                                        {0.08f, 0.52f, 0.56f},
                                                        {0.35f, 0.33f, 0.30f}}};
    return colours[index % colours.size()];
}

}  // namespace gse::bench
