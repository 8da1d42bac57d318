// Attention of all views, masks, views that are asked again, votes.
#include "engine/edit/search/word_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/random.h"
#include "engine/edit/masks/view_vote.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/edit/search/decide_label.h"
#include "engine/edit/search/thing_parts.h"
#include "engine/language/grammar.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr std::size_t RecognisedViews = 6;  // pictures that are compared with words
// Share of a thing that goes: what hangs in the air without it (a bumper) and is no more.
constexpr double IslandShare = 0.05;
// IoU of a view's mask and the common label, below which the view is asked again.
constexpr double AtOdds = 0.6;
constexpr std::uint64_t FirstAsking = 5000;
constexpr std::uint64_t SecondAsking = 9000;  // other noise than the first time
// Multiple of the threshold, at most half-way from it to the largest value. Attention of an object that is
// not there yet reaches wider than the object will.
constexpr double AbsentLevel = 1.2;

void take_mask(ViewEvidence& view, WordMask found) {
    view.region = std::move(found.region);
    view.mask = std::move(found.mask);
    view.points = std::move(found.points);
    view.captured = found.captured;
    view.branch = std::move(found.branch);
    view.trusted = found.trusted;
    view.step = found.step;
    view.failed = !found.found();
}

}  // namespace

void over_views(ThreadPool* threads, std::size_t count,
                const std::function<void(std::size_t, std::size_t, unsigned)>& some) {
    if (threads != nullptr) threads->parallel_for(count, 1, some);
    else some(0, count, 0);
}

WordSearch::WordSearch(const LocateInput& input, const LocateTools& tools, const ViewRenders& seen)
    : input_(input), tools_(tools), seen_(seen), excluded_(excluded_views_of(input.request.excluded_views)) {
    if (input.within == nullptr) return;
    GSE_CHECK_EQ(input.within->size(), input.gaussians.size());
    const std::vector<float> values(input.within->begin(), input.within->end());
    Image thing;
    for (const auto& view : input.views) {
        tools.rasterizer.forward_values(input.gaussians.spans(), view.camera, input.settings, values, thing);
        within_.push_back(localize::threshold_map(thing, LabelSeen));
    }
}

double WordSearch::threshold() const {
    return request().attention_threshold > 0 ? request().attention_threshold : tools_.attention.threshold();
}

