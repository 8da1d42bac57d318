// The sentence as a whole: what it is, its clauses, and what stands between them.
#include "engine/language/plan/grammar/reader.h"

#include <algorithm>

namespace gse::language::plan {
namespace {

constexpr std::size_t LongSentence = 16;  // words; only longer ones may tell a story around the order

}  // namespace

Reader::Reader(std::span<const Word> words, const SceneWords& scene, std::string_view source)
    : c_(words, scene), d_(scene, source), word_count_(words.size()) {}

bool Reader::fail(std::string_view reason) {
    if (reason_.empty()) reason_ = reason;
    return false;
}

Plan Reader::failure() const {
    if (!missing_.empty()) return refusal(reason::NotInScene, missing_);
    Cursor last = c_;
    last.at = word_count_ > 1 ? word_count_ - 1 : 0;
    const bool broken_off = last.peek(Class::article) || last.peek(Class::into) || last.peek(Class::of) ||
                            last.is(Class::word_with) || last.is(Class::word_and);
    if (broken_off && word_count_ > 1) return refusal(reason::Incomplete);  // "turn the bear into"
    return refusal(reason_.empty() ? reason::NotASentence : reason_);
}

/// "can the bear be blue?": a wish. Steps over its first word.
bool Reader::wishes(const Cursor& start) {
    Cursor at = start;
    Phrase subject;
    if (Cursor be = at; be.take(Class::wish) && be.peek(Class::there_is)) {  // "can there be a cat?"
        c_.at = start.at + 1;
        return true;
    }
    if (!at.take(Class::wish) || !at.take_phrase(subject) || !d_.resolve(subject).found()) return false;
    if (!at.peek(Class::copula) && !at.peek(Class::wearing) && !at.peek(Class::having) &&
        !at.peek(Class::holding) && !at.peek(Class::verb_become) && !at.peek(Class::verb_need))
        return false;
    c_.at = start.at + 1;
    return true;
}

/// "what would the bear look like in blue?", "what used to be a bear is a lion": steps to what is said of it.
bool Reader::supposes(Cursor at) {
    Phrase subject;
    if (Cursor former = at; former.is(Class::word_what) && ++former.at) {
        const auto was = former.peek(Class::where_is);
        if (former.word().text != "is" && was) {
            former.at += was.length;
            former.take(Class::to);
            former.take(Class::copula);
            const std::size_t begin = former.at;
            if (former.take_phrase(subject) && d_.resolve(subject).found() &&
                (former.peek(Class::copula) || former.peek(Class::verb_become) ||
                 former.peek(Class::modal))) {
                c_.at = begin;
                return true;
            }
        }
    }
    if (at.is(Class::word_what) || at.word().text == "how") ++at.at;
    else return false;
    if (at.word().text != "would" && at.word().text != "might") return false;
    ++at.at;
    if (!at.take_phrase(subject)) return false;
    const auto found = subject.naming == Naming::It ? d_.pronoun(Naming::It) : d_.resolve(subject);
    if (!(found.found() || subject.naming == Naming::It) || !at.take(Class::look_word)) return false;
    at.take(Class::like);
    if (at.at_end_of_clause()) return false;
    if (found.found() && !found.is_scene()) described_ = found;
    c_.at = at.at;
    return true;
}

std::optional<Plan> Reader::whole_sentence() {
    Cursor at = c_;
    const auto ends = [](Cursor here) {
        while (!here.done() &&
               (here.is_mark(".,;!?:'") || here.take(Class::courtesy) || here.take(Class::as_well)))
            if (here.is_mark(".,;!?:'")) ++here.at;
        return here.done();
    };
    for (int pass = 0; pass < 6; ++pass) {
        for (const auto kind : {Class::never_mind, Class::meta}) {
            Cursor behind = at;
            if (!behind.take(kind) || !ends(behind)) continue;
            if (kind == Class::meta) return refusal(reason::NotAnEdit);
            d_.nothing_asked();
            return d_.finish();
        }
        if (at.is_mark(".,;!?:'")) ++at.at;
        else if (!at.take(Class::courtesy)) break;
    }
    for (Cursor here = c_; !here.done(); ++here.at)
        if (here.peek(Class::injection)) return refusal(reason::NotAnEdit);
    if (at.done()) return refusal(c_.done() ? reason::NotASentence : reason::NotAnEdit);
    if (at.peek(Class::request)) return std::nullopt;
    if (wishes(at) || supposes(at)) return std::nullopt;
    Target there;
    Reader where = *this;
    where.c_ = at;
    bool asked = at.peek(Class::question_word).length > 0 && !(where.stands_where(there) && !where.c_.done());
    Cursor last = c_;
    bool mark = false;
    for (; !last.done(); ++last.at) mark = last.is_mark("?") || (mark && last.is_mark("!"));
    asked = asked || (mark && at.peek(Class::question).length > 0);
    if (asked) return refusal(reason::Question);
    if (const auto verb = at.peek(Class::meta_verb)) {
        constexpr Class Others[] = {
            Class::verb_turn, Class::verb_remove,  Class::verb_rotate, Class::verb_make, Class::verb_add,
            Class::verb_pose, Class::verb_replace, Class::verb_keep,   Class::verb_move, Class::verb_become,
            Class::verb_size, Class::holding,      Class::thing};
        const bool other = std::any_of(std::begin(Others), std::end(Others),
                                       [&](Class kind) { return at.peek(kind).length > 0; });
        bool program = false;
        for (Cursor here = at; !here.done(); ++here.at)
            program = program || here.peek(Class::meta_noun).length > 0;
        bool scene_too = false;
        for (Cursor here = at; !here.done(); ++here.at)
            scene_too = scene_too || here.is_scene_noun(here.word().singular) ||
                        here.peek(Class::style);  // "convert the scene to a cartoon"
        if (!other || (program && !scene_too && verb.length >= 1 && !at.is(Class::word_make)))
            return refusal(reason::NotAnEdit);
    }
    return std::nullopt;
}

bool Reader::skip_separators() {
    const std::size_t before = c_.at;
    while (!c_.done()) {
        if (c_.is_mark(".,;!?:'|/")) ++c_.at;
        else if (const auto behind = c_.peek(Class::as_well);
                 behind && c_.peek(Class::courtesy).length <= behind.length && !c_.peek(Class::rather_than) &&
                 !c_.peek(Class::there_is) && c_.at > 0)
            c_.at += behind.length;
        else break;
    }
    return c_.at > before;
}

/// Segments between commas that say nothing of the scene ("masterpiece, best quality").
bool Reader::skip_noise() {
    const std::size_t before = c_.at;
    Cursor ahead = c_;
    if (ahead.peek(Class::negative_prompt)) {
        ahead.take(Class::negative_prompt);
        if (ahead.is_mark(":")) {
            while (!c_.done()) ++c_.at;
            return true;
        }
    }
    ahead = c_;
    if (ahead.is(Class::word_by)) ++ahead.at;  // "by greg rutkowski"
    const std::size_t begin = ahead.at;
    while ((!ahead.peek(Class::caption) && ahead.take(Class::noise)) ||
           (ahead.at > begin && (ahead.take(Class::conjunction) || ahead.take(Class::degree)))) {}
    if (Cursor shot = c_; shot.take(Class::article) && shot.take(Class::noise)) {
        while (!shot.peek(Class::caption) && shot.take(Class::noise)) {}
        if (shot.peek(Class::caption)) c_.at = shot.at;  // "a stunning photo of a bear"
    }
    if (ahead.at > begin && (ahead.at_end_of_clause() || ahead.peek(Class::caption))) c_.at = ahead.at;
    ahead = c_;
    if (const auto prefix = ahead.peek(Class::prefix); prefix && ahead.is_mark(":", prefix.length)) {
        c_.at += prefix.length + 1;
    }
    return c_.at > before;
}

void Reader::skip_lead_in() {
    while (!c_.done()) {
        if (skip_separators() || skip_noise()) continue;
        const std::size_t before = c_.at;
        if (c_.peek(Class::only) || c_.peek(Class::do_not)) break;
        if (const auto corrects = c_.peek(Class::correction); corrects && d_.size() > 0) {
            Cursor told = c_;  // "make it yellow. actually, orange"
            told.at += corrects.length;
            told.take_mark(',');
            const bool fragment = !told.done() && !starts_verb(told.at - c_.at) && !told.peek(Class::request);
            if (fragment && corrects.length >= c_.peek(Class::courtesy).length) break;
        }
        if (const auto meant = c_.peek(Class::correction); meant.length > 1 && d_.size() == 0 && c_.at < 3)
            c_.at += meant.length;  // "sorry, I meant a blue bear"
        if (const auto found = c_.peek(Class::request)) {
            // "show", "let me": only where something follows
            Cursor ahead = c_;
            ahead.at += found.length;
            if (ahead.done()) break;
            const bool verb_of_ours = found.length == 1 &&
                                      (c_.peek(Class::verb_make) || c_.peek(Class::verb_add)) &&
                                      !c_.is(Class::word_want) && !c_.is(Class::word_try) &&
                                      !starts_verb(found.length);  // "let's paint it"
            if (verb_of_ours) break;
            const bool gets = c_.is(Class::word_get, found.length - 1) &&
                              c_.peek(Class::verb_remove, found.length - 1);  // "can we get rid of the bear?"
            c_.at = gets ? ahead.at - 1 : ahead.at;
            const auto& who = c_.word().text;  // "it would be nice if you put"
            if (c_.previous().text == "if" && (who == "you" || who == "we"))
                c_.at += c_.peek(Class::modal, 1) ? 2 : 1;
            prefers_ = c_.previous().text == "prefer";
            requested_ = true;
        } else if (const auto polite = c_.peek(Class::courtesy);
                   polite && !(polite.length == 1 && c_.noun_length() > 0 && c_.is_mark(":", 1))) {
            c_.at += polite.length;
        } else if (const auto step = c_.peek(Class::sequence); step && !(c_.noun_length() > step.length)) {
            c_.at += step.length;
        } else if (c_.peek(Class::conjunction)) {
            c_.take(Class::conjunction);
        } else if (c_.peek(Class::contrast) && !c_.peek(Class::rather_than)) {
            c_.take(Class::contrast);
        } else if (somebody_says() || would_be_good()) {
            requested_ = true;
        } else if (takes_and()) {
        } else if (c_.peek(Class::colour_word) && c_.is_mark(":>", 1)) {
            c_.at += 2;  // "color=blue"
        } else if (c_.peek(Class::prefix) && c_.is_mark(":", c_.peek(Class::prefix).length)) {
            c_.at += c_.peek(Class::prefix).length + 1;
        }
        if (c_.at == before) break;
    }
}

/// "except the bear": it is left out of the steps that the clause made, which are those from `steps` on.
bool Reader::leaves_out(std::size_t steps) {
    Cursor ahead = c_;
    ahead.take_mark(',');
    Phrase other;
    if (!ahead.take(Class::except) || d_.size() <= steps || !ahead.take_phrase(other) ||
        !(ahead.at_end_of_clause() || ahead.peek(Class::courtesy)))
        return false;
    const auto found = d_.resolve(other);
    if (!found.found() || found.is_scene() || (is_part(other) && !found.thing)) return false;
    c_.at = ahead.at;
    d_.leave_out(found, steps);
    return true;
}

/// Behind a clause: "instead of red", "rather than the grass", "except the bear".
void Reader::skip_rest(std::size_t steps) {
    if (leaves_out(steps)) return;
    Cursor ahead = c_;
    Phrase other;
    Attribute attribute;
    const bool changes = frame_ == Frame::Make || frame_ == Frame::Paint || frame_ == Frame::Turn ||
                         (frame_ == Frame::None && d_.size() > 0);  // "could it be yellow instead of red"
    Cursor place = c_;  // "paint the bear golden on the grass": the grass is there
    if (const auto relation = place.take(Class::relation);
        changes && (relation.value == "on" || relation.value == "in")) {
        Phrase ground;
        if (place.take_phrase(ground) && ground.definite && is_ground(ground) && place.at_end_of_clause() &&
            !d_.things_named(ground).empty()) {
            c_.at = place.at;
            return;
        }
    }
    if (!changes || (!ahead.take(Class::rather_than) && !ahead.take(Class::except))) return;
    Cursor thing = ahead;
    Cursor part = ahead;
    if (c_.peek(Class::except) && part.take_phrase(other) && is_part(other) &&
        d_.things_named(other).empty()) {  // "blue except for the head": no step says it
        c_.at = part.at;
        d_.refuse(reason::NotASentence);
        return;
    }
    const bool except = c_.peek(Class::except) && !c_.peek(Class::rather_than);
    if (except) return;
    if (thing.take_phrase(other) && d_.resolve(other).found()) c_.at = thing.at;
    else if (ahead.take_attribute(attribute, false)) c_.at = ahead.at;
}

bool Reader::ends_well() const {
    Cursor here = c_;
    while ((!here.peek(Class::rather_than) && here.take(Class::as_well)) || here.take(Class::courtesy)) {}
    return here.at_end_of_clause() || here.peek(Class::rather_than) || here.peek(Class::except) ||
           here.peek(Class::conjunction) || here.peek(Class::sequence) || here.peek(Class::contrast) ||
           here.peek(Class::noise) || (here.peek(Class::plain_verb) && starts_verb(here.at - c_.at));
}

/// Position behind "under the bear, which is a bit boring," where what is to be follows; else the same.
Cursor Reader::behind_modifiers(Cursor subject) const {
    Cursor behind = subject;
    Phrase place;
    if (behind.take(Class::relation) && !behind.take_phrase(place)) return subject;
    if (Cursor apart = behind; apart.take_mark(',') && apart.take(Class::relative)) {
        while (!apart.done() && !apart.is_mark(".,;!?:")) ++apart.at;
        if (apart.take_mark(',')) behind.at = apart.at;
    }
    return behind.peek(Class::modal) ? behind : subject;
}

/// A clause of a long sentence that tells a story, up to the next comma.
bool Reader::skip_narrative(std::size_t start) {
    if (word_count_ < LongSentence) return false;
    Cursor here = c_;
    here.at = start;
    bool story = false;
    while (!here.at_end_of_clause()) {
        story = story || here.peek(Class::narrative) || here.peek(Class::subordinate);
        ++here.at;
    }
    if (!story) return false;
    c_.at = here.at;
    return true;
}

/// "where the bear is": the target that stands there.
bool Reader::stands_where(Target& target) {
    Cursor ahead = c_;
    Phrase phrase;
    if (!ahead.is(Class::word_where)) return false;
    ++ahead.at;
    if (!ahead.take_phrase(phrase)) return false;
    const auto found = d_.resolve(phrase);
    if (!found.found() || !ahead.take(Class::where_is)) return false;
    while (ahead.take(Class::as_well)) {}
    target = found;
    c_.at = ahead.at;
    return true;
}

/// "in the bear's place": the target whose place it is.
bool Reader::in_place_of(Target& target) {
    Cursor ahead = c_;
    Phrase owner;
    if (const auto instead = ahead.peek(Class::instead); instead.length > 2) {  // "in its place"
        target = d_.removed_last() ? *d_.removed_last() : d_.focus();
        c_.at += instead.length;
        return target.found();
    }
    ahead.take(Class::modal);
    const bool takes = ahead.word().base == "take";  // "take the bear's place"
    if (!ahead.is(Class::word_in) && !takes) return false;
    ++ahead.at;
    Cursor place = ahead;
    place.take(Class::definite);
    if (place.is(Class::word_place) && place.peek(Class::of, 1)) {  // "the place of the bear"
        place.at += 2;
        if (!place.take_phrase(owner)) return false;
        ahead.at = place.at;
    } else if (takes && ahead.peek(Class::possessive) && ahead.is(Class::word_place, 1)) {
        owner.naming = Naming::It;
        ahead.at += 2;
    } else if (ahead.take_phrase(owner) && ahead.is_owner_mark() && ahead.is(Class::word_place, 1)) {
        ahead.at += 2;
    } else return false;
    target = owner.naming == Naming::It ? d_.focus() : d_.resolve(owner);
    if (!target.found()) return false;
    c_.at = ahead.at;
    return true;
}

/// "my boss thinks that": steps over who says it.
bool Reader::somebody_says() {
    Cursor ahead = c_;
    Phrase who;
    if (!ahead.take_phrase(who) || who.naming != Naming::Thing || who.noun.empty()) return false;
    const bool person = (kinds_of(who.noun) & Person) != 0 || who.possessive;
    if (!person || d_.resolve(who).found() || is_part(who) || is_worn(who)) return false;
    if (!ahead.take(Class::said_by) || ahead.at_end_of_clause()) return false;
    c_.at = ahead.at;
    return true;
}

/// "it would be fantastic if you could": steps over it.
bool Reader::would_be_good() {
    constexpr std::size_t MostWords = 3;  // between "be" and "if"
    Cursor ahead = c_;
    if (ahead.is(Class::word_it)) ++ahead.at;
    if (ahead.word().text != "would" || ahead.word(1).text != "be") return false;
    ahead.at += 2;
    std::size_t words = 0;
    for (; words < MostWords && !ahead.at_end_of_clause() && ahead.word().text != "if"; ++words) ++ahead.at;
    if (words == 0 || ahead.word().text != "if") return false;
    ++ahead.at;
    const auto& who = ahead.word().text;
    if ((who == "you" || who == "we") && ahead.peek(Class::modal, 1)) ahead.at += 2;
    else if (who == "you" || who == "we") ++ahead.at;
    c_.at = ahead.at;
    return true;
}

/// "take the bear and": the thing that an order is about.
bool Reader::takes_and() {
    Cursor ahead = c_;
    Phrase phrase;
    if (!ahead.is(Class::word_take)) return false;
    ++ahead.at;
    if (!ahead.take_phrase(phrase)) return false;
    const auto found = phrase.naming == Naming::It ? d_.pronoun(Naming::It) : d_.resolve(phrase);
    ahead.take_mark(',');
    if (!found.found() || !ahead.take(Class::conjunction) || !starts_verb(ahead.at - c_.at)) return false;
    d_.mention(found);
    c_.at = ahead.at;
    return true;
}

bool Reader::correction() {
    Cursor ahead = c_;
    const bool refuses = ahead.peek(Class::none).length > 0;
    if (!ahead.take(Class::correction)) return false;
    if (refuses && ahead.at == c_.at + 1 && !ahead.is_mark(",.!") && !ahead.peek(Class::correction))
        return false;                                                 // "no grass"
    while (!(ahead.peek(Class::none) && ahead.noun_length(1) > 0) &&  // "on second thought, no hat"
           (ahead.take(Class::correction) || ahead.take_mark(',') || ahead.take_mark('.'))) {}
    if ((d_.size() == 0 && !d_.says_same()) || ahead.done()) return false;
    if (Cursor not_at_all = ahead;
        not_at_all.take(Class::do_not) && (not_at_all.take_mark('.'), not_at_all.done())) {
        while (d_.size() > 0) d_.drop_last();  // "actually, do not"
        d_.nothing_asked();
        c_.at = not_at_all.at;
        return true;
    }
    c_.at = ahead.at;
    return true;
}

Plan Reader::read_story() {
    bool asked = false;  // "could you please ...?" is no question
    for (Cursor here = c_; !here.done(); ++here.at) {
        asked = asked || here.peek(Class::request);
        if (here.peek(Class::injection) || (here.is_mark("?") && !asked)) return failure();
    }
    while (!c_.done()) {
        const std::size_t start = c_.at;
        requested_ = false;
        skip_lead_in();
        if (c_.done()) break;
        const auto draft = d_;
        Phrase subject;
        Cursor ahead = c_;
        const bool wish = ahead.take_phrase(subject) && d_.resolve(subject).found() &&
                          behind_modifiers(ahead).peek(Class::modal);
        const bool order = starts_verb() && c_.word().text == c_.word().base && !c_.peek(Class::verb_keep);
        const std::size_t begin = c_.at;
        const bool read = (requested_ || wish || order) && clause() && c_.at > begin && ends_well();
        reason_ = {};
        missing_.clear();
        if (read) continue;
        d_ = draft;
        c_.at = std::max(begin, start);
        while (!c_.done() && !c_.is_mark(".,;!:") && !c_.peek(Class::request)) ++c_.at;
        if (c_.at == begin && c_.peek(Class::request)) ++c_.at;
    }
    if (d_.size() == 0 && !d_.asked_nothing()) return refusal(reason::NotAnEdit);
    return d_.finish();
}

/// An order about what is not there, beside others: "rotate the house and paint the bear black". Steps over
/// it.
bool Reader::refuses_clause(std::size_t start) {
    Phrase named;
    named.noun = named.typed = missing_;
    if (missing_.empty() || reason_ != reason::NotInScene || !is_thing(named)) return false;
    c_.at = start;
    if (!starts_verb()) return false;
    Cursor next = c_;
    ++next.at;
    for (; !next.done(); ++next.at) {
        Cursor order = next;
        while (order.is_mark(".,;") || order.peek(Class::conjunction) || order.peek(Class::sequence))
            ++order.at;
        if (order.at > next.at && starts_verb(order.at - c_.at)) break;
        if (next.is_mark(".;!")) return false;  // what follows is no order
    }
    if (next.done() && d_.size() == 0 && not_there_.empty()) return false;
    for (Cursor rest = next; !rest.done(); ++rest.at)
        if (rest.peek(Class::pronoun_it) || rest.peek(Class::pronoun_person) || rest.peek(Class::possessive))
            return false;
    not_there_.push_back(missing_);
    reason_ = {};
    missing_.clear();
    c_.at = next.at;
    return true;
}

/// "turn the bear so that it faces left": the second clause says how. Steps over the first.
bool Reader::says_how_later(std::size_t start) {
    Cursor ahead = c_;
    ahead.at = start;
    Phrase phrase;
    const auto verb =
        ahead.peek(Class::verb_rotate) ? ahead.take(Class::verb_rotate) : ahead.take(Class::verb_move);
    if (reason_ != reason::Incomplete || !verb || !ahead.take_phrase(phrase) || !ahead.take_mark(','))
        return false;
    const auto found = d_.resolve(phrase);
    if (!found.found() || !(ahead.peek(Class::pronoun_it) || ahead.peek(Class::pronoun_person))) return false;
    d_.mention(found);
    reason_ = {};
    c_.at = ahead.at;
    return true;
}

Plan Reader::read() {
    if (auto plan = whole_sentence()) return *plan;
    bool narrated = false;
    while (true) {
        skip_lead_in();
        if (c_.done()) break;
        const std::size_t start = c_.at;
        const std::size_t steps = d_.size();
        const bool read = clause();
        if (read) skip_rest(std::min(steps, d_.size()));
        if (read && ends_well()) continue;
        if (!read && (refuses_clause(start) || says_how_later(start))) continue;
        if (!missing_.empty() && !read && reason_ == reason::NotInScene && d_.size() == 0) return failure();
        c_.at = start;
        if (read || !skip_narrative(start)) {
            if (reason_.empty()) reason_ = reason::NotASentence;
            return failure();
        }
        reason_ = {};
        missing_.clear();
        narrated = true;
    }
    if (d_.size() == 0 && !not_there_.empty()) return refusal(reason::NotInScene, not_there_.front());
    for (const auto& each : not_there_) d_.refuse(reason::NotInScene, each);
    if (d_.size() == 0 && (!reason_.empty() || !missing_.empty())) return failure();
    if (narrated && d_.size() == 0) return refusal(reason::NotAnEdit);
    if (d_.size() == 0 && !d_.says_same() && !d_.asked_nothing()) return refusal(reason::Incomplete);
    return d_.finish();
}

}  // namespace gse::language::plan
