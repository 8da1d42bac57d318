// Places: where a thing is, seen from another, and what is around all of them.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
namespace {

constexpr std::pair<std::string_view, std::string_view> Inverses[] = {
    {"on", "under"},           {"under", "above"},      {"above", "under"},
    {"left of", "right of"},   {"right of", "left of"}, {"behind", "in front of"},
    {"in front of", "behind"}, {"in", "around"},        {"around", "in"}};

std::string_view inverse(std::string_view relation) {
    for (const auto& [one, other] : Inverses)
        if (one == relation) return other;
    return relation;
}

}  // namespace

/// "in blue", "in stripes".
bool Reader::in_colour(const Target& subject) {
    {
        Cursor colour = c_;
        colour.take(Class::article);
        const auto attributes = colour.take_attributes();
        const bool ends = colour.at_end_of_clause() ||
                          (colour.ends_phrase(0, true) && colour.noun_length() == 0) ||
                          colour.peek(Class::colour_word);
        const bool colours = !attributes.empty() &&
                             std::all_of(attributes.begin(), attributes.end(), [](const Attribute& each) {
                                 return each.quality == Quality::Colour || each.quality == Quality::Pattern ||
                                        each.quality == Quality::Shift || each.quality == Quality::Material;
                             });
        if (colours && ends && subject.found() &&
            !(attributes.size() == 1 && attributes[0].quality == Quality::Material &&
              has(Class::ground, attributes[0].value))) {
            c_.at = colour.at;
            c_.take(Class::colour_word);
            return apply_all({subject}, attributes);
        }
    }
    return false;
}

/// "a forest", with `before` said of it, where the scene shows none.
bool Reader::in_place(const Cursor& ahead, const std::string& before) {
    const auto place = ahead.peek(Class::place);
    Phrase named;
    named.noun = named.typed = std::string(place.value);
    if (place && d_.things_named(named).empty()) {
        Cursor behind = ahead;
        behind.at += place.length;
        if (behind.at_end_of_clause() || behind.ends_phrase(0, true)) {
            c_.at = behind.at;
            d_.environment(before + std::string(place.value));
            return true;
        }
    }
    return false;
}

/// Surroundings: "at night", "in a forest", "in the style of", "in blue".
bool Reader::surroundings(const Target& subject, std::string_view relation) {
    Cursor ahead = c_;
    const bool inside = relation == "in" || relation == "under" || relation == "beside" || relation == "on" ||
                        relation == "in front of";
    if (!inside) return false;
    Cursor style = ahead;
    style.take(Class::definite);
    style.take(Class::article);
    if (style.take(Class::style_word) && style.take(Class::of)) {
        const auto whole = described_ && subject.found() && described_->reference == subject.reference &&
                                   frame_ == Frame::Describe && !described_definite_
                               ? d_.scene_target()
                               : subject;
        c_.at = style.at;
        if (style_text({whole})) return true;
        Phrase model;
        if (!c_.take_phrase(model)) return false;
        d_.style(whole, model.typed);
        return true;
    }
    if (relation == "in" && style_text({frame_ == Frame::Describe ? d_.scene_target() : subject}))
        return true;
    ahead.take(Class::article);
    ahead.take(Class::definite);
    Attribute adjective;
    Cursor described = ahead;
    std::string text;
    if (!ahead.peek(Class::environment) && described.take_attribute(adjective, true)) {
        if (described.peek(Class::environment) || described.peek(Class::place)) {
            text = adjective.typed + " ";
            ahead.at = described.at;
        }
    }
    if (const auto kind = ahead.peek(Class::environment); kind && ahead.peek(Class::place, kind.length)) {
        text = std::string(kind.value) + " ";  // "in a dark forest"
        ahead.at += kind.length;
    }
    const auto weather = ahead.peek(Class::environment);
    Cursor time = ahead;
    time.at += weather.length;
    const bool hour = time.at > ahead.at && has(Class::time_of_day, time.previous().text);  // "rainy evening"
    if (weather && (relation != "on" || hour || time.peek(Class::time_of_day))) {
        Cursor behind = ahead;
        behind.at += weather.length;
        const auto more = behind.take(Class::environment);  // "a winter evening"
        if (behind.at_end_of_clause() || behind.ends_phrase(0, true) || behind.peek(Class::time_word) ||
            behind.noun_length() == 0) {
            text += weather.value;
            if (more) text.append(1, ' ').append(more.value);
            behind.take(Class::time_word);
            c_.at = behind.at;
            d_.environment(text);
            return true;
        }
    }
    if (relation != "under" && relation != "in front of" && in_place(ahead, text)) return true;
    return relation == "in" && in_colour(subject);
}

