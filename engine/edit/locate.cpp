// Renders, asks for attention, makes masks and fuses them into labels.
#include "engine/edit/locate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/localize/clusters.h"
#include "engine/localize/graph_cut.h"
#include "engine/localize/points.h"
#include "engine/localize/spread.h"

namespace gse::edit {
namespace {

constexpr int ClusterGrid = 64;              // clustering happens on maps of this width (method 2.7)
constexpr std::size_t LeastRegionCells = 4;  // smaller regions of a 64-cell map count as nothing found
constexpr int LeastViews = 3;                // fewer voting views cannot tell front from back
constexpr double LargestMaskShare = 0.9;     // of the picture: such a mask has found nothing
constexpr double LargestMaskGrowth = 4;      // of the attention region's area: the segmenter ran away
constexpr double LeastOverlapIou = 0.1;      // of a text segmenter's mask and the attention region (A8)
constexpr double LeastTextScore = 0.3;
constexpr double LeastEvidenceShare = 0.2;  // of the mean evidence of the rows that are seen at all
constexpr double ReferenceSide = 512;       // pictures for which request lengths in pixels are stated
constexpr double AttentionShare = 0.5;      // of a vote: the attention itself, beside the mask cut out of it
constexpr double AttentionLevel = 0.85;     // of the threshold: attention that counts half
constexpr double AttentionSoftness = 0.05;  // how far from there it counts a quarter more or less
constexpr double RivalLead = 0.5;           // another thing that has so much more takes the pixel from the mask

/// Position of the word in the sentence, -1 = absent.
int word_position(const std::vector<std::string>& words, const std::string& word) {
    const auto found = std::find(words.begin(), words.end(), word);
    return found == words.end() ? -1 : static_cast<int>(found - words.begin());
}

bool any_of_between(const std::vector<std::string>& words, int begin, int end,
                    const std::vector<std::string>& wanted) {
    for (int i = begin + 1; i < end; ++i)
        if (std::find(wanted.begin(), wanted.end(), words[static_cast<std::size_t>(i)]) != wanted.end())
            return true;
    return false;
}

int grid_height(const Image& map) { return std::max(1, ClusterGrid * map.height / map.width); }

void normalise_maximum(Image& map) {
    const float largest = map.data.empty() ? 0 : *std::max_element(map.data.begin(), map.data.end());
    if (!(largest > 0) || !std::isfinite(largest)) {
        std::fill(map.data.begin(), map.data.end(), 0.0f);
        return;
    }
    for (auto& value : map.data) value = std::isfinite(value) ? std::max(0.0f, value / largest) : 0.0f;
}

BoxPrompt bounds(const Mask& mask) {
    BoxPrompt box{static_cast<double>(mask.width), static_cast<double>(mask.height), 0, 0};
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            box.x0 = std::min(box.x0, static_cast<double>(x));
            box.y0 = std::min(box.y0, static_cast<double>(y));
            box.x1 = std::max(box.x1, x + 1.0);
            box.y1 = std::max(box.y1, y + 1.0);
        }
    return box;
}

Image mask_image(const Mask& mask) {
    Image image(mask.width, mask.height, 1);
    for (std::size_t i = 0; i < mask.data.size(); ++i) image.data[i] = mask.data[i] != 0 ? 1.0f : 0.0f;
    return image;
}

/// Whether the attention is above a level, in [0,1].
double above(double attention, double level) {
    return 1 / (1 + std::exp((level - attention) / AttentionSoftness));
}

/// What a view says about its pixels, [H,W,1] in [0,1]. A mask cut out by colours has sharp edges but leaves out what has
/// another colour (a mushroom's stem, a car's windows); the attention is blurred but knows that they belong. Where the
/// two disagree, the other views and the cut between neighbours decide; what another named thing has for sure (the white
/// legs of a dog on snow) the mask does not take from it. A text segmenter is believed as it is.
Image vote_of(const ViewEvidence& view, double threshold) {
    Image vote = mask_image(view.mask);
    if (view.failed || view.branch == "text") return vote;
    for (std::size_t i = 0; i < vote.data.size(); ++i) {
        const double attention = above(view.map.data[i], AttentionLevel * threshold);
        const double lost = view.lead.data.empty() ? 0 : above(view.lead.data[i], RivalLead);
        vote.data[i] =
            static_cast<float>((1 - AttentionShare) * (1 - lost) * vote.data[i] + AttentionShare * attention);
    }
    return vote;
}

/// One word to look for.
struct Search {
    std::string word;
    std::string prompt;
    std::vector<std::string> rivals;
    bool rivals_given = false;   // by the user, not read off the sentence
    bool absent = false;
};

/// Steps of locate() over all views.
class Locator {
public:
    Locator(const LocateInput& input, const LocateTools& tools) : input_(input), tools_(tools) {
        GSE_CHECK(input.view_words.empty() || input.view_words.size() == input.views.size());
    }

