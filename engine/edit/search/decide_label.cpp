// Each step returns a value of its own; the field stays what the views said.
#include "engine/edit/search/decide_label.h"

#include <algorithm>
#include <utility>

#include "engine/base/log.h"
#include "engine/edit/placement/ground_rows.h"
#include "engine/edit/search/thing_parts.h"
#include "engine/localize/graph_cut.h"
#include "engine/localize/propagate_labels.h"

namespace gse::edit {
namespace {

constexpr float SupportWeight = 0.5f;  // of the threshold: the most that rows beside the thing keep

/// Weights on the side of the threshold where the bits are; of Gaussians that nobody knows they stay.
std::vector<float> decided_weights(const LabelField& field, const std::vector<std::uint8_t>& bits,
                                   double threshold, double least_coverage) {
    std::vector<float> weights = field.probability;
    for (std::size_t row = 0; row < weights.size(); ++row) {
        const bool known = field.coverage[row] > least_coverage || field.inferred[row] != 0;
        if (known && (bits[row] != 0) != (weights[row] > threshold))
            weights[row] = localize::decided_probability(weights[row], bits[row] != 0, threshold);
    }
    return weights;
}

/// Rows that both have; none where `rows` is empty.
std::vector<std::size_t> both(const std::vector<std::uint8_t>& rows, const std::vector<std::uint8_t>& bits) {
    std::vector<std::size_t> result;
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0 && bits[row] != 0) result.push_back(row);
    return result;
}

}  // namespace

DecidedLabel decide_label(std::string name, const GaussianSet& set, const FoundField& found, double threshold,
                          ThreadPool* threads) {
    const LabelRule& rule = found.rule;
    const localize::SpreadParameters spread{.least_coverage = rule.least_coverage, .threshold = threshold};
    const LabelField field = localize::propagate_labels_knn(set.spans(), spread, found.field, threads);
    const localize::CutParameters cut{.smoothness = rule.smoothness,
                                      .threshold = threshold,
                                      .least_coverage = rule.least_coverage,
                                      .island_share = rule.island_share};
    auto bits = localize::cut_label(set.spans(), cut, field, threads);
    auto weights = decided_weights(field, bits, threshold, rule.least_coverage);
    const auto leave = [&](const std::vector<std::size_t>& rows, const char* other) {
        for (const auto row : rows) {
            bits[row] = 0;
            weights[row] = std::min(weights[row], static_cast<float>(SupportWeight * threshold));
        }
        if (!rows.empty())
            log::debug("{} splats of the {} at \"{}\" are left to it", rows.size(), other, name);
    };
    leave(ground_rows(set, bits, rule.up, rule.front), "ground");
    auto beside = parts_beside(set, bits, rule.nature, rule.up, rule.front);
    leave(both(beside.rows, bits), beside.name);
    for (const auto row : beside.lacking) {
        bits[row] = 1;
        weights[row] = localize::decided_probability(weights[row], true, threshold);
    }
    return {{std::move(name), std::make_shared<const std::vector<float>>(std::move(weights)),
             std::make_shared<const std::vector<std::uint8_t>>(std::move(bits))},
            std::move(beside.rows)};
}

}  // namespace gse::edit
