// Reads the scene, looks, moves in, looks again.
#include "engine/pipeline/run/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/content_hash.h"
#include "engine/base/log.h"
#include "engine/edit/masks/view_vote.h"
#include "engine/edit/placement/head.h"
#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/placement/upright_bounds.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/search/front_reading.h"
#include "engine/edit/search/place_drawing.h"
#include "engine/edit/search/scene_reading.h"
#include "engine/edit/search/second_look.h"
#include "engine/edit/words/dye_words.h"
#include "engine/language/grammar.h"
#include "engine/language/news.h"
#include "engine/language/vocabulary.h"
#include "engine/localize/focus.h"
#include "engine/pipeline/run/search_from.h"
#include "engine/pipeline/select/cut_out.h"
#include "engine/pipeline/select/point_out.h"

namespace gse::pipeline {
namespace {

constexpr std::array<double, 5> ScanDistances{1.0, 0.7, 0.45, 0.3, 0.22};  // of the fitted orbit's radius
constexpr int ScanViews = 6;                                               // per distance
constexpr double StepBack = 1.2;  // of the distance, where what was drawn does not fit into the pictures
constexpr double CutShares[] = {
    0.6, 1};  // of the views, from which that is so, a step each: a wing may reach out of some views; every
              // step draws the thing once more, and the second is worth it only where no view shows all of it
constexpr double WholeShare = 0.5;    // of the views that may cut off what is seen whole
constexpr double SameFraming = 0.05;  // of the distance: a nearer framing shows the same
// SameFraming for a worn addition: every look costs as much as an edit does.
constexpr double SameFramingWorn = 0.12;
constexpr double WearerSize = 3;   // of what it wears: a hat is a third of a figure
constexpr double SameThing = 0.2;  // IoU of what a glance found and of what is found from nearer; share of a
                                   // label among what was found
// Multiple of the distance of a sure glance. Anything that would be framed from farther off is no object.
constexpr double MostBack = 1.25;
constexpr std::array<double, 2> StepsOff{1.5, 2.25};  // of the distance, where pictures cut a finding off
constexpr std::size_t FrontViews = 12;                // in which the front of a scene is looked for

/// Room for an addition around the source; beside it more than on it.
double room_around(language::Relation relation) {
    constexpr double BesideIt = 1.75;
    return language::place_name(relation).empty() ? 1 : BesideIt;  // what is worn fits into the head room
}

const Label& thing_of(const edit::LocateResult& result) {
    return result.mode == edit::EditMode::Add ? result.source_label : result.label;
}

/// How many rows both have.
double common(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    return static_cast<double>(
        std::inner_product(a.begin(), a.end(), b.begin(), std::size_t{0}, std::plus{},
                           [](auto first, auto second) { return std::size_t{first != 0 && second != 0}; }));
}

/// Tells whether two searches for one word found the same splats, roughly.
bool same_thing(const edit::LocateResult& a, const edit::LocateResult& b) {
    const auto &first = *thing_of(a).bits, &second = *thing_of(b).bits;
    const double both = common(first, second);
    return both >= SameThing * (common(first, first) + common(second, second) - both);
}

/// Tells whether a fair share of what is labelled by hand is among what was found.
bool holds_some(const Label& found, const std::vector<std::uint8_t>& by_hand) {
    return common(*found.bits, by_hand) >= SameThing * common(by_hand, by_hand);
}

/// Orbit from which an object is seen as large, and as high in the picture, as figures are in the model's
/// training pictures. There a figure's height tells the place of its foot in the picture.
OrbitParameters framed_figure(const edit::UprightBounds& standing, const OrbitParameters& orbit,
                              const edit::ModelTraits& traits) {
    const double height = edit::figure_height(standing);
    OrbitParameters framed = orbit;
    framed.centre = standing.foot + normalized(orbit.up) * (traits.figure_aim * height);
    framed.radius = traits.half_picture * height / std::tan(orbit.fov_x / 2);
    return framed;
}

bool worth_moving(const OrbitParameters& from, const OrbitParameters& to, edit::EditMode mode,
                  bool as_figure) {
    if (!as_figure) return localize::worth_refocusing(from, to);
    const double most = (mode == edit::EditMode::Add ? SameFramingWorn : SameFraming) * from.radius;
    return std::abs(to.radius - from.radius) > most || length(to.centre - from.centre) > most;
}

std::string key_of(const Located& located) {
    ContentHash hash;
    hash.text(search_key(located.recipe));
    hash.fields(static_cast<const edit::LabelThresholds&>(located.recipe.request));
    hash.text(located.views.key);
    hash.numbers(located.label.size());
    hash.bytes(located.label.data(), located.label.size());
    hash.bytes(located.result.label.bits->data(), located.result.label.bits->size());
    return hash.key().hex();
}

/// Tells whether the views are those of what the words found, and not of a new thing's place.
bool shows_finding(const Located& located) {
    return !located.by_label() && located.found() && located.result.mode != edit::EditMode::Add &&
           !edit::replaces_accessory(located.recipe.request.sentence(), located.result.mode);
}

/// Note that an uncertain finding is seen in its views only.
Located finished(RunContext& context, Located located) {
    if (shows_finding(located)) located = completed_by_shape(context, std::move(located));
    auto& result = located.result;
    if (shows_finding(located))
        edit::take_second_look(result, edit::second_look(finding_of(context, located), context.second_look()),
                               located.recipe.request.least_confidence);
    if (located.found())
        edit::require_head(result, finding_of(context, located), located.recipe.request,
                           context.second_look());
    if (!located.found())
        for (auto* label : {&result.label, &result.source_label})
            *label = make_label(label->name, std::vector<float>(label->bits->size(), 0.0f), 0.5f);
    located.key = key_of(located);
    return located;
}

/// One search; every step of it gives a new value.
class Search {
public:
    Search(RunContext& context, CheckedRecipe recipe, const Views& views, const Hints& hints,
           const JobControl& control)
        : context_(context), recipe_(std::move(recipe)), views_(views), hints_(hints), control_(control) {}

