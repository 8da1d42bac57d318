// Modes of a search: one label, or the place of something new.
#include "engine/edit/search/locate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/edit/masks/view_vote.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/edit/placement/head.h"
#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/placement/voxel_region.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/search/word_search.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/language/grammar.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr std::uint64_t Drawing = 8000;

const char* doing(EditMode mode) {
    switch (mode) {
        case EditMode::Add: return "adding";
        case EditMode::Replace: return "replacing";
        case EditMode::Remove: return "removing";
        case EditMode::Transform: return "moving, turning or resizing";
        default: return "changing";
    }
}

/// Relation of something new to the source. What is worn goes to its own place on a body, and a thing in a
/// scene whose ground was named stands on that ground.
language::Relation relation_of_new(const CheckedRequest& request, const std::string& thing) {
    using language::Relation;
    const auto relation = request.sentence().relation();
    if (language::has_usual_place(thing)) return relation == Relation::Above ? Relation::None : relation;
    const bool on_ground = relation == Relation::None && language::names_ground(request.source());
    return on_ground ? Relation::Above : relation;
}

/// Steps of locate() over all views.
class Locator {
public:
    Locator(const LocateInput& input, const LocateTools& tools)
        : input_(input), tools_(tools), words_(input, tools, seen_) {
        GSE_CHECK(input.view_words.empty() || input.view_words.size() == input.views.size());
        render_all();
    }

    LocateResult run() {
        LocateResult result;
        result.on_ground = input_.ground.has_value();
        std::tie(result.mode, result.reason) = decide_mode(input_.request, found_share());
        log::info("{} \"{}\": {}", doing(result.mode),
                  result.mode == EditMode::Add ? input_.request.target() : input_.request.source(),
                  result.reason);
        if (result.mode == EditMode::Add) add(result);
        else modify(result);
        result.failed_views = static_cast<int>(std::count_if(
            result.views.begin(), result.views.end(), [](const ViewEvidence& view) { return view.failed; }));
        result.broken_attention = broken_ + words_.broken();
        if (result.broken_attention > 0)
            log::warning("{} values of the attention were not finite and count as none",
                         result.broken_attention);
        return result;
    }

private:
    const CheckedRequest& request() const { return input_.request; }