    LocateResult run() {
        LocateResult result;
        render_all();
        std::tie(result.mode, result.reason) = decide_mode(input_.request, found_share());
        log::info("{} \"{}\": {}", result.mode == EditMode::Add ? "adding" : "changing",
                  result.mode == EditMode::Add ? input_.request.target : input_.request.source,
                  result.reason);
        if (result.mode == EditMode::Modify)
            modify(result);
        else
            add(result);
        result.failed_views = static_cast<int>(std::count_if(
            result.views.begin(), result.views.end(), [](const ViewEvidence& view) { return view.failed; }));
        return result;
    }

private:
    const EditRequest& request() const { return input_.request; }

    double threshold() const {
        return request().attention_threshold > 0 ? request().attention_threshold : tools_.attention.threshold();
    }

    void check_stop() const {
        if (tools_.job.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
    }

    void render_all() {
        raster::ForwardOutput output;
        for (const auto& view : input_.views) {
            check_stop();
            tools_.rasterizer.forward(input_.gaussians.spans(), view.camera, input_.settings, output);
            Image colour = output.colour;
            for (auto& value : colour.data) value = std::clamp(value, 0.0f, 1.0f);
            renders_.push_back(std::move(colour));
            Image depth = output.depth;
            for (std::size_t i = 0; i < depth.data.size(); ++i)
                depth.data[i] = output.alpha.data[i] > 0.5f ? depth.data[i] / output.alpha.data[i] : 0.0f;
            depths_.push_back(std::move(depth));
            tools_.job.report("rendering views", static_cast<int>(renders_.size()),
                              static_cast<int>(input_.views.size()));
        }
    }

    /// Share of the views in which the text segmenter sees the target word; nothing without one.
    std::optional<double> found_share() {
        if (tools_.text_segmenter == nullptr || request().mode != "auto" || renders_.empty())
            return std::nullopt;
        int found = 0;
        for (const auto& render : renders_) {
            check_stop();
            const auto [mask, score] = tools_.text_segmenter->segment(render, request().target);
            found += score >= LeastTextScore && mask.count() > 0 ? 1 : 0;
        }
        return static_cast<double>(found) / static_cast<double>(renders_.size());
    }

    /// The word with a prompt that surely contains it and its rivals.
    Search search_for(const std::string& word, bool absent) const {
        std::string sentence = request().prompt;
        if (!has_word(sentence, word)) sentence = sentence_before(request());   // "on the snow" was "on the grass"
        if (!has_word(sentence, word)) sentence = "a " + word;
        Search search{word, std::move(sentence), {}, request().rivals != "auto", absent};
        if (absent || request().rivals == "none") return search;
        for (const auto& rival :
             search.rivals_given ? words_of(request().rivals) : things_named(sentence_before(request()))) {
            if (rival == word) continue;
            if (!has_word(search.prompt, rival)) search.prompt += ", " + rival;
            search.rivals.push_back(rival);
        }
        return search;
    }

    std::vector<ViewEvidence> look(const Search& search) {
        std::vector<ViewEvidence> views;
        for (std::size_t v = 0; v < input_.views.size(); ++v) {
            check_stop();
            views.push_back(attend(search, v));
            if (!search.absent && !views.back().failed) segment(search, views.back());
            tools_.job.report(fmt::format("looking for \"{}\"", search.word), static_cast<int>(v + 1),
                              static_cast<int>(input_.views.size()));
        }
        return views;
    }

    /// Attention map and its clean region (threshold, DBSCAN; GSEditPro 3.2).
    ViewEvidence attend(const Search& search, std::size_t v) {
        ViewEvidence view;
        view.render = renders_[v];
        std::vector<std::string> words{search.word};
        words.insert(words.end(), search.rivals.begin(), search.rivals.end());
        AttentionQuery query{view.render,
                             search.prompt,
                             std::move(words),
                             input_.view_words.empty() ? std::string() : input_.view_words[v],
                             search.absent,
                             request().attention_repeats,
                             Random::stream(request().seed, 5000 + v).next()};
        auto maps = ask(query, search.rivals_given);
        GSE_CHECK_EQ(maps.size(), query.words.size());
        for (auto& map : maps) {
            GSE_CHECK(map.width == view.render.width && map.height == view.render.height);
            normalise_maximum(map);
        }
        view.map = std::move(maps.front());
        compete(view, maps, search.rivals_given);
        const double level = threshold();
        const Image small = localize::resize_image(view.map, ClusterGrid, grid_height(view.map));
        small_region_ = localize::clean_clusters(localize::threshold_map(small, level), small,
                                                 {request().dbscan_eps, request().dbscan_min_samples},
                                                 request().keep_mass);
        view.region = localize::resize_mask(small_region_, view.map.width, view.map.height);
        view.mask = view.region;
        view.branch = "attention";
        view.captured = 1;
        small_map_ = small;
        const bool everything = static_cast<double>(view.region.count()) >
                                LargestMaskShare * static_cast<double>(view.region.data.size());
        if (small_region_.count() < LeastRegionCells || everything) fail(view);
        return view;
    }

    /// A rival nobody asked for must not end the search: what the model cannot read of a long sentence is left out.
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

    /// How far ahead the others are; those that the user gave take every pixel they have more of, those of the sentence only
    /// count in vote_of(): the attention of a wide ground is strong under the feet of what stands on it.
    static void compete(ViewEvidence& view, const std::vector<Image>& maps, bool strict) {
        if (maps.size() < 2) return;
        view.lead = Image(view.map.width, view.map.height, 1);
        for (std::size_t i = 0; i < view.map.data.size(); ++i) {
            for (std::size_t rival = 1; rival < maps.size(); ++rival)
                view.lead.data[i] = std::max(view.lead.data[i], maps[rival].data[i] - view.map.data[i]);
            if (strict && view.lead.data[i] > 0) view.map.data[i] = 0;
        }
    }

    static void fail(ViewEvidence& view) {
        view.failed = true;
        view.branch = "none";
        view.captured = 0;
        std::fill(view.mask.data.begin(), view.mask.data.end(), std::uint8_t{0});
    }

    /// Refines the region of the last attend(): text segmenter, clicks, or the region itself (A8).
    void segment(const Search& search, ViewEvidence& view) {
        choose_clicks(view);
        std::optional<Mask> from_text;
        double text_mass = 0;
        if (tools_.text_segmenter != nullptr) {
            auto [mask, score] = tools_.text_segmenter->segment(view.render, search.word);
            if (score >= LeastTextScore && mask.data.size() == view.region.data.size() && mask.count() > 0) {
                text_mass = localize::captured_mass(view.map, view.region, mask);
                from_text = std::move(mask);
            }
        }
        if (from_text && text_mass >= request().fallback_mass &&
            localize::mask_iou(*from_text, view.region) >= LeastOverlapIou) {
            accept(view, std::move(*from_text), text_mass, "text");
            return;
        }
        if (tools_.segmenter != nullptr) {
            Mask mask = tools_.segmenter->segment(view.render, view.points, bounds(view.region), view.map);
            mask = localize::clean_clusters(mask, view.map, {1.5, 1}, request().keep_mass);
            const double mass = localize::captured_mass(view.map, view.region, mask);
            if (sane(mask, view.region) && mass >= std::max(request().fallback_mass, text_mass)) {
                accept(view, std::move(mask), mass, "points");
                return;
            }
        }
        if (from_text && text_mass >= request().fallback_mass)
            accept(view, std::move(*from_text), text_mass, "text");
    }

    static void accept(ViewEvidence& view, Mask mask, double mass, const char* branch) {
        view.mask = std::move(mask);
        view.captured = mass;
        view.branch = branch;
    }

    static bool sane(const Mask& mask, const Mask& region) {
        const auto area = static_cast<double>(mask.count());
        return area > 0 && area <= LargestMaskShare * static_cast<double>(mask.data.size()) &&
               area <= LargestMaskGrowth * static_cast<double>(region.count());
    }

    void choose_clicks(ViewEvidence& view) const {
        localize::PointParameters parameters;
        parameters.positive = request().positive_points;
        parameters.negative = request().negative_points;
        const double scale_x = static_cast<double>(view.map.width) / small_map_.width;
        const double scale_y = static_cast<double>(view.map.height) / small_map_.height;
        for (const auto& point : localize::choose_points(small_map_, small_region_, parameters))
            view.points.push_back({point.x * scale_x, point.y * scale_y, point.positive});
    }

    /// Fuses the masks into weights and a label.
    std::pair<localize::LabelWeights, Label> label_of(const Search& search,
                                                      const std::vector<ViewEvidence>& views) {
        std::vector<localize::MaskedView> votes;
        for (std::size_t v = 0; v < views.size(); ++v)
            votes.push_back({input_.views[v].camera, vote_of(views[v], threshold()), views[v].failed});
        auto weights =
            localize::back_project(input_.gaussians.spans(), votes, input_.settings, tools_.rasterizer);
        if (weights.views_used < LeastViews)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("\"{}\" was found in {} views, at least {} are needed", search.word,
                                    weights.views_used, LeastViews),
                        "look from more views");
        const double least = least_evidence(weights);
        localize::SpreadParameters spread;
        spread.least_evidence_px = least;
        spread.tau = request().tau;
        localize::spread_to_unseen(input_.gaussians.spans(), spread, weights);
        localize::CutParameters cut;
        cut.tau = request().tau;
        cut.least_evidence_px = least;
        cut.smoothness = request().label_smoothness;
        const auto changed = localize::cut_label(input_.gaussians.spans(), cut, weights);
        if (changed > 0) log::debug("{} splats took the label of those they belong to", changed);
        Label label = localize::label_from_weights(search.word, weights, request().tau, least);
        return {std::move(weights), std::move(label)};
    }

