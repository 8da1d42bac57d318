// Refreshing, joining and smoothing of masks.
#include "engine/edit/masks/dynamic_mask.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/edit/masks/word_mask.h"
#include "engine/edit/request/scales.h"
#include "engine/localize/clusters.h"

namespace gse::edit {
namespace {

constexpr float LabelCounts = 0.05f;              // where the label's render counts at all
constexpr double LabelReachPx = 8;                // of a 512-pixel picture
constexpr float Memory = 0.5f;                    // weight of the mask before
constexpr float TurnsOn = 0.6f, TurnsOff = 0.4f;  // hysteresis
constexpr double LargestGrowth = 3;               // times the static area; beyond, the mask has run away

/// Word to look for once the edit shows it: the replacement ("on the snow" that was "on the grass").
std::string word_after(const language::EditSentence& said, std::string word) {
    if (said.sentence().contains(word)) return word;
    return said.sentence().contains(said.target()) ? said.target() : std::string();
}

}  // namespace

DynamicMasks::DynamicMasks(const EditPlan& plan, const CheckedRequest& request, std::string word,
                           AttentionSource* attention, Segmenter* segmenter)
    : plan_(plan), request_(request), word_(word_after(request.sentence(), std::move(word))),
      attention_(attention), segmenter_(segmenter), masks_(plan.masks.size()),
      static_area_(plan.masks.size()), soft_(plan.masks.size()), last_refresh_(plan.masks.size(), -1) {
    for (std::size_t v = 0; v < masks_.size(); ++v) set_static(v, plan.masks[v]);
}

void DynamicMasks::set_static(std::size_t view, Mask mask) {
    soft_[view] = Image(mask.width, mask.height, 1);
    std::copy(mask.data.begin(), mask.data.end(), soft_[view].data.begin());
    static_area_[view] = mask.count();
    masks_[view] = std::move(mask);
}

bool DynamicMasks::due(std::size_t view, int iteration) const {
    if (attention_ == nullptr || !request_.dynamic_mask || word_.empty()) return false;
    if (iteration < request_.dynamic_from * request_.iterations) return false;
    const double every = std::max(1.0, request_.dynamic_every * request_.iterations);
    return last_refresh_[view] < 0 || iteration - last_refresh_[view] >= every;
}

Mask DynamicMasks::found_in(const Image& shown, std::size_t view, int iteration) const {
    const AttentionQuery query{
        shown,
        request_.sentence().prompt(),
        {word_},
        plan_.view_words.empty() ? std::string() : plan_.view_words[view],
        false,
        1,  // one repeat is enough for a mask that is averaged anyway
        Random::stream(request_.seed, 9000 + static_cast<std::uint64_t>(iteration)).next()};
    auto maps = attention_->locate(query);
    GSE_CHECK_EQ(maps.size(), std::size_t{1});
    const double level =
        request_.attention_threshold > 0 ? request_.attention_threshold : attention_->threshold();
    normalise_maximum(maps.front());
    return find_word_mask(shown, maps.front(), level, word_, request_, {segmenter_, nullptr}).mask;
}

void DynamicMasks::refresh(std::size_t view, int iteration, const Image& shown, const Image& label_seen) {
    last_refresh_[view] = iteration;
    const double px = shown.width / ReferenceSide;
    Mask found = found_in(shown, view, iteration);
    const Mask near_label =
        localize::dilate(localize::threshold_map(label_seen, LabelCounts), LabelReachPx * px);
    for (std::size_t i = 0; i < found.data.size(); ++i)
        found.data[i] = found.data[i] != 0 && near_label.data[i] != 0 ? 1 : 0;
    found = localize::dilate(found, request_.dilate_px * px);
    const auto area = static_cast<double>(found.count());
    if (area == 0 || area > LargestGrowth * static_cast<double>(static_area_[view])) {
        ++kept_;
        return;
    }
    ++refreshed_;
    for (std::size_t i = 0; i < found.data.size(); ++i) {
        float& soft = soft_[view].data[i];
        soft = Memory * soft + (1 - Memory) * static_cast<float>(found.data[i]);
        auto& bit = masks_[view].data[i];
        bit = soft > TurnsOn ? 1 : soft < TurnsOff ? 0 : bit;
    }
}

}  // namespace gse::edit
