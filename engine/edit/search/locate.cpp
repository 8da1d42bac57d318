// Renders, asks for attention, makes masks and fuses them into labels.
#include "engine/edit/search/locate.h"
#include "engine/edit/placement/voxel_region.h"
#include "engine/edit/request/decide_mode.h"

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
#include "engine/edit/placement/ground_rows.h"
#include "engine/edit/placement/head.h"
#include "engine/edit/placement/placement_volume.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/search/confidence.h"
#include "engine/edit/target_views/strategies/studio_background.h"
#include "engine/language/grammar.h"
#include "engine/language/sentence.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/localize/clusters.h"
#include "engine/localize/graph_cut.h"
#include "engine/localize/propagate_labels.h"

namespace gse::edit {
namespace {

constexpr std::size_t RecognisedViews = 6;  // pictures that are compared with words
constexpr int LeastViews = 3;               // fewer voting views cannot tell front from back
constexpr std::size_t LeastSplats =
    4;  // of a thing; what views at odds have in common by chance are one or two
constexpr double IslandShare =
    0.05;  // of a thing that goes: what hangs in the air without it (a bumper) and is no more
constexpr float GroundWeight = 0.5f;  // of tau: what ground under a thing keeps of its weight at most
constexpr double LargestLabelShare =
    0.97;                                // of what the views see, where the sentence names other things too
constexpr float LabelSeen = 0.5f;        // share of a pixel from which it shows the artist's label
constexpr std::uint64_t SearchSeed = 0;  // one for all: what is found does not follow the loop's dice
constexpr double AtOdds =
    0.6;  // IoU of a view's mask and the common label, below which the view is asked again
constexpr std::uint64_t FirstAsking = 5000;
constexpr std::uint64_t Drawing = 8000;
constexpr std::uint64_t SecondAsking = 9000;  // other noise than the first time
// Of the threshold (at most half-way from it to the most there is): attention of what is not there yet
// reaches wider than what will be. Of 8 added things each on seeds 55 | 56 | 57 | 58 (`gseditpro-lab eval
// --kinds add --edits 8`) 1 changed 2.5 | 2.5 | 1.9 | 1.0 % of the pixels outside the true part, 1.2
// changed 1.8 | 1.4 | 1.8 | 0.7 %; outlines (mean IoU .40) and error removed (13 %) were the same.
constexpr double AbsentLevel = 1.2;

/// One word to look for.
struct Search {
    std::string word;
    std::string prompt;
    std::vector<std::string> rivals;
    bool rivals_given = false;  // by the user, not read off the sentence
    bool absent = false;
    bool whole = false;  // what the request is about: views that are left out do not vote on it
    bool alone = false;  // it goes, and the sentence names nothing that it wears or holds: what only it holds
                         // goes with it
};

/// Steps of locate() over all views.
class Locator {
public:
    Locator(const LocateInput& input, const LocateTools& tools) : input_(input), tools_(tools) {
        GSE_CHECK(input.view_words.empty() || input.view_words.size() == input.views.size());
    }

    LocateResult run() {
        LocateResult result;
        result.on_ground = input_.ground.has_value();
        left_out_ = views_left_out(request().left_out);
        render_all();
        std::tie(result.mode, result.reason) = decide_mode(input_.request, found_share());
        log::info("{} \"{}\": {}",
                  result.mode == EditMode::Add       ? "adding"
                  : result.mode == EditMode::Replace ? "replacing"
                                                     : "changing",
                  result.mode == EditMode::Add ? input_.request.target : input_.request.source,
                  result.reason);
        if (result.mode == EditMode::Add) add(result);
        else modify(result);
        result.failed_views = static_cast<int>(std::count_if(
            result.views.begin(), result.views.end(), [](const ViewEvidence& view) { return view.failed; }));
        result.broken_attention = broken_;
        if (broken_ > 0)
            log::warning("{} values of the attention were not finite and count as none", broken_);
        return result;
    }

private:
    const EditRequest& request() const { return input_.request; }

