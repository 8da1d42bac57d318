// Farthest views and feathered masks.
#include "engine/edit/target_views/view_round.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/edit/interfaces/broken_values.h"
#include "engine/edit/request/scales.h"
#include "engine/edit/words/colour_word.h"
#include "engine/language/description.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

Mask eroded(Mask mask, double radius_px) {
    for (auto& bit : mask.data) bit = bit != 0 ? 0 : 1;
    mask = localize::dilate(mask, radius_px);
    for (auto& bit : mask.data) bit = bit != 0 ? 0 : 1;
    return mask;
}

constexpr double FeatherPx = 3;                // of a picture of ReferenceSide (METHOD.md, Redrawn views)
constexpr std::uint64_t ColourStream = 39000;  // of the request's seed
// Raise of redrawing that hardly changed anything (METHOD.md, Agreement of views)
constexpr double StrengthRaise = 0.1;

/// The pictures that the model draws, one per view; what is not finite in them is counted and stays as the
/// scene is.
EditedViews drawn_by(MultiViewEditor& guidance, const std::vector<EditView>& views,
                     const EditViewsRequest& input, const JobControl& job) {
    auto drawn = guidance.edit(views, input, job);
    if (const auto broken = mend_broken(views, drawn.images); broken > 0) {
        drawn.scalars["broken_values"] = static_cast<double>(broken);
        log::warning("{} values of the redrawn views were not finite; the scene stays as it was there",
                     broken);
    }
    return drawn;
}

/// Agreement of the views of which something of use came.
ViewAgreement agreement_of_usable(const std::vector<EditView>& views, const EditedViews& drawn) {
    if (drawn.rejected.empty()) return view_agreement(views, drawn.images);
    std::vector<EditView> usable;
    std::vector<Image> pictures;
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (drawn.rejected[v] != 0) continue;
        usable.push_back(views[v]);
        pictures.push_back(drawn.images[v]);
    }
    return view_agreement(usable, pictures);
}

}  // namespace

namespace {

/// Lets a thing that gets another shape leave the old one.
void free_geometry(LoopSettings& settings) {
    settings.geometry_share.override_if_unset(1);
    settings.colour_coupling.override_if_unset(0);
    for (const auto anchor : {&LoopSettings::anchor_position, &LoopSettings::anchor_rotation,
                              &LoopSettings::anchor_opacity, &LoopSettings::anchor_scale})
        (settings.*anchor).override_if_unset(0);
}

/// New rows grow several times in each round, from hulls whose colours are near: fast rates follow single
/// views.
void grow_often(LoopSettings& settings, int fit_steps) {
    constexpr int GrowthsPerRound = 6;
    settings.densify_percent.override_if_unset(0.1);
    settings.max_growth.override_if_unset(4);
    settings.max_aspect.override_if_unset(6);
    settings.rate_colour.override_if_unset(0.012);
    if (settings.densify_every > 0)
        settings.densify_every = settings.densify_from = std::max(1, fit_steps / GrowthsPerRound);
}

}  // namespace

EditSettings restyling(EditSettings settings, EditMode mode) {
    if (mode != EditMode::Modify) return settings;
    settings.view_strength.override_if_unset(1);
    settings.view_steps = settings.restyle_steps;
    return settings;
}

EditSettings loop_settings(EditSettings settings, EditMode mode, bool by_views,
                           bool supports_appearance_editing) {
    if (supports_appearance_editing) settings = restyling(std::move(settings), mode);
    const auto plan = round_plan(settings, mode);
    if (mode == EditMode::Replace || (by_views && plan.anew)) free_geometry(settings);
    if (!by_views) return settings;
    settings.iterations = plan.rounds * plan.fit_steps;
    settings.rounds = plan.rounds;
    settings.fit_steps = plan.fit_steps;
    settings.dynamic_mask = settings.prune_added = false;
    if (plan.anew) {
        grow_often(settings, plan.fit_steps);
    } else if (settings.densify_every > 0) {
        settings.densify_every = settings.densify_from = std::max(1, plan.fit_steps / 2);
    }
    settings.densify_until = 1 - 0.5 / plan.rounds;
    return settings;
}

