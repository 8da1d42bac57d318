// Complements: what a thing becomes, looks like, is made of.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
namespace {

Attribute material_attribute(std::string_view value) {
    return {Quality::Material, std::string(value), std::string(value), ""};
}

}  // namespace

bool Reader::apply_all(const Targets& targets, const std::vector<Attribute>& attributes) {
    for (const auto& target : targets)
        for (const auto& attribute : attributes) {
            const bool on_ground = target.thing && d_.scene().things[*target.thing].is_ground;
            const bool stuff = attribute.quality == Quality::Material || attribute.quality == Quality::Colour;
            if (on_ground && stuff && has(Class::ground, attribute.value)) {
                Phrase ground;
                ground.noun = ground.typed = attribute.value;
                d_.ground(ground);
            } else if (target.is_scene() && attribute.quality == Quality::Shift)
                d_.step(Operation::Recolour, target, attribute.value);
            else d_.apply(target, attribute);
        }
    return !attributes.empty();
}

/// "made of glass", "out of polished bronze".
bool Reader::material_of(const Targets& targets) {
    Cursor ahead = c_;
    if (!ahead.take(Class::made_of) && !ahead.take(Class::of) && !ahead.take(Class::from)) return false;
    while (ahead.take(Class::made_of) || ahead.take(Class::degree)) {}
    ahead.take(Class::article);
    ahead.take(Class::some);
    ahead.take(Class::number);
    ahead.take(Class::stuff_of);
    std::vector<Attribute> found;
    Attribute next;
    while (!ahead.at_end_of_clause()) {
        if (const auto material = ahead.peek(Class::material)) {
            ahead.at += material.length;
            found.push_back(material_attribute(material.value));
            if (ahead.ends_phrase(0, true) || ahead.done()) break;
            continue;
        }
        if (!ahead.take_attribute(next, true)) break;
        found.push_back(next);
    }
    const bool named = std::any_of(found.begin(), found.end(),
                                   [](const Attribute& each) { return each.quality == Quality::Material; });
    if (!named) {
        if (!c_.peek(Class::made_of)) return false;
        Phrase stuff;
        const bool noun = ahead.take_phrase(stuff) && !stuff.noun.empty() && !stuff.definite &&
                          d_.things_named(stuff).empty() && (kinds_of(stuff.noun) & (Animal | Person)) == 0;
        if (!noun) return false;
        found.push_back(material_attribute(stuff.typed));
    }
    if (named) ahead.take(Class::stuff_noun);  // "built from wooden planks"
    // "polished", "solid", "clear" say how that material is
    std::erase_if(found, [](const Attribute& each) {
        return each.quality != Quality::Material && each.quality != Quality::Colour;
    });
    c_.at = ahead.at;
    return apply_all(targets, found);
}

/// "(look) like a robot", "like a desert", "like grass".
bool Reader::looks_like(const Targets& targets, const Phrase& model) {
    if (targets.size() == 1 && d_.resolve(model).found() &&
        d_.resolve(model).reference == targets.front().reference) {  // "look like grass" of grass
        d_.already_so();
        return apply_all(targets, model.attributes) || true;
    }
    const bool on_ground =
        targets.size() == 1 && targets.front().thing && d_.scene().things[*targets.front().thing].is_ground;
    if (on_ground && is_ground(model)) {  // "make the lawn look like a desert"
        d_.ground(model);
        return true;
    }
    if (has(Class::environment, model.noun) || has(Class::environment, model.typed)) {
        d_.environment(model.typed);
        return true;
    }
    if (has(Class::material, model.noun)) return become(targets, model);
    for (const auto& target : targets) {
        if (target.is_scene()) d_.style(target, model.typed);
        else d_.step(Operation::Alter, target, model.typed);
    }
    return true;
}

