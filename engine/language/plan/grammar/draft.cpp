// Steps of a plan and the rules that they follow.
#include "engine/language/plan/grammar/draft.h"

#include <algorithm>
#include <map>

namespace gse::language::plan {
namespace {

std::string canonical(std::string_view word) {
    if (const auto material = meaning(Class::material, word)) return std::string(*material);
    if (const auto surface = meaning(Class::material_surface, word)) return std::string(*surface);
    return std::string(word);
}

constexpr std::pair<std::string_view, std::string_view> Opposites[] = {{"bigger", "smaller"},
                                                                       {"taller", "shorter"},
                                                                       {"wider", "narrower"},
                                                                       {"thicker", "thinner"},
                                                                       {"longer", "shorter"},
                                                                       {"move left", "move right"},
                                                                       {"move up", "move down"},
                                                                       {"move forward", "move back"},
                                                                       {"lighter", "darker"},
                                                                       {"brighter", "darker"},
                                                                       {"more saturated", "less saturated"},
                                                                       {"older", "younger"},
                                                                       {"old", "young"},
                                                                       {"round", "square"},
                                                                       {"happy", "sad"},
                                                                       {"open", "closed"},
                                                                       {"sitting", "standing"},
                                                                       {"night", "day"}};

bool opposite(std::string_view a, std::string_view b) {
    return std::any_of(std::begin(Opposites), std::end(Opposites), [&](const auto& pair) {
        return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
    });
}

int rank(Operation operation) {
    switch (operation) {
        case Operation::Remove: return 2;
        case Operation::Replace: return 3;
        case Operation::Add:
        case Operation::Duplicate: return 4;
        case Operation::Style:
        case Operation::Environment: return 5;
        case Operation::None: return 6;
        case Operation::Refuse: return 7;
        default: return 1;
    }
}

Operation operation_for(Quality quality) {
    switch (quality) {
        case Quality::Colour:
        case Quality::Shift: return Operation::Recolour;
        case Quality::Material:
        case Quality::Surface: return Operation::Material;
        case Quality::Pattern: return Operation::Pattern;
        case Quality::Size: return Operation::Transform;
        case Quality::Pose: return Operation::Pose;
        case Quality::Style: return Operation::Style;
        default: return Operation::Alter;
    }
}

}  // namespace

Target Draft::scene_target() const {
    return {Target::Kind::There, scene_reference(), std::nullopt, std::nullopt, ""};
}

Target Draft::ground_target() const {
    const auto ground = scene_->ground();
    return ground ? target_of_thing(*ground) : Target{};
}

void Draft::push(Step step) {
    if (std::find(steps_.begin(), steps_.end(), step) == steps_.end()) steps_.push_back(std::move(step));
}

bool Draft::is_so(const Target& target, const Attribute& attribute) const {
    if (!target.thing) return false;
    const auto& told = scene_->things[*target.thing].attributes;
    return std::any_of(told.begin(), told.end(), [&](const std::string& word) {
        return word == attribute.value || word == attribute.typed || canonical(word) == attribute.value;
    });
}

void Draft::apply(const Target& target, const Attribute& attribute) {
    if (attribute.quality == Quality::Side || !target.found()) return;
    if (attribute.quality == Quality::Worn || attribute.quality == Quality::Unworn) {
        Phrase phrase;
        phrase.noun = attribute.value;
        phrase.typed = attribute.value;
        if (attribute.quality == Quality::Worn) {
            add(phrase, "worn by", {target});
            return;
        }
        const auto found = things_named(phrase);
        if (!found.empty()) remove(target_of_thing(found.front()));
        else if (is_part(phrase) && target.kind == Target::Kind::There) remove(part_target(target, phrase));
        else same_ = true;
        return;
    }
    if (const auto [how, part] = described_part(attribute.value);
        !part.empty() && target.kind == Target::Kind::There) {  // "a blue-eyed bear"
        Phrase whose;
        whose.noun = whose.typed = part;
        const auto of = part_target(target, whose);
        if (const auto size = meaning(Class::size, how)) step(Operation::Transform, of, std::string(*size));
        else if (has(Class::colour, how) && !has(Class::material, how)) step(Operation::Recolour, of, how);
        else step(Operation::Material, of, std::string(meaning(Class::material, how).value_or(how)));
        return;
    }
    if (target.kind == Target::Kind::Made && attribute.quality != Quality::Pose) {
        auto& attributes = steps_[*target.step].thing.attributes;
        const auto text = brace_text(attribute);
        if (steps_[*target.step].operation == Operation::Duplicate) return;
        if (std::find(attributes.begin(), attributes.end(), text) == attributes.end())
            attributes.push_back(text);
        return;
    }
    const bool change = attribute.quality == Quality::Colour || attribute.quality == Quality::Material ||
                        attribute.quality == Quality::Surface || attribute.quality == Quality::Size ||
                        attribute.quality == Quality::State;
    if (change && is_so(target, attribute)) {
        same_ = true;
        std::erase_if(steps_, [&](const Step& step) {                      // "make it blue, then red again"
            const bool surface = has(Class::material_surface, step.text);  // "a mossy stone statue"
            return step.operation == operation_for(attribute.quality) && step.subject == target.reference &&
                   step.anchors.empty() && surface == (attribute.quality == Quality::Surface);
        });
        return;
    }
    step(operation_for(attribute.quality), target, attribute.value,
         attribute.quality == Quality::Pattern ? attribute.colour : std::string());
}

void Draft::deny(const Target& target, const Attribute& attribute) {
    Step denied;
    denied.operation = operation_for(attribute.quality);
    denied.subject = target.reference;
    denied.text = attribute.value;
    denied_.push_back(denied);
}

void Draft::step(Operation operation, const Target& target, std::string text, std::string text2) {
    Step made;
    made.operation = operation;
    made.subject = target.reference;
    made.text = std::move(text);
    made.text2 = std::move(text2);
    if (made.text.starts_with("face ") && !steps_.empty() && steps_.back().text == "rotate" &&
        steps_.back().subject == made.subject)
        steps_.pop_back();  // "rotate it so that it looks to the left"
    push(made);
}

void Draft::move(const Target& target, std::string change, const Target& other) {
    Step made;
    made.operation = Operation::Transform;
    made.subject = target.reference;
    made.text = std::move(change);
    made.anchors = {other.reference};
    push(made);
}

Target Draft::replace(const Target& target, const Phrase& phrase) {
    if (target.thing && !phrase.noun.empty() && !phrase.another) {
        const auto& noun = scene_->things[*target.thing].noun;
        if (phrase.noun == noun &&
            (phrase.count.empty() || phrase.count == "all")) {  // with itself: how it is
            if (phrase.attributes.empty()) same_ = true;
            for (const auto& attribute : phrase.attributes) apply(target, attribute);
            return target;
        }
        if (phrase.noun == noun && !phrase.count.empty()) {  // "make it two bears"
            for (const auto& attribute : phrase.attributes) apply(target, attribute);
            duplicate(target, phrase.count);
            return target;
        }
    }
    Step made;
    made.operation = Operation::Replace;
    made.subject = target.reference;
    made.thing = thing_of(phrase);
    if (made.thing.count == "some" && phrase.count.empty() && target.reference.links.front().count == "all")
        made.thing.count.clear();                  // "turn both bears into cats"
    std::erase_if(steps_, [&](const Step& step) {  // "remove it and put a tree in its place"
        return step.operation == Operation::Remove && step.subject == target.reference;
    });
    push(made);
    Target result{
        Target::Kind::Made, {{{made.thing.noun, "", {}}}, false}, std::nullopt, steps_.size() - 1, ""};
    for (const auto& attribute : phrase.attributes)
        if (attribute.quality == Quality::Worn) apply(result, attribute);
    return result;
}

Target Draft::add(const Phrase& phrase, std::string_view relation, const std::vector<Target>& anchors) {
    const auto found = things_named(phrase);
    const bool there = !found.empty() && !phrase.another && phrase.count.empty() && !phrase.plural;
    if (there && relation == "worn by") {
        const auto target = target_of_thing(found.front());
        same_ = true;
        for (const auto& attribute : phrase.attributes) apply(target, attribute);
        return target;
    }
    Step made;
    made.operation = Operation::Add;
    made.thing = thing_of(phrase);
    made.relation = relation;
    for (const auto& anchor : anchors) made.anchors.push_back(anchor.reference);
    if (made.anchors.empty()) made.anchors.push_back(scene_reference());
    steps_.push_back(made);
    return {Target::Kind::Made, {{{made.thing.noun, "", {}}}, false}, std::nullopt, steps_.size() - 1, ""};
}

void Draft::set_anchors(const Target& made, std::string_view relation, const std::vector<Target>& anchors) {
    if (!made.step) return;
    auto& step = steps_[*made.step];
    if (step.operation != Operation::Add) return;
    step.relation = relation;
    Phrase clothes;
    clothes.noun = clothes.typed = step.thing.noun;
    if (relation == "on" && anchors.size() == 1 && anchors.front().thing && is_worn(clothes) &&
        can_wear(anchors.front()))
        step.relation = "worn by";  // "two hats on the bear"
    if (relation == "above" && has(Class::cloth, step.thing.noun.substr(step.thing.noun.rfind(' ') + 1)))
        step.relation = "on";  // "a blanket over the sofa"
    step.anchors.clear();
    for (const auto& anchor : anchors) step.anchors.push_back(anchor.reference);
    if (relation != "between" || anchors.size() != 1) return;
    const auto of_all = anchors.front().reference.links.front();  // "between the cars"
    step.anchors.clear();
    for (std::size_t i = 0; of_all.count == "all" && i < scene_->things.size(); ++i)
        if (scene_->things[i].noun == of_all.noun) step.anchors.push_back(target_of_thing(i).reference);
    if (step.anchors.size() == 2) return;
    step.relation = "beside";
    step.anchors = {anchors.front().reference};
}

void Draft::set_anchor(const Target& made, std::string_view relation, const Target& anchor) {
    set_anchors(made, relation, {anchor});
}

void Draft::ground(const Phrase& phrase, bool another) {
    const auto old = scene_->ground();
    Step made;
    made.operation = Operation::Ground;
    made.text2 = old ? scene_->things[*old].noun : "-";
    made.thing = thing_of(phrase);
    made.thing.count.clear();
    if (!phrase.typed.empty() && phrase.plural) made.thing.noun = phrase.typed;
    if (old && (made.thing.noun == made.text2 || (!another && are_synonyms(made.text2, made.thing.noun)))) {
        same_ = true;
        for (const auto& attribute : phrase.attributes) apply(target_of_thing(*old), attribute);
        return;
    }
    if (old)
        std::erase_if(steps_, [&](const Step& step) {  // "no grass, snow"
            return step.operation == Operation::Remove && step.subject == target_of_thing(*old).reference;
        });
    push(made);
}

void Draft::remove(const Target& target) { step(Operation::Remove, target); }

void Draft::duplicate(const Target& target, std::string count) {
    step(Operation::Duplicate, target, std::move(count));
}

void Draft::environment(std::string text) { step(Operation::Environment, scene_target(), std::move(text)); }

void Draft::style(const Target& target, std::string text) { step(Operation::Style, target, std::move(text)); }

void Draft::refuse(std::string_view reason, std::string_view word) {
    Step made;
    made.operation = Operation::Refuse;
    made.text = reason;
    made.text2 = word;
    push(made);
}

void Draft::share_place(std::size_t from) {
    if (from + 1 >= steps_.size()) return;
    const auto& last = steps_.back();
    const bool placed = last.operation == Operation::Add && last.anchors.size() == 1 &&
                        !last.anchors.front().is_scene() && last.relation != "worn by" &&
                        last.relation != "held by";
    if (!placed) return;
    const auto& whose = last.anchors.front().root();
    const bool at_new =
        std::any_of(steps_.begin(), steps_.end(), [&](const Step& step) { return step.thing.noun == whose; });
    for (std::size_t i = from; !at_new && i + 1 < steps_.size(); ++i) {
        auto& step = steps_[i];
        if (step.operation != Operation::Add || step.anchors.size() != 1 || !step.anchors.front().is_scene())
            continue;
        step.relation = last.relation;
        step.anchors = last.anchors;
    }
}

bool Draft::stands_nowhere(const Target& made) const {
    if (!made.step) return false;
    const auto& step = steps_[*made.step];
    return step.operation == Operation::Add && step.anchors.size() == 1 && step.anchors.front().is_scene();
}

bool Draft::changes_whole() const {
    return std::any_of(steps_.begin(), steps_.end(), [](const Step& step) {
        return step.subject.links.size() == 1 && rank(step.operation) == 1;
    });
}

bool Draft::replaces(const Target& target) const {
    return std::any_of(steps_.begin(), steps_.end(), [&](const Step& step) {
        return step.operation == Operation::Replace && step.subject == target.reference;
    });
}

void Draft::leave_out(const Target& target, std::size_t from) {
    const auto& noun = target.reference.links.front().noun;
    std::vector<Step> left(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(from));
    for (std::size_t at = from; at < steps_.size(); ++at) {
        auto step = steps_[at];
        const bool changes = step.operation != Operation::Add && step.operation != Operation::Environment;
        if (!changes || step.subject == target.reference) {
            if (!changes) left.push_back(step);
            continue;
        }
        if (step.subject.is_scene()) {
            step.subject = target.reference;
            step.subject.except = true;
        }
        const bool of_all = !step.subject.links.empty() && step.subject.links.front().count == "all" &&
                            step.subject.links.front().noun == noun && target.thing;
        if (!of_all) {
            left.push_back(step);
            continue;
        }
        for (std::size_t i = 0; i < scene_->things.size(); ++i) {
            if (scene_->things[i].noun != noun || i == *target.thing) continue;
            step.subject = target_of_thing(i).reference;
            left.push_back(step);
        }
    }
    steps_ = std::move(left);
}

std::optional<Target> Draft::removed_last() const {
    if (steps_.empty() || steps_.back().operation != Operation::Remove) return std::nullopt;
    for (std::size_t i = 0; i < scene_->things.size(); ++i)
        if (target_of_thing(i).reference == steps_.back().subject) return target_of_thing(i);
    return std::nullopt;
}

bool Draft::is_removed(const Target& target) const {
    return std::any_of(steps_.begin(), steps_.end(), [&](const Step& step) {
        return step.operation == Operation::Remove && step.subject == target.reference;
    });
}

void Draft::drop_last() {
    if (!steps_.empty()) steps_.pop_back();
    last_.reset();
}

bool Draft::contradicts() const {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        const auto& a = steps_[i];
        for (const auto& denied : denied_)
            if (a.operation == denied.operation && a.subject == denied.subject && a.text == denied.text)
                return true;
        for (std::size_t j = 0; a.operation == Operation::Remove && j < steps_.size(); ++j) {
            const auto& b = steps_[j];
            const bool on_removed =
                std::find(b.anchors.begin(), b.anchors.end(), a.subject) != b.anchors.end();
            if (i != j && (b.subject == a.subject || on_removed)) return true;
        }
        for (std::size_t j = i + 1; j < steps_.size(); ++j) {
            const auto& b = steps_[j];
            if (a.operation == Operation::Ground && b.operation == Operation::Ground) return true;
            if (a.operation != b.operation || !(a.subject == b.subject)) continue;
            if (opposite(a.text, b.text)) return true;
            const bool colours =
                a.operation == Operation::Recolour && has(Class::shift, a.text) == has(Class::shift, b.text);
            const bool materials = a.operation == Operation::Material && has(Class::material, a.text) &&
                                   has(Class::material, b.text);
            if ((colours || materials || a.operation == Operation::Replace) && a.text != b.text) return true;
            if (a.operation == Operation::Replace) return true;
        }
    }
    return false;
}