Image blend_inside(const Image& edited, const Image& original, const Mask& mask, double feather_px) {
    GSE_CHECK_EQ(edited.data.size(), original.data.size());
    GSE_CHECK_EQ(mask.data.size(), original.pixel_count());
    Image result = original;
    const int rings = static_cast<int>(std::ceil(feather_px));
    Mask inside = mask;
    std::vector<float> share(mask.data.size(), 0.0f);
    for (int ring = 0; ring <= rings; ++ring) {  // one step of the ramp for every pixel from the rim
        for (std::size_t i = 0; i < share.size(); ++i)
            if (inside.data[i] != 0) share[i] += 1.0f / static_cast<float>(rings + 1);
        if (ring < rings) inside = eroded(inside, 1);
    }
    for (std::size_t i = 0; i < share.size(); ++i) {
        if (mask.data[i] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            result.data[i * 3 + c] =
                share[i] * edited.data[i * 3 + c] + (1 - share[i]) * original.data[i * 3 + c];
    }
    return result;
}

ViewRounds::ViewRounds(const EditPlan& plan, const CheckedRequest& request, MultiViewEditor& guidance,
                       ShapeFinder* shapes, std::vector<std::string> known)
    : plan_(plan), request_(request), guidance_(guidance), shapes_(shapes), known_(std::move(known)),
      targets_(plan.views.size()), edited_(plan.views.size()) {}

void ViewRounds::choose(const std::vector<std::size_t>& visible, const std::vector<Mask>& masks) {
    std::vector<View> views;
    std::vector<double> covered;
    for (const auto v : visible) {
        views.push_back(plan_.views[v]);
        covered.push_back(static_cast<double>(masks[v].count()) / static_cast<double>(masks[v].data.size()));
    }
    views_.clear();
    const auto redrawn =
        views_to_redraw(views, covered, static_cast<std::size_t>(round_plan(request_, plan_.mode).views));
    for (const auto index : redrawn) views_.push_back(visible[index]);
}

bool ViewRounds::begins(int iteration) const { return round_ < 0 || iteration / request_.fit_steps > round_; }

/// Orders for this round. `stream` is that of the request's seed.
EditViewsRequest ViewRounds::input(std::uint64_t stream) const {
    const auto plan = round_plan(request_, plan_.mode);
    EditViewsRequest asked{round_,
                           plan.rounds,
                           plan.steps_of(round_),
                           std::min(1.0, plan.strength_of(round_) + raised_),
                           Random::stream(request_.seed, stream).next(),
                           shapes_ != nullptr,
                           sentence_,
                           plan.guided_until};
    if (plan_.mode == EditMode::Add) asked.tells_changes = true, asked.noise = request_.add_noise;
    return asked;
}

/// Colour of the new object when the sentence leaves it open: the one that the search has drawn it in most.
/// Otherwise the view with most room for it is drawn first. All views are told the word for it.
void ViewRounds::name_colour(const std::vector<EditView>& views, const JobControl& job) {
    const auto& told = request_.sentence().prompt();
    if (shapes_ == nullptr || views.empty() || language::is_described(told, shapes_->word())) return;
    if (guidance_.agrees_on_colour()) return;
    const auto colour = plan_.drawn_colour.empty() ? colour_of_key_view(views, job) : plan_.drawn_colour;
    if (colour.empty()) return;
    sentence_ = language::described_as(told, shapes_->word(), colour);
    log::info(
        "the sentence names no colour for \"{}\"; most of what was drawn is {}: all views are drawn as "
        "\"{}\"",
        shapes_->word(), colour, sentence_);
}

std::string ViewRounds::colour_of_key_view(const std::vector<EditView>& views, const JobControl& job) {
    const auto key = std::max_element(views.begin(), views.end(), [](const auto& a, const auto& b) {
        return a.mask.count() < b.mask.count();
    });
    const auto drawn = drawn_by(guidance_, {*key}, input(ColourStream), job);
    ++extra_pictures_;
    return shapes_->colour_in(*key, drawn, Random::stream(request_.seed, ColourStream + 1).next(), known_);
}

/// The pictures of a round. Where most of them hardly differ from the scene, they are drawn once more,
/// further from it.
EditedViews ViewRounds::draw(const std::vector<EditView>& views, const JobControl& job) {
    const auto asked = input(40000 + static_cast<std::uint64_t>(round_));
    auto drawn = drawn_by(guidance_, views, asked, job);
    auto agreement = agreement_of_usable(views, drawn);
    if (drawn.unfinished) agreement.unchanged = 0;
    if (shapes_ == nullptr && raised_ == 0 && asked.strength < 1 && hardly_edited(agreement)) {
        raised_ = StrengthRaise;
        extra_pictures_ += views.size();
        log::info(
            "{:.0f} % of the redrawn views hardly differ from the scene: they are redrawn with strength "
            "{:.2f}",
            100 * agreement.unchanged, std::min(1.0, asked.strength + raised_));
        drawn = drawn_by(guidance_, views, input(40000 + static_cast<std::uint64_t>(round_)), job);
        agreement = agreement_of_usable(views, drawn);
    }
    judge(agreement, drawn);
    return drawn;
}

/// Says what is suspicious about the pictures as the model drew them.
void ViewRounds::judge(const ViewAgreement& agreement, EditedViews& drawn) {
    drawn.scalars.merge(agreement.scalars());
    warnings_ = warnings_of(agreement, shapes_ != nullptr);
    warnings_.insert(warnings_.end(), drawn.warnings.begin(), drawn.warnings.end());
    for (const auto& warning : warnings_) log::warning("{}", warning);
}

std::map<std::string, double> ViewRounds::redraw(int iteration, const std::vector<EditView>& views,
                                                 const std::vector<Image>& originals, const JobControl& job) {
    GSE_CHECK_EQ(views.size(), views_.size());
    round_ = iteration / request_.fit_steps;
    if (round_ == 0) name_colour(views, job);
    auto drawn = draw(views, job);
    rejected_ = drawn.rejected;
    missing_ = drawn.missing;
    if (shapes_ != nullptr) {
        found_ = shapes_->cut_out(views, drawn, round_, job);
        drawn.scalars.merge(found_.scalars);
    }
    for (std::size_t i = 0; i < views.size(); ++i)
        replace(views_[i], std::move(drawn.images[i]), originals[views_[i]], views[i].mask);
    return std::move(drawn.scalars);
}

void ViewRounds::redo(std::size_t view, const EditView& begun, int attempt, const Image& original,
                      const JobControl& job) {
    constexpr std::uint64_t first = 1u << 20, most_views = 1u << 20,
                            most_rounds = 64;  // streams that nothing else draws from
    const auto stream =
        first +
        (static_cast<std::uint64_t>(attempt) * most_rounds + static_cast<std::uint64_t>(round_)) *
            most_views +
        view;
    auto drawn = drawn_by(guidance_, {begun}, input(stream), job);
    if (!drawn.rejected.empty() && drawn.rejected.front() != 0)
        throw Error(ErrorCode::Model, "nothing of use was drawn");
    if (shapes_ != nullptr)
        shapes_->take_out(begun, drawn, 0, Random::stream(request_.seed, stream + 1).next());
    replace(view, std::move(drawn.images.front()), original, begun.mask);
}

void ViewRounds::replace(std::size_t view, Image edited, const Image& original, const Mask& mask) {
    edited_[view] = std::move(edited);
    blend(view, original, mask);
}

void ViewRounds::resume(const RoundState& start) {
    round_ = start.round;
    sentence_ = start.sentence;
    views_ = start.views;
    raised_ = start.raised;
}

void ViewRounds::blend(std::size_t view, const Image& original, const Mask& mask) {
    if (edited_[view].data.empty()) return;
    targets_[view] = blend_inside(edited_[view], original, mask, FeatherPx * original.width / ReferenceSide);
}

}  // namespace gse::edit