    /// The request's evidence is meant for scenes whose splats cover a few pixels; in denser ones no splat
    /// has that much.
    double least_evidence(const localize::LabelWeights& weights) const {
        double sum = 0;
        std::size_t seen = 0;
        for (const double evidence : weights.evidence) {
            sum += evidence;
            seen += evidence > 0 ? 1 : 0;
        }
        return seen == 0
                   ? 0
                   : std::min(request().evidence_px, LeastEvidenceShare * sum / static_cast<double>(seen));
    }

    static std::size_t count_bits(const Label& label) {
        return static_cast<std::size_t>(std::count(label.bits->begin(), label.bits->end(), std::uint8_t{1}));
    }

    void modify(LocateResult& result) {
        const Search search = search_for(request().source, false);
        result.word = search.word;
        result.views = look(search);
        std::tie(result.weights, result.label) = label_of(search, result.views);
        if (count_bits(result.label) == 0)
            throw Error(ErrorCode::NotFound, fmt::format("no splat was labelled \"{}\"", search.word),
                        "name something the scene shows and the model knows, or lower --tau");
        result.source_label = result.label;
    }

    /// The rows the new thing belongs to; the whole scene when they are not found.
    void find_source(LocateResult& result) {
        const std::size_t rows = input_.gaussians.size();
        if (request().source != request().target) {
            const Search search = search_for(request().source, false);
            try {
                std::tie(result.weights, result.source_label) = label_of(search, look(search));
                if (count_bits(result.source_label) > 0) return;
            } catch (const Error& failure) {
                if (failure.code() == ErrorCode::Cancelled) throw;
            }
            log::warning("\"{}\" was not found; the whole scene stands for it", request().source);
        }
        result.source_label = make_label(request().source, std::vector<float>(rows, 1.0f), 0.5f);
    }

