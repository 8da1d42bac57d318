// Minimum cut (Boykov and Kolmogorov 2004, OpenCV's graph) over nearest neighbours.
#include "engine/localize/graph_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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
constexpr float BeyondThreshold = 0.02f;    // a row that changes sides lies this far beyond

struct Box {
    std::array<double, 3> low, high;
};

/// Box of the labelled rows with its margin. Nothing when none is labelled.
bool labelled_box(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelField& field,
                  Box& box) {
    box.low.fill(std::numeric_limits<double>::max());
    box.high.fill(std::numeric_limits<double>::lowest());
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        if (field.probability[row] <= parameters.threshold || !finite_position(gaussians, row)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min<double>(box.low[axis], gaussians.position[row * 3 + axis]);
            box.high[axis] = std::max<double>(box.high[axis], gaussians.position[row * 3 + axis]);
        }
    }
    if (box.low[0] > box.high[0]) return false;
    const double margin =
        parameters.margin_share *
        std::hypot(box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] -= margin;
        box.high[axis] += margin;
    }
    return true;
}

bool known(const LabelField& field, const CutParameters& parameters, std::size_t row) {
    return field.coverage[row] > parameters.least_coverage ||
           (!field.inferred.empty() && field.inferred[row] != 0);
}

/// Rows inside the box that have an opinion and a colour.
RowPoints taking_part(const GaussianSpans& gaussians, const CutParameters& parameters,
                      const LabelField& field, const Box& box) {
    RowPoints rows;
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3;
    for (std::size_t row = 0; row < gaussians.size; ++row) {
        bool inside = known(field, parameters, row) && std::isfinite(field.probability[row]);
        for (std::size_t axis = 0; axis < 3 && inside; ++axis) {
            const double place = gaussians.position[row * 3 + axis];
            inside = place >= box.low[axis] && place <= box.high[axis] &&
                     std::isfinite(gaussians.sh[row * stride + axis]);
        }
        if (inside) rows.add(gaussians, row);
    }
    return rows;
}

/// Colour of every row [M,3], side by side.
std::vector<float> colours_of(const GaussianSpans& gaussians, const RowPoints& rows) {
    const auto stride = static_cast<std::size_t>(sh_coefficient_count(gaussians.sh_degree)) * 3;
    std::vector<float> colours;
    colours.reserve(rows.row.size() * 3);
    for (const std::size_t row : rows.row)
        for (std::size_t c = 0; c < 3; ++c) colours.push_back(gaussians.sh[row * stride + c]);
    return colours;
}

/// Costs -log p for "labelled" and "not labelled", each times the trust in the row.
std::pair<double, double> row_costs(const LabelField& field, const CutParameters& parameters,
                                    double mean_evidence, std::size_t row) {
    const double w = field.probability[row], even_at = std::clamp(parameters.threshold, 1e-3, 1 - 1e-3);
    const double even = w < even_at ? 0.5 * w / even_at : 0.5 + 0.5 * (w - even_at) / (1 - even_at);
    const double p = std::clamp(even, 1 - SurestProbability, SurestProbability);
    const bool seen = field.coverage[row] > parameters.least_coverage;
    const double trust =
        seen ? field.coverage[row] / (field.coverage[row] + HalfTrust * mean_evidence) : InferredTrust;
    return {-trust * std::log(p), -trust * std::log(1 - p)};
}

constexpr std::uint32_t NoRow = std::numeric_limits<std::uint32_t>::max();
constexpr double NoEdge = -1;  // cost of a pair that is met from its other row, or does not take part

/// Terms of the energy for the rows that take part.
struct Problem {
    RowPoints rows;
    std::vector<std::pair<double, double>> row_costs;  // [M] of "labelled" and of "not labelled"
    std::vector<float> colours;                        // [M,3]
    std::vector<std::uint32_t>
        nearest;  // [M,neighbours] indices into the rows; NoRow where there are not so many
    std::vector<double> edge_costs;      // [M,neighbours] of cutting the edges to them; or NoEdge
    std::vector<std::uint8_t> enclosed;  // [M] 1 where no row beyond the box is as near as the nearest
    std::size_t neighbours = 0;
    double smoothness = 0, mean_difference = 0;

