// Minimum cut (Boykov and Kolmogorov 2004, OpenCV's graph) over nearest neighbours.
#include "engine/localize/graph_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/check.h"
#include "engine/localize/row_tree.h"

#ifdef GSE_HAVE_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#endif

namespace gse::localize {
namespace {

constexpr double SurestProbability = 0.95;  // of a row all views agree on: systematic misses are not rare
constexpr double HalfTrust = 0.25;          // of the mean evidence: a row with this much counts half
constexpr double InferredTrust = 0.25;      // of a row no view saw
constexpr double LeastDifference = 1e-12;   // scenes of one colour
constexpr float BeyondTau = 0.02f;          // a row that changes sides lies at least this far beyond

struct Edge {
    std::uint32_t from, to;    // indices into the rows that take part
    double value;              // squared difference of the colours, then the cost of cutting it
};

struct Box {
    std::array<double, 3> low, high;
};

/// Box of the labelled rows with its margin; nothing when none is labelled.
bool labelled_box(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelWeights& weights, Box& box) {
    box.low.fill(std::numeric_limits<double>::max());
    box.high.fill(std::numeric_limits<double>::lowest());
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (weights.weight[row] <= parameters.tau || !finite_position(gaussians, row)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min<double>(box.low[axis], gaussians.position[row * 3 + axis]);
            box.high[axis] = std::max<double>(box.high[axis], gaussians.position[row * 3 + axis]);
        }
    }
    if (box.low[0] > box.high[0]) return false;
    const double margin = parameters.margin_share * std::hypot(box.high[0] - box.low[0], box.high[1] - box.low[1],
                                                               box.high[2] - box.low[2]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] -= margin;
        box.high[axis] += margin;
    }
    return true;
}

bool known(const LabelWeights& weights, const CutParameters& parameters, std::size_t row) {
    return weights.evidence[row] > parameters.least_evidence_px ||
           (!weights.inferred.empty() && weights.inferred[row] != 0);
}

/// The rows inside the box that have an opinion and a colour.
RowPoints taking_part(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelWeights& weights,
                      const Box& box) {
    RowPoints rows;
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        bool inside = known(weights, parameters, row) && std::isfinite(weights.weight[row]);
        for (std::size_t axis = 0; axis < 3 && inside; ++axis) {
            const double place = gaussians.position[row * 3 + axis];
            inside = place >= box.low[axis] && place <= box.high[axis] && std::isfinite(gaussians.sh[row * stride + axis]);
        }
        if (inside) rows.add(gaussians, row);
    }
    return rows;
}

double squared_colour_difference(const GaussianSpans& gaussians, std::size_t a, std::size_t b) {
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3;
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(static_cast<double>(gaussians.sh[a * stride + c]) - gaussians.sh[b * stride + c], 2);
    return sum;
}

constexpr std::uint32_t NoRow = std::numeric_limits<std::uint32_t>::max();

std::vector<Edge> neighbour_edges(const GaussianSpans& gaussians, const CutParameters& parameters, const RowPoints& rows,
                                  ThreadPool* threads) {
    const RowTree tree(3, rows, nanoflann::KDTreeSingleIndexAdaptorParams(RowTreeLeaf));
    const auto wanted = static_cast<std::size_t>(parameters.neighbours) + 1;   // itself among them
    std::vector<Edge> edges(rows.row.size() * wanted, Edge{NoRow, NoRow, 0});
    const auto take = [&](std::size_t i, std::span<const std::uint32_t> nearest, std::span<const float>) {
        for (std::size_t k = 0; k < nearest.size(); ++k)
            if (nearest[k] != i)
                edges[i * wanted + k] = {static_cast<std::uint32_t>(i), nearest[k],
                                         squared_colour_difference(gaussians, rows.row[i], rows.row[nearest[k]])};
    };
    nearest_of_all(tree, rows.position, wanted, threads, take);
    std::erase_if(edges, [](const Edge& edge) { return edge.from == NoRow; });
    return edges;
}

