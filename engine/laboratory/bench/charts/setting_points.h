// Settings measured: a point each, with their fronts, their panels and their table.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/laboratory/bench/charts/pareto_chart.h"

namespace gse::bench {

/// One setting, what it costs and what it reaches.
struct SettingPoint {
    std::string curve, name;          // "avx512", "2 threads"
    bool standard = false;            // what the program does where nobody says otherwise
    nlohmann::ordered_json settings;  // what is set
    nlohmann::ordered_json
        figures;  // numbers by name; null where there is none. "per_case": {name: one number per case}
};

/// Two of the figures against each other.
struct Facet {
    std::string x, y;  // names of figures; x is the cost
    std::string x_title, y_title;
    bool less_is_better = true;  // of y
    ChartScale y_scale = ChartScale::Logarithmic;
    std::string title = {};
};

/// Differences of a cost below this share say nothing: times of one setting scatter by as much from run to
/// run.
constexpr double CostNoise = 0.05;

/// Standard errors of the mean difference from which a lead counts, case by case. One lead of chance in forty
/// passes over many cases, one in fourteen over four; a bench compares a dozen points.
constexpr double LeadErrors = 2;

/// Fronts and default per facet: [{"x", "y", "front": ["avx512, 2 threads", ...], "default": {"name",
/// "on_front", "beaten_by": [...], "within_scatter": [{"name", "lead", "standard_error"}]}}].
/// The default is on the front unless a point beats it. A point beats it by reaching more for a cost of at
/// most (1 + CostNoise) times, or as much for a cost lower by more than CostNoise. A lead below LeadErrors
/// standard errors is within the scatter of the cases and does not count, where both points have figures per
/// case.
nlohmann::ordered_json fronts_of(const std::vector<SettingPoint>& points, const std::vector<Facet>& facets);

/// The points as JSON: curve, name, default, settings and the figures.
nlohmann::ordered_json points_json(const std::vector<SettingPoint>& points);

/// A panel with the front of all points; curves in the order of their first points.
ChartPanel panel_of(const std::vector<SettingPoint>& points, const Facet& facet);

/// Colours that can be told apart, by index.
DrawColour curve_colour(std::size_t index);

}  // namespace gse::bench
