// A sentence, parsed once, and what it says of the thing that an edit is about.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/language/lexicon.h"

namespace gse::language {

/// A noun phrase of a sentence: "a red hat" of "a bear wearing a red hat".
struct NounPhrase {
    std::size_t begin = 0;                // index of its first term
    std::string joint;                    // term before that: "wearing"; empty at the sentence's beginning
    std::vector<std::string> attributes;  // "red"
    std::string head;                     // "hat"
};

/// The words of a prompt. Phrases are words with one blank between them, in lower case.
class Sentence {
public:
    Sentence() = default;
    explicit Sentence(std::string_view prompt);

    /// Lower-case words with one blank between them: the prompt as models are told it.
    const std::string& prompt() const { return prompt_; }
    const std::vector<std::string>& words() const { return words_; }
    bool empty() const { return words_.empty(); }
    /// Tells whether the phrase's words follow one another in it.
    bool contains(std::string_view phrase) const;
    /// Index of the phrase's first word; the number of words where it is not in the sentence.
    std::size_t position_of(std::string_view phrase) const;
    /// Words, with compound prepositions and each of the phrases as one entry.
    std::vector<std::string> terms(const std::vector<std::string>& phrases) const;
    /// Noun phrases in their order; one of `phrases` ("teddy bear") counts as one word.
    std::vector<NounPhrase> noun_phrases(const std::vector<std::string>& phrases = {}) const;
    /// The things that it names, each once: heads of noun phrases, without those that say what another is
    /// made of, or becomes.
    std::vector<std::string> things(const std::vector<std::string>& phrases = {}) const;

private:
    std::vector<std::string> words_;
    std::string prompt_;
};

/// Kind of an edit: change of colour, material or style; addition beside something; replacement; removal;
/// change of place, size or number.
enum class EditMode { Modify, Add, Replace, Remove, Transform };

/// True for edits in which a model draws. The others only look for their thing.
constexpr bool is_drawn(EditMode mode) { return mode != EditMode::Remove && mode != EditMode::Transform; }

/// A sentence as it is read for an edit of `source`, in which `target` is new; both phrases are in lower
/// case.
class EditSentence {
public:
    EditSentence() = default;
    EditSentence(Sentence sentence, std::string source, std::string target);

    const Sentence& sentence() const { return sentence_; }
    /// The prompt as models are told it.
    const std::string& prompt() const { return sentence_.prompt(); }
    const std::string& source() const { return source_; }
    const std::string& target() const { return target_; }
    /// Sentence before the edit: without the target, or without the phrase that brings it ("wearing a red
    /// hat"). If the target stands in the source's place ("into a panda"), it has the source instead.
    const std::string& before() const { return before_; }
    /// Things that the sentence before the edit names (Sentence::things()).
    std::vector<std::string> things_before(const std::vector<std::string>& phrases) const;
    /// Object that replaces the source ("cat" of "a red cat on the grass" for a bear). Empty if the sentence
    /// keeps the source, or changes the ground.
    const std::string& replacement() const { return replacement_; }
    /// Direction of the target, seen from the source.
    Relation relation() const { return relation_; }

    /// The sentence with another new phrase.
    EditSentence with_target(std::string target) const;
    /// Another prompt for the edit of that source, with its own name for what is new.
    EditSentence reworded(std::string_view prompt, std::string target) const;

private:
    Sentence sentence_;
    std::string source_, target_, before_, replacement_;
    Relation relation_ = Relation::None;
};

/// The mode that was asked for, else the one that the sentence states, and the reason.
/// `target_found_share`: of the views in which a text segmenter sees the target; nothing without one.
std::pair<EditMode, std::string> decide_mode(const EditSentence& words, std::optional<EditMode> asked,
                                             std::optional<double> target_found_share = std::nullopt);

/// Thing with a shape of its own after an edit of that mode: the replacement of the source, or the target.
const std::string& new_thing(const EditSentence& words, EditMode mode);

/// Caption of pictures of the scene while a model learns it: "a photo of a bear", with the identifier where
/// the sentence has one ("a photo of a * bear").
std::string instance_prompt(const EditSentence& words);

/// Instruction for a model that edits pictures by instructions: "turn the <source> into <prompt without its
/// article>". Without a source: "make it <prompt without its article>".
std::string instruction_for(const Sentence& sentence, const std::string& source);

}  // namespace gse::language
