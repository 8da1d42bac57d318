// NaN, infinities and absurd sizes put at random into what an edit is handed: pulls, redrawn views, gradients
// of the rasterizer, attention, masks. They are counted and left out, and the run ends well.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/optimise/oracle_guidance.h"
#include "engine/scene/delta.h"
#include "tests/unit/edit/view_oracle.h"

namespace injected_values_test {

namespace {

using namespace gse;

// Share of the way to the target that an edit goes although a part of its steps is left out.
constexpr double LeastGain = 0.5;

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

float broken_value(Random& random) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr std::array<float, 3> values{std::numeric_limits<float>::quiet_NaN(), infinity, -infinity};
    return values[random.below(values.size())];
}

/// Breaks one to `most` values; returns how many times it did.
std::size_t break_some(std::vector<float>& values, std::size_t most, Random& random) {
    const std::size_t count = 1 + random.below(most);
    for (std::size_t i = 0; i < count; ++i) values[random.below(values.size())] = broken_value(random);
    return count;
}

/// A rasterizer some of whose gradients are broken.
class BreakingRasterizer final : public raster::Rasterizer {
public:
    BreakingRasterizer(raster::Rasterizer& whole, double share, std::uint64_t seed)
        : whole_(whole), share_(share), random_(seed) {}
    void forward(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings,
                 raster::ForwardOutput& output) override {
        whole_.forward(rows, camera, settings, output);
    }
    void backward(const Image& d_colour, const Image& d_alpha, std::size_t first_row,
                  raster::Gradients& output) override {
        whole_.backward(d_colour, d_alpha, first_row, output);
        if (random_.uniform() >= share_ || output.opacity_logit.empty()) return;
        const std::size_t rows = output.opacity_logit.size();
        const std::array<LineFloats*, 6> tensors{&output.position, &output.log_scale,
                                                 &output.rotation, &output.opacity_logit,
                                                 &output.sh,       &output.mean2d_norm};
        for (int i = 0; i < 5; ++i) {
            const std::size_t which = random_.below(tensors.size()), row = random_.below(rows);
            const std::size_t stride = tensors[which]->size() / rows;
            (*tensors[which])[row * stride + random_.below(stride)] =
                random_.below(4) == 0 ? 1e30f : broken_value(random_);
        }
        for (std::size_t row = 0; row < rows; ++row) {
            bool good = true;
            for (std::size_t which = 0; which + 1 < tensors.size();
                 ++which) {  // the last one is for densification only
                const std::size_t stride = tensors[which]->size() / rows;
                for (std::size_t k = row * stride; k < (row + 1) * stride; ++k)
                    good = good && std::abs((*tensors[which])[k]) <= 1e15f;
            }
            broken_rows += good ? 0 : 1;
        }
    }
    void contributions(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings,
                       const Image& mask, std::span<double> masked, std::span<double> total) override {
        whole_.contributions(rows, camera, settings, mask, masked, total);
    }
    void forward_values(const GaussianSpans& rows, const Camera& camera, const raster::Settings& settings,
                        std::span<const float> values, Image& output) override {
        whole_.forward_values(rows, camera, settings, values, output);
    }
    std::string name() const override { return whole_.name(); }

    std::size_t broken_rows = 0;  // summed over the calls

private:
    raster::Rasterizer& whole_;
    double share_;
    Random random_;
};

/// The oracle, some of whose pulls are broken.
class BreakingGuidance final : public edit::Guidance {
public:
    BreakingGuidance(edit::Guidance& whole, double share, std::uint64_t seed)
        : whole_(whole), share_(share), random_(seed) {}
    edit::GuidanceOutput evaluate(const edit::GuidanceInput& input) override {
        auto output = whole_.evaluate(input);
        if (random_.uniform() < share_) {
            break_some(output.gradient.data, 20, random_);
            output.scalars["loss"] = broken_value(random_);
            ++broken;
        }
        return output;
    }
    std::size_t broken = 0;

private:
    edit::Guidance& whole_;
    double share_;
    Random random_;
};

/// Attention to what is red or blue, some of whose values are broken.
class BreakingAttention final : public edit::AttentionSource {
public:
    explicit BreakingAttention(double share, std::uint64_t seed) : share_(share), random_(seed) {}
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        Image map(query.image.width, query.image.height, 1);
        for (std::size_t i = 0; i < map.data.size(); ++i) {
            const float* pixel = &query.image.data[i * 3];
            map.data[i] = std::max(0.0f, std::max(pixel[0], pixel[2]) - pixel[1]);
        }
        std::vector<Image> maps(query.words.size(), Image(map.width, map.height, 1));
        maps.front() = std::move(map);
        for (auto& values : maps)
            if (random_.uniform() < share_) {
                break_some(values.data, 10, random_);
                if (random_.below(2) == 0) values.data.front() = broken_value(random_);
                ++broken;
            }
        return maps;
    }
    int image_size() const override { return 48; }
    std::size_t broken = 0;

private:
    double share_;
    Random random_;
};

