// Orders that add, move, size and turn things.
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {

static bool is_article(const Cursor& here, std::size_t ahead) {
    return here.peek(Class::article, ahead).length > 0;
}

/// "2 meters", "by 50 cm": as a change has it, with a blank before; empty for none, and for other units.
std::string Reader::take_amount() {
    std::string amount;
    Cursor ahead = c_;
    ahead.is(Class::word_by) ? void(++ahead.at) : void();
    Cursor number = ahead;
    if (ahead.is(Class::word_half) && number.peek(Class::unit, 2) && is_article(number, 1)) {
        amount = "0.5";  // "half a meter"
        number.at += 2;
    } else if (const auto named = number.peek(Class::number)) {
        amount = named.value;
        number.at += named.length;
    } else if (number.take(Class::article)) amount = "1";
    else if (!number.word().text.empty() &&
             std::isdigit(static_cast<unsigned char>(number.word().text[0])) != 0)
        amount = number.word().text, ++number.at;
    else return amount;
    const auto unit = number.peek(Class::unit);
    if (!unit) {
        amount.clear();
        return amount;
    }
    const bool known = unit.value == "m" || unit.value == "cm" || unit.value == "%";
    amount = known ? " " + amount + " " + std::string(unit.value) : "";
    number.at += unit.length;
    c_.at = number.at;
    return amount;
}

/// "to the left": moves the target that way, or onto what stands there.
void Reader::move_way(const Target& target, const Match& direction, std::string amount) {
    const std::string way(direction.value);
    c_.at += direction.length;
    while (c_.take(Class::degree)) {}
    if (amount.empty()) amount = take_amount();
    Cursor onto = c_;
    if (onto.peek(Class::relation) && onto.peek(Class::relation).value == "on") {
        onto.take(Class::relation);
        Phrase where;
        if (onto.take_phrase(where)) {
            const auto place = d_.resolve(where);
            if (place.found()) {
                c_.at = onto.at;
                d_.move(target, "move on", place);
                return;
            }
        }
    }
    d_.step(Operation::Transform, target, "move " + way + amount);
}

/// Steps over "from the table" where the way goes on.
bool Reader::skip_origin() {
    Cursor ahead = c_;
    Phrase origin;
    if (!ahead.take(Class::from) || !ahead.take_phrase(origin)) return false;
    if (!d_.resolve(origin).found() || !(ahead.is(Class::word_to) || ahead.peek(Class::relation)))
        return false;
    c_.at = ahead.at;
    return true;
}

/// "behind the statue", "in a cage", "on snow".
bool Reader::move_to(const Target& target, const Match& relation, bool from) {
    auto name = relation ? relation.value : std::string_view("beside");
    c_.at += relation ? relation.length : 1;
    if (name == "in" && in_colour(target)) return true;  // "put the bear in camouflage"
    if (c_.is(Class::word_to) || c_.is(Class::word_of)) ++c_.at;
    Phrase where;
    if (!c_.take_phrase(where)) { return fail(reason::Incomplete); }
    auto place = where.naming == Naming::It ? d_.focus() : d_.resolve(where);
    const bool flat = place.thing && (d_.scene().things[*place.thing].is_ground ||
                                      has(Class::furniture_flat, place.reference.root()));
    if (from && !relation && flat) name = "on";  // "from the table to the floor"
    Target body = d_.focus();
    if (where.possessive && !d_.is_animate(body)) body = d_.pronoun(Naming::Person);  // "in his hands"
    if (!place.found() && on_bearer(where, body)) place = body;
    if (!place.found()) {
        if (is_ground(where) && (name == "on" || (name == "in" && where.definite)) &&
            place.kind == Target::Kind::Missing) {  // "put it on snow", "on the beach"
            d_.ground(where);
            return true;
        }
        const bool place_name = has(Class::place, where.noun) || has(Class::environment, where.noun);
        if (place.kind == Target::Kind::Missing && (where.indefinite || place_name) &&
            where.naming == Naming::Thing) {
            const bool inside = name == "in" || name == "on" || name == "beside";
            if (place_name && inside)
                d_.environment(where.typed);  // "put the bear in a cage", "in the forest"
            else if (!relate(target, name, where)) return false;
            return true;
        }
        return expect(where).found();
    }
    if (name == "between" && c_.take(Class::conjunction)) {
        Phrase second;
        if (!c_.take_phrase(second)) return fail(reason::Incomplete);
        d_.move(target, "move beside", place);
        return true;
    }
    if (target.reference == place.reference) return fail(reason::Incomplete);
    const bool other_ground = place.thing && d_.scene().things[*place.thing].is_ground && where.indefinite &&
                              is_ground(where) && where.noun != place.reference.root() &&
                              !are_synonyms(place.reference.root(), where.noun);
    if (other_ground && (name == "on" || name == "in")) {  // "put it on a marble floor" of grass
        d_.ground(where);
        return true;
    }
    if (name == "on" && place.thing && !where.attributes.empty() && !where.definite) {
        d_.already_so();  // "put it on blue grass"
        return apply_all({place}, where.attributes);
    }
    const bool usual = name == "on" && target.thing && place.thing &&
                       !d_.scene().things[*place.thing].is_ground && d_.scene().things.size() == 2;
    const bool worn = target.thing && d_.scene().things[*target.thing].is_worn && d_.can_wear(place);
    const bool on_ground = (name == "on" || name == "in") && place.thing && d_.scene().things.size() == 2 &&
                           d_.scene().things[*place.thing].is_ground;  // "put the bear in the meadow"
    if (usual || on_ground || (worn && name == "on")) d_.already_so();
    else d_.move(target, "move " + std::string(name), place);
    return true;
}

/// Steps over "over" and "down" before a place: "over to the statue", "down on the floor", "back on it".
void Reader::skip_particle() {
    const bool over = c_.word().text == "over" && (c_.is(Class::word_to, 1) || c_.peek(Class::relation, 1));
    const bool down = (c_.is(Class::word_down) || c_.word().text == "back") && c_.peek(Class::relation, 1) &&
                      !c_.is(Class::word_by, 1) && c_.peek(Class::relation).length < 2;
    if (over || down) ++c_.at;
}

/// A thing that is there goes to another place.
bool Reader::move_target(const Target& target) {
    c_.take(Class::degree);
    if (const auto over = c_.peek(Class::flipping);
        over.length > 1 && over.value == "flip") {  // "lay it on its back"
        c_.at += over.length;
        d_.step(Operation::Transform, target, std::string(over.value));
        return true;
    }
    if (c_.is(Class::word_on) && c_.peek(Class::possessive, 1) && c_.word(2).text == "side") {
        c_.at += 3;
        d_.step(Operation::Pose, target, "lying on its side");
        return true;
    }
    const auto amount = take_amount();
    bool moved = false;
    while (true) {
        const std::size_t start = c_.at;
        if (moved) {
            const bool joint = c_.take(Class::conjunction).length > 0;
            if (!joint) break;
        }
        c_.take(Class::degree);
        while (c_.take(Class::emerging)) {}
        skip_particle();
        Target whose;
        if (const auto side = take_side(whose); !side.empty()) {
            d_.move(target, "move " + std::string(side), whose);
            moved = true;
            continue;
        }
        const bool from = skip_origin();
        const auto relation = c_.peek(Class::relation);
        const auto direction = c_.peek(Class::direction);
        Cursor behind = c_;
        behind.at += direction.length;
        const bool plain =
            direction && direction.length >= relation.length &&
            (behind.at_end_of_clause() || behind.peek(Class::as_well) || behind.peek(Class::conjunction) ||
             behind.peek(Class::courtesy) || behind.is(Class::word_by) || behind.peek(Class::degree) ||
             behind.peek(Class::unit, 1) || (direction.length >= relation.length && direction.length > 1) ||
             behind.peek(Class::from) || behind.is(Class::word_to));
        if (plain) {
            move_way(target, direction, amount);
            moved = true;
            continue;
        }
        if (relation || c_.is(Class::word_to) || c_.is(Class::word_from)) {
            if (!move_to(target, relation, from)) return false;
            moved = true;
            continue;
        }
        c_.at = start;
        break;
    }
    return moved || fail(reason::Incomplete);
}

/// "(lay the bear) down": a pose.
bool Reader::poses_so(std::string_view verb, const Targets& targets) {
    const std::string_view pose = verb == "lay"     ? "lying"
                                  : verb == "sit"   ? "sitting"
                                  : verb == "stand" ? "standing"
                                                    : "";
    if (pose.empty() || !(c_.is(Class::word_down) || c_.is(Class::word_up))) return false;
    ++c_.at;
    for (const auto& target : targets) d_.step(Operation::Pose, target, std::string(pose));
    return true;
}

bool Reader::move_clause() {
    const auto lift = c_.peek(Class::verb_lift);
    const auto verb = c_.peek(Class::verb_move);
    if (!verb && !lift) return false;
    const auto base = c_.word().text;
    c_.at += std::max(verb.length, lift.length);
    Targets targets;
    Phrase first;
    Cursor ahead = c_;
    if (!ahead.take_phrase(first)) return false;
    const auto found = d_.resolve(first);
    const bool one_of = first.single && d_.things_named(first).size() > 1;  // "move one chair"
    if (!found.found() || (first.indefinite && !one_of && first.naming == Naming::Thing)) {
        if (found.kind == Target::Kind::Ambiguous && first.naming != Naming::Thing)
            return fail(reason::Ambiguous);
        return false;
    }
    if (found.kind == Target::Kind::There && !found.thing && found.reference.links.size() > 1)
        return false;                 // a part: a pose
    if (first.another) return false;  // "put another flower in the vase"
    if (!objects(targets)) return false;
    if (poses_so(base, targets)) return ends_well();
    Cursor way = c_;
    while (way.take(Class::degree) || way.take(Class::emerging)) {}
    const bool goes =
        way.peek(Class::direction) || way.peek(Class::relation) || way.is(Class::word_to) ||
        way.is(Class::word_by) ||
        (!way.word().text.empty() && std::isdigit(static_cast<unsigned char>(way.word().text[0])) != 0) ||
        way.peek(Class::number) || way.is(Class::word_from) || way.is(Class::word_half) ||
        (way.peek(Class::article) && way.peek(Class::unit, 1));
    Cursor position = c_;
    const bool stands =
        (position.peek(Class::pose) && !position.peek(Class::direction)) || position.peek(Class::flipping);
    if (lift && (c_.at_end_of_clause() || !goes)) {
        for (const auto& target : targets) d_.step(Operation::Transform, target, std::string(lift.value));
        while (c_.take(Class::degree)) {}
        return c_.at_end_of_clause() || ends_well();
    }
    if (lift && goes) {  // "lift the bear 1 meter"
        Cursor before = c_;
        const auto amount = take_amount();
        if (!amount.empty() && ends_well()) {
            for (const auto& target : targets)
                d_.step(Operation::Transform, target, std::string(lift.value) + amount);
            return true;
        }
        c_.at = before.at;
    }
    if (lift && way.is(Class::word_up)) {
        ++way.at;
        c_.at = way.at;
        const auto amount = take_amount();
        for (const auto& target : targets) d_.step(Operation::Transform, target, "move up" + amount);
        return true;
    }
    if (!goes || stands) return c_.at_end_of_clause() ? fail(reason::Incomplete) : false;
    for (const auto& target : targets)
        if (!move_target(target)) return false;
    return true;
}

/// "1.5", "half", "50 %" as a factor; empty for none. `scale`: percents are of the size, not of the change.
std::string Reader::take_factor(bool scale, bool smaller) {
    std::string number;
    if (const auto times = c_.take(Class::times)) number = times.value;
    else if (const auto named = c_.take(Class::number)) number = named.value;
    else if (!c_.word().text.empty() && std::isdigit(static_cast<unsigned char>(c_.word().text[0])) != 0)
        number = c_.word().text, ++c_.at;
    if (number.empty()) return number;
    if (const auto unit = c_.take(Class::unit); unit && unit.value == "%") {
        const double percent = std::atof(number.c_str());
        const double scaled = scale ? percent / 100 : smaller ? 1 - percent / 100 : 1 + percent / 100;
        number = std::to_string(scaled);
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
    }
    return number;
}

/// "the size of the bear", "the bear's height", "the bear": targets, and what of them is sized.
bool Reader::take_sized(Targets& targets, std::string_view& sizes) {
    Cursor ahead = c_;
    ahead.take(Class::definite);
    if (ahead.peek(Class::dimension) && ahead.peek(Class::of, 1)) {  // "double the size of the bear"
        sizes = ahead.take(Class::dimension).value;
        ahead.take(Class::of);
        c_.at = ahead.at;
    }
    Phrase first;
    Cursor whole = c_;
    if (whole.take_phrase(first) && first.indefinite && !d_.resolve(first).found()) return false;
    if (first.owner && has(Class::dimension, first.noun)) {  // "the bear's size"
        sizes = *meaning(Class::dimension, first.noun);
        const auto target = expect(*first.owner);
        if (!target.found()) return false;
        c_.at = whole.at;
        targets.push_back(target);
        d_.mention(target);
    } else if (!objects(targets)) return false;
    return true;
}

bool Reader::size_clause() {
    const auto size = c_.peek(Class::verb_size);
    const auto factor = c_.peek(Class::verb_double);
    const auto scale = c_.peek(Class::verb_scale);
    if (!size && !factor && !scale) return false;
    c_.at += std::max({size.length, factor.length, scale.length});
    Targets targets;
    std::string_view sizes;
    Phrase several;
    if (Cursor copies = c_; factor && copies.take_phrase(several) && several.plural && !several.owner &&
                            copies.at_end_of_clause()) {  // "double the bears"
        const auto found = d_.resolve(several);
        if (found.thing && factor.value.find('.') == std::string_view::npos) {
            c_.at = copies.at;
            d_.duplicate(found, std::string(factor.value));
            return true;
        }
    }
    if (!take_sized(targets, sizes)) return false;
    std::string change = size ? std::string(size.value) : factor ? "scale " + std::string(factor.value) : "";
    const bool up = c_.is(Class::word_up), down = c_.is(Class::word_down);
    if (up || down) ++c_.at, change = up ? "bigger" : "smaller";
    if (c_.peek(Class::dimension) && !c_.peek(Class::relation)) sizes = c_.take(Class::dimension).value;
    if (c_.is(Class::word_in) && c_.peek(Class::dimension, 1)) c_.at += 2;
    const bool less =
        change == "smaller" || change == "narrower" || change == "shorter" || change == "thinner";
    if (c_.is(Class::word_vertically)) ++c_.at, change = less ? "shorter" : "taller";
    else if (c_.is(Class::word_horizontally) || c_.is(Class::word_sideways))
        ++c_.at, change = less ? "narrower" : "wider";
    const bool by = c_.is(Class::word_by);
    if (by || c_.is(Class::word_to)) {
        ++c_.at;
        if (c_.is(Class::word_a) && !c_.peek(Class::times)) ++c_.at;
        while (c_.take(Class::degree)) {}
        if (c_.is(Class::word_factor) && c_.is(Class::word_of, 1)) c_.at += 2;
        const auto number = take_factor(!by || (scale.length > 0 && !up && !down), change == "smaller");
        if (number.empty()) return fail(reason::Incomplete);
        c_.take(Class::dimension);
        if (c_.is(Class::word_of) && c_.peek(Class::possessive, 1) && c_.peek(Class::dimension, 2)) ++c_.at;
        if (c_.peek(Class::possessive) && c_.peek(Class::dimension, 1)) c_.at += 2;
        change = "scale " + number;
    } else if (scale && change.empty()) {
        if (c_.at_end_of_clause()) return fail(reason::Incomplete);
        return complement(targets);
    }
    if (c_.take(Class::to)) {
        Attribute ignored;
        Phrase other;
        if (!c_.take_attribute(ignored, false) && !c_.take_phrase(other)) return false;
    }
    c_.take(Class::times);
    if (factor && !sizes.empty() && sizes != "scale") {
        const auto blank = sizes.find(' ');
        change = factor.value[0] != '0' ? std::string(sizes.substr(0, blank))
                                        : std::string(sizes.substr(blank + 1));
    }
    while (c_.take(Class::degree) || c_.take(Class::pose_manner)) {}
    for (const auto& each : targets) d_.step(Operation::Transform, each, change);
    return true;
}

/// "90 degrees", "by a quarter turn"; empty for none.
std::string Reader::take_degrees() {
    Cursor angle = c_;
    if (angle.is(Class::word_by)) ++angle.at;
    std::string degrees;
    const bool digits =
        !angle.word().text.empty() && std::isdigit(static_cast<unsigned char>(angle.word().text[0])) != 0;
    if (digits) {
        degrees = angle.word().text;
        ++angle.at;
        angle.take(Class::degrees);
        c_.at = angle.at;
    } else if (const auto named = angle.peek(Class::number);
               named && angle.peek(Class::degrees, named.length)) {
        degrees = named.value;
        angle.at += named.length;
        angle.take(Class::degrees);
        c_.at = angle.at;
    }
    const auto turn = c_.peek(Class::turning);
    if (degrees.empty() && turn) {
        degrees = turn.value;
        c_.at += turn.length;
    }
    return degrees;
}

bool Reader::rotate_clause() {
    const auto verb = c_.peek(Class::verb_rotate);
    const auto flip = c_.peek(Class::verb_flip);
    if (!verb && !flip) return false;
    c_.at += std::max(verb.length, flip.length);
    const bool around = c_.is(Class::word_around);
    if (around) ++c_.at;
    Targets targets;
    Phrase first;
    Cursor ahead = c_;
    if (const auto degrees = take_degrees(); !degrees.empty() && c_.at_end_of_clause() && !flip) {
        if (!d_.focus().found()) return fail(reason::Ambiguous);
        d_.step(Operation::Transform, d_.focus(), "rotate " + degrees);  // "rotate 45 degrees"
        return true;
    }
    c_.at = ahead.at;
    if (!ahead.take_phrase(first)) return false;
    const auto found = d_.resolve(first);
    if (!found.found()) {
        if (verb && c_.peek(Class::verb_turn)) return false;
        return expect(first).found();
    }
    if (!objects(targets)) return false;
    std::string change;
    if (flip) change = flip.value;
    c_.take(Class::degree);
    if (const auto turned = c_.peek(Class::flipping);
        turned && (flip || turned.length > 1 || c_.at + turned.length >= word_count_)) {
        c_.at += turned.length;
        change = turned.value;
    } else if (!flip) {
        auto way = c_.peek(Class::clockwise);
        const bool before =
            way && (c_.is(Class::word_by, way.length) ||
                    std::isdigit(static_cast<unsigned char>(c_.word(way.length).text[0])) != 0);
        if (before) c_.at += way.length;  // "clockwise by 15 degrees"
        const auto told = take_degrees();
        const auto degrees = told.empty() && around && c_.at_end_of_clause() ? "180" : told;
        if (!before) way = c_.peek(Class::clockwise);
        if (degrees.empty() && !way) {
            if (!c_.at_end_of_clause()) return false;
            const auto& text = verb.value;
            if (text == "turn" || text == "roll" || text == "angle") return fail(reason::Incomplete);
            change = "rotate";
        } else {
            change = "rotate" + (degrees.empty() ? "" : " " + degrees);
            if (way) {
                const std::string_view value = way.value;
                change += " " + std::string(value);
                if (!before) c_.at += way.length;
            }
        }
    }
    while (c_.take(Class::degree)) {}
    if (c_.peek(Class::into)) return false;
    for (const auto& target : targets) d_.step(Operation::Transform, target, change);
    return true;
}

/// "make it face left", "turn the bear to face us".
bool Reader::face_clause() {
    Cursor verb = c_;
    if (!verb.take(Class::verb_face)) return false;
    Targets targets;
    c_.at = verb.at;
    Phrase first;
    Cursor ahead = c_;
    if (!ahead.take_phrase(first) || !d_.resolve(first).found()) return false;
    if (!objects(targets)) return false;
    if (c_.take(Class::to) && !c_.peek(Class::verb_face)) --c_.at;
    if (c_.peek(Class::verb_face)) ++c_.at;
    else if (verb.at > 0 && !c_.peek(Class::direction) && !c_.peek(Class::viewer)) return false;
    auto way = c_.take(Class::viewer);
    if (!way) way = c_.take(Class::direction);
    if (!way) return false;
    std::string side(way.value == "up" ? "back" : way.value == "down" ? "forward" : way.value);
    for (const auto& target : targets) d_.step(Operation::Transform, target, "face " + side);
    return true;
}

/// "50 % bigger".
bool Reader::percent(const Targets& targets) {
    Cursor ahead = c_;
    const bool digits =
        !ahead.word().text.empty() && std::isdigit(static_cast<unsigned char>(ahead.word().text[0])) != 0;
    if (!digits || ahead.peek(Class::unit, 1).value != "%") return false;
    Cursor size = ahead;
    size.at += 1 + ahead.peek(Class::unit, 1).length;
    const auto change = size.take(Class::size);
    if (!change) return false;
    std::string text(change.value);
    if (text == "bigger" || text == "smaller") text = "scale " + take_factor(false, text == "smaller");
    c_.at = size.at;
    for (const auto& target : targets) d_.step(Operation::Transform, target, text);
    return true;
}

/// "twice as big", "half as wide", "two times taller", "half its size".
bool Reader::measure(const Targets& targets) {
    Cursor ahead = c_;
    std::string factor;
    if (const auto times = ahead.take(Class::times)) factor = times.value;
    else if (!ahead.word().text.empty() &&
             std::isdigit(static_cast<unsigned char>(ahead.word().text[0])) != 0 &&
             (ahead.is(Class::word_times, 1) || ahead.is(Class::word_x, 1))) {
        factor = ahead.word().text;
        ahead.at += 2;
    } else return percent(targets);
    ahead.take(Class::like);
    ahead.take(Class::of);
    ahead.take(Class::possessive);
    ahead.take(Class::definite);
    Match dimension = ahead.take(Class::dimension);
    std::string_view sizes = dimension.value;
    if (!dimension) {
        const auto size = ahead.take(Class::size);
        const double times = std::atof(factor.c_str());
        if (size.value == "smaller" && times > 1) {  // "3 times smaller"
            const int hundredths = static_cast<int>(100 / times);
            factor = "0." + std::string(hundredths < 10 ? "0" : "") + std::to_string(hundredths);
            if (factor.ends_with('0')) factor.pop_back();
        }
        if (size)
            sizes =
                size.value == "bigger" || size.value == "smaller" ? std::string_view("scale") : size.value;
        else return false;
    }
    ahead.take(Class::like);
    while (ahead.is(Class::word_it) || ahead.is(Class::word_now) || ahead.word().text == "is" ||
           ahead.word().text == "was" || ahead.word().text == "before")
        ++ahead.at;  // "twice as tall as it is now"
    const bool grows = factor[0] != '0';
    std::string change = "scale " + factor;
    if (sizes != "scale") {
        const auto blank = sizes.find(' ');
        change = blank == std::string_view::npos
                     ? std::string(sizes)
                     : std::string(grows ? sizes.substr(0, blank) : sizes.substr(blank + 1));
    }
    c_.at = ahead.at;
    c_.take(Class::as_well);
    for (const auto& target : targets) d_.step(Operation::Transform, target, change);
    return true;
}

/// "as tall as the house", "the same size as the car", "the color of the chair", "bigger than the dog".
bool Reader::compared(const Targets& targets) {
    Cursor ahead = c_;
    Phrase other;
    ahead.take(Class::definite);
    ahead.take(Class::article);
    ahead.take(Class::like);
    const bool same = ahead.is(Class::word_same);
    if (same) ++ahead.at;
    if (const auto size = ahead.peek(Class::size); size && !same) {
        ahead.at += size.length;
        if (!ahead.take(Class::like) && !ahead.take(Class::than)) return false;
        const bool equal = ahead.word().text.empty() ? false : c_.is(Class::word_as);
        if (!ahead.take_phrase(other)) return false;
        c_.at = ahead.at;
        const auto model = d_.resolve(other);
        const bool whole = size.value == "bigger" || size.value == "smaller";
        for (const auto& target : targets)
            if (equal && whole && model.thing) d_.move(target, "same size as", model);
            else d_.step(Operation::Transform, target, std::string(size.value));
        return true;
    }
    const bool colour = ahead.peek(Class::colour_word).length > 0,
               dimension = ahead.peek(Class::dimension).length > 0;
    if (!colour && !dimension) return false;
    ++ahead.at;
    if (!ahead.take(Class::like) && !ahead.take(Class::of)) return false;
    const std::size_t begin = ahead.at;
    Attribute stuff;
    if (Cursor plain = ahead; colour && plain.take_attribute(stuff, false) && plain.at_end_of_clause()) {
        c_.at = plain.at;  // "the color of chocolate"
        return apply_all(targets, {{Quality::Colour, stuff.value, stuff.typed, ""}});
    }
    if (!ahead.take_phrase(other)) return false;
    const auto found = d_.resolve(other);
    if (dimension) {
        if (!found.found()) return false;
        c_.at = ahead.at;
        for (const auto& target : targets) d_.move(target, "same size as", found);
        return true;
    }
    std::string told;
    if (found.thing)
        for (const auto& word : d_.scene().things[*found.thing].attributes)
            if (has(Class::colour, word) || told.empty()) told = word;
    if (told.empty()) told = c_.rest(begin - c_.at).front().text.empty() ? "" : other.noun + "-colored";
    c_.at = ahead.at;
    return apply_all(targets, {{Quality::Colour, told, told, ""}});
}

}  // namespace gse::language::plan
