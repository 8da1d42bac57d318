// A plan being made: which thing a phrase means, and the rules of steps.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/phrases/phrase.h"

namespace gse::language::plan {

/// Thing that a phrase means.
struct Target {
    enum class Kind { There, Made, Missing, Ambiguous } kind = Kind::Missing;
    Reference reference;               // of There and Made
    std::optional<std::size_t> thing;  // index in the scene, when the thing itself is meant, not its part
    std::optional<std::size_t> step;   // of Made: the step that makes it
    std::string word;                  // of Missing: how it was called
    bool found() const { return kind == Kind::There || kind == Kind::Made; }
    bool is_scene() const { return kind == Kind::There && reference.is_scene(); }
};

class Draft {
public:
    Draft(const SceneWords& scene, std::string_view source);

    const SceneWords& scene() const { return *scene_; }
    /// Thing that the sentence is about when it says nothing else: that of the source, or the only one.
    Target focus() const;
    /// Tells whether the sentence is about the ground.
    bool is_on_ground() const { return focus_ && scene_->things[*focus_].is_ground; }
    bool has_focus() const { return focus_.has_value(); }
    bool source_missing() const { return source_missing_; }
    const std::string& source_word() const { return source_word_; }
    Target target_of_thing(std::size_t index) const;
    Target scene_target() const;
    Target ground_target() const;

    /// Thing of the scene, or made before, that the phrase names.
    Target resolve(const Phrase& phrase) const;
    /// All that a phrase names: two of one kind without a word that tells them apart are one target each.
    std::vector<Target> resolve_all(const Phrase& phrase) const;
    /// Index of the thing of the scene with that noun, synonyms among them.
    std::vector<std::size_t> things_named(const Phrase& phrase) const;
    bool is_animate(const Target& target) const;
    /// Tells whether clothes go on it: animals, persons, statues, toys.
    bool can_wear(const Target& target) const;
    /// Thing that the phrase names by another species of the same noun ("polar bear").
    std::optional<std::size_t> kin_of(const Phrase& phrase) const;

    void mention(const Target& target) { last_ = target; }
    const std::optional<Target>& last() const { return last_; }
    Target pronoun(Naming naming, bool bearer = false) const;

    void apply(const Target& target, const Attribute& attribute);
    void deny(const Target& target, const Attribute& attribute);
    /// Tells whether the scene shows the target so already.
    bool is_so(const Target& target, const Attribute& attribute) const;
    void step(Operation operation, const Target& target, std::string text = {}, std::string text2 = {});
    void move(const Target& target, std::string change, const Target& other);
    Target replace(const Target& target, const Phrase& phrase);
    Target add(const Phrase& phrase, std::string_view relation, const std::vector<Target>& anchors);
    void set_anchors(const Target& made, std::string_view relation, const std::vector<Target>& anchors);
    void set_anchor(const Target& made, std::string_view relation, const Target& anchor);
    /// `another`: what is called by a name of the old ground is another ground too ("tiles" for a floor).
    void ground(const Phrase& phrase, bool another = false);
    void remove(const Target& target);
    void duplicate(const Target& target, std::string count);
    void environment(std::string text);
    void style(const Target& target, std::string text);
    /// Things added from that step on without a place stand where the last one does ("a cup and a plate on
    /// the table").
    void share_place(std::size_t from);
    /// Tells whether the target is added to the scene without a place.
    bool stands_nowhere(const Target& made) const;
    /// Tells whether a step changes a thing as a whole, and not a part of it.
    bool changes_whole() const;
    /// Tells whether a step puts another thing in its place.
    bool replaces(const Target& target) const;
    /// Leaves the thing out of the steps from that one on, which are about all of its kind.
    void leave_out(const Target& target, std::size_t from);
    void refuse(std::string_view reason, std::string_view word = {});
    void contradict() { contradicted_ = true; }
    void already_so() { same_ = true; }
    void nothing_asked() { asked_nothing_ = true; }
    /// Tells whether the last step makes the target.
    bool last_is(const Target& made) const { return made.step && *made.step + 1 == steps_.size(); }
    /// Thing that the last step removes.
    std::optional<Target> removed_last() const;
    bool is_removed(const Target& target) const;
    /// Takes the last step back ("no wait", "take it off again").
    void drop_last();
    std::size_t size() const { return steps_.size(); }
    bool asked_nothing() const { return asked_nothing_; }
    bool says_same() const { return same_; }

    Plan finish() const;

private:
    void push(Step step);
    bool contradicts() const;
    bool may_have(const Target& owner, const Phrase& phrase) const;
    Target part_target(const Target& owner, const Phrase& phrase) const;
    Target of_several(const Phrase& phrase, const std::vector<std::size_t>& found) const;
    bool is_plural(const Target& target) const;
    std::optional<Target> ordinal(const Phrase& phrase) const;
    Target owned(const Phrase& phrase) const;
    std::optional<Target> told_thing(const Phrase& phrase) const;
    std::optional<Target> made_named(const Phrase& phrase) const;
    const SceneWords* scene_;
    std::optional<std::size_t> focus_;
    bool source_missing_ = false;
    std::string source_word_;
    std::vector<Step> steps_;
    std::optional<Target> last_;
    std::vector<Step> denied_;
    bool same_ = false, asked_nothing_ = false, contradicted_ = false;
};

/// Tells whether the word names a part of a thing rather than clothes.
bool is_part(const Phrase& phrase);
bool is_worn(const Phrase& phrase);
bool is_held(const Phrase& phrase);
bool is_ground(const Phrase& phrase);
/// Tells whether the noun names something with a shape, and not an idea, a quality or an unknown word.
bool is_thing(const Phrase& phrase);

}  // namespace gse::language::plan
