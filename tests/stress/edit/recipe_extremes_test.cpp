// Both ends of the stated range of every field of a request: a refusal in one sentence, or a finite result.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <limits>
#include <stop_token>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/optimise/oracle_guidance.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/edit_method.h"
#include "tests/unit/edit/view_oracle.h"

namespace recipe_extremes_test {

namespace {

using namespace gse;

constexpr int Steps = 20;  // of every run

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

/// A field at one of its ends.
struct Extreme {
    std::string name;
    edit::EditRequest request;
};

edit::EditRequest usual_request(const std::string& method) {
    edit::EditRequest request;
    request.source = "ball";
    request.target = "blue";
    request.prompt = "a blue ball";
    request.method = method;
    request.iterations = Steps;
    request.densify_every = request.densify_from = 5;
    request.densify_percent = 0.1;
    return request;
}

/// Sets number `which` of the fields to its lower or upper end; false for texts.
template <class T> bool set_end(T& value, bool upper, const Range* range) {
    if constexpr (std::is_same_v<T, bool>) {
        value = upper;
    } else if constexpr (std::is_same_v<T, Overridable>) {
        value = upper ? range->high : range->low;
    } else if constexpr (std::is_arithmetic_v<T>) {
        if (range != nullptr) value = static_cast<T>(upper ? range->high : range->low);
        else value = upper ? std::numeric_limits<T>::max() : std::numeric_limits<T>::lowest();
    } else {
        return false;
    }
    return true;
}

/// Every field of Part, alone, at each of its ends.
template <class Part> std::vector<Extreme> extremes(const edit::EditRequest& usual) {
    std::vector<Extreme> all;
    std::size_t fields = 0;
    edit::EditRequest counted = usual;
    Part::visit_fields(static_cast<Part&>(counted),
                       [&](const char*, auto&, const char*, const auto&...) { ++fields; });
    for (std::size_t wanted = 0; wanted < fields; ++wanted)
        for (const bool upper : {false, true}) {
            Extreme extreme{{}, usual};
            std::size_t at = 0;
            bool changed = false;
            Part::visit_fields(static_cast<Part&>(extreme.request), [&](const char* name, auto& value,
                                                                        const char*, const auto&... range) {
                if (at++ != wanted) return;
                const Range* limits = nullptr;
                ((limits = &range), ...);
                changed = set_end(value, upper, limits);
                extreme.name = std::string(name) + (upper ? " at its upper end" : " at its lower end");
            });
            if (changed) all.push_back(std::move(extreme));
        }
    return all;
}

/// A third of the fields at one of their ends.
edit::EditRequest shaken(edit::EditRequest request, Random& random) {
    edit::LoopSettings::visit_fields(static_cast<edit::LoopSettings&>(request),
                                     [&](const char*, auto& value, const char*, const auto&... range) {
                                         const Range* limits = nullptr;
                                         ((limits = &range), ...);
                                         const auto choice = random.below(6);
                                         if (choice < 2) set_end(value, choice == 1, limits);
                                     });
    return request;
}

bool all_finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

/// Runs, for 20 steps at most, and says how it ended: "finite", "refused: ..." or what is wrong.
std::string outcome(test::Redrawing& ball, edit::Guidance& guidance, const edit::EditRequest& request,
                    edit::EditMode mode) {
    std::stop_source stop;
    auto plan = ball.plan;
    plan.mode = mode;
    edit::EditTools tools{*ball.rasterizer, &guidance, {}, {{}, stop.get_token()}};
    if (edit::method_of(request).draws_views()) tools.views = &ball.oracle;
    tools.iteration = [&](const edit::IterationRecord& record) {
        if (record.iteration + 1 >= Steps) stop.request_stop();
    };
    try {
        const auto valid = edit::check(request);
        const auto result = edit::run_edit(ball.scene.set, plan, valid, tools);
        const auto& set = result.set;
        for (const auto values :
             {set.position(), set.log_scale(), set.rotation(), set.opacity_logit(), set.sh()})
            if (!all_finite(values)) return "a value of the result is not finite";
        for (const auto& record : result.history)
            if (!std::isfinite(record.preservation) || !std::isfinite(record.anchor))
                return "a loss is not finite";
        if (result.changed_outside_label != 0 || result.nonfinite != 0)
            return "a row outside the label has changed";
        if (result.skipped_rows > 0) return "gradients are not finite";
        return "finite";
    } catch (const Error& error) {
        return error.message().size() > 10 ? std::string("refused: ") + error.what()
                                           : "refused without a sentence";
    }
}

void check_outcome(const std::string& name, const std::string& end, std::size_t& refused) {
    DOCTEST_INFO(name);
    DOCTEST_INFO(end);
    const bool sentence = end.rfind("refused: ", 0) == 0;
    refused += sentence ? 1 : 0;
    DOCTEST_CHECK((sentence || end == "finite"));
}

/// Attention to what is red.
class RedAttention final : public edit::AttentionSource {
public:
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        std::vector<Image> maps(query.words.size(), Image(query.image.width, query.image.height, 1));
        for (std::size_t i = 0; i < maps.front().data.size(); ++i)
            maps.front().data[i] = std::max(0.0f, query.image.data[i * 3] - query.image.data[i * 3 + 1]);
        return maps;
    }
    int image_size() const override { return 48; }
};

}  // namespace

