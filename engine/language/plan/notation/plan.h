// A plan: one sentence as an ordered list of operations, and its notation.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gse::language::plan {

enum class Operation {
    Recolour,
    Material,
    Pattern,
    Transform,
    Pose,
    Alter,
    Ground,
    Remove,
    Replace,
    Add,
    Duplicate,
    Style,
    Environment,
    None,
    Refuse
};

/// Name of an operation in the notation ("recolour").
std::string_view name_of(Operation operation);

/// A noun with count and attributes: a new thing, or one link of a reference.
struct Thing {
    std::string noun;
    std::string count;  // "2", "some", "all"; empty for one
    std::vector<std::string> attributes;
    bool operator==(const Thing&) const = default;
};

/// Something that is there: "ear{left} of bear", "scene", "scene except bear". The part stands first.
struct Reference {
    std::vector<Thing> links;  // without "except": those of the thing itself
    bool except = false;       // everything but the thing
    bool operator==(const Reference&) const = default;
    bool is_scene() const { return !except && links.size() == 1 && links[0].noun == "scene"; }
    /// The thing itself, whose part may be meant.
    const std::string& root() const { return links.back().noun; }
};

Reference scene_reference();

/// One operation; which members say something depends on it.
struct Step {
    Operation operation = Operation::None;
    Reference subject;               // what is changed; of Ground: the old one in `text2`
    std::string text;                // colour, material, pattern, change, pose, look, style, count, reason
    std::string text2;               // colour of a pattern; old ground ("-" = none); word of "not in scene"
    Thing thing;                     // new thing of Ground, Replace and Add
    std::string relation;            // of Add
    std::vector<Reference> anchors;  // of Add; of Transform: the other thing
    bool operator==(const Step&) const = default;
};

/// Reasons of none and refuse, as the notation spells them.
namespace reason {
inline constexpr std::string_view AlreadySo = "already so", NothingAsked = "nothing asked", Empty = "empty",
                                  NotASentence = "not a sentence", Question = "question",
                                  Language = "language", Contradiction = "contradiction",
                                  Ambiguous = "ambiguous", Incomplete = "incomplete",
                                  NotAnEdit = "not an edit", NotInScene = "not in scene";
}  // namespace reason

/// Operations in the order in which they are done; never empty.
struct Plan {
    std::vector<Step> steps;
    bool operator==(const Plan&) const = default;
    /// Tells whether nothing of it is to be done: a refusal alone, or nothing to change.
    bool is_refusal() const;
};

Plan refusal(std::string_view reason, std::string_view word = {});

std::string to_string(const Thing& thing);
std::string to_string(const Reference& reference);
std::string to_string(const Step& step);
/// The plan in the notation: "recolour(bear, blue) ; add(hat{red}, worn by, bear)".
std::string to_string(const Plan& plan);

}  // namespace gse::language::plan