    Located run() {
        if (recipe_.request.whole_scene()) return located_everywhere(context_, recipe_, views_, control_);
        if (!recipe_.request.part_of().empty() && hints_.label.empty()) return part();
        Located located = shown_whole(searched());
        located.result.room = room_on_wearer(located);
        return located;
    }

private:
    /// Looks for the thing, and for the part within it.
    Located part() {
        CheckedRecipe whole = recipe_;
        whole.request = recipe_.request.search_for_whole();
        const Hints hints{{}, hints_.said};
        Located located =
            finished(context_, Search(context_, std::move(whole), views_, hints, control_).run());
        located.recipe = recipe_;
        if (!located.found()) return located;
        located.within = *located.result.label.bits;
        return locate_part(context_, std::move(located), control_);
    }

    Located searched() {
        if (!hints_.found.empty()) return from_found();
        if (hints_.by_differences && hints_.label.empty()) return from_differences();
        const bool by_label =
            !hints_.label.empty() &&
            (recipe_.job.brings_label() || hints_.label_alone ||
             !language::vocabulary_contains(context_.model().known_words(), recipe_.request.source()));
        if (hints_.label.empty()) look_for_ground(context_, recipe_, views_);
        read_scene(moves() && !by_label);
        if (by_label) return from_label();
        Located located = moves() ? from_all_distances() : moved_in(views_, {});
        if (hints_.label.empty() || (located.found() && holds_some(thing_of(located.result), hints_.label)))
            return located;
        log::info("{}; the label alone says what may change",
                  located.found() ? "what the words find is not what is labelled" : located.result.message);
        return from_label();
    }

    double cut_of(const Located& located) {
        return edit::look_along_border(finding_of(context_, located), context_.second_look().threads).cut;
    }

