// One word looked for in all views of a scene, and the label that they agree on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/edit/search/locate.h"
#include "engine/localize/back_projection.h"

namespace gse::edit {

constexpr std::uint64_t SearchSeed = 0;  // one for all: what is found does not follow the loop's dice
constexpr float LabelSeen = 0.5f;        // share of a pixel from which it shows a label

/// One word to look for.
struct SoughtWord {
    std::string name;
    std::string prompt;                  // holds the name and those that compete with it
    std::vector<std::string> competing;  // other things, whose attention counts against it
    bool competing_given = false;        // by the user, not read off the sentence
    bool absent = false;                 // the pictures do not show it yet
    bool whole = false;                  // what the request is about: excluded views do not vote on it
    bool alone = false;  // it goes, and the sentence names nothing that it wears or holds: what only it holds
                         // goes with it
};

/// Outcome of the views of one word.
struct FoundWord {
    FoundField field;
    Label label;
    SearchVerdict verdict;
    std::vector<std::uint8_t> beside = {};  // [N] or empty, see LocateResult
};

/// Calls some(begin, end, worker) for parts of [0, count): one after the other without threads.
void over_views(ThreadPool* threads, std::size_t count,
                const std::function<void(std::size_t, std::size_t, unsigned)>& some);

/// Searches over the same views. Refers to all it is given.
class WordSearch {
public:
    WordSearch(const LocateInput& input, const LocateTools& tools, const ViewRenders& seen);

    /// The word with a prompt that surely contains it, and the other things of the sentence.
    SoughtWord sought(const std::string& name, bool absent) const;
    /// Attention and masks of all views.
    std::vector<ViewEvidence> look(const SoughtWord& word);
    /// Looks with few probes, fuses, and asks views again whose mask is at odds with what all say together;
    /// at most half of them: where more are, it is not the noise.
    FoundWord find(const SoughtWord& word, std::vector<ViewEvidence>& views);
    /// Marks the views that the request leaves out.
    void exclude(std::vector<ViewEvidence>& views) const;
    /// Values of the attention so far that were not finite, and count as none.
    std::size_t broken() const { return broken_; }

private:
    const CheckedRequest& request() const { return input_.request; }
    double threshold() const;
    void check_stop() const;
    /// Drops maps of views in which the word draws much less attention than elsewhere: scaled to their
    /// maximum, they are noise.
    void hide_faint(std::vector<ViewEvidence>& views) const;
    void make_masks(const SoughtWord& word, std::vector<ViewEvidence>& views);
    ViewEvidence attend(const SoughtWord& word, std::size_t v);
    AttentionQuery query_of(const SoughtWord& word, std::size_t v, int repeats, std::uint64_t stream) const;
    /// Tells the source of the views from `first` on that are worth asking with it.
    void prepare(const SoughtWord& word, const std::vector<std::size_t>& views, std::size_t first,
                 int repeats, std::uint64_t stream);
    /// Maps of the word and of those that compete with it, each divided by its maximum.
    std::vector<Image> maps_of(const SoughtWord& word, std::size_t v, int repeats, std::uint64_t stream);
    /// Asks once more for the word alone where the model cannot read one that nobody asked for.
    std::vector<Image> ask(AttentionQuery& query, bool strict) const;
    /// Views that are asked again: those of the first threshold that was tried, where that is remembered.
    std::vector<std::size_t> to_ask_again(const SoughtWord& word, const Label& label,
                                          const std::vector<ViewEvidence>& views);
    std::vector<std::size_t> at_odds(const Label& label, const std::vector<ViewEvidence>& views);
    FoundWord nothing(const SoughtWord& word, SearchVerdict verdict) const;
    /// Fuses the masks into a field and its label.
    FoundWord fuse(const SoughtWord& word, const std::vector<ViewEvidence>& views);
    /// Takes what is seen outside of LocateInput::within off the mask of view `v`.
    void limit(ViewEvidence& view, std::size_t v) const;
    /// Takes rows outside of LocateInput::within off.
    /// Takes rows out of what the views said.
    static void leave_out(const std::vector<std::uint8_t>& rows, LabelField& field);
    void keep_within(LabelField& field, Label& label) const;
    /// How well some of the pictures fit the word; negative where nobody can tell.
    double recognised(const std::string& word) const;

    const LocateInput& input_;
    const LocateTools& tools_;
    const ViewRenders& seen_;
    localize::VoteCache votes_;
    std::vector<std::size_t> excluded_;
    std::vector<Mask> within_;  // per view: where LocateInput::within is seen; empty = anywhere
    std::vector<float> peaks_;  // per view: the most attention that the word of the last search drew there
    std::size_t broken_ = 0;
};

}  // namespace gse::edit