/// "between the house and the tree".
bool Reader::between(const Target& subject, const Phrase& phrase) {
    Phrase second;
    Cursor ahead = c_;
    ahead.take(Class::conjunction);
    if (ahead.take_phrase(second)) {
        c_.at = ahead.at;
        const auto one = d_.resolve(phrase), two = d_.resolve(second);
        if (subject.step && one.found() && two.found()) {
            d_.set_anchors(subject, "between", {one, two});
            return true;
        }
        if (!one.found() && !two.found() && subject.kind == Target::Kind::There) {
            d_.add(phrase, "left of", {subject});
            d_.add(second, "right of", {subject});
            return true;
        }
        if (has(Class::seen_by, second.noun) && !two.found() && one.found() && subject.step) {
            d_.set_anchor(subject, "in front of", one);
            return true;
        }
        for (const auto& each : {phrase, second})  // "the camera" is no thing of the scene, and none to add
            if (each.definite && !d_.resolve(each).found()) return expect(each).found();
        if (subject.kind == Target::Kind::There) {
            for (const auto& each : {phrase, second})
                if (!d_.resolve(each).found()) d_.add(each, "beside", {subject});
            return true;
        }
    }
    return false;
}

bool Reader::related(const Target& subject) {
    const std::size_t start = c_.at;
    if (const auto weather = c_.peek(Class::environment); weather && !c_.peek(Class::relation)) {
        c_.at += weather.length;
        d_.environment(std::string(weather.value));
        return true;
    }
    Target other;
    if (const auto side = take_side(other); !side.empty()) {
        if (!subject.step) return false;
        d_.set_anchor(subject, side, other);
        return true;
    }
    const bool at = c_.is(Class::word_at);
    const auto relation = c_.take(Class::relation);
    if (surroundings(subject, relation.value)) return true;
    Phrase phrase;
    if (Cursor place = c_; at && place.take_phrase(phrase) && phrase.definite && is_ground(phrase) &&
                           d_.things_named(phrase).empty()) {
        c_.at = place.at;  // "at the beach"
        d_.ground(phrase);
        return true;
    }
    Attribute ignored;
    if (!c_.take_phrase(phrase)) {
        c_.at = start;
        return false;
    }
    if (relation.value == "in" && phrase.indefinite && is_worn(phrase) && d_.can_wear(subject)) {
        c_.at = start + relation.length;
        return has_list(subject, "worn by");  // "in a hood and boots"
    }
    if (relation.value == "between" && c_.peek(Class::conjunction)) {
        if (between(subject, phrase)) return true;
    }
    if (!relate(subject, relation.value, phrase)) {
        c_.at = start;
        return false;
    }
    // "on the grass and the sand", "next to a tree and a house"
    while (true) {
        Cursor ahead = c_;
        Phrase next;
        if (relation.value == "on" || relation.value == "in" || !ahead.take(Class::conjunction) ||
            starts_verb(ahead.at - c_.at) || !ahead.take_phrase(next) || next.noun.empty() ||
            !next.indefinite)
            break;
        if (ahead.peek(Class::relation) || ahead.peek(Class::copula)) break;
        c_.at = ahead.at;
        if (!relate(subject, relation.value, next)) break;
    }
    return true;
}

/// Tells whether the subject stands on the thing as the scene is told: the thing follows it, or is its
/// ground.
bool Reader::usually_on(const Target& subject, const Target& found) const {
    if (!subject.thing || !found.thing) return true;
    const auto& things = d_.scene().things;
    const auto& noun = things[*found.thing].noun;
    return things[*found.thing].is_ground || has(Class::furniture_flat, noun) || has(Class::support, noun);
}