    /// Looks from farther off where the edges of the pictures cut off what was found.
    Located shown_whole(Located located) {
        if (!moves() || !shows_finding(located)) return located;
        CheckedRecipe scan = recipe_;
        scan.request.views = std::min(scan.request.views, ScanViews);
        for (const double step : StepsOff) {
            const double cut = cut_of(located), sure = located.result.confidence.value;
            if (cut <= edit::MostCut) break;
            log::info("\"{}\" goes on beyond the pictures; it is looked for from farther off",
                      located.result.word);
            const Views off = views_on(nearer(located.views.orbit, step), scan);
            const auto glance = look(scan, off, {});
            if (glance.problem != edit::SearchProblem::None || !same_thing(glance, located.result)) continue;
            Located whole = seen_from(
                faced(views_on(focused_on(thing_of(glance), glance.mode, off.orbit, off.front), recipe_)));
            if (shows_finding(whole) && 2 * whole.result.confidence.value >= sure && cut_of(whole) < cut)
                located = std::move(whole);
        }
        return located;
    }

    bool moves() const { return views_.automatic && recipe_.request.reframe_views; }

    std::optional<edit::StudioBackground> ground() {
        return hints_.label.empty() ? ground_shown(context_, recipe_, views_) : std::nullopt;
    }

    Located from_differences() {
        read_scene(false);
        Located located = moved_in(difference_views(context_, recipe_, views_), {});
        located.by_differences = true;
        return located;
    }

    Located from_label() { return moved_in(views_, hints_.label); }

    /// Looks at the place of what comes alone, from as near as that needs: the source is known.
    Located from_found() {
        if (!moves()) return moved_in(views_, hints_.found);
        const auto mode = edit::decide_mode(recipe_.request, std::nullopt).first;
        const Label known = make_label(recipe_.request.source(),
                                       std::vector<float>(hints_.found.begin(), hints_.found.end()), 0.5f);
        return moved_in(views_on(focused_on(known, mode, views_.orbit, views_.front), recipe_), hints_.found);
    }

    /// Asks the model's encoders, where it has them, which word is new and which distances are worth a
    /// search.
    void read_scene(bool scans) {
        distances_ = scans ? std::vector<double>(ScanDistances.begin(), ScanDistances.end())
                           : std::vector<double>{1.0};
        auto& recognition = context_.recognition();
        auto& request = recipe_.request;
        const bool open = request.target_open();
        if (!recognition.compares() || !(scans || open)) return;
        const int side = request.image_size;
        std::vector<std::vector<Image>> pictures;
        for (const double distance : distances_) {
            const auto some = scans ? orbit_views(nearer(views_.orbit, distance), ScanViews, side, side)
                                    : farthest_views(views_.views, std::size_t{ScanViews});
            pictures.push_back(
                context_.pictures(some, render_settings(context_.scene(), request), ground(), control_));
            control_.report("comparing the sentence with the scene", static_cast<int>(pictures.size()),
                            static_cast<int>(distances_.size()));
        }
        const auto& sentence = request.sentence();
        std::vector<std::string> targets{request.target()};
        if (open) targets = language::possible_targets(sentence.sentence(), request.source(), hints_.said);
        if (open && !sentence.replacement().empty()) targets = {sentence.replacement()};
        // The encoder is not told words that are only drawn: they are new where the scene shows all else. A
        // word that only a server is told is new where there is one.
        const auto known = context_.model().known_words(),
                   said = language::promptable_vocabulary(
                       known, edit::with_dyes(context_.model().generated_vocabulary(), known));
        const auto unheard = [&](const auto& word) { return !language::vocabulary_contains(said, word); };
        const bool news =
            context_.server() != nullptr && std::any_of(targets.begin(), targets.end(), unheard);
        std::erase_if(targets, [&](const auto& word) { return unheard(word) != news; });
        const auto reading = edit::read_scene(recognition, request, targets, pictures, known);
        if (open)
            log::info("new in the sentence: \"{}\" (what it says without fits the scene to {:.2f})",
                      reading.target, reading.fit);
        request = request.with_target(reading.target);
        target_read_ = open;
        std::vector<double> worth;
        if (scans && ground() && reading.distances.front() != 0)
            worth.push_back(ScanDistances.front());  // a scene of one thing shows it whole from there
        for (const auto index : reading.distances) worth.push_back(distances_[index]);
        distances_ = std::move(worth);
    }

