// A thing becomes another, and is added, by redrawn views that are true: what the three-dimensional part
// alone loses.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/base/error.h"
#include "engine/edit/optimise/edit_loop.h"
#include "engine/edit/search/locate.h"
#include "engine/edit/search/make_plan.h"
#include "engine/evaluate/metrics.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/localize/clusters.h"
#include "engine/raster/rasterizer.h"
#include "tests/unit/edit/requests.h"

namespace shape_edit_test {

namespace {

using namespace gse;

constexpr int Side = 96;

synth::SynthScene scene_of(const std::string& object, const std::string& material,
                           const std::string& accessory = {}) {
    synth::SceneSpec spec;
    spec.object = object;
    spec.material = material;
    spec.accessory = accessory;
    spec.seed = 77;
    return synth::generate(spec);
}

std::vector<std::uint8_t> rows_of(const synth::SynthScene& scene, synth::Part part) {
    std::vector<std::uint8_t> bits;
    for (const auto p : scene.parts) bits.push_back(p == part ? 1 : 0);
    return bits;
}

std::vector<View> ring(const synth::SynthScene& scene, int count, double offset) {
    std::vector<View> views;
    for (int i = 0; i < count; ++i)
        views.push_back({fmt::format("ring_{}", i),
                         synth::scene_camera(scene, 2 * 3.14159265358979 * (i + offset) / count,
                                             offset > 0   ? 0.35
                                             : i % 2 == 0 ? 0.2
                                                          : 0.55,
                                             1, Side, Side)});
    return views;
}

Mask mask_of(raster::Rasterizer& rasterizer, const GaussianSet& set, const std::vector<std::uint8_t>& bits,
             const Camera& camera) {
    const std::vector<float> values(bits.begin(), bits.end());
    Image seen;
    rasterizer.forward_values(set.spans(), camera, {}, values, seen);
    return localize::threshold_map(seen, 0.5);
}

Image picture(raster::Rasterizer& rasterizer, const GaussianSet& set, const Camera& camera) {
    raster::ForwardOutput output;
    rasterizer.forward(set.spans(), camera, {}, output);
    for (auto& value : output.colour.data) value = std::clamp(value, 0.0f, 1.0f);
    return output.colour;
}

/// Draws the true scene, and knows where the new thing is in it; some outlines may be wrong.
struct TrueViews : edit::MultiViewEditor, edit::AttentionSource {
    TrueViews(const synth::SynthScene& scene, synth::Part what, raster::Rasterizer& r)
        : truth(scene), part(what), rasterizer(r) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl&) override {
        inputs.push_back(input);
        counts.push_back(views.size());
        cameras.clear();
        asked = 0;
        edit::EditedViews targets;
        for (const auto& view : views) {
            cameras.push_back(view.view.camera);
            targets.images.push_back(picture(rasterizer, shown().scene.gaussians, view.view.camera));
        }
        return targets;
    }
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        words.push_back(query.words.front());
        const Mask mask =
            mask_of(rasterizer, shown().scene.gaussians, rows_of(shown(), part), cameras.at(asked++));
        Image map(mask.width, mask.height, 1);
        std::copy(mask.data.begin(), mask.data.end(), map.data.begin());
        if (blind_views > 0 && asked <= static_cast<std::size_t>(blind_views))
            map = Image(mask.width, mask.height, 1);
        return {map};
    }
    int image_size() const override { return Side; }

    const synth::SynthScene& shown() const {
        return inputs.size() == 1 && at_first != nullptr ? *at_first : truth;
    }

    const synth::SynthScene& truth;
    const synth::SynthScene* at_first = nullptr;  // what the first round shows instead
    synth::Part part;
    raster::Rasterizer& rasterizer;
    std::vector<edit::EditViewsRequest> inputs;
    std::vector<std::size_t> counts;  // of views, per input
    std::vector<Camera> cameras;
    std::vector<std::string> words;
    std::size_t asked = 0;
    int blind_views = 0;
};

struct NoGuidance : edit::Guidance {
    edit::GuidanceOutput evaluate(const edit::GuidanceInput&) override {
        throw Error(ErrorCode::Model, "asked");
    }
};

