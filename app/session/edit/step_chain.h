// Changes of one sentence, made one after another: those to come, and the outcomes of the finished ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/session/state/pending_result.h"
#include "engine/edit/request/step_progress.h"
#include "engine/scene/document.h"

namespace gse::app {

class StepChain {
public:
    /// Begins with the document as it is. `first_id`: identity of the first edit on the stack.
    void begin(std::string sentence, edit::StepProgress steps, const DocumentState& state,
               std::uint64_t first_id);
    /// Takes the outcome of the step that ran, and goes on to the next one. An outcome that failed is kept
    /// out. False behind the last step.
    bool take(PendingResult result);
    /// Ends it: the finished steps as one result. Without any it is the one that failed, or an empty one.
    PendingResult end();

    bool runs() const { return at_ < steps_.size(); }
    bool several() const { return steps_.size() > 1; }
    std::size_t finished() const { return done_.size(); }
    /// True from the second finished step on: its scene is not the document's.
    bool beyond_first() const { return !done_.empty(); }
    const language::plan::StepSentence& step() const { return *steps_.step(at_).words; }
    /// "step 2 of 3"; empty for a single one.
    std::string said() const;
    /// The document as the finished steps leave it.
    const DocumentState& state() const { return state_; }
    /// Words that the finished steps have put into the scene.
    const std::vector<std::string>& words() const { return words_; }
    /// The source of the step in state(), [rows] 0 or 1, where a finished step has found it; else empty.
    std::vector<std::uint8_t> source_found() const;
    /// Row in state() of each row of the document.
    std::vector<std::int64_t> rows() const;

private:
    std::string sentence_;
    edit::StepProgress steps_;
    std::size_t at_ = 0;
    std::vector<PendingResult> done_, failed_;
    DocumentState begun_, state_;
    std::uint64_t first_id_ = 0;
    std::vector<std::string> words_;
};

}  // namespace gse::app
