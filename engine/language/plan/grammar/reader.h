// Reads a sentence clause by clause and makes the steps of its plan.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/language/plan/grammar/draft.h"
#include "engine/language/plan/notation/plan.h"
#include "engine/language/plan/phrases/phrase.h"

namespace gse::language::plan {

class Reader {
public:
    Reader(std::span<const Word> words, const SceneWords& scene, std::string_view source);
    Plan read();
    /// Reads the orders and wishes of a long text, and leaves out what it tells around them.
    Plan read_story();

private:
    using Targets = std::vector<Target>;
    /// Kind of the last verb: "paint the bear green, the grass white".
    enum class Frame { None, Make, Turn, Paint, Replace, Add, Give, Remove, Describe };

    // reader.cpp: the whole sentence, and what stands before and between clauses
    bool wishes(const Cursor& start);
    std::optional<Plan> whole_sentence();
    bool supposes(Cursor at);
    bool refuses_clause(std::size_t start);
    bool says_how_later(std::size_t start);
    void skip_lead_in();
    bool skip_noise();
    bool skip_separators();
    bool clause();
    bool ends_well() const;
    void skip_rest(std::size_t steps);
    bool leaves_out(std::size_t steps);
    bool skip_narrative(std::size_t start);
    Cursor behind_modifiers(Cursor subject) const;
    bool fail(std::string_view reason);
    Plan failure() const;
    bool correction();
    bool stands_where(Target& target);
    bool in_place_of(Target& target);
    bool somebody_says();
    bool would_be_good();
    bool takes_and();
    bool starts_verb(std::size_t ahead = 0) const;
    bool starts_object(std::size_t ahead) const;

    // reader_verbs.cpp: imperatives
    bool verb_clause();
    bool try_verbs();
    void leave_as_it_is(const Phrase& phrase);
    bool keep_coloured(const Phrase& phrase, Cursor behind);
    bool keep_clause();
    bool likes_clause();
    bool make_clause();
    bool looks_as_a_whole();
    bool makes_several(Cursor counted);
    bool paint_clause();
    std::optional<bool> changes_backdrop();
    bool turn_clause();
    std::optional<bool> use_clause(bool substitute);
    bool takes_exchange();
    bool replace_clause();
    bool become_each(const Targets& targets, const Phrase& first);
    void add_beside();
    bool give_clause();
    bool dress_clause();
    bool covers_plainly(const Targets& targets);
    bool cover_clause();
    void skip_from(Targets& targets);
    void take_worn(Targets& targets) const;
    bool takes_away(const Cursor& particle, bool direct, bool gets) const;
    void remove_all(const Targets& targets);
    bool take_things_there(Targets& targets);
    bool pull_off();
    bool remove_excepted(const Phrase& phrase);
    bool remove_clause();
    bool shave_clause();
    bool instruct_less_clause();
    // reader_moves.cpp
    bool add_one();
    bool add_clause();
    bool place_new(const Phrase& phrase, Targets& made);
    bool place_aside(const Target& thing);
    std::string_view take_side(Target& whose);
    bool place_on_body(const Phrase& phrase, const Target& thing, Target body, const Phrase& where,
                       std::string_view relation);
    bool place_between(const Target& thing, const Target& anchor);
    bool add_surroundings(const Phrase& phrase);
    bool add_paint(const Phrase& phrase);
    bool add_pattern(const Phrase& phrase);
    std::optional<bool> add_in_place(const Phrase& phrase, const Target& found);
    bool place_at(const Phrase& phrase, const Target& thing, const Target& bearer, const Phrase& where,
                  std::string_view relation);
    std::string take_amount();
    void move_way(const Target& target, const Match& direction, std::string amount);
    bool skip_origin();
    void skip_particle();
    bool poses_so(std::string_view verb, const Targets& targets);
    bool move_to(const Target& target, const Match& relation, bool from = false);
    bool move_clause();
    std::string take_factor(bool scale, bool smaller);
    bool take_sized(Targets& targets, std::string_view& sizes);
    bool size_clause();
    std::string take_degrees();
    bool rotate_clause();
    bool face_clause();
    bool fire_clause();
    bool move_target(const Target& target);
    bool ellipsis();

