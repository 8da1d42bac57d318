// Settings measured: a point each, with their fronts, their panels and their table.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/laboratory/bench/pareto_chart.h"

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

/// A lead in a mean over cases counts from this many standard errors of the mean difference, case by case: of
/// many cases one lead of chance in forty passes it, of four one in fourteen, and a bench compares a dozen
/// points.
constexpr double LeadErrors = 2;

/// [{"x", "y", "front": ["avx512, 2 threads", ...], "default": {"name", "on_front", "beaten_by": [...],
/// "within_scatter":
/// [{"name", "lead", "standard_error"}]}}], one per facet. The default is on the front where no point reaches
/// more for a cost that is at most (1 + CostNoise) times as high, nor as much for one lower by more than
/// CostNoise. Where both points have figures per case, a lead below LeadErrors standard errors is listed as
/// within the scatter of the cases and does not count.
nlohmann::ordered_json fronts_of(const std::vector<SettingPoint>& points, const std::vector<Facet>& facets);

/// The points as JSON: curve, name, default, settings and the figures.
nlohmann::ordered_json points_json(const std::vector<SettingPoint>& points);

/// A panel with the front of all points; curves in the order of their first points.
ChartPanel panel_of(const std::vector<SettingPoint>& points, const Facet& facet);

/// Colours that can be told apart, by index.
DrawColour curve_colour(std::size_t index);

}  // namespace gse::bench