/// The other thing is there: the subject is beside it, or goes there.
bool Reader::relate_there(const Target& subject, std::string_view relation, const Phrase& phrase,
                          const Target& found) {
    const bool of_focus = subject.step && !phrase.possessive && d_.focus().found();
    Target bearer = of_focus ? d_.focus() : subject;  // "flags on the towers"
    const bool of_other = subject.step && found.kind == Target::Kind::There && !of_focus &&
                          !phrase.possessive && found.reference.links.size() > 1;
    if (on_bearer(phrase, bearer) && subject.step) {
        if (of_other) bearer = found;  // "snow on the roof"
        d_.set_anchor(subject, relation, bearer);
        return true;
    }
    if (subject.step && subject.kind == Target::Kind::Made) {
        const bool worn =
            relation == "on" && has(Class::worn, subject.reference.root()) && d_.can_wear(found);
        d_.set_anchor(subject, worn ? std::string_view("worn by") : relation, found);
        apply_all({found}, found.thing ? phrase.attributes : std::vector<Attribute>{});
        return true;
    }
    if (subject.reference == found.reference) return true;
    const bool surface = !d_.is_animate(found) || (found.thing && d_.scene().things[*found.thing].is_ground);
    const auto& name = found.reference.root();
    const bool backdrop =
        relation == "in front of" && (has(Class::backdrop, name) || has(Class::place, name));
    const bool side = !backdrop && relation != "in" && relation != "beside" && relation != "under" &&
                      (relation != "on" || !surface || !usually_on(subject, found));
    if (found.thing && !phrase.attributes.empty()) apply_all({found}, phrase.attributes);
    if (side && subject.thing && !phrase.owner) d_.move(subject, "move " + std::string(relation), found);
    else d_.already_so();
    return true;
}

/// Subject and another thing, new or there: where the one is, seen from the other.
bool Reader::relate(const Target& subject, std::string_view relation, const Phrase& phrase) {
    if (phrase.naming == Naming::Something) return false;
    const bool place_of_thing = (relation == "on" || relation == "in" || relation == "under") &&
                                is_ground(phrase) && !is_worn(phrase);
    const auto found = d_.resolve(phrase);
    const bool there = found.found();
    if (place_of_thing && !(there && !phrase.another)) {
        if (subject.is_scene()) return false;
        d_.ground(phrase);
        return true;
    }
    if (place_of_thing && there && found.thing && d_.scene().things[*found.thing].is_ground) {
        d_.already_so();
        if (phrase.definite && d_.stands_nowhere(subject)) {  // "lots of flowers in the grass"
            d_.set_anchor(subject, "on", found);
            return true;
        }
        const bool named = phrase.noun == d_.scene().things[*found.thing].noun;
        if (!named && has(Class::ground, phrase.noun) &&
            !are_synonyms(d_.scene().things[*found.thing].noun, phrase.noun))
            d_.ground(phrase);
        else apply_all({found}, phrase.attributes);
        return true;
    }
    const bool like = there && subject.thing && found.reference == subject.reference && phrase.indefinite;
    const bool other = like && std::any_of(phrase.attributes.begin(), phrase.attributes.end(),
                                           [&](const Attribute& each) { return !d_.is_so(subject, each); });
    if (other) {  // "a red bear next to a blue bear"
        Phrase second = phrase;
        second.another = true;
        nested(d_.add(second, inverse(relation), {subject}), subject);
        return true;
    }
    if (there) { return relate_there(subject, relation, phrase, found); }
    if (found.kind == Target::Kind::Ambiguous) return fail(reason::Ambiguous);
    if (phrase.noun.empty() || phrase.naming != Naming::Thing) return false;
    if (phrase.owner || (phrase.possessive && is_part(phrase))) return false;
    if (is_worn(phrase) && relation == "in" && !has(Class::container, phrase.noun))
        return own(subject, phrase, "worn by");
    if (!is_thing(phrase)) return false;
    auto how = inverse(relation);
    if (relation == "between") how = "beside";
    const auto vessel = phrase.noun.substr(phrase.noun.rfind(' ') + 1);
    if (relation == "in" && !has(Class::container, phrase.noun) && !has(Class::container, vessel) &&
        (kinds_of(phrase.noun) & (Artifact | Object)) == 0) {
        if ((kinds_of(phrase.noun) & (Plant | Animal | Person)) == 0) {
            d_.environment(phrase.typed);
            return true;
        }
    }
    const auto made = d_.add(phrase, how, {subject});
    d_.mention(made);
    nested(made, subject);
    return true;
}