    void add(LocateResult& result) {
        find_source(result);
        const Search search = search_for(request().target, true);
        result.word = search.word;
        result.views = look(search);
        std::vector<Mask> masks;
        for (const auto& view : result.views) masks.push_back(view.failed ? Mask() : view.mask);
        const RegionSearch space{
            input_.gaussians, *result.source_label.bits, input_.views, masks, depths_, input_.up,
            input_.front};
        result.region = vote_region(space);
        const bool attended = !result.region.empty();
        if (!attended) {
            const std::string place = usual_place(search.word);
            log::info("the views do not agree where \"{}\" goes; it is put at the usual place: {}",
                      search.word, place);
            result.region = anchor_region(space, place);
        }
        if (result.region.empty())
            throw Error(ErrorCode::NotFound, fmt::format("no place was found for \"{}\"", search.word),
                        "name what it belongs to with --source");
        for (std::size_t v = 0; v < result.views.size(); ++v) {
            auto& view = result.views[v];
            view.mask = region_mask(result.region, input_.views[v].camera);
            view.branch = attended ? "attention" : "anchor";
            view.failed = view.mask.count() == 0;
        }
        result.seeds =
            seed_splats(result.region, request().seed_splats, input_.gaussians.sh_degree(), request().seed);
        result.label = make_label(search.word, std::vector<float>(input_.gaussians.size(), 0.0f), 0.5f);
    }

