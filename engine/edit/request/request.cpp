// Checks of a request before anything is loaded or computed.
#include "engine/edit/request/request.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/request/scales.h"
#include "engine/language/news.h"
#include "engine/language/sentence.h"
#include "engine/language/words.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

/// Lower-case words with one space between them; throws when there are none.
std::string phrase_of(const std::string& text, const char* what) {
    auto phrase = language::normalised_prompt(text);
    if (phrase.empty())
        throw Error(ErrorCode::InvalidArgument,
                    std::string("the ") + what + " \"" + text + "\" is not a word",
                    "give the word or the words that matter");
    return phrase;
}

}  // namespace

language::EditSentence edit_sentence(const EditRequest& request) {
    return {language::Sentence(request.prompt), request.source, request.target};
}

std::string instruction_of(const EditRequest& request) {
    return request.instruction.empty()
               ? language::instruction_for(language::Sentence(request.prompt), request.source)
               : request.instruction;
}

namespace {

/// Whether a version before numbers could be unset has written the request: all of those had this field.
bool of_earlier_version(const nlohmann::ordered_json& json) {
    return json.contains(LoopSettings::RetiredFields.front().name);
}

}  // namespace

void read_request(EditRequest& request, const nlohmann::ordered_json& json) {
    fields_from_json(request, json);
    if (!of_earlier_version(json)) return;
    EditRequest::visit_fields(request, [](const char*, auto& value, const char*, const auto&...) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Overridable>)
            if (value.is_standard()) value.unset();
    });
}

EditRequest validated(EditRequest request) {
    check_fields(request);
    if (language::words_of(request.prompt).empty())
        throw Error(ErrorCode::InvalidArgument, "the edit has no prompt",
                    "describe the scene after the edit in one sentence");
    if (request.mode != "auto" && !mode_named(request.mode))
        throw Error(ErrorCode::InvalidArgument, "\"" + request.mode + "\" is not an edit mode",
                    "use auto, modify, replace or add");
    if (std::find(Qualities.begin(), Qualities.end(), request.quality) == Qualities.end())
        throw Error(ErrorCode::InvalidArgument, "\"" + request.quality + "\" is not a quality",
                    "use draft, normal or fine");
    require_method(request.method);
    excluded_views_of(request.excluded_views);
    if (!request.source.empty()) request.source = phrase_of(request.source, "source");
    if (request.target.empty()) {
        if (request.source.empty())
            throw Error(ErrorCode::InvalidArgument, "neither a source nor a target word is given",
                        "name what the edit is about, or the word of the sentence that is new");
        request.target = language::guessed_target(language::Sentence(request.prompt), request.source);
    }
    request.target = phrase_of(request.target, "target");
    if (!language::has_phrase(request.prompt, request.target))
        throw Error(ErrorCode::InvalidArgument,
                    "the prompt \"" + request.prompt + "\" does not contain the target word \"" +
                        request.target + "\"",
                    "use it in the sentence, or choose another target");
    if (request.source.empty()) request.source = request.target;
    return request;
}

std::string new_thing(const EditRequest& request, EditMode mode) {
    const auto thing = mode == EditMode::Replace ? edit_sentence(request).replacement() : std::string();
    return thing.empty() ? request.target : thing;
}

int RoundPlan::steps_of(int round) const {
    return std::max(1, static_cast<int>(std::ceil(view_steps * strength_of(round) / strength - 1e-9)));
}

double RoundPlan::guided_steps_of(int round) const {
    constexpr double unguided = 0.5;  // of the two passes of a guided step
    const int steps = steps_of(round);
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        sum += strength_of(round) * (steps - i) / steps > guided_until ? 1 : unguided;
    return sum;
}

int RoundPlan::view_steps_within(int steps) const {
    int sum = 0;
    for (int round = 0; round * fit_steps < steps; ++round) sum += steps_of(round);
    return sum;
}

namespace {

/// Work of the views and of their steps.
struct QualityShare {
    double views = 1, steps = 1;
};

QualityShare share_of(const std::string& quality) {
    if (quality == Qualities.front()) return {0.5, 0.75};
    if (quality == Qualities.back()) return {2, 1.5};
    return {};
}

}  // namespace

RoundPlan round_plan(const LoopSettings& settings, EditMode mode) {
    RoundPlan plan{mode == EditMode::Add ? settings.add_rounds : settings.shape_rounds,
                   settings.shape_fit_steps,
                   true,
                   settings.shape_steps,
                   settings.shape_strength,
                   settings.shape_again_strength,
                   settings.shape_views,
                   settings.shape_guided_until};
    if (mode == EditMode::Modify)
        plan = {settings.rounds,      settings.fit_steps,     false,
                settings.view_steps,  settings.view_strength, settings.view_strength,
                settings.edited_views};
    const auto share = share_of(settings.quality);
    const auto scaled = [](int count, double by) {
        return std::max(1, static_cast<int>(std::lround(count * by)));
    };
    plan.views = scaled(plan.views, share.views);
    plan.view_steps = scaled(plan.view_steps, share.steps);
    return plan;
}

double mask_growth(const LoopSettings& settings, EditMode mode, const Mask& mask) {
    const double px = settings.dilate_px * mask.width / ReferenceSide;
    if (mode != EditMode::Add) return px;
    const auto box = localize::bounds_of(mask);
    return std::max(2 * px, settings.add_margin * std::max(box.width, box.height));
}

}  // namespace gse::edit