DOCTEST_TEST_CASE("every field of the loop at each end of its range, for twenty steps of each method") {
    const Quiet quiet;
    test::Redrawing ball;
    edit::OracleGuidance guidance(ball.target, ball.plan.views, ball.plan.settings, *ball.rasterizer);
    std::size_t runs = 0, refused = 0;
    for (const char* method : {"sds", "views"})
        for (const auto& extreme : extremes<edit::LoopSettings>(usual_request(method)))
            for (const auto mode : {edit::EditMode::Modify, edit::EditMode::Replace}) {
                check_outcome(std::string(method) + ", " + edit::mode_name(mode) + ": " + extreme.name,
                              outcome(ball, guidance, extreme.request, mode), refused);
                ++runs;
            }
    DOCTEST_CHECK(runs > 250);
    DOCTEST_CHECK(refused < runs / 20);  // ranges that are stated can be used
}

DOCTEST_TEST_CASE("many fields of the loop at their ends at once") {
    const Quiet quiet;
    test::Redrawing ball;
    edit::OracleGuidance guidance(ball.target, ball.plan.views, ball.plan.settings, *ball.rasterizer);
    Random random(31);
    std::size_t refused = 0;
    for (int trial = 0; trial < 400; ++trial)
        check_outcome("trial " + std::to_string(trial),
                      outcome(ball, guidance, shaken(usual_request(trial % 2 == 0 ? "sds" : "views"), random),
                              edit::EditMode::Modify),
                      refused);
}

DOCTEST_TEST_CASE("every field of a search at each end of its range") {
    const Quiet quiet;
    const auto scene = test::ball_scene(120);
    ThreadPool pool(2);
    const auto rasterizer = raster::make_fast_rasterizer(pool);
    RedAttention attention;
    auto searches = extremes<edit::SearchSettings>(usual_request("views"));
    for (auto& more : extremes<edit::LabelThresholds>(usual_request("views")))
        searches.push_back(std::move(more));
    const std::vector<std::string> words;
    std::size_t found = 0;
    for (const auto& extreme : searches)
        for (const char* mode : {"modify", "add"}) {
            DOCTEST_INFO(extreme.name << ", " << mode);
            auto request = extreme.request;
            request.mode = mode;
            const bool many = request.views > 24, large = request.image_size > 96;
            const auto views = test::ball_views(many                ? 64
                                                : request.views < 3 ? request.views
                                                                    : 6,
                                                large                     ? 256
                                                : request.image_size < 32 ? 16
                                                                          : 48);
            try {
                const auto valid = edit::check(request);
                const auto located = edit::locate({scene.set, views, words, valid, {}, {0, -1, 0}},
                                                  {*rasterizer, attention, nullptr, nullptr, {}});
                DOCTEST_CHECK(all_finite(*located.label.weight));
                DOCTEST_CHECK(std::isfinite(located.confidence.value));
                DOCTEST_CHECK(all_finite(located.seeds.position));
                DOCTEST_CHECK(all_finite(located.seeds.log_scale));
                DOCTEST_CHECK((located.problem == edit::SearchProblem::None || located.message.size() > 10));
                found += located.problem == edit::SearchProblem::None ? 1 : 0;
            } catch (const Error& error) { DOCTEST_CHECK(error.message().size() > 10); }
        }
    DOCTEST_CHECK(found > searches.size());
}

}  // namespace recipe_extremes_test