    const LocateInput& input_;
    const LocateTools& tools_;
    std::vector<Image> renders_, depths_;
    Image small_map_;  // of the view attended last, 64 cells wide
    Mask small_region_;
};

}  // namespace

std::pair<EditMode, std::string> decide_mode(const EditRequest& request,
                                             std::optional<double> target_found_share) {
    constexpr double present_share = 0.3;  // A7
    if (request.mode == "add") return {EditMode::Add, "as asked"};
    if (request.mode == "modify") return {EditMode::Modify, "as asked"};
    if (target_found_share && *target_found_share >= present_share)
        return {EditMode::Modify, "the scene shows \"" + request.target + "\" already"};
    const auto words = words_of(request.prompt);
    const int source = word_position(words, request.source), target = word_position(words, request.target);
    if (source < 0) return {EditMode::Modify, "the sentence replaces \"" + request.source + "\""};
    if (source == target) return {EditMode::Modify, "source and target are the same word"};
    static const std::vector<std::string> joining{"wearing",  "with", "and",   "holding", "has",
                                                  "having",   "on",   "under", "beside",  "near",
                                                  "carrying", "plus", "to",    "behind"};
    static const std::vector<std::string> turning{"made", "of", "into", "as"};
    const int first = std::min(source, target), last = std::max(source, target);
    bool worn = false;
    for (int i = first + 1; i < last; ++i) worn = worn || says_worn(words, static_cast<std::size_t>(i));
    const bool joined =
        (worn || any_of_between(words, first, last, joining)) && !any_of_between(words, first, last, turning);
    if (joined)
        return {EditMode::Add,
                "the sentence puts \"" + request.target + "\" beside \"" + request.source + "\""};
    return {EditMode::Modify, "\"" + request.target + "\" describes \"" + request.source + "\""};
}

LocateResult locate(const LocateInput& input, const LocateTools& tools) {
    if (input.gaussians.empty() || input.views.empty())
        throw Error(ErrorCode::InvalidArgument,
                    "there is nothing to look at: the scene or the list of views is empty");
    return Locator(input, tools).run();
}

EditPlan make_plan(const LocateInput& input, const LocateResult& located, raster::Rasterizer& rasterizer) {
    GSE_CHECK_EQ(located.views.size(), input.views.size());
    EditPlan plan;
    plan.views = input.views;
    plan.view_words = input.view_words;
    plan.label = *located.label.bits;
    plan.seeds = located.seeds;
    plan.settings = input.settings;
    const std::vector<float> values(plan.label.begin(), plan.label.end());
    const bool any = std::find(plan.label.begin(), plan.label.end(), std::uint8_t{1}) != plan.label.end();
    Image seen;
    for (std::size_t v = 0; v < input.views.size(); ++v) {
        const Camera& camera = input.views[v].camera;
        Mask mask = located.views[v].failed ? Mask(camera.width, camera.height) : located.views[v].mask;
        if (any) {
            rasterizer.forward_values(input.gaussians.spans(), camera, input.settings, values, seen);
            for (std::size_t i = 0; i < mask.data.size(); ++i)
                if (seen.data[i] > 0.5f) mask.data[i] = 1;
        }
        const double grow = input.request.dilate_px * (located.mode == EditMode::Add ? 2 : 1);
        plan.masks.push_back(localize::dilate(mask, grow * camera.width / ReferenceSide));
    }
    if (!input.request.localize) std::fill(plan.label.begin(), plan.label.end(), std::uint8_t{1});
    return plan;
}

}  // namespace gse::edit
