// Rounds of full and skipping iterations, one after the other.
#include "engine/raster/skip_bench.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/base/check.h"
#include "engine/base/clock.h"
#include "engine/base/random.h"
#include "engine/math/quantile.h"
#include "engine/raster/bench_tools.h"
#include "engine/raster/view_session.h"

namespace gse::raster {
namespace {

constexpr std::size_t SkipBudget = std::size_t{4} << 30;  // every view is kept
constexpr double StepSize = 1e-4;  // of positions, between rounds, times the spread of the rows

/// All rows, ending with those nearest to the middle. The middle is the row nearest to the mean place.
std::vector<std::size_t> towards_middle(const GaussianSpans& g) {
    std::vector<std::size_t> rows(g.size);
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    Vec3 centre;
    const auto place = [&](std::size_t row) {
        return Vec3{g.position[row * 3], g.position[row * 3 + 1], g.position[row * 3 + 2]};
    };
    for (const std::size_t row : rows) centre = centre + place(row) / static_cast<double>(g.size);
    std::vector<double> distance(g.size);
    const auto measure = [&] {
        for (const std::size_t row : rows) distance[row] = length(place(row) - centre);
    };
    measure();
    centre = place(
        static_cast<std::size_t>(std::min_element(distance.begin(), distance.end()) - distance.begin()));
    measure();
    std::stable_sort(rows.begin(), rows.end(),
                     [&](std::size_t a, std::size_t b) { return distance[a] > distance[b]; });
    return rows;
}

GaussianData in_order(const GaussianSpans& g, std::span<const std::size_t> rows) {
    GaussianData data;
    data.sh_degree = g.sh_degree;
    const auto copy = [&](std::span<const float> from, std::size_t stride, std::vector<float>& to) {
        for (const std::size_t row : rows)
            to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(row * stride),
                      from.begin() + static_cast<std::ptrdiff_t>((row + 1) * stride));
    };
    copy(g.position, 3, data.position);
    copy(g.log_scale, 3, data.log_scale);
    copy(g.rotation, 4, data.rotation);
    copy(g.opacity_logit, 1, data.opacity_logit);
    copy(g.sh, data.sh_stride(), data.sh);
    return data;
}

double largest_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        largest =
            std::max(largest, std::abs(static_cast<double>(a.data[i]) - static_cast<double>(b.data[i])));
    return largest;
}

struct SkipCase {
    GaussianData& data;
    std::size_t first_row = 0;
    std::span<const Camera> views;
    const Image& d_colour;
    double step = 0;
    int repetitions = 1;
};

/// Moves the labelled rows by a step, as an optimiser does.
void move_labelled(const SkipCase& c, Random& random) {
    for (std::size_t i = c.first_row * 3; i < c.data.position.size(); ++i)
        c.data.position[i] += static_cast<float>(c.step * random.normal());
}

class SkipRounds {
public:
    SkipRounds(const SkipCase& c, Rasterizer& rasterizer)
        : case_(c), rasterizer_(rasterizer), session_(rasterizer.view_session(c.views.size(), SkipBudget)) {}

    SkipBench run() {
        Random random(11);
        round();  // prepares the views and warms up
        result_.prepare_ms = skipping_forward_.front();
        for (auto* times :
             {&full_forward_, &full_backward_, &skipping_forward_, &skipping_backward_, &ratios_})
            times->clear();
        for (int i = 0; i < case_.repetitions; ++i) {
            move_labelled(case_, random);
            round();
        }
        result_.labelled = case_.data.size() - case_.first_row;
        result_.full = {upper_median(full_forward_), upper_median(full_backward_)};
        result_.skipping = {upper_median(skipping_forward_), upper_median(skipping_backward_)};
        result_.ratio = upper_median(ratios_);
        result_.kept_mib = static_cast<double>(session_->work().kept_bytes) / 1048576 /
                           static_cast<double>(case_.views.size());
        return result_;
    }

private:
    template <class Work> static double time_of(const Work& work) {
        const double begin = processor_seconds();
        work();
        return 1e3 * (processor_seconds() - begin);
    }