/// "and the moon is shining": says nothing more.
void Reader::skip_moon() {
    Cursor also = c_;  // "and the moon is shining"
    if (also.take(Class::conjunction) && also.take(Class::definite) &&
        (also.is(Class::word_moon) || also.is(Class::word_sun) || also.is(Class::word_stars) ||
         also.is(Class::word_sky))) {
        while (!also.at_end_of_clause()) ++also.at;
        c_.at = also.at;
    }
}

/// "(a storm) rages over the bear": says nothing more.
void Reader::skip_weather_place(Cursor& behind, bool of_it) const {
    Cursor over = behind;
    Phrase place;
    if (!of_it && over.take(Class::weather_goes)) behind.at = over.at;
    if (!of_it && over.take(Class::relation) && over.take_phrase(place) && over.at_end_of_clause() &&
        d_.resolve(place).found())
        behind.at = over.at;
    Cursor before = behind;  // "winter instead of summer"
    if (before.take(Class::rather_than) && before.take(Class::environment) && before.at_end_of_clause())
        behind.at = before.at;
}

/// "it is night", "make it snow", "at night", "let it rain".
bool Reader::environment_clause() {
    Cursor ahead = c_;
    const bool makes =
        ahead.take(Class::verb_make) || ahead.take(Class::verb_turn) || ahead.take(Class::verb_add);
    const bool subject = ahead.is(Class::word_it) || ahead.is(Class::word_its) ||
                         ahead.peek(Class::time_word) || ahead.peek(Class::everything) ||
                         (ahead.peek(Class::definite) && ahead.peek(Class::time_word, 1));
    if (subject) {
        if (!ahead.peek(Class::everything)) ahead.take(Class::definite);
        if (!ahead.take(Class::everything)) ++ahead.at;
    }
    while (ahead.take(Class::modal) || ahead.take(Class::copula) || ahead.take(Class::look_word) ||
           ahead.take(Class::like) || ahead.take(Class::to) || ahead.take(Class::into)) {}
    if (const auto relation = ahead.peek(Class::relation);
        relation && (relation.value == "in" || relation.value == "beside" || relation.value == "under") &&
        ahead.at != c_.at)
        ahead.at += relation.length;
    else if (relation && !makes && !subject &&
             (ahead.is(Class::word_at) || ahead.is(Class::word_in) || ahead.is(Class::word_during)))
        ahead.at += relation.length;
    const auto verb = ahead.peek(Class::weather_verb);
    if (verb && subject && verb.length == 1 && ahead.word(1).text != "on") {
        // with the ground as the source, "make it snow" says what the ground becomes
        if (makes && d_.is_on_ground() && has(Class::ground, ahead.word().text)) return false;
        c_.at = ahead.at + 1;
        while (c_.take(Class::degree) || c_.take(Class::pose_manner)) {}
        d_.environment(std::string(verb.value));
        c_.take(Class::as_well);
        return true;
    }
    ahead.take(Class::article);
    ahead.take(Class::definite);
    const auto weather = ahead.peek(Class::environment);
    if (!weather) return false;
    const bool alone = !makes && !subject && ahead.at == c_.at;
    if (alone && weather.length == 1 &&
        (ahead.peek(Class::shade) || ahead.peek(Class::material_surface) || ahead.is(Class::word_fall)) &&
        ahead.noun_length(1) > 0)
        return false;
    Cursor behind = ahead;
    behind.at += weather.length;
    behind.take(Class::time_word);
    const bool adjacent = behind.at == ahead.at + weather.length;
    std::string text(weather.value);
    if (behind.take(Class::environment) && adjacent) text = ahead.text_to(behind.at);  // "a stormy night"
    skip_weather_place(behind, subject);
    while (behind.take(Class::as_well)) {}
    const bool adds_thing = makes && !subject && ahead.noun_length() > weather.length;
    if (adds_thing || !(behind.at_end_of_clause() || behind.peek(Class::conjunction) ||
                        behind.peek(Class::relation) || behind.peek(Class::courtesy)))
        return false;
    if (subject && c_.is(Class::word_it) == false && makes == false && d_.is_animate(d_.focus()) &&
        ahead.is(Class::word_dark))
        return false;
    c_.at = behind.at;
    d_.environment(text);
    skip_moon();
    return true;
}

