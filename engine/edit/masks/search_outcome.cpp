// Sentences about searches, the same for window, command line and report.
#include "engine/edit/masks/search_outcome.h"

#include <algorithm>

namespace gse::edit {

std::string step_text(ViewStep step) {
    switch (step) {
        case ViewStep::Found: return {};
        case ViewStep::NoAttention: return "the word drew no attention";
        case ViewStep::TooLittle:
            return "what is above the attention threshold is too small or too scattered";
        case ViewStep::Everything: return "nearly the whole picture is above the attention threshold";
        case ViewStep::Hidden: return "the place of the new thing is out of sight";
        case ViewStep::Faint:
            return "the word draws much more attention in other views: what it means is out of sight here";
        case ViewStep::LeftOut: return "it was left out by hand";
    }
    return {};
}

std::string step_remedy(ViewStep step) {
    switch (step) {
        case ViewStep::Found:
        case ViewStep::Hidden:
        case ViewStep::Faint:
        case ViewStep::LeftOut: return {};
        case ViewStep::NoAttention: return "use another word";
        case ViewStep::TooLittle: return "lower the attention threshold";
        case ViewStep::Everything: return "raise the attention threshold";
    }
    return {};
}

std::string search_remedy(const std::vector<ViewStep>& steps) {
    const auto failed = [&](ViewStep step) { return std::count(steps.begin(), steps.end(), step); };
    ViewStep most = ViewStep::NoAttention;
    for (const ViewStep step : {ViewStep::TooLittle, ViewStep::Everything})
        if (failed(step) > failed(most)) most = step;
    return "name something the scene shows and the model knows, " +
           (most == ViewStep::NoAttention ? std::string() : step_remedy(most) + ", ") + "or label it by hand";
}

}  // namespace gse::edit