    double threshold() const {
        return request().attention_threshold > 0 ? request().attention_threshold
                                                 : tools_.attention.threshold();
    }

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
        if (tools_.text_segmenter == nullptr || request().mode != "auto" || request().target.empty() ||
            seen_.renders.empty())
            return std::nullopt;
        int found = 0;
        for (const auto& render : seen_.renders) {
            check_stop();
            const auto [mask, score] = tools_.text_segmenter->segment(render, request().target);
            found += score >= LeastTextScore && mask.count() > 0 ? 1 : 0;
        }
        return static_cast<double>(found) / static_cast<double>(seen_.renders.size());
    }

    /// What the views of one word came to.
    struct Found {
        localize::LabelWeights weights;
        Label label;
        Confidence confidence;
        SearchProblem problem = SearchProblem::None;
        std::string message, remedy;
    };

    /// The word with a prompt that surely contains it and its rivals.
    Search search_for(const std::string& word, bool absent) const {
        std::string sentence = language::normalised_prompt(request().prompt);
        if (!language::has_phrase(sentence, word))
            sentence = edit_sentence(request()).before();  // "on the snow" was "on the grass"
        if (!language::has_phrase(sentence, word)) sentence = "a " + word;
        Search search{word, std::move(sentence), {}, request().rivals != "auto", absent};
        if (absent || request().rivals == "none") return search;
        for (const auto& rival : search.rivals_given
                                     ? language::phrases_of(request().rivals)
                                     : language::Sentence(edit_sentence(request()).before()).things({word})) {
            if (rival == word ||
                (!search.rivals_given && !language::vocabulary_contains(input_.known, rival)))
                continue;
            if (!language::has_phrase(search.prompt, rival)) search.prompt += ", " + rival;
            search.rivals.push_back(rival);
        }
        return search;
    }

    std::vector<ViewEvidence> look(const Search& search) {
        std::vector<ViewEvidence> views;
        peaks_.assign(input_.views.size(), 0.0f);
        std::vector<std::size_t> all(input_.views.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        for (std::size_t v = 0; v < input_.views.size(); ++v) {
            check_stop();
            prepare(search, all, v, request().attention_repeats, FirstAsking);
            views.push_back(attend(search, v));
            if (tools_.seen) tools_.seen(v, views.back());
            tools_.job.report(fmt::format("looking for \"{}\"", search.word), static_cast<int>(v + 1),
                              static_cast<int>(input_.views.size()));
        }
        make_masks(search, views);
        if (!search.absent) hide_faint(views);
        if (tools_.seen)
            for (std::size_t v = 0; v < views.size(); ++v) tools_.seen(v, views[v]);
        return views;
    }

    /// Where a word draws much less attention than elsewhere, its map, scaled to its maximum, is noise.
    void hide_faint(std::vector<ViewEvidence>& views) const {
        for (const auto v : faint_views(peaks_)) {
            auto& view = views[v];
            if (view.failed) continue;
            view.mask = view.region = Mask(view.render.width, view.render.height);
            view.points.clear();
            view.step = ViewStep::Faint;
            view.failed = true;
        }
    }

    /// Views have nothing to do with each other here.
    void make_masks(const Search& search, std::vector<ViewEvidence>& views) {
        const double level =
            search.absent ? std::min(AbsentLevel * threshold(), (1 + threshold()) / 2) : threshold();
        const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
            for (std::size_t v = begin; v < end; ++v) {
                check_stop();
                take_mask(views[v],
                          find_word_mask(views[v].render, views[v].map, level, search.word, request(),
                                         {tools_.segmenter, tools_.text_segmenter}, !search.absent));
            }
        };
        over_views(views.size(), some);
    }

    /// Attention map of a view.
    ViewEvidence attend(const Search& search, std::size_t v) {
        ViewEvidence view;
        view.render = seen_.renders[v];
        auto maps = maps_of(search, v, request().attention_repeats, FirstAsking + v);
        view.map = std::move(maps.front());
        compete(view, maps, search.rivals_given);
        return view;
    }