/// "like a zebra", "as if it were made of gold", "like it is made of chocolate".
bool Reader::alike(const Targets& targets) {
    Cursor ahead = c_;
    if (!ahead.take(Class::like)) return false;
    const std::size_t start = c_.at;
    Phrase same, role;
    Cursor as = ahead;
    const bool is_role = c_.is(Class::word_as) && as.take_phrase(role) && role.indefinite &&
                         !role.noun.empty() && is_thing(role) && !has(Class::style, role.noun);
    if (is_role && (kinds_of(role.noun) & Person) == 0 && !has(Class::person, role.noun)) {
        c_.at = as.at;
        return become(targets, role);
    }
    Cursor clause = ahead;
    const bool subject = clause.take_phrase(same) && clause.peek(Class::copula).length > 0;
    if (subject) ahead.at = clause.at;
    if (ahead.take(Class::copula) || subject) {
        while (ahead.take(Class::copula)) {}
        c_.at = ahead.at;
        if (complement(targets)) return true;
        c_.at = start;
        return false;
    }
    Cursor look = ahead;
    if (look.peek(Class::made_of)) {
        c_.at = ahead.at;
        return material_of(targets);
    }
    c_.at = ahead.at;
    if (style_text(targets)) return true;
    Phrase model;
    Attribute attribute;
    if (const auto pattern = ahead.peek(Class::pattern_animal, ahead.peek(Class::article).length);
        pattern && frame_ == Frame::Paint) {
        c_.at += ahead.peek(Class::article).length + pattern.length;
        return apply_all(targets,
                         {{Quality::Pattern, std::string(pattern.value), std::string(pattern.value), ""}});
    }
    if (ahead.take_phrase(model) && !model.noun.empty()) {
        c_.at = ahead.at;
        return looks_like(targets, model);
    }
    c_.at = ahead.at;
    if (apply_all(targets, c_.take_attributes())) return true;
    c_.at = start;
    return false;
}

/// "an oil painting", "pixel art", "a drawing by van gogh".
bool Reader::style_text(const Targets& targets) {
    Cursor ahead = c_;
    ahead.take(Class::article);
    ahead.take(Class::definite);
    Attribute adjective;
    Cursor described = ahead;
    std::string before;
    while (described.take_attribute(adjective, true) && !ahead.peek(Class::style)) {
        before += adjective.typed + " ";
        ahead.at = described.at;
    }
    const auto style = ahead.peek(Class::style);
    if (!style) return false;
    std::string text = before + std::string(style.value);
    ahead.at += style.length;
    while (const auto more = ahead.peek(Class::style)) {
        text.append(1, ' ').append(more.value);
        ahead.at += more.length;
    }
    if (ahead.is_owner_mark()) ++ahead.at;
    if (const auto kind = ahead.peek(Class::style_kind)) {  // "a pixar movie"
        text.append(1, ' ').append(kind.value);
        ahead.at += kind.length;
    }
    if (ahead.peek(Class::style_word)) ahead.take(Class::style_word);
    if (ahead.is(Class::word_by) || ahead.is(Class::word_from) || ahead.is(Class::word_in)) {
        Cursor artist = ahead;
        ++artist.at;
        if (artist.take(Class::definite), artist.peek(Class::style_word)) ++artist.at, artist.take(Class::of);
        if (const auto who = artist.peek(Class::style)) {
            text.append(" by ").append(who.value);
            artist.at += who.length;
            ahead.at = artist.at;
        }
    }
    if (!ahead.at_end_of_clause() && !ahead.peek(Class::of) && ahead.noun_length() > 0 &&
        !ahead.ends_phrase(0, true))
        return false;
    const bool of_things =
        std::none_of(targets.begin(), targets.end(), [](const Target& each) { return each.is_scene(); });
    Attribute colours;  // "everything but the horse black and white"
    if (of_things && !targets.empty() && c_.at < ahead.at && targets.front().reference.except) {
        Cursor plain = c_;
        if (plain.take_attribute(colours, false) && colours.quality == Quality::Colour &&
            plain.at == ahead.at)
            return false;
    }
    c_.at = ahead.at;
    for (const auto& target : targets) d_.style(target, text);
    return true;
}

/// Tells whether the sentence says how a part is to be: "its neck should be maple" names no other thing.
bool Reader::said_of_part(const Target& target) const {
    return target.reference.links.size() > 1 && !target.thing && frame_ != Frame::Replace &&
           frame_ != Frame::Turn && frame_ != Frame::Add;
}