    double squared_difference(std::size_t a, std::size_t b) const {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = static_cast<double>(colours[a * 3 + c]) - colours[b * 3 + c];
            sum += difference * difference;
        }
        return sum;
    }
    std::span<const std::uint32_t> nearest_to(std::size_t i) const {
        return std::span(nearest).subspan(i * neighbours, neighbours);
    }
    bool is_near(std::size_t i, std::uint32_t other) const {
        const auto near = nearest_to(i);
        return std::find(near.begin(), near.end(), other) != near.end();
    }
    /// Edges of the graph: one for every pair with one among the other's nearest. It costs half if only one
    /// is.
    double edge_cost(std::size_t i, std::uint32_t j) const {
        const bool mutual = is_near(j, static_cast<std::uint32_t>(i));
        if (mutual && j < i) return NoEdge;
        const double alike = std::exp(-squared_difference(i, j) / std::max(mean_difference, LeastDifference));
        return (mutual ? 1.0 : 0.5) * smoothness * alike;
    }
    /// Calls visit(from, to, cost of cutting it) once for every edge.
    template <class F> void for_each_edge(F&& visit) const {
        for (std::size_t at = 0; at < edge_costs.size(); ++at)
            if (edge_costs[at] != NoEdge) visit(at / neighbours, nearest[at], edge_costs[at]);
    }
};

/// Costs of the edges between rows of `inside` [M].
void set_edge_costs(Problem& problem, std::span<const std::uint8_t> inside, ThreadPool* threads) {
    problem.edge_costs.assign(problem.nearest.size(), NoEdge);
    const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
            if (inside[i] == 0) continue;
            for (std::size_t at = i * problem.neighbours;
                 at < (i + 1) * problem.neighbours && problem.nearest[at] != NoRow; ++at)
                if (inside[problem.nearest[at]] != 0)
                    problem.edge_costs[at] = problem.edge_cost(i, problem.nearest[at]);
        }
    };
    constexpr std::size_t chunk = 4096;  // rows
    if (threads != nullptr) threads->parallel_for(problem.rows.row.size(), chunk, some);
    else some(0, problem.rows.row.size(), 0);
}

/// True when a sphere around a row lies in the box.
bool encloses(const Box& box, const float* centre, double radius) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (centre[axis] - radius < box.low[axis] || centre[axis] + radius > box.high[axis]) return false;
    return true;
}

/// Sets the nearest rows and their mean squared difference of colours.
void find_nearest(Problem& problem, const Box& box, ThreadPool* threads) {
    const RowTree tree(3, problem.rows, nanoflann::KDTreeSingleIndexAdaptorParams(RowTreeLeaf));
    const std::size_t count = problem.rows.row.size();
    problem.nearest.assign(count * problem.neighbours, NoRow);
    std::vector<double> difference(count);
    std::vector<std::uint32_t> found(count);
    problem.enclosed.assign(count, 0);
    const auto take = [&](std::size_t i, std::span<const std::uint32_t> nearest,
                          std::span<const float> squared) {
        problem.enclosed[i] = encloses(box, &problem.rows.position[i * 3], std::sqrt(squared.back())) ? 1 : 0;
        std::uint32_t* next = problem.nearest.data() + i * problem.neighbours;
        for (const auto other : nearest) {
            if (other == i || found[i] == problem.neighbours) continue;
            next[found[i]++] = other;
            difference[i] += problem.squared_difference(i, other);
        }
    };
    nearest_of_all(tree, problem.rows.position, problem.neighbours + 1, threads, take);  // itself among them
    const double pairs = std::accumulate(found.begin(), found.end(), 0.0);
    problem.mean_difference =
        pairs > 0 ? std::accumulate(difference.begin(), difference.end(), 0.0) / pairs : 0;
}