    /// From where the artist looked at the thing, radians; nothing where that is not known.
    std::optional<double> looked_from() const {
        const auto& job = recipe_.job;
        if (!job.looked_from.empty() || (job.cut_out.empty() && job.at.empty()))
            return parse_front(job.looked_from, "--looked-from");
        return (job.cut_out.empty() ? azimuth_of_click(job.at) : azimuth_of_box(job.cut_out)) * Degree;
    }

    /// The views with their front, if the recipe leaves it open. Their pictures tell it if the model's
    /// encoder can, else the side that the artist looked at.
    Views faced(Views views) {
        if (!recipe_.job.front.empty() || !views.words.empty() ||
            !language::vocabulary_contains(context_.model().known_words(), "front side back view"))
            return views;
        const auto looked = looked_from();
        const auto front = edit::chosen_front(front_shown(views), looked);
        if (front && front == looked)
            log::info("the side that was looked at ({:.0f} degrees) is taken for the front", *front / Degree);
        return front ? facing(std::move(views), *front, recipe_) : views;
    }

    std::optional<edit::FrontReading> front_shown(const Views& views) {
        auto& recognition = context_.recognition();
        if (!recognition.compares()) return std::nullopt;
        const auto some = farthest_views(views.views, FrontViews);
        if (some.size() < 3) return std::nullopt;
        std::vector<double> azimuths;
        for (const auto& view : some) azimuths.push_back(azimuth_of(view.camera, views.orbit));
        const auto pictures =
            context_.pictures(some, render_settings(context_.scene(), recipe_.request), ground(), control_);
        const auto read =
            edit::read_front(recognition, recipe_.request.sentence().before(), pictures, azimuths);
        log::info("the front is seen at {:.0f} degrees (lead {:.4f})", read.azimuth / Degree, read.lead);
        return read;
    }

    edit::LocateResult look(const CheckedRecipe& recipe, const Views& views,
                            const std::vector<std::uint8_t>& label) {
        auto found = search_from(context_, views, recipe, label.empty() ? nullptr : &label, control_, nullptr,
                                 &beside_);
        add_to(beside_, found.beside);
        found.beside = beside_;
        return found;
    }

    /// Search in few views from one distance.
    struct Glance {
        OrbitParameters orbit;
        edit::LocateResult result;
        bool sure() const { return result.problem == edit::SearchProblem::None; }
    };

    /// The fitted orbit shows the whole scene; what the words mean may be a small part of it. The distance
    /// from which it is found most surely wins; a few views tell, and what something is added to is enough.
    Glance best_glance(const std::vector<double>& distances) {
        CheckedRecipe scan = recipe_;
        scan.request.views = std::min(scan.request.views, ScanViews);
        scan.request.mode = edit::EditMode::Modify;
        Glance best{views_.orbit, {}};
        best.result.problem = edit::SearchProblem::FewViews;
        double most = -1;
        for (const double distance : distances) {
            const Views views = views_on(nearer(views_.orbit, distance), scan);
            auto found = look(scan, views, {});
            if (found.problem != edit::SearchProblem::None && found.problem != edit::SearchProblem::Unsure)
                continue;  // try nearer
            log::debug("orbit at {:.2f} of the fitted distance: confidence {:.3f}", distance,
                       found.confidence.value);
            const bool whole = ground() && found.problem == edit::SearchProblem::None &&
                               !edit::is_cut_off(found, WholeShare);
            const double sure =
                found.confidence.value +
                (whole ? 1 : 0);  // of what stands in nothing a part looks much like the whole
            if (sure > most) {
                most = sure;
                best = {views.orbit, std::move(found)};
            }
        }
        return best;
    }