    AttentionQuery query_of(const Search& search, std::size_t v, int repeats, std::uint64_t stream) const {
        std::vector<std::string> words{search.word};
        words.insert(words.end(), search.rivals.begin(), search.rivals.end());
        return {seen_.renders[v],
                search.prompt,
                std::move(words),
                input_.view_words.empty() ? std::string() : input_.view_words[v],
                search.absent,
                repeats,
                Random::stream(SearchSeed, stream).next()};
    }

    /// Of these views the first one and those that are worth asking with it.
    void prepare(const Search& search, const std::vector<std::size_t>& views, std::size_t first, int repeats,
                 std::uint64_t stream) {
        const std::size_t at_once = tools_.attention.at_once();
        if (at_once < 2 || first % at_once != 0) return;
        std::vector<AttentionQuery> queries;
        for (std::size_t i = first; i < std::min(first + at_once, views.size()); ++i)
            queries.push_back(query_of(search, views[i], repeats, stream + views[i]));
        tools_.attention.prepare(queries);
    }

    /// Of the word and its rivals, each divided by its maximum.
    std::vector<Image> maps_of(const Search& search, std::size_t v, int repeats, std::uint64_t stream) {
        AttentionQuery query = query_of(search, v, repeats, stream);
        auto maps = ask(query, search.rivals_given);
        GSE_CHECK_EQ(maps.size(), query.words.size());
        for (auto& map : maps) {
            GSE_CHECK(map.width == seen_.renders[v].width && map.height == seen_.renders[v].height);
            if (&map == &maps.front()) peaks_[v] = largest_value(map);
            broken_ += normalise_maximum(map);
        }
        return maps;
    }

    /// Looks with few probes, fuses, and asks views again whose mask is at odds with what all say together;
    /// at most half of them: where more are, it is not the noise.
    Found search_views(const Search& search, std::vector<ViewEvidence>& views) {
        views = look(search);
        leave_out(views, search.whole ? left_out_ : std::vector<std::size_t>{});
        Found found = fuse(search, views);
        if (found.problem != SearchProblem::None || request().second_look < 1) return found;
        const auto odd = to_ask_again(search, found.label, views);
        if (odd.empty()) return found;
        std::vector<ViewEvidence> again;
        const auto first = static_cast<float>(request().attention_repeats),
                   more = static_cast<float>(request().second_look);
        for (std::size_t i = 0; i < odd.size(); ++i) {
            check_stop();
            const auto v = odd[i];
            prepare(search, odd, i, request().second_look, SecondAsking);
            auto maps = maps_of(search, v, request().second_look, SecondAsking + v);
            ViewEvidence view;
            view.render = seen_.renders[v];
            view.map = std::move(maps.front());
            for (std::size_t p = 0; p < view.map.data.size(); ++p)
                view.map.data[p] = (first * views[v].map.data[p] + more * view.map.data[p]) / (first + more);
            normalise_maximum(view.map);
            compete(view, maps, search.rivals_given);
            again.push_back(std::move(view));
        }
        make_masks(search, again);
        for (std::size_t i = 0; i < odd.size(); ++i) views[odd[i]] = std::move(again[i]);
        leave_out(views, search.whole ? left_out_ : std::vector<std::size_t>{});
        log::debug("{} of {} views were asked again", odd.size(), views.size());
        return fuse(search, views);
    }

    /// As at the first threshold that was tried, where that is remembered.
    std::vector<std::size_t> to_ask_again(const Search& search, const Label& label,
                                          const std::vector<ViewEvidence>& views) {
        const std::string key = fmt::format("{}\n{}", search.prompt, search.word);
        if (tools_.cache != nullptr)
            if (const auto known = tools_.cache->asked_again.find(key);
                known != tools_.cache->asked_again.end())
                return known->second;
        auto odd = at_odds(label, views);
        if (odd.size() * 2 > views.size()) odd.clear();
        if (tools_.cache != nullptr) tools_.cache->asked_again[key] = odd;
        return odd;
    }

