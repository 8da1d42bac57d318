// A request whose words are complete and whose values are in range: the form in which stages of a run get it.
#pragma once

#include <optional>
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

/// A request that check() made, or one of this class from another. Settings may be changed; the words are one
/// parsed sentence. It is no EditRequest, so that nothing can parse its text again.
class CheckedRequest : public EditSettings {
public:
    /// Mode that was asked for; nothing = the sentence tells it.
    std::optional<EditMode> mode;

    const language::EditSentence& sentence() const { return sentence_; }
    const std::string& source() const { return sentence_.source(); }
    const std::string& target() const { return sentence_.target(); }
    /// The prompt as it was typed. Models are told sentence().prompt().
    const std::string& prompt() const { return prompt_; }
    /// Thing that the source is a part of; empty = it is a thing of its own.
    const std::string& part_of() const { return part_of_; }
    /// Everything changes its look; nothing is looked for.
    bool whole_scene() const { return whole_scene_; }
    /// Other thing that a transform is relative to; empty = none.
    const std::string& anchor() const { return anchor_; }
    /// True for an edit that looks for its thing and has no model draw anything.
    bool is_rearranged() const { return mode && !is_drawn(*mode); }
    /// Nobody has chosen the target: it was guessed, and pictures may know better.
    bool target_open() const { return target_open_; }

    /// The text with source and target completed and normalised; the prompt is as it was typed.
    EditWords words() const;
    /// The request as it is written.
    EditRequest plain() const;

    /// The request with another new phrase of its sentence.
    CheckedRequest with_target(std::string target) const;
    /// The request in other words: what a model is told in place of what was typed.
    CheckedRequest reworded(std::string prompt, std::string target) const;
    /// Search for another `thing` of the sentence, in a scene that shows nothing of the target yet: by the
    /// sentence before the edit, in mode modify.
    CheckedRequest search_for(std::string thing) const;
    /// Search for the anchor, in mode modify.
    CheckedRequest search_for_anchor() const;
    /// Search for the thing that the source is a part of: the sentence without the part ("a bear on the
    /// grass" of "a bear with blue ears on the grass").
    CheckedRequest search_for_whole() const;
    /// The request for a model without a word for the part: the thing itself gets the look ("a blue bear").
    CheckedRequest in_look_of_whole() const;

private:
    friend CheckedRequest check(EditRequest request, const News& news);
    CheckedRequest(const EditRequest& request, language::Sentence sentence, bool target_open);

    std::string prompt_;
    language::EditSentence sentence_;
    std::string part_of_;
    bool whole_scene_ = false;
    std::string description_, anchor_;
    bool target_open_ = false;
};

/// Fills in an open target where a source is named. The only place that guesses a target. It takes
/// `news.read_target`, else the word of the sentence that is new beside `news.said`.
EditRequest with_target(EditRequest request, const News& news);

/// Completes the words and checks all values. A sentence with everything left open takes the words of its
/// plan (sentence_plan.h). Throws Error (InvalidArgument) for an empty prompt, for neither source nor target,
/// for a target that is not in the prompt, and for an unknown mode, method or quality. It throws, too, for a
/// sentence that is no single edit.
CheckedRequest check(EditRequest request, const News& news = {});

/// The search for the source alone, for a sentence that cannot be edited by: "a bear".
EditRequest source_alone(EditRequest request);

/// The order for a model that edits pictures by instructions (InstructPix2Pix): the request's instruction;
/// without one language::instruction_for().
std::string instruction_of(const CheckedRequest& request);

}  // namespace gse::edit
