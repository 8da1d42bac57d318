// What came of looking for a word: how sure it is, and where it failed.
#pragma once

#include <string>
#include <vector>

namespace gse::edit {

/// How sure a search is, in [0,1]; `value` is the one figure that decides, the others are what it is made of.
struct Confidence {
    double value = -1;     // negative = nothing was looked for
    double agreement = 0;  // of the views: 1 when every splat is always or never inside their masks
    double attention = 0;  // share of the word's attention that lies inside the masks
    double share = 0;      // of what the views see, labelled
    double recognition =
        -1;  // share of the other known words that fit the pictures less; negative = nobody can tell
};

/// What a view came to.
enum class ViewStep {
    Found,
    NoAttention,  // the word drew none
    TooLittle,    // too small or scattered above the threshold
    Everything,   // nearly the whole picture is above the threshold
    Hidden,       // the place of a new thing is out of sight
    Faint,        // the word draws much more elsewhere: what it means is out of sight here
    LeftOut       // by the artist
};

/// Why nothing was labelled.
enum class SearchProblem {
    None,
    FewViews,         // most views found nothing
    NothingLabelled,  // the views agree on no splat
    Unsure,           // something was found, but it need not be what the word means
    NoPlace           // a new thing has no place
};

/// "confidence 0.71: the views agree to 0.83, ..."; for what was not looked for, a sentence that says so.
std::string confidence_text(const Confidence& confidence);

/// One sentence about a view, and what mends it; names of settings are those of the request. Empty where
/// nothing failed.
std::string step_text(ViewStep step);
std::string step_remedy(ViewStep step);

/// What a search needs whose views came to these steps: what most of the failed ones need.
std::string search_remedy(const std::vector<ViewStep>& steps);

}  // namespace gse::edit