/// How near the truth an edited scene is, from views between those of the edit.
struct Figures {
    double outline_iou = 0, error_removed = 0, psnr_outside_db = 0;
};

struct ShapeEdit {
    ShapeEdit(const synth::SynthScene& before, const synth::SynthScene& after, edit::EditMode edit_mode)
        : source(before), target(after), mode(edit_mode),
          part(edit_mode == edit::EditMode::Add ? synth::Part::Accessory : synth::Part::Object) {
        request.method = "views";
        request.shape_rounds = 2;  // what a later round does is seen, too
        plan.views = ring(source, 24, 0);
        edit::LocateResult located;
        plan.label = rows_of(source, synth::Part::Object);
        if (mode == edit::EditMode::Add) {
            std::fill(plan.label.begin(), plan.label.end(), std::uint8_t{0});
            const auto bits = rows_of(target, part);
            plan.seeds.sh_degree = source.scene.gaussians.sh_degree();
            const auto data = target.scene.gaussians.to_data();
            for (std::size_t row = 0; row < bits.size(); row += 8)
                if (bits[row] != 0) plan.seeds.append_row(data, row);
            std::fill(plan.seeds.opacity_logit.begin(), plan.seeds.opacity_logit.end(), -2.0f);
        }
        for (const auto& view : plan.views) {
            Mask mask = mask_of(*rasterizer, target.scene.gaussians, rows_of(target, part), view.camera);
            if (mode == edit::EditMode::Replace)
                mask = mask_of(*rasterizer, source.scene.gaussians, plan.label, view.camera);
            located.views.push_back({});
            located.views.back().mask = mask;
        }
        const std::vector<std::string> no_words;
        located.mode = mode;
        located.label.bits = std::make_shared<const std::vector<std::uint8_t>>(plan.label);
        located.seeds = plan.seeds;
        const auto cameras = plan.views;
        plan =
            edit::make_plan({source.scene.gaussians, cameras, no_words, request, {}}, located, *rasterizer);
    }

    edit::EditResult run() {
        edit::EditTools tools{*rasterizer, &never, {}, {}};
        tools.views = &views;
        tools.attention = &views;
        tools.word = "cat";
        tools_changed(tools);
        return edit::run_edit(source.scene.gaussians, plan, request, tools);
    }

    Figures figures(const edit::EditResult& result) {
        double both = 0, either = 0, before = 0, after = 0, squared = 0, outside = 0;
        auto thing = result.label;
        for (std::size_t row = 0; row < thing.size(); ++row) thing[row] &= result.hole_fill[row] == 0 ? 1 : 0;
        for (const auto& view : ring(source, 12, 0.5)) {
            const Mask wanted =
                mask_of(*rasterizer, target.scene.gaussians, rows_of(target, part), view.camera);
            const Mask shown = mask_of(*rasterizer, result.set, thing, view.camera);
            const Mask old = mask_of(*rasterizer, source.scene.gaussians,
                                     rows_of(source, synth::Part::Object), view.camera);
            Mask inside = wanted;
            for (std::size_t p = 0; p < inside.data.size(); ++p) {
                both += wanted.data[p] & shown.data[p];
                either += wanted.data[p] | shown.data[p];
                if (mode == edit::EditMode::Replace) inside.data[p] |= old.data[p];
            }
            inside = localize::dilate(inside, 3);
            const Image was = picture(*rasterizer, source.scene.gaussians, view.camera),
                        is = picture(*rasterizer, result.set, view.camera),
                        should = picture(*rasterizer, target.scene.gaussians, view.camera);
            const auto area = static_cast<double>(inside.count());
            before += area * evaluate::mean_absolute_error(was, should, {&inside, true});
            after += area * evaluate::mean_absolute_error(is, should, {&inside, true});
            for (std::size_t i = 0; i < is.data.size(); ++i)
                if (inside.data[i / 3] == 0) {
                    squared += std::pow(static_cast<double>(is.data[i]) - was.data[i], 2);
                    outside += 1;
                }
        }
        return {both / either, 1 - after / before, -10 * std::log10(std::max(1e-10, squared / outside))};
    }