    std::vector<std::size_t> at_odds(const Label& label, const std::vector<ViewEvidence>& views) {
        std::vector<std::size_t> odd;
        const std::vector<float> values(label.bits->begin(), label.bits->end());
        Image seen;
        for (std::size_t v = 0; v < views.size(); ++v) {
            check_stop();
            tools_.rasterizer.forward_values(input_.gaussians.spans(), input_.views[v].camera,
                                             input_.settings, values, seen);
            if (localize::mask_iou(localize::threshold_map(seen, LabelSeen), views[v].mask) < AtOdds)
                odd.push_back(v);
        }
        return odd;
    }

    static void take_mask(ViewEvidence& view, WordMask found) {
        view.region = std::move(found.region);
        view.mask = std::move(found.mask);
        view.points = std::move(found.points);
        view.captured = found.captured;
        view.branch = std::move(found.branch);
        view.trusted = found.trusted;
        view.step = found.step;
        view.failed = !found.found();
    }

    /// A rival nobody asked for must not end the search: what the model cannot read of a long sentence is
    /// left out.
    std::vector<Image> ask(AttentionQuery& query, bool strict) const {
        try {
            return tools_.attention.locate(query);
        } catch (const Error& failure) {
            if (strict || query.words.size() < 2 || failure.code() != ErrorCode::NotFound) throw;
            log::debug("without the other things of the sentence: {}", failure.what());
        }
        query.words.resize(1);
        return tools_.attention.locate(query);
    }

    Found nothing(const Search& search, SearchProblem problem, std::string message,
                  std::string remedy) const {
        const std::size_t rows = input_.gaussians.size();
        Found found;
        found.weights.weight.assign(rows, 0.0f);
        found.weights.evidence.assign(rows, 0.0);
        found.label = make_label(search.word, std::vector<float>(rows, 0.0f), 0.5f);
        found.confidence.value = 0;
        found.problem = problem;
        found.message = std::move(message);
        found.remedy = std::move(remedy);
        return found;
    }

    /// Fuses the masks into weights and a label.
    Found fuse(const Search& search, const std::vector<ViewEvidence>& views) {
        std::vector<localize::MaskedView> votes;
        for (std::size_t v = 0; v < views.size(); ++v)
            if (views[v].step != ViewStep::LeftOut)
                votes.push_back({input_.views[v].camera, vote_of(views[v], threshold()), views[v].failed});
        const auto voting = static_cast<std::size_t>(
            std::count_if(votes.begin(), votes.end(), [](const auto& vote) { return !vote.failed; }));
        if (voting < LeastViews || voting * 2 < votes.size())
            return nothing(
                search, SearchProblem::FewViews,
                fmt::format("\"{}\" was found in only {} of {} views", search.word, voting, votes.size()),
                voting * 2 < votes.size() ? common_remedy(views) : "look from more views");
        Found found;
        auto& weights = found.weights;
        weights = votes_.back_project(input_.gaussians.spans(), votes, input_.settings, tools_.rasterizer);
        const double least = least_evidence(weights, request().coverage_px);
        localize::SpreadParameters spread;
        spread.least_evidence_px = least;
        spread.tau = request().tau;
        localize::propagate_labels_knn(input_.gaussians.spans(), spread, weights, tools_.threads);
        const localize::CutParameters cut{.smoothness = request().label_smoothness,
                                          .tau = request().tau,
                                          .least_evidence_px = least,
                                          .island_share = search.alone ? IslandShare : 0};
        const auto changed = localize::cut_label(input_.gaussians.spans(), cut, weights, tools_.threads);
        if (changed > 0) log::debug("{} splats took the label of those they belong to", changed);
        found.label = localize::label_from_weights(search.word, weights, request().tau, least);
        if (const auto ground = ground_rows(input_.gaussians, *found.label.bits, input_.up, input_.front);
            !ground.empty()) {
            for (const auto row : ground)
                weights.weight[row] =
                    std::min(weights.weight[row], static_cast<float>(GroundWeight * request().tau));
            log::debug("{} splats of the ground below \"{}\" are left to it", ground.size(), search.word);
            found.label = localize::label_from_weights(search.word, weights, request().tau, least);
        }
        if (const auto labelled = count_bits(found.label);
            labelled < LeastSplats && labelled * 2 < input_.gaussians.size())
            return nothing(search, SearchProblem::NothingLabelled,
                           fmt::format("the views agree on {} splat for \"{}\"",
                                       labelled == 0 ? "no" : "hardly a", search.word),
                           "name something the scene shows and the model knows, or lower tau");
        found.confidence = confidence_of(views, weights, found.label, recognised(search.word),
                                         ground_seen(views, seen_.grounds));
        // The sentence names other things, and nothing is left of the scene for them: it is only the word
        // that is found everywhere.
        if (!search.rivals.empty() && found.confidence.share > LargestLabelShare) found.confidence.value = 0;
        if (found.confidence.value < request().least_confidence) {
            found.problem = SearchProblem::Unsure;
            found.message = fmt::format(
                "it is not sure that \"{}\" was found (confidence {:.2f}, at least {:.2f} is needed)",
                search.word, found.confidence.value, request().least_confidence);
            found.remedy = "name something the scene shows, look at what was found, or label it by hand";
        }
        return found;
    }