void WordSearch::check_stop() const {
    if (tools_.job.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
}

void WordSearch::exclude(std::vector<ViewEvidence>& views) const { exclude_views(views, excluded_); }

SoughtWord WordSearch::sought(const std::string& name, bool absent) const {
    const auto& said = request().sentence();
    // An addition is not there yet: its word would draw attention off the thing that will wear it.
    const bool adds = language::decide_mode(said, std::nullopt, std::nullopt).first == EditMode::Add;
    std::string sentence = adds && !absent ? said.before() : said.prompt();
    if (!language::has_phrase(sentence, name)) sentence = said.before();  // "on the snow" was "on the grass"
    if (!language::has_phrase(sentence, name)) sentence = "a " + name;
    SoughtWord word{name, std::move(sentence), {}, request().competing_words != "auto", absent};
    if (absent || request().competing_words == "none") return word;
    for (const auto& other : word.competing_given ? language::phrases_of(request().competing_words)
                                                  : said.things_before({name})) {
        if (other == name || (!word.competing_given && !language::vocabulary_contains(input_.known, other)))
            continue;
        if (!language::has_phrase(word.prompt, other)) word.prompt += ", " + other;
        word.competing.push_back(other);
    }
    return word;
}

std::vector<ViewEvidence> WordSearch::look(const SoughtWord& word) {
    std::vector<ViewEvidence> views;
    peaks_.assign(input_.views.size(), 0.0f);
    std::vector<std::size_t> all(input_.views.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (std::size_t v = 0; v < input_.views.size(); ++v) {
        check_stop();
        prepare(word, all, v, request().attention_repeats, FirstAsking);
        views.push_back(attend(word, v));
        if (tools_.seen) tools_.seen(v, views.back());
        tools_.job.report(fmt::format("looking for \"{}\"", word.name), static_cast<int>(v + 1),
                          static_cast<int>(input_.views.size()));
    }
    make_masks(word, views);
    for (std::size_t v = 0; v < views.size(); ++v) limit(views[v], v);
    if (!word.absent) hide_faint(views);
    if (tools_.seen)
        for (std::size_t v = 0; v < views.size(); ++v) tools_.seen(v, views[v]);
    return views;
}

void WordSearch::hide_faint(std::vector<ViewEvidence>& views) const {
    for (const auto v : faint_views(peaks_)) {
        auto& view = views[v];
        if (view.failed) continue;
        view.mask = view.region = Mask(view.render.width, view.render.height);
        view.points.clear();
        view.step = ViewStep::Faint;
        view.failed = true;
    }
}

void WordSearch::make_masks(const SoughtWord& word, std::vector<ViewEvidence>& views) {
    const double level =
        word.absent ? std::min(AbsentLevel * threshold(), (1 + threshold()) / 2) : threshold();
    const auto some = [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t v = begin; v < end; ++v) {
            check_stop();
            take_mask(views[v], find_word_mask(views[v].render, views[v].map, level, word.name, request(),
                                               {tools_.segmenter, tools_.text_segmenter}, !word.absent));
        }
    };
    over_views(tools_.threads, views.size(), some);
}

ViewEvidence WordSearch::attend(const SoughtWord& word, std::size_t v) {
    ViewEvidence view;
    view.render = seen_.renders[v];
    auto maps = maps_of(word, v, request().attention_repeats, FirstAsking + v);
    view.map = std::move(maps.front());
    suppress_competitors(view, maps, word.competing_given);
    return view;
}

AttentionQuery WordSearch::query_of(const SoughtWord& word, std::size_t v, int repeats,
                                    std::uint64_t stream) const {
    std::vector<std::string> words{word.name};
    words.insert(words.end(), word.competing.begin(), word.competing.end());
    return {seen_.renders[v],
            word.prompt,
            std::move(words),
            input_.view_words.empty() ? std::string() : input_.view_words[v],
            word.absent,
            repeats,
            Random::stream(SearchSeed, stream).next()};
}

void WordSearch::prepare(const SoughtWord& word, const std::vector<std::size_t>& views, std::size_t first,
                         int repeats, std::uint64_t stream) {
    const std::size_t at_once = tools_.attention.at_once();
    if (at_once < 2 || first % at_once != 0) return;
    std::vector<AttentionQuery> queries;
    for (std::size_t i = first; i < std::min(first + at_once, views.size()); ++i)
        queries.push_back(query_of(word, views[i], repeats, stream + views[i]));
    tools_.attention.prepare(queries);
}

std::vector<Image> WordSearch::maps_of(const SoughtWord& word, std::size_t v, int repeats,
                                       std::uint64_t stream) {
    AttentionQuery query = query_of(word, v, repeats, stream);
    auto maps = ask(query, word.competing_given);
    GSE_CHECK_EQ(maps.size(), query.words.size());
    for (auto& map : maps) {
        GSE_CHECK(map.width == seen_.renders[v].width && map.height == seen_.renders[v].height);
        if (!within_.empty())
            for (std::size_t i = 0; i < map.data.size(); ++i)
                if (within_[v].data[i] == 0) map.data[i] = 0;
        if (&map == &maps.front()) peaks_[v] = largest_value(map);
        broken_ += normalise_maximum(map);
    }
    return maps;
}

FoundWord WordSearch::find(const SoughtWord& word, std::vector<ViewEvidence>& views) {
    views = look(word);
    if (word.whole) exclude(views);
    FoundWord found = fuse(word, views);
    if (!found.verdict.sure() || request().retry_passes < 1) return found;
    const auto odd = to_ask_again(word, found.label, views);
    if (odd.empty()) return found;
    std::vector<ViewEvidence> again;
    const auto first = static_cast<float>(request().attention_repeats),
               more = static_cast<float>(request().retry_passes);
    for (std::size_t i = 0; i < odd.size(); ++i) {
        check_stop();
        const auto v = odd[i];
        prepare(word, odd, i, request().retry_passes, SecondAsking);
        auto maps = maps_of(word, v, request().retry_passes, SecondAsking + v);
        ViewEvidence view;
        view.render = seen_.renders[v];
        view.map = std::move(maps.front());
        for (std::size_t p = 0; p < view.map.data.size(); ++p)
            view.map.data[p] = (first * views[v].map.data[p] + more * view.map.data[p]) / (first + more);
        normalise_maximum(view.map);
        suppress_competitors(view, maps, word.competing_given);
        again.push_back(std::move(view));
    }
    make_masks(word, again);
    for (std::size_t i = 0; i < odd.size(); ++i) {
        limit(again[i], odd[i]);
        views[odd[i]] = std::move(again[i]);
    }
    if (word.whole) exclude(views);
    log::debug("{} of {} views were asked again", odd.size(), views.size());
    return fuse(word, views);
}

std::vector<std::size_t> WordSearch::to_ask_again(const SoughtWord& word, const Label& label,
                                                  const std::vector<ViewEvidence>& views) {
    const std::string key = fmt::format("{}\n{}", word.prompt, word.name);
    if (tools_.cache != nullptr)
        if (const auto known = tools_.cache->asked_again.find(key); known != tools_.cache->asked_again.end())
            return known->second;
    auto odd = at_odds(label, views);
    if (odd.size() * 2 > views.size()) odd.clear();
    if (tools_.cache != nullptr) tools_.cache->asked_again[key] = odd;
    return odd;
}

std::vector<std::size_t> WordSearch::at_odds(const Label& label, const std::vector<ViewEvidence>& views) {
    std::vector<std::size_t> odd;
    const std::vector<float> values(label.bits->begin(), label.bits->end());
    Image seen;
    for (std::size_t v = 0; v < views.size(); ++v) {
        check_stop();
        tools_.rasterizer.forward_values(input_.gaussians.spans(), input_.views[v].camera, input_.settings,
                                         values, seen);
        if (localize::mask_iou(localize::threshold_map(seen, LabelSeen), views[v].mask) < AtOdds)
            odd.push_back(v);
    }
    return odd;
}

std::vector<Image> WordSearch::ask(AttentionQuery& query, bool strict) const {
    try {
        return tools_.attention.locate(query);
    } catch (const Error& failure) {
        if (strict || query.words.size() < 2 || failure.code() != ErrorCode::NotFound) throw;
        log::debug("without the other things of the sentence: {}", failure.what());
    }
    query.words.resize(1);
    return tools_.attention.locate(query);
}

FoundWord WordSearch::nothing(const SoughtWord& word, SearchVerdict verdict) const {
    const std::size_t rows = input_.gaussians.size();
    FoundWord found;
    found.field.field.probability.assign(rows, 0.0f);
    found.field.field.coverage.assign(rows, 0.0);
    found.label = make_label(word.name, std::vector<float>(rows, 0.0f), 0.5f);
    found.verdict = std::move(verdict);
    return found;
}

FoundWord WordSearch::fuse(const SoughtWord& word, const std::vector<ViewEvidence>& views) {
    if (auto refused = refuse_views(word.name, views)) return nothing(word, *std::move(refused));
    std::vector<localize::MaskedView> votes;
    for (std::size_t v = 0; v < views.size(); ++v)
        if (views[v].step != ViewStep::LeftOut)
            votes.push_back({input_.views[v].camera, vote_of(views[v], threshold()), views[v].failed});
    FoundWord found;
    auto& [field, rule] = found.field;
    field = votes_.back_project(input_.gaussians.spans(), votes, input_.settings, tools_.rasterizer);
    rule = {least_coverage(field, request().coverage_px),
            request().label_smoothness,
            word.alone ? IslandShare : 0,
            input_.up,
            input_.front,
            nature_of(word.name)};
    if (input_.beside != nullptr) leave_out(*input_.beside, field);
    auto decided =
        decide_label(word.name, input_.gaussians, found.field, request().label_threshold, tools_.threads);
    found.label = std::move(decided.label);
    found.beside = std::move(decided.beside);
    if (input_.within != nullptr) keep_within(field, found.label);
    if (auto refused = refuse_label(word.name, found.label)) return nothing(word, *std::move(refused));
    found.verdict = judge({word.name, views, field, found.label, recognised(word.name),
                           ground_seen(views, seen_.grounds), !word.competing.empty()},
                          request().least_confidence);
    return found;
}

void WordSearch::limit(ViewEvidence& view, std::size_t v) const {
    if (within_.empty() || view.failed) return;
    for (std::size_t i = 0; i < view.mask.data.size(); ++i) view.mask.data[i] &= within_[v].data[i];
}

void WordSearch::leave_out(const std::vector<std::uint8_t>& rows, LabelField& field) {
    for (std::size_t row = 0; row < rows.size(); ++row)
        if (rows[row] != 0) field.probability[row] = 0;
}

void WordSearch::keep_within(LabelField& field, Label& label) const {
    auto bits = *label.bits;
    auto weight = *label.weight;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        if ((*input_.within)[row] != 0) continue;
        bits[row] = 0;
        weight[row] = field.probability[row] = 0;
    }
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    label.bits = std::make_shared<const std::vector<std::uint8_t>>(std::move(bits));
}

double WordSearch::recognised(const std::string& word) const {
    if (tools_.recognition == nullptr) return -1;
    std::vector<const Image*> some;
    const std::size_t step = std::max<std::size_t>(1, seen_.renders.size() / RecognisedViews);
    for (std::size_t v = 0; v < seen_.renders.size(); v += step) some.push_back(&seen_.renders[v]);
    const std::string& sentence = request().sentence().before();
    return tools_.recognition->of(language::has_phrase(sentence, word) ? sentence : "a " + word, word, some);
}

}  // namespace gse::edit