/// Masks of noise: any byte anywhere, nothing, everything.
class NoiseSegmenter final : public edit::Segmenter {
public:
    explicit NoiseSegmenter(std::uint64_t seed) : random_(seed) {}
    Mask segment(const Image& image, const std::vector<edit::PointPrompt>&,
                 const std::optional<edit::BoxPrompt>&, const Image&) override {
        ++asked;
        Mask mask(image.width, image.height, random_.below(3) == 0 ? 255 : 0);
        if (random_.below(3) != 0)
            for (auto& byte : mask.data)
                byte = static_cast<std::uint8_t>(random_.below(256) * random_.below(2));
        return mask;
    }
    std::string name() const override { return "noise"; }
    std::size_t asked = 0;

private:
    Random random_;
};

/// Redrawn views, some of which are broken.
class BreakingViews final : public edit::MultiViewEditor {
public:
    BreakingViews(edit::MultiViewEditor& whole, double share, std::uint64_t seed)
        : whole_(whole), share_(share), random_(seed) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override {
        auto targets = whole_.edit(views, input, job);
        for (auto& image : targets.images) {
            if (all) std::fill(image.data.begin(), image.data.end(), broken_value(random_));
            else if (random_.uniform() < share_) break_some(image.data, 30, random_);
            for (const float value : image.data) broken += std::isfinite(value) ? 0 : 1;
        }
        return targets;
    }
    bool all = false;
    std::size_t broken = 0;  // values

private:
    edit::MultiViewEditor& whole_;
    double share_;
    Random random_;
};

/// Tells whether every row outside the label is in the result, bit for bit.
bool outside_is_kept(const GaussianSet& base, const std::vector<std::uint8_t>& label,
                     const edit::EditResult& result) {
    for (std::size_t row = 0; row < base.size(); ++row) {
        if (label[row] != 0) continue;
        const auto now = result.base_to_new[row];
        if (now < 0 || !same_row(base.spans(), row, result.set.spans(), static_cast<std::size_t>(now)))
            return false;
    }
    return true;
}

void check_whole(const GaussianSet& base, const std::vector<std::uint8_t>& label,
                 const edit::EditResult& result) {
    DOCTEST_CHECK(outside_is_kept(base, label, result));
    DOCTEST_CHECK(result.nonfinite == 0);
    DOCTEST_CHECK(result.unusable == 0);
    for (const auto& record : result.history) {
        DOCTEST_CHECK(std::isfinite(record.preservation));
        DOCTEST_CHECK(std::isfinite(record.anchor));
        DOCTEST_CHECK(std::isfinite(record.guidance_norm));
        for (const auto& [name, value] : record.guidance) DOCTEST_CHECK(std::isfinite(value));
    }
}

}  // namespace