    synth::SynthScene source, target;
    edit::EditMode mode;
    synth::Part part;
    ThreadPool threads{2};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(threads);
    edit::CheckedRequest request = test::asked("bear", "a blue cat", "cat");
    edit::EditPlan plan;
    TrueViews views{target, part, *rasterizer};
    NoGuidance never;
    std::function<void(edit::EditTools&)> tools_changed = [](edit::EditTools&) {};
};

void tell(const char* what, const Figures& figures) {
    DOCTEST_MESSAGE(fmt::format("{}: outline IoU {:.3f}, error removed {:.3f}, {:.1f} dB outside", what,
                                figures.outline_iou, figures.error_removed, figures.psnr_outside_db));
}

}  // namespace

DOCTEST_TEST_CASE("a thing becomes another: the outline, the colours, and nothing else") {
    for (const auto& [from, to] : std::vector<std::array<const char*, 2>>{
             {"bear", "cat"}, {"mushroom", "tree"}, {"cat", "house"}, {"statue", "chair"}}) {
        ShapeEdit run(scene_of(from, "red"), scene_of(to, "blue"), edit::EditMode::Replace);
        const auto result = run.run();
        const auto figures = run.figures(result);
        tell(to, figures);
        const std::string becomes = to;
        DOCTEST_CAPTURE(becomes);
        DOCTEST_CHECK(figures.outline_iou > 0.85);
        DOCTEST_CHECK(figures.error_removed > 0.7);
        DOCTEST_CHECK(figures.psnr_outside_db > 35);
        // All of the ground is there.
        DOCTEST_CHECK(std::count(result.hole_fill.begin(), result.hole_fill.end(), std::uint8_t{1}) == 0);
        DOCTEST_CHECK(result.changed_outside_label == 0);
        DOCTEST_CHECK(result.nonfinite == 0);
        DOCTEST_REQUIRE(run.views.inputs.size() == static_cast<std::size_t>(run.request.shape_rounds));
        DOCTEST_CHECK(run.views.inputs[0].anew);
        DOCTEST_CHECK(run.views.inputs[1].strength == run.request.shape_again_strength);
        DOCTEST_CHECK(run.views.words.front() == "cat");
    }
}

DOCTEST_TEST_CASE("the ground that went with the old thing is put back, flat and as it was around it") {
    ShapeEdit run(scene_of("bear", "red"), scene_of("mushroom", "blue"), edit::EditMode::Replace);
    const auto& scene = run.source.scene.gaussians;
    Vec3 middle;  // of the ground around the thing
    for (std::size_t row = 0; row < scene.size(); ++row)
        if (run.source.parts[row] == synth::Part::Ground &&
            std::hypot(scene.position()[row * 3], scene.position()[row * 3 + 2]) < 0.4f)
            run.plan.label[row] = 1, middle.y = scene.position()[row * 3 + 1];
    const auto result = run.run();
    const auto figures = run.figures(result);
    tell("mushroom, with the ground", figures);
    DOCTEST_CHECK(figures.outline_iou > 0.8);
    DOCTEST_CHECK(figures.error_removed > 0.7);
    std::size_t count = 0;
    for (std::size_t row = 0; row < result.hole_fill.size(); ++row) {
        if (result.hole_fill[row] == 0) continue;
        ++count;
        DOCTEST_CHECK(std::abs(result.set.position()[row * 3 + 1] - middle.y) < 0.05);
    }
    DOCTEST_CHECK(count > 100);
}

DOCTEST_TEST_CASE("what is added grows from the same hull, and hides nothing that is before it") {
    for (const char* thing : {"hat", "crown", "scarf", "sunglasses", "wings"}) {
        ShapeEdit run(scene_of("bear", "red"), scene_of("bear", "red", thing), edit::EditMode::Add);
        const auto result = run.run();
        const auto figures = run.figures(result);
        tell(thing, figures);
        DOCTEST_CAPTURE(thing);
        DOCTEST_CHECK(figures.error_removed > 0.5);
        DOCTEST_CHECK(result.changed_outside_label == 0);
    }
}

