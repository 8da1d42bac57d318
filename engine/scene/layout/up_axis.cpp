// Evidence and habit, weighed.
#include "engine/scene/layout/up_axis.h"

#include <algorithm>
#include <cmath>

namespace gse {
namespace {

constexpr std::size_t MostSamples = 40'000;
constexpr int GridCells = 56;
constexpr std::size_t LeastSamples = 200;  // fewer show no surface
constexpr double SureLikelihood = 0.7;

// Share of the files that are up along x, -x, y, -y, z, -z: COLMAP and 3DGS write -y, nerfstudio and Blender
// z, viewers y.
constexpr std::array<double, Directions> Habit{0.05, 0.05, 0.18, 0.41, 0.26, 0.05};

// Weights of a multinomial logistic model of the evidence.
double support(const UpEvidence& evidence) {
    constexpr double Light = 2.3, Stands = 5.0, Symmetry = 3.2, Base = 0.9, Level = 3.0, Facing = 3.0,
                     Origin = 5.0;
    constexpr double BaseRange = 4, LeastStands = -0.2, MostStands = 0.5, MostFacing = 0.3;
    return Light * std::tanh(2 * evidence.light) +
           Stands * std::clamp(evidence.stands, LeastStands, MostStands) + Symmetry * evidence.symmetry +
           Base * std::tanh(evidence.base / BaseRange) + Level * evidence.level +
           Facing * std::clamp(evidence.facing, -MostFacing, MostFacing) + Origin * evidence.origin;
}

}  // namespace

bool UpGuess::sure() const { return confidence() >= SureLikelihood; }

UpGuess guess_up_axis(const GaussianSet& set, std::span<const std::uint8_t> skip) {
    const auto samples = surface_samples(set, MostSamples, skip);
    UpGuess guess;
    guess.likelihood = Habit;
    if (samples.size() < LeastSamples) return guess;
    const SolidGrid grid(samples, GridCells);
    if (grid.empty()) return guess;
    const auto evidence = up_evidence(samples, grid);
    std::array<double, Directions> score{};
    for (std::size_t i = 0; i < Directions; ++i) score[i] = support(evidence[i]) + std::log(Habit[i]);
    const double most = *std::max_element(score.begin(), score.end());
    double sum = 0;
    for (auto& value : score) sum += value = std::exp(value - most);
    for (std::size_t i = 0; i < Directions; ++i) guess.likelihood[i] = score[i] / sum;
    guess.best = static_cast<std::size_t>(std::max_element(guess.likelihood.begin(), guess.likelihood.end()) -
                                          guess.likelihood.begin());
    return guess;
}

}  // namespace gse