    /// How well some of the pictures fit the word; negative where nobody can tell.
    double recognised(const std::string& word) const {
        if (tools_.recognition == nullptr) return -1;
        std::vector<const Image*> some;
        const std::size_t step = std::max<std::size_t>(1, seen_.renders.size() / RecognisedViews);
        for (std::size_t v = 0; v < seen_.renders.size(); v += step) some.push_back(&seen_.renders[v]);
        const std::string sentence = edit_sentence(request()).before();
        return tools_.recognition->of(language::has_phrase(sentence, word) ? sentence : "a " + word, word,
                                      some);
    }

    static std::string common_remedy(const std::vector<ViewEvidence>& views) {
        std::vector<ViewStep> steps;
        for (const auto& view : views) steps.push_back(view.step);
        return search_remedy(steps);
    }

    static void take(Found& found, LocateResult& result) {
        result.weights = std::move(found.weights);
        result.confidence = found.confidence;
        result.problem = found.problem;
        result.message = std::move(found.message);
        result.remedy = std::move(found.remedy);
    }

    static std::size_t count_bits(const Label& label) {
        return static_cast<std::size_t>(std::count(label.bits->begin(), label.bits->end(), std::uint8_t{1}));
    }

    void modify(LocateResult& result) {
        Search search = search_for(request().source, false);
        search.whole = true;
        search.alone = result.mode == EditMode::Replace &&
                       std::all_of(search.rivals.begin(), search.rivals.end(), language::names_ground);
        result.word = search.word;
        if (input_.label != nullptr) {
            result.views = labelled_views();
            result.label = label_by_hand(result.weights);
        } else {
            Found found = search_views(search, result.views);
            result.label = found.label;
            take(found, result);
        }
        result.source_label = result.label;
    }

    /// The artist's label, with weights that say nothing of their own.
    Label label_by_hand(localize::LabelWeights& weights) const {
        const std::size_t rows = input_.gaussians.size();
        GSE_CHECK_EQ(input_.label->size(), rows);
        weights.weight.assign(rows, 0.0f);
        weights.evidence.assign(rows, 0.0);
        Label label = make_label(request().source, std::vector<float>(rows, 0.0f), 0.5f);
        label.bits = std::make_shared<const std::vector<std::uint8_t>>(*input_.label);
        return label;
    }

    /// What the views show of the artist's label.
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
            result.source_label = label_by_hand(result.weights);
        } else if (request().source != request().target) {
            const Search search = search_for(request().source, false);
            result.word = search.word;
            Found found = search_views(search, result.views);
            result.source_label = found.label;
            take(found, result);
        } else {
            result.source_label =
                make_label(request().source, std::vector<float>(input_.gaussians.size(), 1.0f), 0.5f);
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
        over_views(result.views.size(), some);
    }

