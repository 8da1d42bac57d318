// Steps in which a view, or a search, can fail, with their sentences.
#pragma once

#include <string>
#include <vector>

namespace gse::edit {

/// Outcome of a view.
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

/// One sentence about a view, and what mends it; names of settings are those of the request. Empty where
/// nothing failed.
std::string step_text(ViewStep step);
std::string step_remedy(ViewStep step);

/// Need of a search whose views came to these steps: the need of most failed ones.
std::string search_remedy(const std::vector<ViewStep>& steps);

}  // namespace gse::edit