    /// Rows to frame for a search: the object that is drawn anew, or its wearer. The box of a neighbour, or
    /// of a ground, is framed as it is.
    bool framed_as_figure(edit::EditMode mode) const {
        return mode == edit::EditMode::Replace ||
               (edit::draws_place(recipe_.request, mode) && context_.model().supports_scene_conditioning());
    }

    /// Place of the wearer of a label, or of its head.
    edit::UprightBounds standing_of_wearer(const Label& label, const OrbitParameters& orbit,
                                           const Vec3& front) {
        if (!wearer_) wearer_ = wearer_of(label, orbit);
        auto bits = *wearer_;
        for (std::size_t row = 0; row < bits.size(); ++row) bits[row] &= (*label.bits)[row] == 0 ? 1 : 0;
        if (std::find(bits.begin(), bits.end(), std::uint8_t{1}) == bits.end()) return {};
        return edit::wearer_of(recipe_.request, context_.drawn(), bits, orbit.up, front, true,
                               context_.traits())
            .standing;
    }

    /// All of a scene that was cut out of its surroundings; else what a few views around what is worn find
    /// for the first other thing of the sentence. Empty where nothing is found.
    std::vector<std::uint8_t> wearer_of(const Label& worn, const OrbitParameters& orbit) {
        const std::size_t rows = context_.drawn().size();
        if (ground_shown(context_, recipe_, views_)) return std::vector<std::uint8_t>(rows, 1);
        CheckedRecipe scan = recipe_;
        const auto& request = recipe_.request;
        const auto& said = request.sentence();
        const auto things = said.sentence().things({said.source(), said.target()});
        const auto wearer = std::find_if(things.begin(), things.end(), [&](const auto& thing) {
            return thing != said.source() && thing != said.target() &&
                   language::vocabulary_contains(context_.model().known_words(), thing);
        });
        if (wearer == things.end()) return {};
        scan.request = request.search_for(*wearer);
        scan.request.views = std::min(request.views, ScanViews);
        auto around = localize::focus_orbit(context_.drawn(), *worn.bits, orbit, {});
        around.radius *= WearerSize;
        const auto found = look(scan, views_on(around, scan), {});
        log::debug("\"{}\", who wears \"{}\": confidence {:.2f}", *wearer, said.source(),
                   found.confidence.value);
        return found.problem == edit::SearchProblem::None ? *found.label.bits : std::vector<std::uint8_t>{};
    }

    /// Place of an object that is worn elsewhere than the one it replaces.
    edit::VoxelRegion room_on_wearer(const Located& located) {
        const auto& result = located.result;
        if (!located.found() || !edit::moves_worn_place(recipe_.request.sentence(), result.mode)) return {};
        const auto standing = standing_of_wearer(result.label, located.views.orbit, located.views.front);
        return edit::room_above(standing, located.views.orbit.up, located.views.front,
                                recipe_.request.add_room);
    }

    /// The orbit that frames a label, with room where something is put beside it; `front`: of the scene.
    OrbitParameters focused_on(const Label& label, edit::EditMode mode, const OrbitParameters& orbit,
                               const Vec3& front) {
        if (framed_as_figure(mode)) {
            const auto standing = edit::wearer_of(recipe_.request, context_.drawn(), *label.bits, orbit.up,
                                                  front, mode == edit::EditMode::Add, context_.traits())
                                      .standing;
            const auto wearer = edit::replaces_accessory(recipe_.request.sentence(), mode)
                                    ? standing_of_wearer(label, orbit, front)
                                    : edit::UprightBounds{};
            if (standing.found())
                return framed_figure(wearer.found() ? wearer : standing, orbit, context_.traits());
        }
        localize::FocusParameters framing;
        framing.head_room = context_.traits().head_room;
        auto focused = localize::focus_orbit(context_.drawn(), *label.bits, orbit, framing);
        if (mode == edit::EditMode::Add) focused.radius *= room_around(recipe_.request.sentence().relation());
        return focused;
    }