Plan Draft::finish() const {
    if (contradicted_ || contradicts()) return refusal(reason::Contradiction);
    Plan plan;
    if (steps_.empty()) {
        for (const auto& denied : denied_)  // "no red": of a red bear
            for (std::size_t i = 0; i < scene_->things.size(); ++i)
                if (target_of_thing(i).reference == denied.subject &&
                    is_so(target_of_thing(i), {Quality::Colour, denied.text, denied.text, ""}))
                    return refusal(reason::Incomplete);
        Step none;
        none.operation = Operation::None;
        none.text = asked_nothing_ && !same_ ? reason::NothingAsked : reason::AlreadySo;
        plan.steps = {none};
        return plan;
    }
    std::vector<std::string> made;
    for (const auto& step : steps_)
        if (!step.thing.noun.empty() && step.operation != Operation::Ground) made.push_back(step.thing.noun);
    const auto on_made = [&](const Step& step) {
        const bool there =
            step.subject.links.empty() ||
            std::any_of(scene_->things.begin(), scene_->things.end(),
                        [&](const SceneThing& thing) { return thing.noun == step.subject.root(); });
        return !there && rank(step.operation) == 1 &&
               std::find(made.begin(), made.end(), step.subject.root()) != made.end();
    };
    plan.steps = steps_;
    std::stable_sort(plan.steps.begin(), plan.steps.end(), [&](const Step& a, const Step& b) {
        const int first = on_made(a) ? 4 : rank(a.operation), second = on_made(b) ? 4 : rank(b.operation);
        return first < second;
    });
    const auto stands_by = [](const Step& step, const Step& other) {
        return step.operation == Operation::Add && other.operation == Operation::Add &&
               std::any_of(step.anchors.begin(), step.anchors.end(),
                           [&](const Reference& anchor) { return anchor.root() == other.thing.noun; });
    };
    for (std::size_t i = 0; i + 1 < plan.steps.size(); ++i)  // "a ball between the bear and a tree"
        if (stands_by(plan.steps[i], plan.steps[i + 1])) std::swap(plan.steps[i], plan.steps[i + 1]);
    return plan;
}

}  // namespace gse::language::plan