    // reader_says.cpp: statements and descriptions
    void skip_moon();
    void skip_weather_place(Cursor& behind, bool of_it) const;
    bool environment_clause();
    bool style_clause();
    bool there_is_clause();
    bool only_clause();
    bool instead_clause();
    std::optional<bool> statement(const std::vector<Phrase>& phrases, bool said, bool adjective_behind);
    bool becomes_bare(const Phrase& phrase);
    bool says_of(const Phrase& phrase) const;
    bool gets_something() const;
    bool moves_part() const;
    bool loses_or_gets(const Target& subject);
    bool takes_off() const;
    bool take_off();
    bool takes_alone(Cursor& ahead, Phrase& phrase) const;
    bool is_to_move(const Target& subject);
    bool names_need() const;
    bool coloned(Phrase& phrase);
    bool noun_clause();
    std::optional<bool> has_something(const Targets& subjects);
    bool is_somehow(const Targets& subjects, bool modal);
    std::optional<bool> stands_somewhere(const Target& subject);
    bool predicate(const Targets& subjects);
    bool describe(const Phrase& phrase);
    bool describe_nameless(const Phrase& phrase);
    bool describe_empty(const Phrase& phrase, const Target& found);
    bool empties(const Targets& targets);
    static bool ends_at(const Cursor& here) { return here.at_end_of_clause() || here.peek(Class::courtesy); }
    void describe_telegraphic(const Target& found);
    bool lies_on_ground(const Phrase& phrase);
    std::optional<bool> describe_elsewhere(const Phrase& phrase);
    bool describe_part(const Phrase& phrase, const Target& found);
    std::optional<bool> describe_place(const Phrase& phrase, bool bare);
    std::optional<bool> describe_instead(const Phrase& phrase);
    bool describe_beside(const Phrase& phrase);
    bool stands_by_other(const Phrase& phrase) const;
    bool describe_pattern(const Phrase& phrase);
    std::optional<bool> describe_on_top(const Phrase& phrase);
    bool describe_new(const Phrase& phrase);
    bool describe_further(const Phrase& phrase, const Target& bearer);
    bool describe_clinging(const Phrase& phrase);
    bool is_slip_of_focus(const Phrase& phrase) const;
    std::optional<bool> describe_other_kind(const Phrase& phrase, const Target& found);
    bool describe_likeness(const Phrase& phrase);
    bool describe_kin(const Phrase& phrase, const Target& kin, std::size_t thing);
    bool describe_in_style(const Phrase& phrase, std::size_t thing);
    bool skip_instead();
    bool describe_more();
    bool bare_ground();
    bool attributes_for();
    bool attribute_clause();
    bool names_later(const Phrase& phrase) const;
    bool mentions_focus(std::size_t from) const;

    // reader_negates.cpp: what is not to be
    bool negative_clause();
    bool no_thing_clause();
    bool nobody_clause(Cursor ahead);
    bool not_there_clause();
    bool do_not_clause(Cursor ahead);
    bool unwanted_clause(Cursor ahead);
    bool is_only_mentioned(const Target& unwanted) const;
    bool neither_clause();
    bool should_not(const Targets& subjects);
    bool denied(const Targets& targets);
    bool lack_list(const Target& subject);
    bool lack_both(const Target& subject);
    bool lack(const Target& subject, const Phrase& phrase);

    // reader_copies.cpp: more of what is there, and exchanges
    bool swaps_colours();
    bool swap_clause();
    bool swap_all(const Targets& targets);
    bool swaps_places(const Targets& targets);
    bool duplicate_clause();
    bool copies(const Phrase& phrase);
    void add_another(const Phrase& phrase, const Target& target, const std::string& noun);
    bool one_more(const Phrase& phrase);
    bool beside_its_like(const Phrase& phrase, const Target& target);
    bool describe_other(const Phrase& phrase);
    std::optional<bool> describe_one_of(const Phrase& phrase);