    void round() {
        double times[4] = {};
        result_.full_pairs = result_.pairs = 0;
        result_.picture_difference = result_.gradient_difference = 0;
        for (std::size_t view = 0; view < case_.views.size(); ++view) {
            const auto rows = spans(case_.data);
            times[0] += time_of([&] { rasterizer_.forward(rows, case_.views[view], {}, full_); });
            times[1] +=
                time_of([&] { rasterizer_.backward(case_.d_colour, {}, case_.first_row, expected_); });
            times[2] += time_of(
                [&] { session_->forward(view, rows, case_.first_row, case_.views[view], {}, skipped_); });
            times[3] += time_of([&] { session_->backward(case_.d_colour, {}, found_); });
            compare();
        }
        const auto count = static_cast<double>(case_.views.size());
        full_forward_.push_back(times[0] / count);
        full_backward_.push_back(times[1] / count);
        skipping_forward_.push_back(times[2] / count);
        skipping_backward_.push_back(times[3] / count);
        ratios_.push_back((times[2] + times[3]) / (times[0] + times[1]));
        result_.full_pairs /= case_.views.size();
        result_.pairs /= case_.views.size();
    }

    void compare() {
        result_.full_pairs += full_.pairs;
        result_.pairs += skipped_.pairs;
        result_.picture_difference =
            std::max({result_.picture_difference, largest_difference(full_.colour, skipped_.colour),
                      largest_difference(full_.alpha, skipped_.alpha),
                      largest_difference(full_.depth, skipped_.depth)});
        result_.gradient_difference =
            std::max({result_.gradient_difference, relative_error(found_.position, expected_.position),
                      relative_error(found_.log_scale, expected_.log_scale),
                      relative_error(found_.rotation, expected_.rotation),
                      relative_error(found_.opacity_logit, expected_.opacity_logit),
                      relative_error(found_.sh, expected_.sh)});
    }

    const SkipCase& case_;
    Rasterizer& rasterizer_;
    std::unique_ptr<ViewSession> session_;
    ForwardOutput full_, skipped_;
    Gradients expected_, found_;
    std::vector<double> full_forward_, full_backward_, skipping_forward_, skipping_backward_, ratios_;
    SkipBench result_;
};

}  // namespace

std::vector<SkipBench> bench_skips(const GaussianSpans& gaussians, std::span<const Camera> cameras,
                                   const BenchSettings& settings, std::span<const double> shares) {
    GSE_CHECK(!cameras.empty() && settings.repetitions > 0 && gaussians.size > 0);
    ThreadPool pool(settings.threads);
    const auto rasterizer = make_rasterizer_of(settings.kernels, pool);
    std::vector<Camera> views;
    for (const Camera& camera : cameras) views.push_back(camera.resized(settings.width, settings.height));
    const Image d_colour = noise_image(settings.width, settings.height);
    const auto order = towards_middle(gaussians);
    const auto far = in_order(gaussians, std::span(order).first(1)),
               near = in_order(gaussians, std::span(order).last(1));
    double spread = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        spread = std::max(spread, std::abs(static_cast<double>(far.position[axis]) -
                                           static_cast<double>(near.position[axis])));
    std::vector<SkipBench> results;
    for (const double share : shares) {
        GaussianData data = in_order(gaussians, order);
        const auto labelled = static_cast<std::size_t>(share * static_cast<double>(data.size()));
        const std::size_t first_row = data.size() - std::min(labelled, data.size());
        const SkipCase c{data, first_row, views, d_colour, StepSize * spread, settings.repetitions};
        results.push_back(SkipRounds(c, *rasterizer).run());
        results.back().share = share;
    }
    return results;
}

}  // namespace gse::raster