Problem make_problem(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelField& field,
                     ThreadPool* threads) {
    Problem problem;
    Box box;
    if (parameters.neighbours <= 0 || !labelled_box(gaussians, parameters, field, box)) return problem;
    problem.rows = along_curve(gaussians, taking_part(gaussians, parameters, field, box));
    problem.colours = colours_of(gaussians, problem.rows);
    problem.neighbours = static_cast<std::size_t>(parameters.neighbours);
    problem.smoothness = parameters.smoothness;
    const auto& rows = problem.rows.row;
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(rows.size(), 1));
    double mean_evidence = 0;
    for (const auto row : rows) mean_evidence += field.coverage[row] * share;
    problem.row_costs.reserve(rows.size());
    for (const auto row : rows) problem.row_costs.push_back(row_costs(field, parameters, mean_evidence, row));
    if (!rows.empty()) find_nearest(problem, box, threads);
    return problem;
}

}  // namespace

double label_energy(const GaussianSpans& gaussians, const CutParameters& parameters, const LabelField& field,
                    std::span<const std::uint8_t> label) {
    GSE_CHECK_EQ(label.size(), gaussians.size);
    Problem problem = make_problem(gaussians, parameters, field, nullptr);
    const auto& rows = problem.rows.row;
    set_edge_costs(problem, std::vector<std::uint8_t>(rows.size(), 1), nullptr);
    double energy = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
        energy += label[rows[i]] != 0 ? problem.row_costs[i].first : problem.row_costs[i].second;
    problem.for_each_edge([&](std::size_t from, std::size_t to, double cost) {
        if ((label[rows[from]] != 0) != (label[rows[to]] != 0)) energy += cost;
    });
    return energy;
}

#ifdef GSE_HAVE_OPENCV

namespace {

/// Minimum cut of the rows `inside` [M] and the edges between them: 1 for labelled rows.
std::vector<std::uint8_t> cut_inside(const Problem& problem, std::span<const std::uint8_t> inside) {
    constexpr int NoVertex = -1;
    std::vector<int> vertex(inside.size(), NoVertex);
    int count = 0;
    for (std::size_t i = 0; i < inside.size(); ++i)
        if (inside[i] != 0) vertex[i] = count++;
    const auto edges = static_cast<unsigned>(std::count_if(
        problem.edge_costs.begin(), problem.edge_costs.end(), [](double cost) { return cost != NoEdge; }));
    cv::detail::GCGraph<double> graph(static_cast<unsigned>(count), 2 * edges);  // both ways
    for (std::size_t i = 0; i < inside.size(); ++i)  // the source's side is "labelled"
        if (inside[i] != 0)
            graph.addTermWeights(graph.addVtx(), problem.row_costs[i].second, problem.row_costs[i].first);
    problem.for_each_edge([&](std::size_t from, std::size_t to, double cost) {
        graph.addEdges(vertex[from], vertex[to], cost, cost);
    });
    if (count > 0) graph.maxFlow();
    std::vector<std::uint8_t> label(inside.size(), 0);
    for (std::size_t i = 0; i < inside.size(); ++i)
        label[i] = inside[i] != 0 && graph.inSourceSegment(vertex[i]) ? 1 : 0;
    return label;
}

/// Adds the rows that are `steps` edges or fewer away. Returns false if there is none.
bool grow(const Problem& problem, int steps, std::vector<std::uint8_t>& inside) {
    bool any = false;
    for (int step = 0; step < steps; ++step) {
        const auto before = inside;
        for (std::size_t i = 0; i < inside.size(); ++i)
            for (const auto j : problem.nearest_to(i)) {
                if (j == NoRow) break;
                if (before[i] != 0) inside[j] = 1;
                if (before[j] != 0) inside[i] = 1;
            }
        if (inside == before) break;
        any = true;
    }
    return any;
}

/// True when a labelled row has an edge to a row outside.
bool leaves(const Problem& problem, std::span<const std::uint8_t> inside,
            std::span<const std::uint8_t> label) {
    for (std::size_t i = 0; i < inside.size(); ++i)
        for (const auto j : problem.nearest_to(i)) {
            if (j == NoRow) break;
            if (inside[i] != inside[j] && label[i] + label[j] > 0) return true;
        }
    return false;
}

/// Minimum cut of all rows, mostly from a part: the rows around those that prefer the label. Rows left out
/// prefer no label. If no labelled row of the part has an edge to them, the cut of the part is a minimum of
/// the whole. Its energy is then the least of all labels of the part, and so is that of the rest.
std::vector<std::uint8_t> cut_around_preferring(Problem& problem, int reach, ThreadPool* threads) {
    std::vector<std::uint8_t> inside(problem.rows.row.size());
    for (std::size_t i = 0; i < inside.size(); ++i)
        inside[i] = reach <= 0 || problem.row_costs[i].first < problem.row_costs[i].second ? 1 : 0;
    for (;; reach *= 2) {
        const bool grown = grow(problem, reach, inside);
        set_edge_costs(problem, inside, threads);
        auto label = cut_inside(problem, inside);
        if (!grown || !leaves(problem, inside, label)) return label;
    }
}

/// Disjoint sets of rows (Tarjan 1975, with path halving).
struct Components {
    std::vector<std::uint32_t> parent;

