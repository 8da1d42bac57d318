// How sure a search is of what it found, and whether that is enough: the whole rule.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/edit/masks/search_outcome.h"
#include "engine/edit/masks/view_evidence.h"
#include "engine/edit/search/view_renders.h"
#include "engine/scene/label_field.h"
#include "engine/scene/scene.h"

namespace gse::edit {

/// Share of a label's border that the pictures' edges may make (localize::frame_cut). Labels that lie whole
/// in the views have 0 to 0.01, cut ones 0.05 and more (`gseditpro-lab bench search`).
constexpr double MostCut = 0.1;
constexpr int LeastVotingViews = 3;  // fewer voting views cannot tell front from back

/// One figure that a confidence is made of, in [0,1].
struct ConfidencePart {
    const char* key;  // in reports
    double value = 0;
    const char* phrase;    // for one line, with {} in place of the figure
    const char* sentence;  // for a line of its own, with {} in place of the figure
};

/// How sure a search is, in [0,1]; `value` is the one figure that decides.
struct Confidence {
    double value = -1;  // negative = nothing was looked for
    std::vector<ConfidencePart> parts;

    /// Value of the part with this key; negative where there is none.
    double part(const std::string& key) const;
};

/// "confidence 0.71: the views agree to 0.83, ..."; for what was not looked for, a sentence that says so.
std::string confidence_text(const Confidence& confidence);

/// All that speaks for and against what a search found.
struct SearchEvidence {
    const std::string& word;
    const std::vector<ViewEvidence>& views;
    const LabelField& field;
    const Label& label;       // of the field
    double recognition = -1;  // share of the other known words that fit the pictures less; negative = unknown
    GroundEvidence ground = {};  // that is no part of the scene
    bool names_others = false;   // the sentence names other things than the word
};

/// Verdict on a search: found or not, how surely, and if it was not: the reason and the remedy.
struct SearchVerdict {
    Confidence confidence;
    SearchProblem problem = SearchProblem::None;
    std::string message = {}, remedy = {};
    bool sure() const { return problem == SearchProblem::None; }
};

/// Outcome of a second look at a finding (second_look.h).
struct SecondLook {
    std::optional<double> lead;    // WordLead::lead; nothing where no encoder can tell
    std::string better;            // the word that fits better; empty where none does
    bool worn = false;             // the word names something worn
    double cut = 0;                // share of the label's border that the pictures' edges make
    int cut_views = 0, views = 0;  // views whose mask reaches the picture's edge, and views that vote
};

/// The refusal of views of which too few found the word; nothing where enough did. Views that are left out
/// do not count.
std::optional<SearchVerdict> refuse_views(const std::string& word, const std::vector<ViewEvidence>& views);

/// The refusal of a label that holds next to nothing of a scene; nothing where it holds enough.
std::optional<SearchVerdict> refuse_label(const std::string& word, const Label& label);

/// The confidence, and SearchProblem::Unsure where it is below `least`.
SearchVerdict judge(const SearchEvidence& evidence, double least);

/// The verdict after a second look, never surer than before. It is unsure where the encoder does not agree
/// with the word, or where the pictures cut the label off.
SearchVerdict reconsider(SearchVerdict verdict, const std::string& word, const SecondLook& look,
                         double least);

/// Pixels of a ground that is no part of the scene (ViewRenders::grounds), over the views that found
/// something.
GroundEvidence ground_seen(const std::vector<ViewEvidence>& views, const std::vector<Image>& grounds);

}  // namespace gse::edit