/// Another thing in its place, or what it is made of: "into a panda", "into wood", "a darker red".
bool Reader::become(const Targets& targets, const Phrase& phrase) {
    if (phrase.naming != Naming::Thing || phrase.none || has(Class::direction, phrase.noun)) return false;
    if (phrase.noun.empty()) return apply_all(targets, phrase.attributes);
    if (has(Class::colour_word, phrase.noun) || has(Class::look_word, phrase.noun))
        return apply_all(targets, phrase.attributes);
    for (const auto& target : targets) {
        const bool on_ground = target.thing && d_.scene().things[*target.thing].is_ground;
        const auto material = meaning(Class::material, phrase.noun);
        if (on_ground &&
            (is_ground(phrase) || has(Class::material, phrase.noun) || has(Class::place, phrase.noun))) {
            d_.ground(phrase, frame_ == Frame::Replace);
        } else if (material && !phrase.indefinite && phrase.count.empty()) {
            apply_all({target}, {material_attribute(*material)});
            apply_all({target}, phrase.attributes);
        } else if (has(Class::style, phrase.noun) || has(Class::style, phrase.typed)) {
            d_.style(target, phrase.typed);
        } else if ((!is_thing(phrase) && !material) || (said_of_part(target) && !phrase.has_determiner())) {
            return fail(reason::NotASentence);
        } else if (target.is_scene()) {
            if (!has(Class::place, phrase.noun) && !has(Class::environment, phrase.noun) &&
                !is_ground(phrase))
                return fail(reason::NotASentence);
            d_.environment(phrase.typed);
        } else if (on_ground && !target.reference.except) {
            d_.replace(target, phrase);
        } else {
            const auto made = d_.replace(target, phrase);
            d_.mention(made);
            posts(made);
        }
    }
    return true;
}

/// "(a cat) sleeping on the sofa": says where the new thing is.
bool Reader::lies_there(const Target& made) {
    Cursor where = c_;
    Phrase place;
    const auto relation = where.take(Class::relation);
    if (!relation || !where.take_phrase(place) || place.naming != Naming::Thing) return false;
    const auto found = d_.resolve(place);
    if (!found.thing || d_.scene().things[*found.thing].is_ground) return false;
    c_.at = where.at;
    d_.set_anchor(made, relation.value, found);
    return true;
}

/// "waves its hand", "smile broadly", "sitting".
bool Reader::pose_text(const Targets& targets) {
    Cursor ahead = c_;
    std::string text;
    if (const auto raised = ahead.peek(Class::verb_raise)) {
        Cursor part = ahead;
        part.at += raised.length;
        Phrase what;
        if (part.take_phrase(what) && (what.possessive || what.owner || what.count == "all") &&
            is_part(what)) {
            c_.at = part.at;
            const auto pose = ahead.word().base + " " + what.typed;
            for (const auto& target : targets) d_.step(Operation::Pose, target, pose);
            return true;
        }
    }
    if (const auto pose = ahead.peek(Class::pose)) {
        text = pose.value;
        ahead.at += pose.length;
    } else if (const auto verb = ahead.peek(Class::verb_pose)) {
        text = verb.value;
        ahead.at += verb.length;
    } else return false;
    while (const auto manner = ahead.peek(Class::pose_manner)) {
        text.append(1, ' ').append(manner.value);
        ahead.at += manner.length;
    }
    if (const auto high = ahead.peek(Class::direction); high.value == "up" && high.length > 1)
        ahead.at += high.length;  // "floating in the air"
    c_.at = ahead.at;
    if (targets.size() == 1 && targets.front().step && lies_there(targets.front())) return true;
    for (const auto& target : targets) {
        Attribute attribute{Quality::Pose, text, text, ""};
        d_.apply(target, attribute);
    }
    // "running across the grass", "waving at us"
    Cursor where = c_;
    Phrase place;
    if (where.take(Class::relation) && where.take_phrase(place)) {
        const auto found = d_.resolve(place);
        const bool other = found.thing && !targets.empty() && found.thing != targets.front().thing;
        const bool ground = !found.found() && is_ground(place) && place.naming == Naming::Thing &&
                            (c_.is(Class::word_on) || c_.is(Class::word_across));
        if (ground) d_.ground(place);  // "walking on water"
        if (place.naming != Naming::Thing || other || ground) c_.at = where.at;
    }
    return true;
}

