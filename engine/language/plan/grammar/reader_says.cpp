// Statements and descriptions: "the bear is blue", "a blue bear wearing a hat", "on snow", "no hat".
#include <algorithm>

#include "engine/language/plan/grammar/reader.h"

namespace gse::language::plan {
/// "the grass alone", to the end of the sentence.
bool Reader::takes_alone(Cursor& ahead, Phrase& phrase) const {
    Cursor alone = ahead;
    const bool read = alone.take_phrase(phrase) && phrase.definite && alone.word().text == "alone" &&
                      alone.at + 1 >= word_count_;
    if (read) ahead.at = alone.at + 1;
    return read;
}

/// "only grass": what else is there goes.
bool Reader::only_clause() {
    Cursor ahead = c_;
    Phrase phrase;
    const bool keeps = ahead.take(Class::verb_keep).length > 0;
    if ((keeps || !takes_alone(ahead, phrase)) && !(ahead.take(Class::only) && ahead.take_phrase(phrase)))
        return false;
    std::vector<Phrase> kept{phrase};
    Cursor more = ahead;
    for (Phrase next; (more.take_mark(','), more.take(Class::conjunction), more.at > ahead.at) &&
                      more.take_phrase(next) && !next.none && d_.resolve(next).thing;) {
        kept.push_back(next);
        ahead.at = more.at;
    }
    if (kept.size() > 1 && d_.resolve(phrase).thing && ahead.at_end_of_clause() && d_.size() == 0) {
        Targets others;  // "leave only the bear and the grass"
        c_.at = ahead.at;
        if (!all_but(kept, others)) return false;
        std::erase_if(others, [&](const Target& each) { return d_.scene().things[*each.thing].is_ground; });
        d_.already_so();
        remove_all(others);
        return true;
    }
    Cursor said = ahead;
    said.take(Class::modal);
    bool stays = said.is(Class::word_stay) || said.is(Class::word_stays) || said.is(Class::word_remain) ||
                 said.is(Class::word_remains);
    if (stays) ahead.at = said.at + 1;
    stays = stays || keeps;
    while (ahead.take(Class::courtesy)) {}
    if (!ahead.at_end_of_clause()) return false;
    if (const auto told = d_.resolve(phrase); ahead.is_mark(",:") && told.found() && !stays) {
        Cursor order = ahead;  // "only the tail, make it black"
        ++order.at;
        if (starts_verb(order.at - c_.at) &&
            (order.peek(Class::pronoun_it, 1) || order.peek(Class::pronoun_all, 1))) {
            d_.mention(told);
            c_.at = order.at;
            return clause();
        }
    }
    if (d_.size() > 0 || !phrase.attributes.empty() || phrase.naming != Naming::Thing) return false;
    if (phrase.single && d_.things_named(phrase).size() > 1) {  // "keep only one chair"
        c_.at = ahead.at;
        return describe(phrase);
    }
    const auto found = d_.resolve(phrase);
    const auto focus = d_.focus();
    if (!found.thing || !focus.found()) return false;
    c_.at = ahead.at;
    d_.already_so();
    const auto& things = d_.scene().things;
    if (things[*found.thing].is_ground) d_.remove(focus);
    for (std::size_t i = 0; stays && i < things.size(); ++i)  // "only the dog should stay"
        if (i != *found.thing && !things[i].is_ground && !things[i].is_worn &&
            !(things[*found.thing].is_ground && d_.target_of_thing(i).reference == focus.reference))
            d_.remove(d_.target_of_thing(i));
    return true;
}

bool Reader::clause() {
    if (correction()) {
        // "no wait, green": in the place of the last
        if (c_.done()) return true;
        d_.drop_last();
        return clause();
    }
    if (only_clause()) return true;
    if (c_.take(Class::only)) skip_lead_in();
    if (keep_clause() || instead_clause() || negative_clause() || environment_clause() || style_clause())
        return true;
    if (!reason_.empty()) return false;
    if (there_is_clause()) return true;
    if (!reason_.empty()) return false;
    if (frame_ != Frame::None && frame_ != Frame::Describe && ellipsis()) return true;
    const bool acts = c_.peek(Class::wearing) || c_.peek(Class::holding) || c_.peek(Class::riding);
    if (d_.size() == 0 && acts && c_.word().text.ends_with("ing") && d_.focus().found()) {
        const std::size_t start = c_.at;  // "wearing a hat"
        if (post(d_.focus())) {
            posts(d_.focus());
            return true;
        }
        c_.at = start;
    }
    if (starts_verb()) {
        const std::size_t start = c_.at;
        if (verb_clause()) return true;
        if (!reason_.empty()) return false;
        c_.at = start;
    }
    const auto sized = d_.size() > 0 && d_.last() && d_.last()->found() ? *d_.last() : d_.focus();
    if (c_.peek(Class::times) && sized.found() && measure({sized})) return true;  // "half the size"
    return noun_clause() || attribute_clause();
}

bool Reader::there_is_clause() {
    Cursor ahead = c_;
    if (!ahead.take(Class::there_is)) return false;
    ahead.take(Class::as_well);
    const std::size_t start = c_.at;
    c_.at = ahead.at;
    if (c_.peek(Class::none) || c_.peek(Class::negation)) return negative_clause();
    Targets made;
    Phrase phrase;
    do {
        if (!c_.take_phrase(phrase) || phrase.noun.empty()) {
            c_.at = start;
            return false;
        }
        if (one_more(phrase) || lies_on_ground(phrase)) continue;
        const auto found = d_.resolve(phrase);
        if (found.found() && phrase.count.empty() && !phrase.another) {
            apply_all({found}, phrase.attributes);
            d_.already_so();
            posts(found);
            continue;
        }
        if (!place_new(phrase, made)) return false;
    } while (list_goes_on());
    return true;
}

/// "instead of a bear I want a cat".
bool Reader::instead_clause() {
    Target there;
    if (const std::size_t start = c_.at;
        stands_where(there) || (c_.is(Class::word_in) && in_place_of(there))) {  // "where the bear is, put"
        skip_lead_in();
        while (c_.take(Class::verb_add) || c_.take(Class::there_is) || c_.take(Class::verb_make)) {}
        Phrase phrase;
        if (c_.at > start && c_.take_phrase(phrase) && phrase.naming == Naming::Thing)
            return become({there}, phrase);
        return fail(reason::NotASentence);
    }
    Cursor ahead = c_;
    if (!ahead.peek(Class::rather_than) || ahead.is(Class::word_not)) return false;
    ahead.take(Class::rather_than);
    Attribute denied;
    if (Cursor colour = ahead;
        d_.focus().found() && colour.take_attribute(denied, false) && colour.take_mark(',')) {
        c_.at = colour.at;  // "instead of red, blue"
        return clause();
    }
    Phrase old;
    if (!ahead.take_phrase(old)) return false;
    const auto target = d_.resolve(old);
    c_.at = ahead.at;
    skip_lead_in();
    while (c_.take(Class::verb_add) || c_.take(Class::there_is) || c_.take(Class::verb_make)) {}
    Phrase phrase;
    if (!target.found()) {  // "instead of snow, grass"
        return expect(old).found();
    }
    if (!c_.take_phrase(phrase)) return fail(reason::Incomplete);
    if (!become({target}, phrase)) return false;
    if (c_.is(Class::word_there)) ++c_.at;
    return true;
}

/// "wears a hat", "has wings"; nothing where no such verb stands.
std::optional<bool> Reader::has_something(const Targets& subjects) {
    for (const auto kind : {Class::wearing, Class::holding, Class::riding, Class::having}) {
        if (!c_.peek(kind) || c_.peek(Class::conjunction)) continue;
        if (c_.peek(Class::relation).length > c_.peek(kind).length) continue;  // "holding hands with"
        Cursor verb = c_;
        verb.take(kind);
        if (verb.peek(Class::copula) || verb.peek(Class::verb_become)) {  // "has turned blue"
            c_.take(Class::having);
            break;
        }
        bool all = true;
        const std::size_t behind = verb.at;
        for (const auto& subject : subjects) {
            c_.at = behind;
            const std::string_view relation = kind == Class::wearing   ? "worn by"
                                              : kind == Class::holding ? "held by"
                                              : kind == Class::riding  ? "ridden by"
                                                                       : "with";
            all = all && has_list(subject, relation);
        }
        if (!all) return false;
        for (const auto& subject : subjects) posts(subject);
        return true;
    }
    return std::nullopt;
}

/// "is blue", "is painted blue", "is replaced by a cat", "is behind the statue".
bool Reader::is_somehow(const Targets& subjects, bool modal) {
    if (looks_somewhere(subjects)) return true;  // "should look to the right"
    if (c_.peek(Class::look_word).length > c_.peek(Class::copula).length) c_.take(Class::look_word);
    c_.take(Class::copula);
    if (!c_.is(Class::word_too)) c_.take(Class::as_well);
    if (Cursor lacking = c_;
        lacking.take(Class::negation) && (lacking.take(Class::wearing) || lacking.take(Class::holding))) {
        c_.at = lacking.at;
        if (!lack_list(subjects.front())) return false;
        c_.take(Class::as_well);
        return true;
    }
    if (c_.peek(Class::holding) || c_.peek(Class::wearing))
        if (const auto read = has_something(subjects)) return *read;  // "is holding balloons"
    if (const auto stands = c_.peek(Class::emerging);                 // "is parked on the beach"
        stands && c_.peek(Class::relation, stands.length) && !c_.peek(Class::pose))
        c_.at += stands.length;
    if (empties(subjects)) return true;  // "the table should be empty"
    if (Cursor complains = c_; !modal && complains.take(Class::complaint) && complains.at_end_of_clause()) {
        c_.at = complains.at;  // "bears are boring, use a giraffe"
        d_.nothing_asked();
        return true;
    }
    if (c_.peek(Class::fire_words)) return post(subjects.front());
    if (!c_.peek(Class::like) && c_.peek(Class::relation) && !c_.peek(Class::flipping) &&
        !(c_.peek(Class::into) && c_.is(Class::word_into)))
        return (modal && is_to_move(subjects.front())) || related(subjects.front());
    // "is replaced by a cat", "is painted blue", "is removed"
    if (c_.peek(Class::verb_replace) && c_.word().text.ends_with("ed")) {
        ++c_.at;
        Phrase phrase;
        if ((c_.is(Class::word_by) || c_.is(Class::word_with)) && ++c_.at && c_.take_phrase(phrase))
            return become(subjects, phrase);
        return false;
    }
    if ((c_.peek(Class::verb_recolour) || c_.peek(Class::verb_turn)) && c_.word().text.ends_with("ed"))
        ++c_.at;
    if (c_.peek(Class::verb_remove) && (c_.word().text.ends_with("ed") || c_.word().text.ends_with("en"))) {
        c_.take(Class::verb_remove);
        for (const auto& subject : subjects) d_.remove(subject);
        return true;
    }
    return complement(subjects);
}

/// "stands on the grass wearing a hat", "leaning on", "hiding behind a bush"; nothing for other verbs.
std::optional<bool> Reader::stands_somewhere(const Target& subject) {
    const bool stands = c_.peek(Class::emerging) && c_.peek(Class::relation, c_.peek(Class::emerging).length);
    const bool placed = c_.peek(Class::relation).length > 1 && c_.word().text.ends_with("ing");
    if (!stands && !placed) return std::nullopt;
    if (!placed) c_.take(Class::emerging);
    if (!related(subject)) return false;
    posts(subject);
    return true;
}

bool Reader::predicate(const Targets& subjects) {
    const std::size_t start = c_.at;
    const auto back = [&] {
        c_.at = start;
        return false;
    };
    if (c_.take(Class::modal_not)) return should_not(subjects) || back();
    if (c_.take(Class::past_be)) {  // "used to be red, now it is white"
        d_.already_so();
        return !c_.take_attributes().empty() || back();
    }
    if (gets_something() && subjects.size() == 1) {
        if (c_.is(Class::word_has) || c_.is(Class::word_have)) ++c_.at;
        ++c_.at;
        return has_list(subjects.front(), "with") || back();
    }
    const bool modal = c_.take(Class::modal).length > 0;
    if (modal && subjects.size() == 1 && (c_.word().base == "lose" || gets_something()))
        return loses_or_gets(subjects.front()) || back();
    if (modal && subjects.size() == 1 && names_need())
        return has_list(subjects.front(), "with") || back();  // "the bear needs a hat"
    while (c_.take(Class::as_well)) {}
    if (c_.peek(Class::gone)) {
        Cursor behind = c_;
        behind.take(Class::gone);
        if (behind.at_end_of_clause() || behind.peek(Class::conjunction) || behind.peek(Class::from) ||
            behind.peek(Class::contrast)) {
            c_.at = behind.at;
            for (const auto& subject : subjects) d_.remove(subject);
            return true;
        }
    }
    if (c_.is(Class::word_does) && c_.peek(Class::negation, 1) && c_.peek(Class::verb_need, 2)) {
        c_.at += 3;  // "does not need a hat"
        return lack_list(subjects.front()) || back();
    }
    if (c_.peek(Class::without)) {
        c_.take(Class::without);
        return lack_list(subjects.front()) || back();
    }
    if (modal && c_.take(Class::negation)) return should_not(subjects) || back();
    if (const auto off = c_.peek(Class::verb_remove);
        off.length > 1 && c_.peek(Class::possessive, off.length))
        return remove_clause() || back();  // "takes off its hat"
    if (takes_off()) return take_off() || back();
    if (const auto read = has_something(subjects)) return *read || back();
    if (stands_on_part(subjects.front())) return true;
    if (const auto read = stands_somewhere(subjects.front())) return *read || back();
    if (c_.peek(Class::copula) || c_.peek(Class::look_word) || c_.peek(Class::verb_become) || modal) {
        return is_somehow(subjects, modal) || back();
    }
    if (c_.is_mark(":>")) {
        ++c_.at;
        if (c_.at_end_of_clause()) return back();
        return complement(subjects) || back();
    }
    if ((c_.peek(Class::verb_pose) || moves_part()) && subjects.front().found())
        return pose_text(subjects) || back();
    return back();
}

/// Subjects and what is said of them; nothing where the words may be a description.
std::optional<bool> Reader::statement(const std::vector<Phrase>& phrases, bool said, bool adjective_behind) {
    const auto& phrase = phrases.front();
    Targets subjects;
    bool all = true;
    const bool is_new = phrases.size() == 1 && phrase.indefinite && d_.things_named(phrase).empty();
    if (is_new && is_worn(phrase) && c_.peek(Class::emerging)) {  // "a crown sits on its head"
        Targets made;
        return place_new(phrase, made);
    }
    if (Cursor place = c_;
        is_new && is_thing(phrase) && !d_.kin_of(phrase) &&
        ((place.take(Class::modal) && place.peek(Class::emerging)) || place.take(Class::copula))) {
        place.take(Class::emerging);
        if (place.peek(Class::relation)) {  // "a sign should stand in front of the bear"
            Targets made;
            c_.at = place.at;
            return place_new(phrase, made);
        }
    }
    if (phrase.noun.empty() && phrase.indefinite && !phrase.definite)
        return std::nullopt;  // "a bare wearing"
    const auto named = d_.things_named(phrase);
    const bool exact = std::any_of(named.begin(), named.end(),
                                   [&](std::size_t i) { return d_.scene().things[i].noun == phrase.noun; });
    if (phrase.indefinite && !exact && d_.kin_of(phrase) && phrases.size() == 1)
        return std::nullopt;  // "a teddy bear sits on the grass"
    for (const auto& each : phrases) {
        const auto found = d_.resolve(each);
        all = all && found.found();
        subjects.push_back(found);
    }
    if (all) {
        d_.mention(subjects.front());
        for (std::size_t i = 0; i < subjects.size(); ++i)
            if (subjects[i].thing && phrases[i].indefinite) apply_all({subjects[i]}, phrases[i].attributes);
        const std::size_t here = c_.at;
        if (said && predicate(subjects)) {
            frame_ = Frame::Make;
            if (phrase.indefinite && !described_) described_ = subjects.front();
            return true;
        }
        c_.at = here;
        if (!reason_.empty()) return false;
        if (adjective_behind && complement(subjects)) {
            frame_ = Frame::Make;
            return true;
        }
        if (said && phrase.naming != Naming::Thing) return false;
    } else if (said && subjects.front().kind == Target::Kind::Ambiguous) {
        return fail(reason::Ambiguous);
    } else if (phrase.definite && said && d_.kin_of(phrase) == std::nullopt && !is_ground(phrase)) {
        missing_ = subjects.front().word;
        return fail(reason::NotInScene);
    }
    return std::nullopt;
}

/// "bear to the right", "bear to robot": orders without a verb.
bool Reader::becomes_bare(const Phrase& phrase) {
    const auto found = d_.resolve(phrase);
    if (!found.found()) return false;
    Cursor way = c_;
    const auto side = way.take(Class::direction);
    if (!phrase.has_determiner() && side.length > 1 && way.at_end_of_clause() && found.thing) {
        move_way(found, side, {});
        return true;
    }
    Cursor to = c_;
    Phrase other;
    if (c_.is(Class::word_as) || !to.take(Class::into) || !to.take_phrase(other) ||
        other.naming != Naming::Thing || d_.resolve(other).found() ||
        !(to.at_end_of_clause() || to.peek(Class::conjunction)))
        return false;
    c_.at = to.at;
    frame_ = Frame::Turn;
    return become({found}, other);
}

/// "(the vase should be) under the table": moves it to what is there.
bool Reader::is_to_move(const Target& subject) {
    Cursor ahead = c_;
    Phrase place;
    const auto relation = ahead.take(Class::relation);
    if (!subject.thing || !ahead.take_phrase(place) || !place.definite) return false;
    const auto found = d_.resolve(place);
    return found.thing && !d_.scene().things[*found.thing].is_ground && move_to(subject, relation);
}

/// "(should) lose its hat", "(should) get a hat".
bool Reader::loses_or_gets(const Target& subject) {
    const bool loses = c_.word().base == "lose";
    ++c_.at;
    return loses ? lack_list(subject) : has_list(subject, "with");
}

/// Tells whether a thing stands there that someone may need: "(needs) a hat", "(needs) wings".
bool Reader::names_need() const {
    Cursor needed = c_;
    Phrase clothes;
    return c_.peek(Class::article) || c_.peek(Class::number) || c_.peek(Class::some) ||
           (needed.take_phrase(clothes) && (is_worn(clothes) || is_part(clothes)) && !clothes.definite);
}

/// "takes its hat off".
bool Reader::takes_off() const {
    Cursor ahead = c_;
    Phrase worn;
    if (ahead.word().base != "take" || !c_.peek(Class::possessive, 1)) return false;
    ++ahead.at;
    return ahead.take_phrase(worn) && ahead.is(Class::word_off);
}

bool Reader::take_off() {
    Phrase worn;
    ++c_.at;
    const auto found = c_.take_phrase(worn) ? expect(worn) : Target{};
    ++c_.at;
    if (found.found()) remove_all({found});
    return found.found();
}

/// "raises its arms".
bool Reader::moves_part() const {
    const auto raises = c_.peek(Class::verb_raise);
    return raises && (c_.peek(Class::possessive, raises.length) || c_.is(Class::word_both, raises.length));
}

/// "gets a scarf", "receives two medals".
bool Reader::gets_something() const {
    const std::size_t at = c_.is(Class::word_has) || c_.is(Class::word_have) ? 1 : 0;  // "has grown a beard"
    const auto& verb = c_.word(at).base;
    if (verb == "grow" && c_.peek(Class::worn, at + 1)) return true;
    return (verb == "get" || verb == "receive" || verb == "gain" || verb == "grow" || verb == "sprout") &&
           (c_.peek(Class::article, at + 1) || c_.peek(Class::number, at + 1) ||
            c_.peek(Class::some, at + 1));
}

/// Tells whether a predicate of the phrase follows: "is", "should", "wears", "takes off its".
bool Reader::says_of(const Phrase& phrase) const {
    const auto off = c_.peek(Class::verb_remove);
    return c_.peek(Class::copula) || takes_off() || c_.peek(Class::modal_not) || c_.peek(Class::past_be) ||
           gets_something() || (off.length > 1 && c_.peek(Class::possessive, off.length)) ||
           (c_.is(Class::word_does) && c_.peek(Class::negation, 1)) || c_.peek(Class::modal) ||
           c_.peek(Class::gone) || c_.is_mark(":>") || c_.peek(Class::verb_become) ||
           c_.peek(Class::look_word) ||
           (phrase.has_determiner() &&
            (c_.peek(Class::wearing) || c_.peek(Class::holding) || moves_part() ||
             (c_.is(Class::word_has) || c_.is(Class::word_have)) || c_.peek(Class::verb_pose)));
}

/// "hat: red": takes how a new thing is behind a colon.
bool Reader::coloned(Phrase& phrase) {
    Cursor colon = c_;
    const bool is_new = phrase.naming == Naming::Thing && !phrase.noun.empty() && !phrase.definite &&
                        d_.things_named(phrase).empty() && is_worn(phrase);
    if (!is_new || !c_.is_mark(":>")) return false;
    ++colon.at;
    const auto how = colon.take_attributes();
    if (how.empty() || !colon.at_end_of_clause()) return false;
    c_.at = colon.at;
    phrase.attributes.insert(phrase.attributes.end(), how.begin(), how.end());
    return true;
}

bool Reader::noun_clause() {
    const std::size_t start = c_.at;
    Phrase phrase;
    const bool holds = c_.peek(Class::holding) && c_.word().text.ends_with("ing");
    if (holds && described_) return false;
    if (holds && d_.size() > 0) return fail(reason::NotASentence);  // who holds it was not said
    if (!c_.take_phrase(phrase)) return false;
    if (phrase.naming == Naming::Something) return false;
    narrow(phrase);
    if (phrase.definite) c_.at = behind_modifiers(c_).at;
    if (phrase.owner && has(Class::colour_word, phrase.noun) && c_.peek(Class::modal))
        phrase = Phrase(*phrase.owner);  // "the color of the bear should be red"
    // "chair blue", "the bears ears white", "bear: green"
    std::vector<Phrase> phrases{phrase};
    Cursor list = c_;
    Phrase next;
    for (Cursor ahead = list;
         ahead.take(Class::conjunction) && ahead.take_phrase(next) && !next.noun.empty();) {
        phrases.push_back(next);
        list.at = ahead.at;
    }
    const bool verb = list.peek(Class::copula) || list.peek(Class::modal) || list.peek(Class::gone) ||
                      list.is_mark(":>") || list.peek(Class::verb_become);
    if (phrases.size() > 1 && verb && d_.resolve(phrases[1]).found()) c_.at = list.at;
    else phrases.resize(1);
    if (requested_ && c_.is(Class::word_to) &&
        (starts_verb(1) || c_.peek(Class::wearing, 1) || c_.peek(Class::copula, 1) ||
         c_.peek(Class::holding, 1) || c_.peek(Class::having, 1) || c_.peek(Class::verb_become, 1) ||
         c_.peek(Class::look_word, 1)))
        ++c_.at;  // "my daughter wants the bear to wear a hat"
    const bool said = says_of(phrase);
    Attribute behind;
    Cursor adjective = c_;
    const bool adjective_behind =
        !said && adjective.take_attribute(behind, false) && adjective.at_end_of_clause();
    if (!said && d_.size() == 0 && becomes_bare(phrase)) return true;
    if (!reason_.empty()) return false;
    if (coloned(phrase)) return describe(phrase);
    if (said || adjective_behind) {
        if (const auto read = statement(phrases, said, adjective_behind)) return *read;
    }
    if (phrase.naming == Naming::Everything && !c_.at_end_of_clause()) {
        const auto whole = d_.resolve(phrase);
        if (!whole.found()) return false;
        if (phrase.excepted.empty() || !c_.is(Class::word_in)) posts(whole);
        else if (++c_.at, !complement({whole})) return false;  // "everything but the dog in gray"
        return c_.at_end_of_clause() || c_.peek(Class::except);
    }
    if (requested_ && phrase.naming == Naming::It && c_.is(Class::word_in) && d_.focus().found() &&
        post(d_.focus()))
        return true;  // "could I see it in purple"
    if (phrase.naming != Naming::Thing) {
        c_.at = start;
        return false;
    }
    return describe(phrase);
}

}  // namespace gse::language::plan