    void check_stop() const {
        if (tools_.job.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
    }

    void render_all() {
        if (tools_.cache != nullptr && tools_.cache->renders.size() == input_.views.size()) {
            seen_ = *tools_.cache;
            return;
        }
        seen_ = render_views(input_.gaussians, input_.views, input_.settings, input_.ground,
                             tools_.rasterizer, tools_.job);
        if (tools_.cache != nullptr) static_cast<ViewRenders&>(*tools_.cache) = seen_;
    }

    /// Share of the views in which the text segmenter sees the target word; nothing without one.
    std::optional<double> found_share() {
        if (tools_.text_segmenter == nullptr || request().mode || request().target().empty() ||
            seen_.renders.empty())
            return std::nullopt;
        int found = 0;
        for (const auto& render : seen_.renders) {
            check_stop();
            const auto [mask, score] = tools_.text_segmenter->segment(render, request().target());
            found += score >= LeastTextScore && mask.count() > 0 ? 1 : 0;
        }
        return static_cast<double>(found) / static_cast<double>(seen_.renders.size());
    }

    static void take(FoundWord& found, LocateResult& result) {
        result.found = std::move(found.field);
        result.beside = std::move(found.beside);
        result.confidence = std::move(found.verdict.confidence);
        result.problem = found.verdict.problem;
        result.message = std::move(found.verdict.message);
        result.remedy = std::move(found.verdict.remedy);
    }

    void modify(LocateResult& result) {
        SoughtWord word = words_.sought(request().source(), false);
        word.whole = true;
        word.alone = result.mode == EditMode::Replace &&
                     std::all_of(word.competing.begin(), word.competing.end(), language::names_ground);
        result.word = word.name;
        if (input_.label != nullptr) {
            result.views = labelled_views();
            result.label = label_by_hand(result.found.field);
        } else {
            FoundWord found = words_.find(word, result.views);
            result.label = found.label;
            take(found, result);
        }
        result.source_label = result.label;
    }

    /// The artist's label; its field says nothing.
    Label label_by_hand(LabelField& field) const {
        const std::size_t rows = input_.gaussians.size();
        GSE_CHECK_EQ(input_.label->size(), rows);
        field.probability.assign(rows, 0.0f);
        field.coverage.assign(rows, 0.0);
        Label label = make_label(request().source(), std::vector<float>(rows, 0.0f), 0.5f);
        label.bits = std::make_shared<const std::vector<std::uint8_t>>(*input_.label);
        return label;
    }

    /// Masks of the artist's label in the views.
    std::vector<ViewEvidence> labelled_views() {
        std::vector<ViewEvidence> views;
        const std::vector<float> values(input_.label->begin(), input_.label->end());
        Image seen;
        for (std::size_t v = 0; v < input_.views.size(); ++v) {
            const Camera& camera = input_.views[v].camera;
            tools_.rasterizer.forward_values(input_.gaussians.spans(), camera, input_.settings, values, seen);
            ViewEvidence view;
            view.render = seen_.renders[v];
            view.map = Image(camera.width, camera.height, 1);
            view.mask = localize::threshold_map(seen, LabelSeen);
            view.region = view.mask;
            view.branch = "label";
            view.failed = view.mask.count() == 0;
            view.step = view.failed ? ViewStep::Hidden : ViewStep::Found;
            views.push_back(std::move(view));
        }
        return views;
    }

    /// The rows the new thing belongs to: labelled by hand, found, or (where it is no thing of its own) the
    /// whole scene.
    void find_source(LocateResult& result) {
        if (input_.label != nullptr) {
            result.source_label = label_by_hand(result.found.field);
        } else if (request().source() != request().target()) {
            const SoughtWord word = words_.sought(request().source(), false);
            result.word = word.name;
            FoundWord found = words_.find(word, result.views);
            result.source_label = found.label;
            take(found, result);
        } else {
            result.source_label =
                make_label(request().source(), std::vector<float>(input_.gaussians.size(), 1.0f), 0.5f);
        }
    }

    /// The region as the views see it takes the place of what each of them said.
    void show_region(LocateResult& result, bool attended, bool drawn) {
        const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t v = begin; v < end; ++v) {
                auto& view = result.views[v];
                view.mask = region_mask(result.region, input_.views[v].camera, &seen_.depths[v]);
                const bool undrawn = drawn && view.drawn.data.empty();
                view.branch = attended && !undrawn ? drawn ? "drawn" : "attention" : "anchor";
                if (undrawn) view.map = mask_image(view.mask);
                view.failed = view.mask.count() == 0;
                view.step = view.failed ? ViewStep::Hidden : ViewStep::Found;
            }
        };
        over_views(tools_.threads, result.views.size(), some);
    }

    /// Drawn views are sure of what they show: what is seen from one side alone (flames in front, wings
    /// behind) counts.
    static RegionParameters of_drawn_views() {
        RegionParameters parameters;
        parameters.least_covered = 0.2;
        return parameters;
    }

    static bool votes(const std::vector<ViewEvidence>& views) {
        return std::count_if(views.begin(), views.end(), [](const auto& view) { return !view.failed; }) >=
               LeastVotingViews;
    }

    /// Draws the sought accessory around its wearer, by a model that is shown the scene. Empty without such a
    /// model.
    std::vector<ViewEvidence> draw(const SoughtWord& word, const AttachmentTarget& wearer,
                                   const std::vector<std::uint8_t>& source_bits) {
        if (tools_.drawing == nullptr || !draws_place(request(), EditMode::Add)) return {};
        const auto room = room_above(wearer.standing, input_.up, input_.front, request().add_room);
        if (room.empty()) return {};
        const PlaceDrawing drawing{input_.views,
                                   input_.view_words,
                                   input_.azimuths,
                                   input_.elevations,
                                   seen_.renders,
                                   seen_.depths,
                                   room,
                                   request(),
                                   word.name,
                                   Random::stream(SearchSeed, Drawing).next()};
        DrawnViews drawn;
        DrawnViews& kept = tools_.cache != nullptr
                               ? tools_.cache->drawn[drawing_key(drawing, wearer.bits, tools_.plain_ground)]
                               : drawn;
        if (kept.views.empty()) kept = drawn_into(drawing, source_bits);
        std::vector<ViewEvidence> views(input_.views.size());
        for (std::size_t v = 0; v < views.size(); ++v) {
            views[v].render = seen_.renders[v];
            views[v].map = Image(seen_.renders[v].width, seen_.renders[v].height, 1);
            views[v].failed = true;
        }
        auto places = find_drawn(drawing, kept, tools_.attention, tools_.job);
        for (std::size_t i = 0; i < places.size(); ++i) {
            auto& view = views[kept.views[i]];
            broken_ += places[i].broken;
            view.drawn = kept.pictures[i];
            view.map = std::move(places[i].map);
            view.region = view.mask = std::move(places[i].mask);
            view.failed = view.mask.count() == 0;
        }
        return views;
    }

    DrawnViews drawn_into(const PlaceDrawing& drawing, const std::vector<std::uint8_t>& source_bits) const {
        std::optional<GroundUnder> ground;
        if (tools_.plain_ground)
            ground = ground_under(request().prompt(), input_.gaussians, source_bits, input_.up, input_.front,
                                  tools_.rasterizer, input_.traits);
        if (!ground || !ground->in_nothing) return draw_thing(drawing, *tools_.drawing, tools_.job);
        OnPlainGround on_ground(*tools_.drawing, ground->plain, BeforePlain::Scene);
        return draw_thing(drawing, on_ground, tools_.job);
    }

    void add(LocateResult& result) {
        result.label =
            make_label(request().target(), std::vector<float>(input_.gaussians.size(), 0.0f), 0.5f);
        find_source(result);
        if (result.problem != SearchProblem::None) return;
        const SoughtWord word = words_.sought(request().target(), true);
        result.word = word.name;
        const bool of_source = request().source() != request().target();
        const auto relation = of_source ? relation_of_new(request(), word.name) : language::Relation::None;
        const auto wearer = wearer_of(request(), input_.gaussians, *result.source_label.bits, input_.up,
                                      input_.front, tools_.drawing != nullptr, input_.traits);
        if (wearer.head < 1)
            log::info("the head is {:.0f} % of its height: \"{}\" goes there", 100 * wearer.head, word.name);
        auto views = draw(word, wearer, *result.source_label.bits);
        const bool drawn = votes(views);
        result.views = drawn ? std::move(views) : words_.look(word);
        words_.exclude(result.views);
        std::vector<Mask> masks;
        for (const auto& view : result.views) masks.push_back(view.failed ? Mask() : view.mask);
        const RegionSearch space{input_.gaussians, wearer.bits,    input_.views, masks,
                                 seen_.depths,     input_.up,      input_.front, relation,
                                 tools_.threads,   wearer.standing};
        result.region = vote_region(space, drawn ? of_drawn_views() : RegionParameters{});
        const bool attended = !result.region.empty();
        if (!attended) {
            result.region = usual_region(space, word.name);
            log::info("the views do not agree where \"{}\" goes; it is put at the usual place: {}", word.name,
                      result.region.origin);
        }
        if (result.region.empty()) {
            result.problem = SearchProblem::NoPlace;
            result.message = fmt::format("no place was found for \"{}\"", word.name);
            result.remedy = "name what it belongs to";
            return;
        }
        show_region(result, attended, drawn);
        words_.exclude(result.views);
        result.seeds =
            seed_splats(result.region, request().seed_splats, input_.gaussians.sh_degree(), SearchSeed);
    }

    const LocateInput& input_;
    const LocateTools& tools_;
    ViewRenders seen_;
    WordSearch words_;
    std::size_t broken_ = 0;  // values of the attention in drawn views
};

}  // namespace