    void over_views(std::size_t count,
                    const std::function<void(std::size_t, std::size_t, unsigned)>& some) const {
        if (tools_.threads != nullptr) tools_.threads->parallel_for(count, 1, some);
        else some(0, count, 0);
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
               LeastViews;
    }

    /// What a model that is shown the scene draws around what wears it; nothing where there is no such model.
    std::vector<ViewEvidence> draw(const Search& search, const AttachmentTarget& wearer,
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
                                   search.word,
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
            ground = ground_under(request().prompt, input_.gaussians, source_bits, input_.up, input_.front,
                                  tools_.rasterizer, input_.traits);
        if (!ground || !ground->in_nothing) return draw_thing(drawing, *tools_.drawing, tools_.job);
        OnPlainGround on_ground(*tools_.drawing, ground->plain, BeforePlain::Scene);
        return draw_thing(drawing, on_ground, tools_.job);
    }

    void add(LocateResult& result) {
        result.label = make_label(request().target, std::vector<float>(input_.gaussians.size(), 0.0f), 0.5f);
        find_source(result);
        if (result.problem != SearchProblem::None) return;
        const Search search = search_for(request().target, true);
        result.word = search.word;
        const bool of_source = request().source != request().target;
        const auto relation = of_source ? edit_sentence(request()).relation() : language::Relation::None;
        const auto wearer = wearer_of(request(), input_.gaussians, *result.source_label.bits, input_.up,
                                      input_.front, tools_.drawing != nullptr, input_.traits);
        if (wearer.head < 1)
            log::info("the head is {:.0f} % of its height: \"{}\" goes there", 100 * wearer.head,
                      search.word);
        auto views = draw(search, wearer, *result.source_label.bits);
        const bool drawn = votes(views);
        result.views = drawn ? std::move(views) : look(search);
        leave_out(result.views, left_out_);
        std::vector<Mask> masks;
        for (const auto& view : result.views) masks.push_back(view.failed ? Mask() : view.mask);
        const RegionSearch space{input_.gaussians, wearer.bits,    input_.views, masks,
                                 seen_.depths,     input_.up,      input_.front, relation,
                                 tools_.threads,   wearer.standing};
        result.region = vote_region(space, drawn ? of_drawn_views() : RegionParameters{});
        const bool attended = !result.region.empty();
        if (!attended) {
            result.region = usual_region(space, search.word);
            log::info("the views do not agree where \"{}\" goes; it is put at the usual place: {}",
                      search.word, result.region.origin);
        }
        if (result.region.empty()) {
            result.problem = SearchProblem::NoPlace;
            result.message = fmt::format("no place was found for \"{}\"", search.word);
            result.remedy = "name what it belongs to";
            return;
        }
        show_region(result, attended, drawn);
        leave_out(result.views, left_out_);
        result.seeds =
            seed_splats(result.region, request().seed_splats, input_.gaussians.sh_degree(), SearchSeed);
    }

    const LocateInput& input_;
    const LocateTools& tools_;
    ViewRenders seen_;
    localize::VoteCache votes_;
    std::vector<std::size_t> left_out_;
    std::vector<float> peaks_;  // per view: the most attention that the word of the last search drew there
    std::size_t broken_ = 0;    // values of the attention so far
};

}  // namespace

void require_found(const LocateResult& located) {
    if (located.problem == SearchProblem::None) return;
    throw Error(ErrorCode::NotFound, located.message, located.remedy);
}

LocateResult locate(const LocateInput& input, const LocateTools& tools) {
    if (input.gaussians.empty() || input.views.empty())
        throw Error(ErrorCode::InvalidArgument,
                    "there is nothing to look at: the scene or the list of views is empty");
    return Locator(input, tools).run();
}

}  // namespace gse::edit