/// -log p for "labelled" and "not labelled", each times the trust in the row.
std::pair<double, double> row_costs(const LabelWeights& weights, const CutParameters& parameters, double mean_evidence,
                                    std::size_t row) {
    const double w = weights.weight[row], tau = std::clamp(parameters.tau, 1e-3, 1 - 1e-3);
    const double even = w < tau ? 0.5 * w / tau : 0.5 + 0.5 * (w - tau) / (1 - tau);
    const double p = std::clamp(even, 1 - SurestProbability, SurestProbability);
    const bool seen = weights.evidence[row] > parameters.least_evidence_px;
    const double trust = seen ? weights.evidence[row] / (weights.evidence[row] + HalfTrust * mean_evidence) : InferredTrust;
    return {-trust * std::log(p), -trust * std::log(1 - p)};
}

/// The energy's numbers for the rows that take part.
struct Problem {
    RowPoints rows;
    std::vector<std::pair<double, double>> row_costs;   // of "labelled" and of "not labelled"
    std::vector<Edge> edges;
};

Problem make_problem(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelWeights& weights,
                     ThreadPool* threads) {
    Problem problem;
    Box box;
    if (parameters.neighbours <= 0 || !labelled_box(gaussians, parameters, weights, box)) return problem;
    problem.rows = taking_part(gaussians, parameters, weights, box);
    const auto& rows = problem.rows.row;
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(rows.size(), 1));
    double mean_evidence = 0, mean_difference = 0;
    for (const auto row : rows) mean_evidence += weights.evidence[row] * share;
    for (const auto row : rows) problem.row_costs.push_back(row_costs(weights, parameters, mean_evidence, row));
    problem.edges = neighbour_edges(gaussians, parameters, problem.rows, threads);
    for (const auto& edge : problem.edges) mean_difference += edge.value / static_cast<double>(problem.edges.size());
    for (auto& edge : problem.edges)   // an edge found from both of its ends counts twice a half
        edge.value = 0.5 * parameters.smoothness * std::exp(-edge.value / std::max(mean_difference, LeastDifference));
    return problem;
}

}  // namespace

double label_energy(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelWeights& weights,
                    std::span<const std::uint8_t> label) {
    GSE_CHECK_EQ(label.size(), gaussians.size);
    const Problem problem = make_problem(gaussians, parameters, weights, nullptr);
    const auto& rows = problem.rows.row;
    double energy = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
        energy += label[rows[i]] != 0 ? problem.row_costs[i].first : problem.row_costs[i].second;
    for (const auto& edge : problem.edges)
        if ((label[rows[edge.from]] != 0) != (label[rows[edge.to]] != 0)) energy += edge.value;
    return energy;
}

#ifdef GSE_HAVE_OPENCV

std::size_t cut_label(const GaussianSpans& gaussians, const CutParameters& parameters, LabelWeights& weights,
                      ThreadPool* threads) {
    GSE_CHECK_EQ(weights.weight.size(), gaussians.size);
    if (parameters.smoothness <= 0) return 0;
    Problem problem = make_problem(gaussians, parameters, weights, threads);
    const auto& rows = problem.rows.row;
    if (problem.edges.empty()) return 0;
    cv::detail::GCGraph<double> graph(static_cast<unsigned>(rows.size()), static_cast<unsigned>(problem.edges.size()));
    for (const auto& [labelled, not_labelled] : problem.row_costs)
        graph.addTermWeights(graph.addVtx(), not_labelled, labelled);   // the source's side is "labelled"
    for (const auto& edge : problem.edges)
        graph.addEdges(static_cast<int>(edge.from), static_cast<int>(edge.to), edge.value, edge.value);
    problem.edges = {};   // the graph has its own
    graph.maxFlow();
    std::size_t changed = 0;
    const auto tau = static_cast<float>(parameters.tau);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        float& weight = weights.weight[rows[i]];
        const bool labelled = graph.inSourceSegment(static_cast<int>(i));
        if (labelled == (weight > tau)) continue;
        weight = labelled ? std::min(1.0f, tau + BeyondTau) : std::max(0.0f, tau - BeyondTau);
        ++changed;
    }
    return changed;
}

#else

std::size_t cut_label(const GaussianSpans&, const CutParameters&, LabelWeights&, ThreadPool*) { return 0; }

#endif

}  // namespace gse::localize