    /// Views of a second search, when few were sure: all look from where these would move to.
    Located from_glance(const std::vector<double>& distances) {
        const Glance glance = best_glance(distances);
        if (!glance.sure()) return moved_in(views_on(glance.orbit, recipe_), {});
        const auto mode = edit::decide_mode(recipe_.request, std::nullopt).first;
        const auto focused = focused_on(glance.result.label, mode, glance.orbit, views_.front);
        // A thing; a ground is seen as well from here.
        const bool frames = focused.radius < MostBack * glance.orbit.radius;
        const Views views = views_on(frames ? focused : glance.orbit, recipe_);
        Located near = framed_as_figure(mode) && frames
                           ? moved_in(views, {})
                           : seen_from(faced(views));  // a glance tells a thing's size roughly
        return !frames || (near.found() && same_thing(near.result, glance.result))
                   ? near
                   : seen_from_afar(glance, std::move(near));
    }

    Located seen_from(const Views& views) {
        return {views, recipe_, {}, look(recipe_, views, {}), target_read_, {}};
    }

    /// So near that it fills the pictures the model may not know what it knew within its surroundings: a hat
    /// without who wears it.
    Located seen_from_afar(const Glance& glance, Located near) {
        Located far = seen_from(faced(views_on(glance.orbit, recipe_)));
        if (!far.found()) return near;
        log::info("\"{}\" is not known from near by: it is looked for from farther off", far.result.word);
        if (!framed_as_figure(far.result.mode) || far.result.mode == edit::EditMode::Add) return far;
        Located drawn = moved_in(near.views, *far.result.label.bits);  // where it is drawn anew
        drawn.result.confidence = far.result.confidence;               // that of the search which found it
        return drawn;
    }

    /// Looks from the views as they are, and once more from nearer where what was found is small.
    Located moved_in(const Views& from, const std::vector<std::uint8_t>& by_hand) {
        const Views views = faced(from);
        Located located{views, recipe_, by_hand, look(recipe_, views, by_hand), target_read_, {}};
        const auto& result = located.result;
        const auto& label = thing_of(result);
        if (!moves() ||
            std::find(label.bits->begin(), label.bits->end(), std::uint8_t{1}) == label.bits->end())
            return located;
        const auto focused = focused_on(label, result.mode, views.orbit, views.front);
        const bool as_figure = framed_as_figure(result.mode);
        if (worth_moving(views.orbit, focused, result.mode, as_figure)) {
            located.views = faced(views_on(focused, recipe_));
            located.result = look(recipe_, located.views, by_hand);
        }
        const bool worn = result.mode == edit::EditMode::Add ||
                          edit::replaces_accessory(recipe_.request.sentence(), result.mode);
        for (const double share : CutShares) {
            if (!worn || !as_figure || !edit::is_cut_off(result, share)) break;
            log::info("\"{}\" does not fit into the pictures; it is looked for from farther off",
                      result.word);
            located.views = faced(views_on(nearer(located.views.orbit, StepBack), recipe_));
            located.result = look(recipe_, located.views, by_hand);
        }
        return located;
    }

    /// Place of a new thing on its wearer, which is found as a search for it alone finds it. The new word
    /// would draw attention off the head. Nothing for other edits, or where no wearer is found.
    std::optional<Located> on_wearer() {
        const auto mode = edit::decide_mode(recipe_.request, std::nullopt).first;
        if (mode != edit::EditMode::Add || !framed_as_figure(mode)) return std::nullopt;
        Search for_wearer = *this;
        for_wearer.recipe_.request = recipe_.request.search_for(recipe_.request.source());
        const Located wearer = for_wearer.shown_whole(for_wearer.from_all_distances());
        beside_ = for_wearer.beside_;
        if (!wearer.found()) return std::nullopt;
        const auto& label = wearer.result.label;
        const auto focused = focused_on(label, mode, wearer.views.orbit, wearer.views.front);
        Located worn = moved_in(views_on(focused, recipe_), *label.bits);
        worn.result.confidence = wearer.result.confidence;
        return worn;
    }

