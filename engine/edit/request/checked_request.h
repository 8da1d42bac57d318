// A request whose words are complete and whose values are in range.
#pragma once

#include <string>
#include <vector>

#include "engine/edit/request/request.h"
#include "engine/language/sentence.h"

namespace gse::edit {

/// Knowledge about the news of a sentence besides its words.
struct News {
    std::vector<std::string> said = {};  // words that the scene shows already: no news
    std::string read_target = {};  // word that a search of this sentence saw to be new; empty = none has
};

/// Only check() makes one. Its settings may still be changed; its words are read through words(), which
/// parsed them once.
class CheckedRequest : public EditRequest {
public:
    /// The request with source and target completed and normalised; the prompt is as it was typed.
    const EditRequest& plain() const { return *this; }
    const language::EditSentence& words() const { return words_; }
    /// Nobody has chosen the target: it was guessed, and pictures may know better.
    bool target_open() const { return target_open_; }

private:
    friend CheckedRequest check(EditRequest request, const News& news);
    CheckedRequest(EditRequest request, language::Sentence sentence, bool target_open);

    using EditWords::prompt;
    using EditWords::source;
    using EditWords::target;
    language::EditSentence words_;
    bool target_open_ = false;
};

/// Fills in an open target where a source is named. The only place that guesses a target. It takes
/// `news.read_target`, else the word of the sentence that is new beside `news.said`.
EditRequest with_target(EditRequest request, const News& news);

/// Completes the words and checks all values. Throws Error (InvalidArgument): an empty prompt, neither source
/// nor target, a target that is not in the prompt, an unknown mode, method or quality.
CheckedRequest check(EditRequest request, const News& news = {});

/// The search for the source alone, for a sentence that cannot be edited by: "a bear".
EditRequest source_alone(EditRequest request);

}  // namespace gse::edit