/// "a darker red", "bigger and blue".
bool Reader::described_as(const Targets& targets) {
    Cursor adjectives = c_;
    const bool a_lot = adjectives.peek(Class::degree).length > 1;  // "a lot furrier"
    const bool article = !a_lot && adjectives.take(Class::article).length > 0;
    const auto attributes = adjectives.take_attributes();
    if (article && !attributes.empty() && adjectives.is(Class::word_one)) ++adjectives.at;  // "a blue one"
    const bool ends = adjectives.at_end_of_clause() || adjectives.ends_phrase(0, true) ||
                      adjectives.noun_length() == 0 || adjectives.peek(Class::colour_word);
    const bool model = std::any_of(attributes.begin(), attributes.end(),
                                   [](const Attribute& each) { return each.quality == Quality::Colour; });
    const auto& last = adjectives.previous();
    const bool noun = article && attributes.size() == 1 && attributes[0].quality == Quality::Colour &&
                      (kinds_of(last.text) & (Food | Animal)) != 0 && !adjectives.peek(Class::colour_word);
    if (noun) return false;  // "the orange should be a peach"
    if (!attributes.empty() && ends &&
        !(article && adjectives.noun_length() > 0 && !adjectives.peek(Class::colour_word) &&
          !adjectives.ends_phrase(0, true))) {
        const bool only_pose = attributes.size() == 1 && attributes[0].quality == Quality::Pose;
        if (!only_pose) {
            c_.at = adjectives.at;
            c_.take(Class::colour_word);
            Cursor like = c_;  // "green like a frog"
            Phrase of_that;
            Attribute stuff;  // "as black as coal"
            if (model && like.take(Class::like) &&
                (like.take_phrase(of_that) || like.take_attribute(stuff, false)))
                c_.at = like.at;
            return apply_all(targets, attributes);
        }
    }
    return false;
}

/// "as black as coal": the likeness says nothing more.
bool Reader::as_much_as(const Targets& targets) {
    Cursor ahead = c_;
    Attribute attribute;
    Phrase model;
    if (!ahead.is(Class::word_as)) return false;
    ++ahead.at;
    if (!ahead.take_attribute(attribute, false) || !ahead.is(Class::word_as)) return false;
    if (attribute.quality == Quality::Size) return false;
    ++ahead.at;
    if (!ahead.take_phrase(model) || !ahead.at_end_of_clause()) return false;
    c_.at = ahead.at;
    return apply_all(targets, {attribute});
}

/// "look to the left", "looks up".
bool Reader::looks_somewhere(const Targets& targets) {
    Cursor ahead = c_;
    if (!ahead.take(Class::look_word)) return false;
    auto way = ahead.take(Class::viewer);
    if (!way) way = ahead.take(Class::direction);
    if (!way || !ahead.at_end_of_clause()) return false;
    c_.at = ahead.at;
    const std::string side(way.value);
    for (const auto& target : targets) {
        if (side == "up" || side == "down") d_.step(Operation::Pose, target, "looking " + side);
        else d_.step(Operation::Transform, target, "face " + side);
    }
    return true;
}

/// "facing left", "face the camera".
bool Reader::faces(const Targets& targets) {
    if (!c_.peek(Class::verb_face) && !c_.is(Class::word_facing)) return false;
    Cursor side = c_;
    ++side.at;
    auto direction = side.take(Class::viewer);
    if (!direction) direction = side.take(Class::direction);
    if (!direction) return false;
    c_.at = side.at;
    const bool vertical = direction.value == "up" || direction.value == "down";
    for (const auto& target : targets)
        d_.step(Operation::Transform, target, "face " + std::string(vertical ? "forward" : direction.value));
    return true;
}

/// "stand on cobblestones", "stand on its head".
bool Reader::stands_so(const Targets& targets) {
    ++c_.at;
    const auto turned = c_.take(Class::flipping);
    if (!turned) return targets.size() == 1 && related(targets.front());
    for (const auto& target : targets) d_.step(Operation::Transform, target, std::string(turned.value));
    return true;
}