    // reader_change.cpp: what becomes of things
    bool shift_clause();
    bool pose_clause();
    bool complement(const Targets& targets);
    bool described_as(const Targets& targets);
    bool stands_so(const Targets& targets);
    bool complement_once(const Targets& targets);
    bool as_much_as(const Targets& targets);
    bool faces(const Targets& targets);
    bool looks_somewhere(const Targets& targets);
    bool measure(const Targets& targets);
    bool percent(const Targets& targets);
    bool compared(const Targets& targets);
    bool looks_like(const Targets& targets, const Phrase& model);
    bool alike(const Targets& targets);
    bool said_of_part(const Target& target) const;
    bool become(const Targets& targets, const Phrase& phrase);
    bool material_of(const Targets& targets);
    bool apply_all(const Targets& targets, const std::vector<Attribute>& attributes);
    bool lies_there(const Target& made);
    bool pose_text(const Targets& targets);
    bool style_text(const Targets& targets);

    // reader_posts.cpp: what stands behind a noun
    void posts(const Target& subject);
    bool inversely_related(const Target& subject);
    bool weather_clause();
    bool burns(const Target& subject);
    void skip_where_pose();
    bool holds(const Target& subject);
    bool post(const Target& subject);
    bool stands_on_part(const Target& subject);
    bool has_quality(const Target& subject, std::string_view relation);
    bool has_looks(const Target& subject, const std::vector<Attribute>& attributes);
    void undress();
    bool has_list(const Target& subject, std::string_view relation);
    bool own_there(const Target& subject, const Phrase& phrase, std::string_view relation,
                   const Target& there);
    bool own(const Target& subject, const Phrase& phrase, std::string_view relation);
    bool own_part(const Target& subject, const Phrase& phrase);
    bool own_pattern(const Target& subject, const Phrase& phrase);
    bool related(const Target& subject);
    bool usually_on(const Target& subject, const Target& found) const;
    bool relate_there(const Target& subject, std::string_view relation, const Phrase& phrase,
                      const Target& found);
    bool between(const Target& subject, const Phrase& phrase);
    bool relate(const Target& subject, std::string_view relation, const Phrase& phrase);
    bool in_colour(const Target& subject);
    bool in_place(const Cursor& ahead, const std::string& before);
    bool surroundings(const Target& subject, std::string_view relation);
    bool relative(const Target& subject);
    bool skip_likeness();
    std::optional<bool> nested_place(const Target& made, const Target& bearer, Cursor ahead);
    void nested(const Target& made, const Target& bearer);
    bool list_goes_on();
    bool takes_use(const Target& made, const Target& bearer);

    bool objects(Targets& targets, std::vector<Phrase>* phrases = nullptr, bool split = false);
    bool contradicts_colour(const Phrase& phrase, const Target& found) const;
    Targets things_on(const Target& target) const;
    Targets what_is_worn();
    void narrow(Phrase& phrase);
    void tell_apart(Phrase& phrase);
    std::string doing();
    bool all_but(const std::vector<Phrase>& excepted, Targets& targets);
    Targets both() const;
    Targets collective(const Phrase& phrase) const;
    std::optional<bool> untold_object(Targets& targets, Phrase& phrase);
    bool object(Targets& targets, Phrase& phrase, bool split = false);
    Target expect(const Phrase& phrase);
    bool on_bearer(const Phrase& phrase, Target& bearer) const;

    Cursor c_;
    Draft d_;
    Frame frame_ = Frame::None;
    std::string_view reason_;
    std::string missing_;
    std::vector<Phrase> instead_;
    std::vector<std::string> not_there_;  // what orders that are left out are about
    std::optional<Target> described_;
    bool described_definite_ = false;  // "the bear", not "a bear"
    bool requested_ = false, prefers_ = false, puts_ = false, refused_part_ = false;
    std::size_t word_count_ = 0;
};

}  // namespace gse::language::plan
