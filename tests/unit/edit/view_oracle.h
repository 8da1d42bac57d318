// An oracle of view guidance and the edit of a ball that it leads, for tests of the session without networks.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/base/thread_pool.h"
#include "engine/edit/optimise/edit_loop.h"
#include "tests/unit/edit/edit_scenes.h"

namespace gse::test {

/// Knows the answer: the render of another scene from every view.
class OracleViews : public edit::MultiViewEditor {
public:
    OracleViews(const GaussianSet& target, raster::Rasterizer& rasterizer)
        : target_(target), rasterizer_(rasterizer) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override {
        if (job.stop_requested()) throw Error(ErrorCode::Cancelled, "stopped");
        if (input.round == fails_in || (fails_alone && views.size() == 1))
            throw Error(ErrorCode::Model, "not finite");
        inputs.push_back(input);
        asked.push_back(views);
        Random random(input.seed);
        edit::EditedViews targets;
        for (const auto& view : views) {
            if (input.strength < least_strength) {
                targets.images.push_back(view.rendered);
                continue;
            }
            raster::ForwardOutput output;
            rasterizer_.forward(target_.spans(), view.view.camera, {}, output);
            if (noisy)
                for (auto& value : output.colour.data) value += static_cast<float>(random.uniform(0, 0.1));
            targets.images.push_back(output.colour);
        }
        if (missing_in_round > 0 && views.size() > 1) {
            targets.rejected.assign(views.size(), 0);
            std::fill_n(targets.rejected.begin(), missing_in_round, std::uint8_t{1});
            targets.missing = targets.rejected;
        }
        targets.scalars["broken"] = std::nan("");
        targets.scalars["views"] = static_cast<double>(views.size());
        return targets;
    }
    std::vector<edit::EditViewsRequest> inputs;
    std::vector<std::vector<edit::EditView>> asked;  // per input
    int fails_in = -1;                               // round
    bool fails_alone = false;                        // where a single view is asked for
    double least_strength = 0;                       // below it the pictures stay as they are
    bool noisy = false;                              // another picture for another seed
    int missing_in_round = 0;                        // first views that a whole round lacks

private:
    const GaussianSet& target_;
    raster::Rasterizer& rasterizer_;
};

/// The red ball in blue.
inline GaussianSet blue_ball(const BallScene& scene) {
    GaussianData data = scene.set.to_data();
    for (std::size_t row = 0; row < scene.first.size(); ++row)
        if (scene.first[row] != 0)
            std::swap(data.sh[row * data.sh_stride()], data.sh[row * data.sh_stride() + 2]);
    return GaussianSet(std::move(data));
}

inline double difference(const GaussianSet& a, const GaussianSet& b, const std::vector<View>& views,
                         raster::Rasterizer& rasterizer) {
    double sum = 0;
    for (const auto& view : views) {
        raster::ForwardOutput of_a, of_b;
        rasterizer.forward(a.spans(), view.camera, {}, of_a);
        rasterizer.forward(b.spans(), view.camera, {}, of_b);
        for (std::size_t i = 0; i < of_a.colour.data.size(); ++i)
            sum += std::abs(of_a.colour.data[i] - of_b.colour.data[i]);
    }
    return sum;
}

/// The red ball is to become blue, by an oracle's views; the guidance that pulls is never asked.
struct Redrawing {
    int side = 32;
    BallScene scene = ball_scene();
    ThreadPool threads{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(threads);
    edit::EditPlan plan = ball_plan(scene, *rasterizer, 6, side);
    GaussianSet target = blue_ball(scene);
    OracleViews oracle{target, *rasterizer};
    FunctionGuidance never{
        [](const edit::GuidanceInput&) -> edit::GuidanceOutput { throw Error(ErrorCode::Model, "asked"); }};
    edit::EditTools tools{*rasterizer, &never, {}, {}};
    explicit Redrawing(int picture_side = 32) : side(picture_side) { tools.views = &oracle; }
    edit::EditResult edited(const edit::CheckedRequest& request) {
        return edit::run_edit(scene.set, plan, request, tools);
    }
    double error_of(const GaussianSet& set) { return difference(set, target, plan.views, *rasterizer); }
};

inline edit::CheckedRequest view_request(int rounds, int fit_steps) {
    auto request = asked("ball", "a blue ball", "blue");
    request.method = "views";
    request.rounds = rounds;
    request.fit_steps = fit_steps;
    request.edited_views = 4;
    return request;
}

}  // namespace gse::test
