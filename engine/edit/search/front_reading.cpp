// Two-way centred cosines of pictures and side words, or shares of viewpoints, compared for fronts all
// around.
#include "engine/edit/search/front_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

constexpr double Pi = std::numbers::pi;
constexpr int Fronts = 72;  // that are tried
constexpr double FrontLimit = 50 * Pi / 180,
                 BackLimit = 130 * Pi / 180;  // as far as one says "front view", from where "back view"
const std::array<std::string, 3> SideWords{"front view", "side view", "back view"};

std::size_t side_at(double azimuth) {
    const double turned = std::abs(std::remainder(azimuth, 2 * Pi));
    return turned < FrontLimit ? 0 : turned > BackLimit ? 2 : 1;
}

/// [pictures][sides], with mean zero over each picture and over each side.
std::vector<std::array<double, 3>> centred_fits(VocabularyRanker& recognition, const std::string& sentence,
                                                const std::vector<Image>& pictures) {
    std::vector<std::array<double, 3>> fits(pictures.size());
    std::array<double, 3> of_side{};
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        double mean = 0;
        for (std::size_t s = 0; s < SideWords.size(); ++s)
            mean += fits[i][s] = recognition.fit(sentence + ", " + SideWords[s], {&pictures[i]});
        for (std::size_t s = 0; s < SideWords.size(); ++s) of_side[s] += fits[i][s] -= mean / 3;
    }
    for (auto& fit : fits)
        for (std::size_t s = 0; s < SideWords.size(); ++s)
            fit[s] -= of_side[s] / static_cast<double>(pictures.size());
    return fits;
}

constexpr double LeastLead = 0.005;  // of a front by words: below, fronts are anywhere (`bench clip`)
/// Least lead of a front by viewpoints, in nats per picture. By judgement on drawn and photographed scenes
/// (`gseditpro-lab bench clip`).
constexpr double LeastGain = 1.5;
// Lead of a sure front by viewpoints, in nats per picture (`gseditpro-lab bench clip`).
constexpr double SureGain = 2.5;
// Sharpness of how likely a front is: pictures that count for themselves, as neighbours err alike.
constexpr double Sharpness = 4;
constexpr double LeastShare = 1e-3;  // of a sector: one picture alone rules nothing out

/// Least lead of the two nearest sectors.
double log_share(const std::vector<float>& shares, double azimuth) {
    const auto count = static_cast<long>(shares.size());
    const double at = azimuth / (2 * Pi) * static_cast<double>(count), first = std::floor(at);
    const auto of = [&](long sector) {
        return std::log(
            std::max<double>(LeastShare, shares[static_cast<std::size_t>((sector % count + count) % count)]));
    };
    const auto sector = static_cast<long>(first);
    return (1 - (at - first)) * of(sector) + (at - first) * of(sector + 1);
}

constexpr double SectorWidth = Pi / 4;

/// Words for one of the eight sides, counted from the front to the left.
const std::string& sector(long index) {
    static const std::array<std::string, 8> sectors{"front view",      "front left view", "left side view",
                                                    "back left view",  "back view",       "back right view",
                                                    "right side view", "front right view"};
    return sectors[static_cast<std::size_t>((index % 8 + 8) % 8)];
}

}  // namespace

std::string view_words(double azimuth, bool sided) {
    return sided ? sector(std::lround(std::remainder(azimuth, 2 * Pi) / SectorWidth))
                 : SideWords[side_at(azimuth)];
}

SideBlend side_blend(double azimuth) {
    const double turn = std::remainder(azimuth, 2 * Pi) / SectorWidth, first = std::floor(turn);
    const auto index = static_cast<long>(first);
    return {sector(index), sector(index + 1), turn - first};
}

FrontReading front_by_words(VocabularyRanker& recognition, const std::string& sentence,
                            const std::vector<Image>& pictures, const std::vector<double>& azimuths) {
    GSE_CHECK(pictures.size() >= 3);
    GSE_CHECK_EQ(pictures.size(), azimuths.size());
    const auto fits = centred_fits(recognition, sentence, pictures);
    std::array<double, Fronts> total{};
    for (int f = 0; f < Fronts; ++f) {
        const double front = 2 * Pi * f / Fronts;
        for (std::size_t i = 0; i < pictures.size(); ++i)
            total[static_cast<std::size_t>(f)] += fits[i][side_at(azimuths[i] - front)];
        total[static_cast<std::size_t>(f)] /= static_cast<double>(pictures.size());
    }
    // Neighbours that fit alike have one front in their middle, where the sum over 60 degrees is largest.
    FrontReading best;
    double most = -1e300;
    for (int f = 0; f < Fronts; ++f) {
        double around = 0;
        for (int d = -Fronts / 12; d <= Fronts / 12; ++d)
            around += total[static_cast<std::size_t>((f + d + Fronts) % Fronts)];
        if (around <= most) continue;
        most = around;
        best.azimuth = std::remainder(2 * Pi * f / Fronts, 2 * Pi);
        best.lead =
            total[static_cast<std::size_t>(f)] - total[static_cast<std::size_t>((f + Fronts / 2) % Fronts)];
    }
    best.clear = best.lead >= LeastLead;
    return best;
}

FrontReading front_by_viewpoints(const std::vector<std::vector<float>>& seen,
                                 const std::vector<double>& azimuths) {
    GSE_CHECK(!seen.empty());
    GSE_CHECK_EQ(seen.size(), azimuths.size());
    std::array<double, Fronts> fit{};
    for (int f = 0; f < Fronts; ++f)
        for (std::size_t i = 0; i < seen.size(); ++i)
            fit[static_cast<std::size_t>(f)] +=
                log_share(seen[i], azimuths[i] - 2 * Pi * f / Fronts) / static_cast<double>(seen.size());
    const auto peak = std::max_element(fit.begin(), fit.end());
    // The cameras stand at steps of their own: between these the peak is the mean of what is nearly as likely
    // around it.
    const int middle = static_cast<int>(peak - fit.begin());
    double weights = 0, offset = 0;
    for (int d = -Fronts / 8; d <= Fronts / 8; ++d) {
        const double weight =
            std::exp(Sharpness * (fit[static_cast<std::size_t>((middle + d + Fronts) % Fronts)] - *peak));
        weights += weight, offset += weight * d;
    }
    FrontReading best;
    best.azimuth = std::remainder(2 * Pi * (middle + offset / weights) / Fronts, 2 * Pi);
    best.lead = *peak - std::accumulate(fit.begin(), fit.end(), 0.0) / Fronts;
    best.clear = best.lead >= LeastGain;
    best.sure = best.lead >= SureGain;
    return best;
}

FrontReading read_front(VocabularyRanker& recognition, const std::string& sentence,
                        const std::vector<Image>& pictures, const std::vector<double>& azimuths) {
    GSE_CHECK(!pictures.empty());
    if (!recognition.viewpoint(pictures.front()).empty()) {
        std::vector<std::vector<float>> seen;
        for (const auto& picture : pictures) seen.push_back(recognition.viewpoint(picture));
        if (const auto read = front_by_viewpoints(seen, azimuths); read.clear) return read;
    }
    return front_by_words(recognition, sentence, pictures, azimuths);
}

std::optional<double> chosen_front(const std::optional<FrontReading>& read,
                                   const std::optional<double>& looked_from) {
    if (looked_from && !(read && read->sure)) return looked_from;
    if (read && read->clear) return read->azimuth;
    return std::nullopt;
}

}  // namespace gse::edit
