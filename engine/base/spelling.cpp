// Levenshtein distance and the nearest of a list.
#include "engine/base/spelling.h"

#include <algorithm>

namespace gse {

double spelling_distance(const std::string& a, const std::string& b) {
    if (a.empty() && b.empty()) return 0;
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
            diagonal = above;
        }
    }
    return static_cast<double>(row[b.size()]) / static_cast<double>(std::max(a.size(), b.size()));
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
    constexpr double most_different = 0.5;
    std::string best;
    double least = most_different;
    for (const auto& candidate : known) {
        const double distance = spelling_distance(word, candidate);
        if (distance > least || (distance == least && !best.empty())) continue;
        least = distance;
        best = candidate;
    }
    return best;
}

}  // namespace gse
