// Whole edits with and without the memory for what does not change: the same bytes, whatever happens to the
// rows meanwhile.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <numbers>

#include "engine/edit/optimise/edit_loop.h"
#include "engine/edit/optimise/oracle_guidance.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/scene/delta.h"
#include "tests/agree/raster/scenes.h"
#include "tests/unit/edit/requests.h"

namespace view_session_edit_test {

namespace {

using namespace gse;

constexpr int Side = 64;
constexpr std::size_t Ample = std::size_t{256} << 20;

/// A bear whose hat changes its colour, with a label that takes in less and then more of it on the way.
struct Case {
    synth::SynthScene scene;
    GaussianSet target;
    std::vector<std::uint8_t> hat;
    edit::EditPlan plan;
    edit::CheckedRequest request;
};

Case hat_case() {
    synth::SceneSpec spec;
    spec.accessory = "hat";
    spec.accessory_colour = "blue";
    spec.seed = 6;
    Case c{synth::generate(spec), {}, {}, {}, test::asked("bear", "a bear wearing a red hat", "red")};
    spec.accessory_colour = "red";
    c.target = synth::generate(spec).scene.gaussians;
    for (const auto part : c.scene.parts) c.hat.push_back(part == synth::Part::Accessory ? 1 : 0);
    // Every seventh row of the hat goes at the first occasion.
    GaussianData faint = c.scene.scene.gaussians.to_data();
    for (std::size_t row = 0; row < c.hat.size(); ++row)
        if (c.hat[row] != 0 && row % 7 == 0) faint.opacity_logit[row] = -8;
    c.scene.scene.gaussians = GaussianSet(std::move(faint));
    c.plan.label = c.hat;
    for (int i = 0; i < 6; ++i) {
        const double azimuth = 2 * std::numbers::pi * i / 6, elevation = i % 2 == 0 ? 0.25 : 0.55;
        c.plan.views.push_back({"view", synth::scene_camera(c.scene, azimuth, elevation, 0.95, Side, Side)});
        c.plan.masks.push_back(Mask(Side, Side, 1));
    }
    c.request.iterations = 40;
    c.request.densify_every = 8;
    c.request.densify_from = 8;
    c.request.geometry_share = 1;
    c.request.anchor_opacity = 0;
    return c;
}

edit::EditResult run(const Case& c, const std::string& kernels, unsigned threads, std::size_t budget,
                     bool relabels) {
    ThreadPool pool(threads);
    const auto rasterizer = raster::make_fast_rasterizer(pool, kernels);
    edit::OracleGuidance guidance(c.target, c.plan.views, c.plan.settings, *rasterizer);
    edit::EditTools tools{*rasterizer, &guidance, {}, {}};
    tools.view_bytes = budget;
    int asked = 0;
    if (relabels)
        tools.new_label = [&]() -> std::optional<std::vector<std::uint8_t>> {
            ++asked;
            if (asked != 12 && asked != 24) return std::nullopt;
            auto label = c.hat;
            for (std::size_t row = 0, seen = 0; row < label.size(); ++row)
                if (label[row] != 0 && seen++ % 2 == (asked == 12 ? 0u : 1u))
                    label[row] = 0;  // as many rows, but others
            return label;
        };
    return edit::run_edit(c.scene.scene.gaussians, c.plan, c.request, tools);
}

bool same_result(const edit::EditResult& a, const edit::EditResult& b) {
    if (a.set.size() != b.set.size() || a.history.size() != b.history.size()) return false;
    for (std::size_t row = 0; row < a.set.size(); ++row)
        if (!same_row(a.set.spans(), row, b.set.spans(), row)) return false;
    for (std::size_t i = 0; i < a.history.size(); ++i)
        if (a.history[i].preservation != b.history[i].preservation ||
            a.history[i].anchor != b.history[i].anchor ||
            a.history[i].guidance_norm != b.history[i].guidance_norm)
            return false;
    return a.label == b.label && a.generation == b.generation;
}

}  // namespace

DOCTEST_TEST_CASE("an edit gives the same bytes with and without memory for its views") {
    const Case c = hat_case();
    for (const bool relabels : {false, true})
        for (const std::string& kernels : raster::usable_kernels()) {
            DOCTEST_CAPTURE(relabels);
            DOCTEST_CAPTURE(kernels);
            const auto full = run(c, kernels, 2, 0, relabels);
            DOCTEST_CHECK(full.continued_pictures == 0);
            DOCTEST_CHECK(full.cloned + full.split > 0);
            DOCTEST_CHECK(full.pruned > 0);
            DOCTEST_CHECK(full.label_changes == (relabels ? 2 : 0));
            for (const std::size_t budget : {std::size_t{700} << 10, Ample})
                for (const unsigned threads : {1u, 2u}) {
                    DOCTEST_CAPTURE(budget);
                    DOCTEST_CAPTURE(threads);
                    const auto skipping = run(c, kernels, threads, budget, relabels);
                    DOCTEST_CHECK(same_result(skipping, full));
                    DOCTEST_CHECK(skipping.continued_pictures > 0);
                    DOCTEST_CHECK((skipping.continued_pictures < full.history.size()) == (budget < Ample));
                }
        }
}

}  // namespace view_session_edit_test