/// "minecraft style", "in the style of van gogh", "as an oil painting", "an oil painting of a bear".
bool Reader::style_clause() {
    Cursor ahead = c_;
    const std::size_t start = c_.at;
    if (ahead.is(Class::word_in) || ahead.is(Class::word_as) || ahead.is(Class::word_with)) ++ahead.at;
    ahead.take(Class::definite);
    ahead.take(Class::article);
    if (ahead.take(Class::style_word) && ahead.take(Class::of)) {
        c_.at = ahead.at;
        if (style_text({d_.scene_target()})) return true;
        Phrase model;
        if (c_.take_phrase(model)) {
            d_.style(d_.scene_target(), model.typed);
            return true;
        }
        c_.at = start;
        return false;
    }
    ahead = c_;
    if (ahead.is(Class::word_in) || ahead.is(Class::word_as) || ahead.is(Class::word_like)) ++ahead.at;
    c_.at = ahead.at;
    if (style_text({d_.scene_target()})) {
        Cursor whom = c_, last = c_;
        --last.at;
        Phrase model;
        if (last.is(Class::word_version) && whom.take(Class::of) && whom.take_phrase(model) &&
            model.definite && d_.resolve(model).thing &&
            whom.at_end_of_clause()) {  // "a low-poly version of the fox"
            d_.drop_last();
            c_.at = ahead.at;
            const bool read = style_text({d_.resolve(model)});
            c_.at = whom.at;
            return read;
        }
        if (c_.take(Class::of)) {
            const bool more = clause();
            return more || c_.at_end_of_clause();
        }
        if (c_.at_end_of_clause() || c_.peek(Class::conjunction)) return true;
        d_.drop_last();
    }
    // "lego style"
    c_.at = start;
    Phrase named;
    if (c_.take_phrase(named) && !named.noun.empty() && c_.at_end_of_clause()) {
        const auto blank = named.typed.rfind(' ');
        const auto last = blank == std::string::npos ? named.typed : named.typed.substr(blank + 1);
        if (has(Class::style_word, last) && last != "look" && last != "version") {
            std::string text;
            for (const auto& attribute : named.attributes) text += attribute.typed + " ";
            if (blank != std::string::npos) text += named.typed.substr(0, blank);
            while (!text.empty() && text.back() == ' ') text.pop_back();
            if (!text.empty()) {
                d_.style(d_.scene_target(), text);
                return true;
            }
        }
    }
    c_.at = start;
    return false;
}

/// "standing on one leg", "lies on its side": how it stands, not where.
bool Reader::stands_on_part(const Target& subject) {
    Cursor ahead = c_;
    auto pose = ahead.peek(Class::pose);
    if (!pose) pose = ahead.peek(Class::verb_pose);
    if (!pose || !ahead.peek(Class::where_pose)) return false;
    ahead.at += ahead.peek(Class::where_pose).length;
    const std::size_t begin = ahead.at;
    Phrase part;
    if (!ahead.take(Class::relation) || !ahead.take_phrase(part) || !is_part(part) ||
        !(part.possessive || part.single || !part.count.empty()) || !d_.things_named(part).empty() ||
        !ahead.at_end_of_clause())
        return false;
    std::string text(pose.value);
    for (c_.at = begin; c_.at < ahead.at; ++c_.at) text.append(1, ' ').append(c_.word().text);
    d_.step(Operation::Pose, subject, text);
    return true;
}

/// "scratching its back": what it does with a part of itself; empty for other words.
std::string Reader::doing() {
    const auto& verb = c_.word();
    const bool participle = verb.text.ends_with("ing") && verb.base != verb.text &&
                            ((kinds_of(verb.base) & Kind::Verb) != 0 || c_.peek(Class::holding));
    if (!participle || c_.peek(Class::wearing) || c_.peek(Class::having) || c_.peek(Class::riding)) return {};
    Cursor ahead = c_;
    Phrase part;
    ++ahead.at;
    if (!ahead.take_phrase(part) || !part.possessive || !is_part(part) || !d_.things_named(part).empty())
        return {};
    const auto text = verb.text + " " + part.typed;
    c_.at = ahead.at;
    return text;
}