    explicit Components(std::size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), 0u); }
    std::uint32_t root(std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    }
    void unite(std::uint32_t a, std::uint32_t b) { parent[root(a)] = root(b); }
};

/// Facts of a component of the rows without the label, at the number of its root.
struct Component {
    std::uint32_t rows = 0;
    bool beside_label = false;
    bool enclosed = true;  // none of its neighbours can lie outside the box
};

Components components_without(const Problem& problem, std::span<const std::uint8_t> label) {
    Components components(label.size());
    for (std::uint32_t i = 0; i < label.size(); ++i)
        for (const auto j : problem.nearest_to(i)) {
            if (j == NoRow) break;
            if (j < i && label[i] == 0 && label[j] == 0 && problem.is_near(j, i)) components.unite(i, j);
        }
    return components;
}

std::vector<Component> describe(const Problem& problem, std::span<const std::uint8_t> label,
                                Components& components) {
    std::vector<Component> about(label.size());
    for (std::uint32_t i = 0; i < label.size(); ++i) {
        if (label[i] == 0) {
            auto& own = about[components.root(i)];
            ++own.rows;
            own.enclosed = own.enclosed && problem.enclosed[i] != 0;
        }
        for (const auto j : problem.nearest_to(i)) {
            if (j == NoRow) break;
            if (label[i] != label[j]) about[components.root(label[i] == 0 ? i : j)].beside_label = true;
        }
    }
    return about;
}

/// Labels the islands that are no larger than `share` of what is labelled.
void label_islands(const Problem& problem, double share, std::vector<std::uint8_t>& label) {
    const double most = share * static_cast<double>(std::count(label.begin(), label.end(), std::uint8_t{1}));
    Components components = components_without(problem, label);
    const auto about = describe(problem, label, components);
    for (std::uint32_t i = 0; i < label.size(); ++i) {
        const auto& own = about[components.root(i)];
        if (label[i] == 0 && own.beside_label && own.enclosed && own.rows <= most) label[i] = 1;
    }
}

}  // namespace

std::vector<std::uint8_t> cut_label(const GaussianSpans& gaussians, const CutParameters& parameters,
                                    const LabelField& field, ThreadPool* threads) {
    GSE_CHECK_EQ(field.probability.size(), gaussians.size);
    auto result = bits(field, parameters.threshold, parameters.least_coverage);
    if (parameters.smoothness <= 0) return result;
    Problem problem = make_problem(gaussians, parameters, field, threads);
    const auto& rows = problem.rows.row;
    if (rows.size() < 2) return result;
    auto label = cut_around_preferring(problem, parameters.reach, threads);
    if (parameters.island_share > 0) label_islands(problem, parameters.island_share, label);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const float decided =
            decided_probability(field.probability[rows[i]], label[i] != 0, parameters.threshold);
        result[rows[i]] = decided > parameters.threshold ? 1 : 0;
    }
    return result;
}

#else

std::vector<std::uint8_t> cut_label(const GaussianSpans&, const CutParameters& parameters,
                                    const LabelField& field, ThreadPool*) {
    return bits(field, parameters.threshold, parameters.least_coverage);
}

#endif

float decided_probability(float probability, bool labelled, double threshold) {
    const auto level = static_cast<float>(threshold);
    if (labelled == (probability > level)) return probability;
    return labelled ? std::min(1.0f, level + BeyondThreshold) : std::max(0.0f, level - BeyondThreshold);
}

}  // namespace gse::localize