DOCTEST_TEST_CASE("what the first round took the thing for leaves nothing in the last") {
    ShapeEdit run(scene_of("statue", "red"), scene_of("chair", "blue"), edit::EditMode::Replace);
    const auto tree = scene_of("tree", "green");
    run.views.at_first = &tree;
    const auto figures = run.figures(run.run());
    tell("chair, at first a tree", figures);
    DOCTEST_CHECK(figures.outline_iou > 0.85);
    DOCTEST_CHECK(figures.error_removed > 0.7);
}

DOCTEST_TEST_CASE("views that do not show the new thing are left out; too few are said") {
    ShapeEdit run(scene_of("bear", "red"), scene_of("cat", "blue"), edit::EditMode::Replace);
    run.request.shape_fit_steps = 60;
    run.request.shape_views = 8;
    run.views.blind_views = 2;
    const auto result = run.run();
    std::vector<std::size_t> drawn;
    for (const auto& line : result.history)
        if (std::find(drawn.begin(), drawn.end(), line.view) == drawn.end()) drawn.push_back(line.view);
    DOCTEST_CHECK(drawn.size() == 6);
    DOCTEST_CHECK(run.figures(result).outline_iou > 0.7);
    run.views.blind_views = 6;
    DOCTEST_CHECK_THROWS_WITH_AS(run.run(), doctest::Contains("only 2 of 8 views"), Error);
}

DOCTEST_TEST_CASE("the same request gives the same bytes; a snapshot goes on from where it was") {
    ShapeEdit run(scene_of("bear", "red"), scene_of("cat", "blue"), edit::EditMode::Replace);
    run.request.shape_fit_steps = 20;
    const auto first = run.run(), second = run.run();
    DOCTEST_CHECK(std::equal(first.set.sh().begin(), first.set.sh().end(), second.set.sh().begin(),
                             second.set.sh().end()));
    DOCTEST_CHECK(std::equal(first.set.position().begin(), first.set.position().end(),
                             second.set.position().begin(), second.set.position().end()));
}

DOCTEST_TEST_CASE(
    "a colour that the sentence leaves open is the one that the first view shows, for all views and rounds") {
    ShapeEdit run(scene_of("bear", "red"), scene_of("cat", "orange"), edit::EditMode::Replace);
    run.request = run.request.reworded("a cat on the grass", run.request.target());
    run.request.shape_fit_steps = 10;
    edit::ViewTargets shown;
    run.tools_changed = [&](edit::EditTools& tools) {
        tools.targets = [&](const edit::ViewTargets& sheet) { shown = sheet; };
    };
    const auto result = run.run();
    DOCTEST_CHECK(result.redrawn_views ==
                  std::accumulate(run.views.counts.begin(), run.views.counts.end(), std::size_t{0}));
    const auto& inputs = run.views.inputs;
    DOCTEST_REQUIRE(inputs.size() == static_cast<std::size_t>(run.request.shape_rounds) + 1);
    DOCTEST_CHECK(inputs[0].sentence.empty());  // one view, as the artist says it
    DOCTEST_CHECK(run.views.counts[0] == 1);
    for (std::size_t i = 1; i < inputs.size(); ++i) {
        DOCTEST_CHECK(inputs[i].sentence == "an orange cat on the grass");
        DOCTEST_CHECK(run.views.counts[i] == static_cast<std::size_t>(run.request.shape_views));
    }
    DOCTEST_CHECK(shown.sentence == "an orange cat on the grass");
    run.views.inputs.clear();
    run.views.counts.clear();
    run.plan.drawn_colour = "blue";  // the search has drawn it: no view is drawn first
    run.run();
    DOCTEST_REQUIRE(run.views.inputs.size() == static_cast<std::size_t>(run.request.shape_rounds));
    for (const auto& input : run.views.inputs) DOCTEST_CHECK(input.sentence == "a blue cat on the grass");
    run.plan.drawn_colour.clear();
    run.views.inputs.clear();
    run.tools_changed = [](edit::EditTools& tools) {
        tools.known = {"a", "cat", "on", "the", "grass"};
    };  // no colours
    run.run();
    for (const auto& input : run.views.inputs) DOCTEST_CHECK(input.sentence.empty());
}

}  // namespace shape_edit_test
