// Adam, anchors and the preservation loss against twins in double precision, step by step.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "engine/edit/optimise/preservation_loss.h"
#include "engine/edit/optimise/working_set.h"
#include "tests/unit/edit/edit_scenes.h"
#include "tests/unit/edit/row_gradients.h"

namespace optimiser_twin_test {

namespace {

using namespace gse;

constexpr double Extent = 3;
constexpr double StepError = 3e-6;     // of one Adam step in float, relative: a dozen roundings
constexpr double ValueError = 1.2e-7;  // of a value that is stored as float, relative
constexpr double SsimLossError = 2e-6,
                 SsimGradientError = 2e-4;  // relative; the gradient's to its largest value

/// One value under Adam (Kingma and Ba 2015, algorithm 1), beta 0.9 / 0.999, eps 1e-15.
struct AdamTwin {
    double value = 0, first = 0, second = 0;
    double step(double gradient, double rate, int count) {
        first = 0.9 * first + 0.1 * gradient;
        second = 0.999 * second + 0.001 * gradient * gradient;
        const double change = rate * (first / (1 - std::pow(0.9, count))) /
                              (std::sqrt(second / (1 - std::pow(0.999, count))) + 1e-15);
        value -= change;
        return change;
    }
};

/// Everything of one attribute that a step reads.
struct Attribute {
    const std::vector<float>& values;
    std::size_t first_row;
    const std::vector<float>& anchor;
    const edit::AdamMoments& moments;
    std::span<const float> gradient;
    std::size_t stride;
    double anchor_weight;
    std::array<double, 48> rates;
};

struct TwinStep {
    std::vector<double> values, rates;  // of the labelled rows
    double anchor_loss = 0;
};

/// GSEditPro eq. 6: the mean over the values of weight * generation's weight * (value - anchor)^2, and Adam
/// on both gradients.
TwinStep twin_step(const Attribute& a, const edit::RowTable& table, const edit::GenerationSchedule& schedule,
                   double row_factor, int count) {
    TwinStep result;
    const std::size_t size = a.anchor.size();
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t row = i / a.stride;
        AdamTwin twin{a.values[a.first_row * a.stride + i],
                      a.moments.first.empty() ? 0.0 : a.moments.first[i],
                      a.moments.second.empty() ? 0.0 : a.moments.second[i]};
        const double factor =
            a.anchor_weight / static_cast<double>(size) * schedule.weight(table.generation[row]);
        const double away = twin.value - static_cast<double>(a.anchor[i]);
        result.anchor_loss += factor * away * away;
        const double share = table.origin[row] >= 0 ? row_factor : 1;
        result.rates.push_back(a.rates[i % a.stride] * share);
        twin.step(a.gradient[i] + 2 * factor * away, result.rates.back(), count);
        result.values.push_back(twin.value);
    }
    return result;
}

std::array<double, 48> all_at(double rate) {
    std::array<double, 48> rates{};
    rates.fill(rate);
    return rates;
}

edit::EditRequest twin_request() {
    edit::EditRequest request;
    request.iterations = 60;
    request.geometry_share = 0.4;
    request.colour_coupling = 0;
    request.anchor_first = 0.5;
    request.anchor_colour = 20;
    // Far from every guard.
    request.rate_scale = request.rate_colour = request.rate_sh = request.rate_opacity = 1e-3;
    request.densify_percent = 0.1;
    request.min_opacity = 0;
    return request;
}

raster::Gradients noisy_gradients(const edit::WorkingSet& set, Random& random) {
    return test::row_gradients(set, [&] { return 1e-3 * random.normal() * std::exp(3 * random.normal()); });
}

/// Pictures in double precision, one channel.
struct Plane {
    int width = 0, height = 0;
    std::vector<double> values;
    double at(int x, int y) const {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

Plane plane_of(const Image& image, std::size_t channel) {
    Plane plane{image.width, image.height, {}};
    for (std::size_t i = channel; i < image.data.size(); i += 3) plane.values.push_back(image.data[i]);
    return plane;
}

/// Sum of 1 - SSIM by the definition: an 11 x 11 Gaussian window around every pixel, zeros beyond the border.
double ssim_loss(const Plane& a, const Plane& b) {
    std::array<double, 11> window{};
    double sum = 0, total = 0;
    for (int i = 0; i < 11; ++i)
        sum += window[static_cast<std::size_t>(i)] = std::exp(-(i - 5) * (i - 5) / 4.5);
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
            for (int v = std::max(0, y - 5); v <= std::min(a.height - 1, y + 5); ++v)
                for (int u = std::max(0, x - 5); u <= std::min(a.width - 1, x + 5); ++u) {
                    const double w = window[static_cast<std::size_t>(v - y + 5)] *
                                     window[static_cast<std::size_t>(u - x + 5)] / (sum * sum);
                    const double p = a.at(u, v), q = b.at(u, v);
                    ma += w * p, mb += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
                }
            total += 1 - (2 * ma * mb + 1e-4) * (2 * (ab - ma * mb) + 9e-4) /
                             ((ma * ma + mb * mb + 1e-4) * (aa - ma * ma + bb - mb * mb + 9e-4));
        }
    return total;
}

}  // namespace

DOCTEST_TEST_CASE(
    "Adam in float follows its twin in double for thousands of steps, for gradients from 1e-12 to 1e12") {
    constexpr std::size_t count = 200;
    constexpr int steps = 3000;
    constexpr double rate = 0.01;
    std::vector<float> values(count, 0.5f), gradient(count);
    std::vector<AdamTwin> twins(count, {0.5});
    edit::AdamMoments moments;
    Random random(5);
    std::vector<double> way(count, 0);
    for (int step = 1; step <= steps; ++step) {
        for (std::size_t i = 0; i < count; ++i) {
            const double size = std::pow(10.0, -12 + 24 * static_cast<double>(i) / count);
            gradient[i] = static_cast<float>(size * (random.normal() + 0.3 * std::sin(0.01 * step)));
            if (random.below(10) == 0) gradient[i] = 0;
        }
        edit::adam_step(values, gradient, moments, {std::array{rate}, {}, step});
        for (std::size_t i = 0; i < count; ++i) way[i] += std::abs(twins[i].step(gradient[i], rate, step));
    }
    for (std::size_t i = 0; i < count; ++i) {
        DOCTEST_CAPTURE(i);
        // Each step adds its own rounding and that of the value it is added to.
        DOCTEST_CHECK(std::abs(values[i] - twins[i].value) <
                      StepError * way[i] + steps * ValueError * std::max(1.0, way[i] / 10));
    }
}

DOCTEST_TEST_CASE("every step of the working set is that of its twin: anchors by generation, shares, Adam") {
    const auto scene = test::ball_scene(150, 1);
    const auto request = twin_request();
    edit::WorkingSet set(scene.set, scene.first, {}, request, Extent);
    edit::GenerationSchedule schedule(request);
    Random random(6), growth(7);
    std::size_t compared = 0;
    for (int iteration = 0; iteration < request.iterations; ++iteration) {
        const edit::RowTable before = set.table();
        const auto gradients = noisy_gradients(set, random);
        set.collect(gradients);
        const double loss = set.step(gradients, iteration, request);
        const double progress = static_cast<double>(iteration) / (request.iterations - 1);
        const double position_rate = Extent * std::pow(request.rate_position, 1 - progress) *
                                     std::pow(request.rate_position_end, progress);
        auto colour_rates = all_at(request.rate_sh);
        std::fill_n(colour_rates.begin(), 3, request.rate_colour);
        const GaussianData &was = before.rows, &now = set.rows();
        const std::size_t first = before.first_row, sh = was.sh_stride();
        const std::array<std::pair<Attribute, const std::vector<float>*>, 5> attributes{
            {{{was.position, first, before.anchor.position, before.position, gradients.position, 3,
               request.anchor_position, all_at(position_rate)},
              &now.position},
             {{was.log_scale, first, before.anchor.log_scale, before.log_scale, gradients.log_scale, 3,
               request.anchor_scale, all_at(request.rate_scale)},
              &now.log_scale},
             {{was.rotation, first, before.anchor.rotation, before.rotation, gradients.rotation, 4,
               request.anchor_rotation, all_at(request.rate_rotation)},
              &now.rotation},
             {{was.opacity_logit, first, before.anchor.opacity_logit, before.opacity, gradients.opacity_logit,
               1, request.anchor_opacity, all_at(request.rate_opacity)},
              &now.opacity_logit},
             {{was.sh, first, before.anchor.sh, before.sh, gradients.sh, sh, request.anchor_colour,
               colour_rates},
              &now.sh}}};
        double twin_loss = 0, worst = 0;  // steps are of the size of their rate
        for (std::size_t k = 0; k < attributes.size(); ++k) {
            const auto& [attribute, values] = attributes[k];
            const auto twin = twin_step(attribute, before, schedule,
                                        k < 4 ? double{request.geometry_share} : 1.0, iteration + 1);
            twin_loss += twin.anchor_loss;
            for (std::size_t i = 0; i < twin.values.size(); ++i) {
                const double allowed = StepError * twin.rates[i] + ValueError * std::abs(twin.values[i]);
                worst = std::max(
                    worst, std::abs((*values)[first * attribute.stride + i] - twin.values[i]) / allowed);
                ++compared;
            }
        }
        DOCTEST_CAPTURE(iteration);
        DOCTEST_CHECK(worst <= 1);
        DOCTEST_CHECK(loss == doctest::Approx(twin_loss).epsilon(1e-9));
        if (iteration % 20 == 19) {
            set.densify(request, growth, true);
            schedule.advance();
        }
    }
    DOCTEST_CHECK(set.labelled() > 150);
    DOCTEST_CHECK(compared > 60 * 150 * 20);
}

DOCTEST_TEST_CASE(
    "the structural loss and its gradient are those of the twin: flat, black against white, and bright "
    "pictures") {
    constexpr int width = 19, height = 14;
    const auto filled = [&](std::uint64_t seed, double low, double high) {
        Image image(width, height, 3);
        Random random(seed);
        for (auto& value : image.data) value = static_cast<float>(random.uniform(low, high));
        return image;
    };
    struct Pair {
        const char* name;
        Image a, b;
    };
    const std::array<Pair, 5> pairs{{{"noise", filled(1, 0, 1), filled(2, 0, 1)},
                                     {"flat and nearly flat", filled(3, 0.5, 0.5), filled(4, 0.49, 0.51)},
                                     {"black and white", filled(5, 0, 0), filled(6, 1, 1)},
                                     {"dark", filled(7, 0, 0.01), filled(8, 0, 0.01)},
                                     {"ten times display white", filled(9, 8, 10), filled(10, 8, 10)}}};
    for (const auto& pair : pairs) {
        DOCTEST_CAPTURE(pair.name);
        edit::PreservationLoss preservation({0, 1, 1});
        Image gradient(width, height, 3);
        const double loss = preservation.add_gradient(pair.a, pair.b, Mask(width, height), gradient);
        double twin_loss = 0, largest = 0, worst = 0;
        for (std::size_t channel = 0; channel < 3; ++channel)
            twin_loss += ssim_loss(plane_of(pair.a, channel), plane_of(pair.b, channel));
        const auto count = static_cast<double>(gradient.data.size());
        DOCTEST_CHECK(loss == doctest::Approx(twin_loss / count).epsilon(SsimLossError));
        const Plane other = plane_of(pair.b, 1);
        for (const float value : gradient.data)
            largest = std::max(largest, std::abs(static_cast<double>(value)));
        Random random(11);
        for (int trial = 0; trial < 25; ++trial) {  // central differences in double: exact to 1e-8
            constexpr double nudge = 1e-5;
            const std::size_t i = random.below(static_cast<std::uint64_t>(width) * height);
            Plane up = plane_of(pair.a, 1), down = up;
            up.values[i] += nudge, down.values[i] -= nudge;
            const double slope = (ssim_loss(up, other) - ssim_loss(down, other)) / (2 * nudge * count);
            worst = std::max(worst, std::abs(gradient.data[i * 3 + 1] - slope));
        }
        DOCTEST_CHECK(worst < SsimGradientError * largest);
    }
}

}  // namespace optimiser_twin_test