bool Reader::complement_once(const Targets& targets) {
    const std::size_t start = c_.at;
    if (looks_somewhere(targets) || swaps_places(targets)) return true;
    while (c_.take(Class::look_word) || c_.take(Class::copula) ||
           (c_.is(Class::word_to) && c_.take(Class::to)) || c_.take(Class::modal) ||
           c_.take(Class::verb_become)) {}
    if (!c_.is(Class::word_too)) c_.take(Class::as_well);
    if (Cursor stays = c_; stays.is(Class::word_stay) || stays.is(Class::word_remain)) {
        Attribute same;
        ++stays.at;
        if (stays.take_attribute(same, false)) ++c_.at;  // "let it stay red"
    }
    if (c_.at_end_of_clause() && !c_.done() && c_.at == start) return false;
    if (const auto gone = c_.peek(Class::gone)) {
        Cursor behind = c_;
        behind.at += gone.length;
        if (behind.at_end_of_clause() || behind.peek(Class::from) || behind.peek(Class::conjunction) ||
            behind.peek(Class::as_well) || behind.peek(Class::courtesy)) {
            c_.at = behind.at;
            for (const auto& target : targets) d_.remove(target);
            return true;
        }
    }
    if (c_.peek(Class::negation)) return denied(targets);
    if (const auto off = c_.peek(Class::verb_remove);
        off.length > 1 && c_.peek(Class::possessive, off.length))
        return remove_clause();  // "take off its hat"
    if (measure(targets) || as_much_as(targets) || compared(targets)) return true;
    if (c_.peek(Class::made_of) || c_.peek(Class::of)) return material_of(targets);
    if (c_.is(Class::word_from) && material_of(targets)) return true;
    if (c_.peek(Class::verb_make) && c_.is(Class::word_made)) ++c_.at;
    if (c_.peek(Class::verb_recolour) && c_.word().text.ends_with("ed") && !c_.at_end_of_clause())
        c_.at += c_.is(Class::word_in, 1) ? 2 : 1;  // "have it painted pink", "painted in pink"
    if (const auto turned = c_.peek(Class::flipping);
        turned && !c_.is(Class::word_to, turned.length) && !c_.peek(Class::relation, turned.length)) {
        c_.at += turned.length;
        for (const auto& target : targets) d_.step(Operation::Transform, target, std::string(turned.value));
        return true;
    }
    if (c_.peek(Class::like).length < 2 && c_.take(Class::into)) {
        if (c_.peek(Class::made_of)) return material_of(targets);
    }
    if (!targets.empty() && (targets[0].is_scene()) && environment_clause()) return true;
    if (style_text(targets)) return true;
    if (alike(targets)) return true;
    if (faces(targets)) return true;
    if (c_.peek(Class::inverse_relation) && targets.size() == 1)  // "full of flowers"
        return inversely_related(targets.front());
    if (empties(targets) || described_as(targets)) return true;
    if (c_.word().base == "stand" && c_.peek(Class::relation, 1)) return stands_so(targets);
    if (pose_text(targets)) return true;
    Phrase phrase;
    if (c_.take_phrase(phrase) && become(targets, phrase)) return true;
    c_.at = start;
    return false;
}

/// Reads what the targets become; several, joined by commas and "and".
bool Reader::complement(const Targets& targets) {
    const std::size_t before = d_.size();
    bool done = complement_once(targets);
    if (!done) {
        for (const auto& target : targets) done = post(target) || done;
        if (!done) return false;
    }
    for (const auto& target : targets)
        if (targets.size() == 1) posts(target);
    while (true) {
        Cursor ahead = c_;
        const bool comma = ahead.take_mark(',');
        const bool joint = ahead.take(Class::conjunction).length > 0;
        if (!joint && (!comma || has(Class::ground, ahead.word().text))) break;  // "blue, snow"
        if (ahead.peek(Class::correction)) break;                                // "green, actually brown"
        Attribute next;
        Cursor probe = ahead;
        ahead.take(Class::as_well);
        const bool adjective = probe.take_attribute(next, false) &&
                               (probe.at_end_of_clause() || probe.ends_phrase(0, true)) &&
                               !probe.is_mark(":") && !probe.peek(Class::copula);
        if (ahead.peek(Class::into)) {  // "into a cat and into a dog"
            c_.at = ahead.at;
            if (!complement_once(targets)) return false;
            continue;
        }
        const bool denied_more = ahead.peek(Class::negation) && targets.size() == 1;
        if (!adjective && !denied_more) break;
        if (adjective && starts_verb(ahead.at - c_.at)) break;
        const std::size_t here = c_.at;
        c_.at = ahead.at;
        if (complement_once(targets)) continue;
        c_.at = here;  // "paint the bear green, not the hat"
        if (!denied_more) return false;
        break;
    }
    (void)before;
    return true;
}

