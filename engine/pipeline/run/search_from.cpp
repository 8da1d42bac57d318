// Questions put to views, and what comes of them.
#include "engine/pipeline/run/search_from.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/placement/body_part.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/search/decide_label.h"
#include "engine/language/grammar.h"
#include "engine/language/vocabulary.h"
#include "engine/math/quantile.h"
#include "engine/pipeline/select/whole_thing.h"
#include "engine/remote/api/server_settings.h"

namespace gse::pipeline {
namespace {

constexpr int DifferenceViews = 8, DifferenceSide = 512;  // of a search by what a server changes; px at most

}  // namespace

edit::LocateInput question(const RunContext& context, const CheckedRecipe& recipe, const Views& views,
                           const std::vector<std::uint8_t>* label) {
    const auto& scene = context.scene();
    const auto elevations = views.azimuths.empty() ? std::vector<double>{} : elevations_above(views);
    return {context.drawn(),
            views.views,
            views.words,
            recipe.request,
            render_settings(scene, recipe.request),
            scene.info.up,
            views.front,
            label,
            context.model().known_words(),
            views.azimuths,
            elevations,
            {},
            context.traits()};
}

void look_for_ground(RunContext& context, const CheckedRecipe& recipe, const Views& views) {
    if (recipe.guidance.plain_ground) context.look_for_ground(views.views);
}

std::optional<edit::StudioBackground> ground_shown(RunContext& context, const CheckedRecipe& recipe,
                                                   const Views& views) {
    look_for_ground(context, recipe, views);
    return recipe.guidance.plain_ground ? context.ground(recipe.request.sentence().before()) : std::nullopt;
}

bool searches_by_differences(const CheckedRecipe& recipe, const std::vector<std::string>& known) {
    const auto search = remote::server_search_of(recipe.server.search);
    const auto& request = recipe.request;
    if (!recipe.server.used() || search == remote::ServerSearch::None) return false;
    if (request.whole_scene() || !request.part_of().empty() || request.is_rearranged() ||
        recipe.job.brings_label())
        return false;
    const bool asked = search != remote::ServerSearch::Auto;
    if (edit::decide_mode(request, std::nullopt).first == edit::EditMode::Add) {
        if (!asked) return false;
        throw Error(ErrorCode::InvalidArgument,
                    "an addition does not show where the thing is that it goes to",
                    "leave --server-search out, or label the thing (--at, --cut-out)");
    }
    return asked || !language::unknown_word(known, request.source()).empty();
}

int pictures_of_differences(const CheckedRecipe& recipe) {
    const bool paints = remote::server_search_of(recipe.server.search) == remote::ServerSearch::Paint;
    return std::min(recipe.request.views, DifferenceViews) * (paints ? 1 : 2);
}

Views difference_views(const RunContext& context, CheckedRecipe& recipe, const Views& views) {
    auto& request = recipe.request;
    request.views = std::min(request.views, DifferenceViews);
    request.image_size = std::min(context.server()->side(), DifferenceSide);
    request.retry_passes = 0;
    const bool paints = remote::server_search_of(recipe.server.search) == remote::ServerSearch::Paint;
    log::info("\"{}\" is looked for by what the server {}: it is asked for {} of each of {} views",
              request.source(), paints ? "paints" : "changes", paints ? "a picture" : "two pictures",
              request.views);
    return views.automatic ? views_on(views.orbit, recipe) : some_views(views, recipe);
}

void add_to(std::vector<std::uint8_t>& rows, const std::vector<std::uint8_t>& more) {
    if (rows.empty()) rows = more;
    else
        for (std::size_t row = 0; row < more.size(); ++row) rows[row] |= more[row];
}

edit::LocateResult search_from(RunContext& context, const Views& views, const CheckedRecipe& recipe,
                               const std::vector<std::uint8_t>* label, const JobControl& control,
                               const std::vector<std::uint8_t>* within,
                               const std::vector<std::uint8_t>* beside) {
    auto input = question(context, recipe, views, label);
    input.within = within;
    input.beside = beside;
    input.ground = label == nullptr ? ground_shown(context, recipe, views) : std::nullopt;
    auto tools = context.tools(views, input.ground, control);
    const auto drawing = context.place_drawing(recipe);
    tools.drawing = drawing.get();
    tools.plain_ground = recipe.guidance.plain_ground;
    return edit::locate(input, tools);
}

namespace {

bool is_known(const RunContext& context, const std::string& word) {
    return language::vocabulary_contains(context.model().known_words(), word);
}

}  // namespace

Located locate_part(RunContext& context, Located located, const JobControl& control) {
    const auto& request = located.recipe.request;
    const std::string part = request.source();
    auto& result = located.result;
    if (is_known(context, part)) {
        result = search_from(context, located.views, located.recipe, nullptr, control, &located.within);
        if (!located.found())
            result.message = fmt::format("\"{}\" was not found within \"{}\" ({})", part, request.part_of(),
                                         result.message);
        return located;
    }
    const auto rows = edit::labelled_part(part, context.drawn(), located.within, located.views.orbit.up);
    result = edit::part_of_finding(question(context, located.recipe, located.views, nullptr),
                                   context.painter().rasterizer(), std::move(result), rows, part);
    if (request.is_rearranged()) {  // the thing was looked for to change its look
        result.mode = *request.mode;
        result.reason = "as asked";
    }
    log::info("\"{}\" is told by the shape of \"{}\": {} splats", part, request.part_of(),
              std::count(rows.begin(), rows.end(), std::uint8_t{1}));
    return located;
}

Located completed_by_shape(RunContext& context, Located located) {
    auto& result = located.result;
    const auto tools = context.second_look();
    if (tools.recognition == nullptr || !tools.recognition->available() || !located.within.empty() ||
        language::names_ground(result.word) || result.found.rule.nature == ThingNature::Vessel ||
        edit::encoder_knows(finding_of(context, located), *tools.recognition))
        return located;
    const bool worn = language::has_usual_place(result.word);
    const auto before = result.label;
    const auto whole = whole_thing(context.drawn(), *before.bits, located.views.orbit, worn);
    if (whole.empty()) return located;
    auto& probability = result.found.field.probability;
    std::vector<float> sure;
    for (std::size_t row = 0; row < whole.size(); ++row)
        if ((*before.bits)[row] != 0) sure.push_back(probability[row]);
    const float usual = upper_median(sure);
    for (std::size_t row = 0; row < whole.size(); ++row)
        if (whole[row] != 0 && (*before.bits)[row] == 0 && (result.beside.empty() || result.beside[row] == 0))
            probability[row] = std::max(probability[row], usual);
    auto decided = edit::decide_label(before.name, context.drawn(), result.found,
                                      located.recipe.request.label_threshold, tools.threads);
    const auto labelled = [](const Label& label) {
        return std::count(label.bits->begin(), label.bits->end(), std::uint8_t{1});
    };
    log::info("{} splats were labelled as \"{}\", and with its shape {}", labelled(before), result.word,
              labelled(decided.label));
    result.label = std::move(decided.label);
    add_to(result.beside, decided.beside);
    if (!worn) return located;
    located.label_doubt =
        "the words found a part of it, and its shape the rest; look at the label, and correct it where it is "
        "wrong";
    log::warning("\"{}\": {}", result.word, located.label_doubt);
    return located;
}

Located located_everywhere(RunContext& context, const CheckedRecipe& recipe, const Views& views,
                           const JobControl& control) {
    Located located{views, recipe, std::vector<std::uint8_t>(context.drawn().size(), 1), {}, false, {}};
    located.result = search_from(context, views, recipe, &located.label, control);
    for (auto& view : located.result.views) {
        std::fill(view.mask.data.begin(), view.mask.data.end(), std::uint8_t{1});
        view.region = view.mask;
        view.failed = false;
        view.step = edit::ViewStep::Found;
    }
    return located;
}

}  // namespace gse::pipeline
