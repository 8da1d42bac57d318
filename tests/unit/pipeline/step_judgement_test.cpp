// Verdicts on edits that have run: right ones pass, and each way of failing has its reason.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "engine/pipeline/steps/step_judgement.h"

namespace step_judgement_test {

using namespace gse;
using namespace gse::pipeline;
using edit::EditMode;

namespace {

StepFigures right(EditMode mode) {
    StepFigures figures;
    figures.mode = mode;
    figures.thing = "bear";
    figures.news = mode == EditMode::Modify ? "blue" : mode == EditMode::Add ? "hat" : "cat";
    figures.pictures = figures.scene = 0.5;
    figures.changed = 0.9;
    figures.new_shown = mode == EditMode::Replace ? 0.8 : 0;
    figures.seen = 1;
    figures.added = mode == EditMode::Modify ? 0 : 300;
    return figures;
}

/// Reason for the figures of a right edit with one of them changed.
template <class Value>
std::string reason(EditMode mode, Value StepFigures::*member, std::type_identity_t<Value> value) {
    auto figures = right(mode);
    figures.*member = value;
    const auto judgement = judge_step(figures);
    DOCTEST_CHECK(judgement.remedy.empty() == judgement.passed());
    return judgement.reason;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

constexpr EditMode Modes[] = {EditMode::Modify, EditMode::Add, EditMode::Replace};

}  // namespace

DOCTEST_TEST_CASE("judgement of a step: an edit that did what it was to do passes") {
    for (const auto mode : Modes) {
        DOCTEST_CHECK(judge_step(right(mode)).passed());
        const auto json = judgement_to_json(judge_step(right(mode)));
        DOCTEST_CHECK(json["passed"] == true);
        DOCTEST_CHECK(!json.contains("reason"));
    }
}

DOCTEST_TEST_CASE("judgement of a step: each way of failing has its reason, and a remedy") {
    for (const auto mode : Modes) {
        DOCTEST_CHECK(contains(reason(mode, &StepFigures::changed_rows, 3), "3 splats outside"));
        DOCTEST_CHECK(contains(reason(mode, &StepFigures::changed, 0.04), "only 4 %"));
        DOCTEST_CHECK(contains(reason(mode, &StepFigures::spilled, 0.2), "20 % of what surrounds the bear"));
        DOCTEST_CHECK(contains(reason(mode, &StepFigures::likeness, 0.05), "like no known thing"));
    }
    DOCTEST_CHECK(contains(reason(EditMode::Add, &StepFigures::added, 0), "no hat was added"));
    DOCTEST_CHECK(contains(reason(EditMode::Add, &StepFigures::seen, 0.1), "from 10 % of the views"));
    auto smeared = right(EditMode::Add);
    smeared.on_thing = 0.9;
    DOCTEST_CHECK(judge_step(smeared).passed());  // worn
    smeared.beside = true;
    DOCTEST_CHECK(contains(judge_step(smeared).reason, "on the bear, not beside it"));
    DOCTEST_CHECK(contains(reason(EditMode::Replace, &StepFigures::old_left, 0.6), "60 % of the bear"));
    DOCTEST_CHECK(contains(reason(EditMode::Replace, &StepFigures::new_shown, 0.01), "hardly any cat"));
    DOCTEST_CHECK(contains(reason(EditMode::Remove, &StepFigures::gone, 0.95), "95 % of the scene is gone"));
    DOCTEST_CHECK(reason(EditMode::Remove, &StepFigures::gone, 0.7).empty());
}

DOCTEST_TEST_CASE("judgement of a step: figures of other kinds of change do not count") {
    DOCTEST_CHECK(reason(EditMode::Modify, &StepFigures::seen, 0).empty());
    DOCTEST_CHECK(reason(EditMode::Replace, &StepFigures::gone, 1).empty());
    DOCTEST_CHECK(reason(EditMode::Replace, &StepFigures::seen, 0).empty());
    DOCTEST_CHECK(reason(EditMode::Add, &StepFigures::old_left, 1).empty());
    DOCTEST_CHECK(reason(EditMode::Add, &StepFigures::new_shown, 0).empty());
}

DOCTEST_TEST_CASE("judgement of a step: where nothing is drawn, the place and the surroundings count") {
    const auto of = [](EditMode mode, double changed, double spilled) {
        StepFigures figures;
        figures.mode = mode;
        figures.thing = figures.news = "bear";
        figures.changed = changed;
        figures.spilled = spilled;
        return judge_step(figures).reason;
    };
    DOCTEST_CHECK(of(EditMode::Remove, 0.9, 0).empty());
    DOCTEST_CHECK(contains(of(EditMode::Remove, 0.01, 0), "the place of the bear looks as before"));
    DOCTEST_CHECK(of(EditMode::Transform, 0.01, 0).empty());  // a small move shows little
    for (const auto mode : {EditMode::Remove, EditMode::Transform})
        DOCTEST_CHECK(contains(of(mode, 0.9, 0.2), "20 % of what surrounds the bear"));
}

DOCTEST_TEST_CASE("judgement of a step: the better score counts, and none is no failure") {
    auto figures = right(EditMode::Modify);
    figures.pictures = figures.scene = 0.0;
    DOCTEST_CHECK(contains(judge_step(figures).reason, "does not show \"blue\""));
    for (auto* score : {&figures.pictures, &figures.scene}) {
        *score = 0.5;
        DOCTEST_CHECK(judge_step(figures).passed());
        *score = 0.0;
    }
    figures.pictures = figures.scene = std::nullopt;
    DOCTEST_CHECK(judge_step(figures).passed());
    figures.changed = 0.2;  // a dye near the colour that is there
    DOCTEST_CHECK(judge_step(figures).passed());
    figures.scene = 0.5;
    DOCTEST_CHECK(contains(judge_step(figures).reason, "only 20 %"));
}

DOCTEST_TEST_CASE("judgement of a step: the report says what failed and what to try") {
    auto figures = right(EditMode::Replace);
    figures.old_left = 0.5;
    figures.scene = std::nullopt;
    const auto json = judgement_to_json(judge_step(figures));
    DOCTEST_CHECK(json["passed"] == false);
    DOCTEST_CHECK(!json["reason"].get<std::string>().empty());
    DOCTEST_CHECK(!json["remedy"].get<std::string>().empty());
    DOCTEST_CHECK(json["old_left"] == 0.5);
    DOCTEST_CHECK(json["score_scene"].is_null());
}

}  // namespace step_judgement_test