void require_found(const LocateResult& located) {
    if (located.problem == SearchProblem::None) return;
    throw Error(ErrorCode::NotFound, located.message, located.remedy);
}

LocateResult part_of_finding(const LocateInput& input, raster::Rasterizer& rasterizer, LocateResult whole,
                             const std::vector<std::uint8_t>& part, const std::string& name) {
    GSE_CHECK_EQ(part.size(), input.gaussians.size());
    auto& probability = whole.found.field.probability;
    for (std::size_t row = 0; row < probability.size(); ++row)
        if (part[row] == 0) probability[row] = 0;
    const std::string thing = std::exchange(whole.word, name);
    Label label = make_label(name, std::vector<float>(part.begin(), part.end()), 0.5f);
    const bool any = std::find(part.begin(), part.end(), std::uint8_t{1}) != part.end();
    const std::vector<float> values(part.begin(), part.end());
    Image seen;
    for (std::size_t v = 0; v < whole.views.size(); ++v) {
        auto& view = whole.views[v];
        rasterizer.forward_values(input.gaussians.spans(), input.views[v].camera, input.settings, values,
                                  seen);
        view.mask = view.region = localize::threshold_map(seen, LabelSeen);
        view.failed = view.failed || view.mask.count() == 0;
        if (view.failed && view.step == ViewStep::Found) view.step = ViewStep::Hidden;
    }
    whole.label = whole.source_label = std::move(label);
    if (any) return whole;
    whole.problem = SearchProblem::NothingLabelled;
    whole.message = fmt::format("no \"{}\" was found within \"{}\"", name, thing);
    whole.remedy = "label the part by hand";
    return whole;
}

LocateResult locate(const LocateInput& input, const LocateTools& tools) {
    if (input.gaussians.empty() || input.views.empty())
        throw Error(ErrorCode::InvalidArgument,
                    "there is nothing to look at: the scene or the list of views is empty");
    return Locator(input, tools).run();
}

}  // namespace gse::edit
