// Changes of one sentence, made one after another: those to come, and the outcomes of the finished ones.
#include "app/session/edit/step_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/session/state/edit_scope.h"
#include "engine/language/words.h"
#include "engine/scene/row_values.h"

namespace gse::app {

void StepChain::begin(std::string sentence, edit::StepProgress steps, const DocumentState& state,
                      std::uint64_t first_id) {
    *this = {};
    sentence_ = std::move(sentence);
    steps_ = std::move(steps);
    begun_ = state_ = state;
    first_id_ = first_id;
}

bool StepChain::take(PendingResult result) {
    if (!result.failed.empty() && several()) {
        failed_.push_back(std::move(result));
        steps_.leave_out(at_);
    } else {
        for (auto& word : language::words_of(step().target)) words_.push_back(std::move(word));
        state_ = applied(state_, result, first_id_ + done_.size());
        steps_.take(at_);
        done_.push_back(std::move(result));
    }
    do ++at_;
    while (runs() && !steps_.step(at_).words);  // one that rested on what failed
    return runs();
}

PendingResult StepChain::end() {
    StepChain ended = std::exchange(*this, {});
    if (ended.done_.empty()) return ended.failed_.empty() ? PendingResult{} : ended.failed_.back();
    PendingResult whole =
        ended.done_.size() == 1 ? ended.done_.front() : together(ended.done_, ended.sentence_);
    whole.asked = ended.steps_.size();
    for (const auto& failed : ended.failed_)
        whole.kept_out.push_back(fmt::format("{}: {}", failed.name, failed.failed));
    return whole;
}

std::string StepChain::said() const {
    return several() ? fmt::format("step {} of {}", at_ + 1, steps_.size()) : std::string();
}

std::vector<std::uint8_t> StepChain::source_found() const {
    const auto& words = step();
    if (!words.part_of.empty() || words.whole_scene) return {};
    const bool among = std::any_of(done_.begin(), done_.end(), [&](const auto& change) {
        return change.label && change.label->found_for == words.source && change.renamed.to.empty();
    });
    const auto label = std::find_if(state_.labels.begin(), state_.labels.end(),
                                    [&](const auto& one) { return is_label_of(one, words.source); });
    return among && label != state_.labels.end() ? *label->bits : std::vector<std::uint8_t>{};
}

std::vector<std::int64_t> StepChain::rows() const { return row_map(*begun_.row_ids, *state_.row_ids); }

}  // namespace gse::app