DOCTEST_TEST_CASE(
    "broken pulls, gradients and attention are counted and left out, and the edit arrives all the same") {
    const Quiet quiet;
    test::Redrawing ball;
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        DOCTEST_CAPTURE(seed);
        BreakingRasterizer rasterizer(*ball.rasterizer, 0.3, seed);
        edit::OracleGuidance oracle(ball.target, ball.plan.views, ball.plan.settings, *ball.rasterizer);
        BreakingGuidance guidance(oracle, 0.25, seed + 10);
        BreakingAttention attention(0.5, seed + 20);
        NoiseSegmenter segmenter(seed + 30);
        auto request = test::asked("ball", "a blue ball", "ball");
        request.method = "sds";
        request.iterations = 150;
        request.seed = seed;
        request.densify_every = request.densify_from = 20;
        request.densify_percent = 0.1;
        edit::EditTools tools{rasterizer, &guidance, {}, {}};
        tools.attention = &attention;
        tools.segmenter = &segmenter;
        tools.word = "ball";
        const auto result = edit::run_edit(ball.scene.set, ball.plan, request, tools);
        check_whole(ball.scene.set, ball.scene.first, result);
        DOCTEST_CHECK_FALSE(result.failure.has_value());
        DOCTEST_CHECK(result.iterations == request.iterations);
        DOCTEST_CHECK(guidance.broken > 20);
        DOCTEST_CHECK(result.skipped_steps == guidance.broken);
        DOCTEST_CHECK(rasterizer.broken_rows > 50);
        DOCTEST_CHECK(result.skipped_rows == rasterizer.broken_rows);
        DOCTEST_CHECK(attention.broken > 2);
        DOCTEST_CHECK(segmenter.asked > 5);
        DOCTEST_CHECK(ball.error_of(result.set) < (1 - LeastGain) * ball.error_of(ball.scene.set));
    }
}

DOCTEST_TEST_CASE(
    "broken pixels of redrawn views are counted and left as they were; views that are broken throughout are "
    "an error") {
    const Quiet quiet;
    test::Redrawing ball;
    const auto request = test::view_request(2, 40);
    const double untouched = ball.error_of(ball.scene.set);
    for (const std::uint64_t seed : {1, 2, 3}) {
        DOCTEST_CAPTURE(seed);
        BreakingViews views(ball.oracle, 0.6, seed);
        ball.tools.views = &views;
        const auto result = ball.edited(request);
        check_whole(ball.scene.set, ball.scene.first, result);
        DOCTEST_CHECK(result.skipped_rows == 0);
        DOCTEST_CHECK(views.broken > 0);
        double counted = 0;
        for (const auto& record : result.history)
            if (const auto found = record.guidance.find("broken_values"); found != record.guidance.end())
                counted += found->second;
        DOCTEST_CHECK(counted == static_cast<double>(views.broken));
        DOCTEST_CHECK(ball.error_of(result.set) < (1 - LeastGain) * untouched);
    }
    BreakingViews views(ball.oracle, 0, 9);
    views.all = true;
    ball.tools.views = &views;
    std::string message;
    try {
        ball.edited(request);
    } catch (const Error& error) { message = error.what(); }
    DOCTEST_CHECK(message.find("not finite") != std::string::npos);
}

DOCTEST_TEST_CASE("a search whose attention is broken in places finds what it finds with whole attention") {
    const Quiet quiet;
    const auto scene = test::ball_scene(200);
    const auto views = test::ball_views(12, 48);
    ThreadPool pool(1);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    const auto request = test::asked("ball", "a blue ball", "blue");
    const std::vector<std::string> words;
    const edit::LocateInput input{scene.set, views, words, request, {}, {0, -1, 0}};
    BreakingAttention whole(0, 1);
    const auto expected = edit::locate(input, {*rasterizer, whole, nullptr, nullptr, {}});
    DOCTEST_REQUIRE(expected.problem == edit::SearchProblem::None);
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        DOCTEST_CAPTURE(seed);
        BreakingAttention attention(1, seed);
        const auto found = edit::locate(input, {*rasterizer, attention, nullptr, nullptr, {}});
        DOCTEST_CHECK(attention.broken >= views.size());
        DOCTEST_CHECK(found.problem == edit::SearchProblem::None);
        DOCTEST_CHECK(found.failed_views == 0);
        DOCTEST_CHECK(found.broken_attention > 0);
        std::size_t others = 0;
        for (std::size_t row = 0; row < scene.set.size(); ++row)
            others += (*found.label.bits)[row] != (*expected.label.bits)[row] ? 1 : 0;
        // Rows of 400 rows: a broken pixel at the rim moves a view's mask by as much.
        constexpr std::size_t few = 8;
        DOCTEST_CHECK(others <= few);
    }
}

}  // namespace injected_values_test