    Located from_all_distances() {
        if (auto worn = on_wearer()) return std::move(*worn);
        Located located = from_glance(distances_);
        std::vector<double> others;
        for (const double distance : ScanDistances)
            if (std::find(distances_.begin(), distances_.end(), distance) == distances_.end())
                others.push_back(distance);
        if (located.found() || others.empty()) return located;
        // The pictures as a whole fitted best where the word was not found.
        Located other = from_glance(others);
        const bool better = other.found() || other.result.confidence.value > located.result.confidence.value;
        return better ? other : located;
    }

    RunContext& context_;
    CheckedRecipe recipe_;
    const Views& views_;
    const Hints& hints_;
    const JobControl& control_;
    std::vector<double> distances_;  // shares of the fitted orbit's radius that are tried
    bool target_read_ = false;
    std::vector<std::uint8_t> beside_;  // [N] or empty: parts beside the thing, as searches found them
    std::optional<std::vector<std::uint8_t>> wearer_;  // [N] of what is worn, once it was looked for
};

}  // namespace

edit::Finding finding_of(const RunContext& context, const Located& located) {
    const auto& result = located.result;
    return {context.drawn(),
            result.word,
            thing_of(result),
            located.views.views,
            result.views,
            located.views.orbit,
            located.views.front,
            render_settings(context.scene(), located.recipe.request),
            result.on_ground ? context.ground(located.recipe.request.sentence().before()) : std::nullopt,
            context.traits()};
}

Located locate(RunContext& context, const CheckedRecipe& recipe, const Views& views, const Hints& hints,
               const JobControl& control) {
    if (hints.label.empty())
        edit::require_views(edit::excluded_views_of(recipe.request.excluded_views),
                            views.views.size());  // before any work
    context.ask_anew(recipe.attention);
    if (hints.by_differences && hints.label.empty()) context.ask_server(recipe, control);
    CheckedRecipe all = recipe;  // from all views; what is left out is a matter of those that it ends with
    all.request.excluded_views.clear();
    Located located = finished(context, Search(context, all, views, hints, control).run());
    if (recipe.request.excluded_views.empty() || located.by_label()) return located;
    all = located.recipe;
    all.request.excluded_views = recipe.request.excluded_views;
    return locate_again(context, located, all, control);
}

Located locate_again(RunContext& context, const Located& located, const CheckedRecipe& recipe,
                     const JobControl& control) {
    context.ask(recipe.attention);
    Located again{located.views, recipe, located.label, {}, located.target_read, {}};
    again.by_differences = located.by_differences;
    if (recipe.request.whole_scene())
        return finished(context, located_everywhere(context, recipe, located.views, control));
    if (!located.within.empty() && !again.by_label()) {
        again.within = located.within;
        again.result = located.result;
        return finished(context, locate_part(context, std::move(again), control));
    }
    const auto* label = again.by_label() ? &again.label : nullptr;
    again.result = search_from(context, again.views, recipe, label, control, nullptr, &located.result.beside);
    add_to(again.result.beside, located.result.beside);
    if (edit::moves_worn_place(recipe.request.sentence(), again.result.mode))
        again.result.room = located.result.room;
    return finished(context, std::move(again));
}

Located locate_by_label(RunContext& context, const Located& located, std::vector<std::uint8_t> label,
                        const JobControl& control) {
    Located labelled = located;
    labelled.label = std::move(label);
    return locate_again(context, labelled, labelled.recipe, control);
}

Located with_label(const Located& located, const std::vector<std::uint8_t>& bits) {
    Located corrected = located;
    corrected.result.label.bits = std::make_shared<const std::vector<std::uint8_t>>(bits);
    corrected.label_doubt.clear();
    corrected.key = key_of(corrected);
    return corrected;
}

}  // namespace gse::pipeline