/// Verbs that name the change: "bleach the bear", "gild it", "age the man", "stripe the bear".
bool Reader::shift_clause() {
    constexpr std::pair<Class, Operation> Changes[] = {{Class::verb_shift, Operation::Recolour},
                                                       {Class::verb_material, Operation::Material},
                                                       {Class::verb_pattern, Operation::Pattern},
                                                       {Class::verb_style, Operation::Style},
                                                       {Class::verb_alter, Operation::Alter}};
    for (const auto& [kind, operation] : Changes) {
        const auto verb = c_.peek(kind);
        if (!verb) continue;
        c_.at += verb.length;
        Targets targets;
        Phrase backdrop;
        Cursor ahead = c_;
        if (ahead.take_phrase(backdrop) && has(Class::backdrop, backdrop.noun) &&
            d_.things_named(backdrop).empty()) {
            c_.at = ahead.at;
            if (operation == Operation::Style)
                d_.style(d_.scene_target(), std::string(verb.value) + " " + backdrop.noun);
            else d_.environment(std::string(verb.value) + " " + backdrop.noun);
            return true;
        }
        if (!objects(targets)) return false;
        if (c_.is(Class::word_up) || c_.is(Class::word_down) || c_.is(Class::word_out)) ++c_.at;
        while (c_.take(Class::degree) || c_.take(Class::pose_manner)) {}
        if (c_.is(Class::word_by)) {
            while (!c_.at_end_of_clause() && !c_.peek(Class::conjunction)) ++c_.at;
        }
        const bool whole = operation == Operation::Material && targets.front().is_scene();
        for (const auto& target : targets)  // "pixelate everything"
            d_.step(whole ? Operation::Style : operation, target, std::string(verb.value));
        return true;
    }
    return false;
}

/// "open the door", "raise the left arm", "let it smile".
bool Reader::pose_clause() {
    const auto verb = c_.peek(Class::verb_pose);
    const auto raise = c_.peek(Class::verb_raise);
    if (!verb && !raise) return false;
    if (verb.length > 2 && c_.is(Class::possessive, 1) && d_.focus().found()) {  // "raise its hand"
        c_.at += verb.length;
        d_.step(Operation::Pose, d_.pronoun(Naming::It, true), std::string(verb.value));
        return true;
    }
    c_.at += std::max(verb.length, raise.length);
    Targets targets;
    if (!objects(targets)) {
        if (c_.at_end_of_clause() && verb && d_.focus().found()) return false;
        return false;
    }
    if (!verb && targets.front().thing && d_.is_animate(targets.front())) return false;  // "turn the bear"
    const auto text = raise.length >= verb.length ? raise.value : verb.value;
    if (c_.is(Class::word_up) || c_.is(Class::word_out) || c_.is(Class::word_down) || c_.is(Class::word_wide))
        ++c_.at;
    while (c_.take(Class::pose_manner)) {}
    for (const auto& target : targets) d_.step(Operation::Pose, target, std::string(text));
    return true;
}

/// "an ice sculpture of a bear": the bear of that material.
bool Reader::describe_likeness(const Phrase& phrase) {
    const auto focus = d_.focus();
    const auto of = phrase.noun.find(" of ");
    if (described_ || !focus.thing || of == std::string::npos ||
        !has(Class::figure, phrase.noun.substr(0, of)) ||
        phrase.noun.substr(of + 4) != focus.reference.root())
        return false;
    std::vector<Attribute> stuff;
    for (const auto& each : phrase.attributes)
        if (each.quality == Quality::Material) stuff.push_back(each);
    if (stuff.empty() || stuff.size() != phrase.attributes.size()) return false;
    described_ = focus;
    apply_all({focus}, stuff);
    posts(focus);
    return true;
}

/// "anime girl" of a girl.
bool Reader::describe_in_style(const Phrase& phrase, std::size_t thing) {
    const auto first = phrase.noun.substr(0, phrase.noun.rfind(' '));
    if (!has(Class::style, first)) return false;
    described_ = d_.target_of_thing(thing);
    d_.style(*described_, first);
    apply_all({*described_}, phrase.attributes);
    posts(*described_);
    return true;
}

}  // namespace gse::language::plan