/// "surrounded by penguins", "covered with moss".
bool Reader::inversely_related(const Target& subject) {
    if (c_.peek(Class::inverse_relation)) {
        const auto relation = c_.take(Class::inverse_relation).value;
        Phrase phrase;
        if (Cursor rust = c_;
            relation == "on" && subject.thing) {  // "covered in rust", which is a colour too
            const auto covering = rust.take(Class::covering);
            if (covering && !d_.scene().things[*subject.thing].is_ground &&
                (rust.at_end_of_clause() || rust.peek(Class::conjunction))) {
                c_.at = rust.at;
                const std::string how(covering.value);
                return apply_all({subject}, {{Quality::Material, how, how, ""}});
            }
        }
        if (!c_.take_phrase(phrase)) return false;
        const bool on_ground = subject.thing && d_.scene().things[*subject.thing].is_ground;
        if (relation == "on" && on_ground && is_ground(phrase)) {  // "the lawn is covered with snow"
            d_.ground(phrase);
            return true;
        }
        if (relation == "on" && subject.thing && (is_ground(phrase) || has(Class::covering, phrase.noun))) {
            if (const auto covering = meaning(Class::covering, phrase.typed))
                return apply_all({subject},
                                 {{Quality::Material, std::string(*covering), std::string(*covering), ""}});
        }
        d_.add(phrase, relation, {subject});
        return true;
    }
    return false;
}

/// "(a balloon) to hold", "(a cape) to wear".
bool Reader::takes_use(const Target& made, const Target& bearer) {
    Cursor ahead = c_;
    ++ahead.at;
    constexpr std::pair<Class, std::string_view> Uses[] = {
        {Class::holding, "held by"}, {Class::wearing, "worn by"}, {Class::riding, "ridden by"}};
    for (const auto& [use, relation] : Uses) {
        Cursor behind = ahead;
        if (!behind.take(use)) continue;
        Cursor part = behind;  // "to hold in its hand"
        Phrase hand;
        if (part.is(Class::word_in) && (++part.at, part.take_phrase(hand)) && is_part(hand))
            behind.at = part.at;
        if (!behind.at_end_of_clause() && !behind.peek(Class::conjunction)) continue;
        c_.at = behind.at;
        d_.set_anchor(made, relation, bearer);
        return true;
    }
    return false;
}

/// Steps over how a new thing is: "(wings) like an eagle".
bool Reader::skip_likeness() {
    Cursor like = c_;
    Phrase model;
    if (c_.is(Class::word_as) || !like.take(Class::like) || !like.take_phrase(model) || model.noun.empty() ||
        !like.at_end_of_clause())
        return false;
    c_.at = like.at;
    return true;
}

/// A ground or a place: "snow instead of grass", "a forest"; nothing for things.
std::optional<bool> Reader::describe_place(const Phrase& phrase, bool bare) {
    Cursor instead = c_;
    Phrase replaced;
    if (is_ground(phrase) && instead.take(Class::rather_than) &&
        instead.take_phrase(replaced)) {  // "snow instead of grass"
        const auto old = d_.resolve(replaced);
        if (!old.found()) return expect(replaced).found();
        c_.at = instead.at;
        return become({old}, phrase);
    }
    if (is_ground(phrase) && !is_worn(phrase) && phrase.count.empty() && (described_ || bare) &&
        !has(Class::thing, phrase.noun)) {
        d_.ground(phrase);
        return true;
    }
    if (has(Class::place, phrase.noun) && bare) {
        d_.environment(phrase.typed);
        return true;
    }
    if (bare && has(Class::environment, phrase.noun)) {  // "golden sunlight"
        std::string text;
        for (const auto& attribute : phrase.attributes) text += attribute.typed + " ";
        d_.environment(text + phrase.typed);
        return true;
    }
    return std::nullopt;
}

/// "snow on the ground": the ground becomes so.
bool Reader::lies_on_ground(const Phrase& phrase) {
    Cursor below = c_;
    Phrase ground;
    if (!is_ground(phrase) || phrase.has_determiner() || !below.is(Class::word_on)) return false;
    ++below.at;
    const auto old = below.take_phrase(ground) ? d_.resolve(ground) : Target{};
    if (!old.thing || !d_.scene().things[*old.thing].is_ground || !below.at_end_of_clause()) return false;
    c_.at = below.at;
    d_.ground(phrase);
    return true;
}

}  // namespace gse::language::plan
