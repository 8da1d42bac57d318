// Agreement of the views, attention inside the masks, share of the scene, and one figure of them.
#include "engine/edit/search/confidence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gse::edit {
namespace {

// Gaussians of a thing; what views at odds have in common by chance are one or two.
constexpr std::size_t LeastSplats = 4;
// Leads of another word (a mean cosine) at which the encoder contradicts altogether; METHOD.md says how they
// were chosen.
constexpr double LostLead = 0.2, LostLeadWorn = 0.06;
// Share of what the views see, where the sentence names other things too.
constexpr double LargestLabelShare = 0.97;

/// Share of what is seen that all views have one opinion of: 1 when every splat is always or never inside the
/// masks, 0 when all are half the time. The ground that is no part of the scene counts as one splat, as that
/// of other scenes does, which is never what was looked for.
double agreement_of(const LabelField& field, const std::vector<float>& weights,
                    const GroundEvidence& ground) {
    double decided = std::max(0.0, ground.seen - 2 * ground.inside), all = ground.seen;
    for (std::size_t row = 0; row < weights.size(); ++row) {
        decided += field.coverage[row] * std::abs(2.0 * weights[row] - 1);
        all += field.coverage[row];
    }
    return all > 0 ? decided / all : 0;
}

double share_of(const LabelField& field, const std::vector<std::uint8_t>& bits,
                const GroundEvidence& ground) {
    double labelled = 0, all = ground.seen;
    for (std::size_t row = 0; row < bits.size(); ++row) {
        labelled += bits[row] != 0 ? field.coverage[row] : 0;
        all += field.coverage[row];
    }
    return all > 0 ? labelled / all : 0;
}

/// Mean over the views; one that found nothing has no attention inside, one that was left out does not count.
struct Attention {
    double inside = 0;  // share of the attention inside the masks
    // Attention per pixel inside, over that inside and outside: 0.5 = as strong outside as inside.
    double focus = 0;
};

Attention attention_of(const std::vector<ViewEvidence>& views) {
    Attention mean;
    const auto out = std::count_if(views.begin(), views.end(),
                                   [](const auto& view) { return view.step == ViewStep::LeftOut; });
    for (const auto& view : views) {
        if (view.failed) continue;
        double inside = 0, all = 0, area = 0;
        for (std::size_t i = 0; i < view.map.data.size(); ++i) {
            const bool in = view.mask.data[i] != 0;
            inside += in ? view.map.data[i] : 0;
            all += view.map.data[i];
            area += in ? 1 : 0;
        }
        const double rest = static_cast<double>(view.map.data.size()) - area;
        if (!(all > 0) || !(area > 0)) continue;
        const double dense = inside / area, thin = rest > 0 ? (all - inside) / rest : 0;
        mean.inside += inside / all;
        mean.focus += dense / (dense + thin);
    }
    const auto count = static_cast<double>(std::max<std::ptrdiff_t>(1, std::ssize(views) - out));
    return {mean.inside / count, mean.focus / count};
}

/// 0 at one half, where nothing is said, to 1.
double above_half(double value) { return std::clamp(2 * value - 1, 0.0, 1.0); }

/// 1 where no other word of its kind fits the pictures better, 0 where one leads by LostLead.
double agreement_of_encoder(const SecondLook& look) {
    return look.lead ? std::clamp(1 + *look.lead / (look.worn ? LostLeadWorn : LostLead), 0.0, 1.0) : 1;
}

std::vector<ConfidencePart> parts_of(double agreement, double inside, double share, double recognition) {
    std::vector<ConfidencePart> parts{
        {"agreement", agreement, "the views agree to {}", "The views agree to {}."},
        {"attention_inside", inside, "{} of the attention is inside",
         "{} of the attention is inside the masks."},
        {"labelled_share", share, "{} of what they see is labelled",
         "{} of what the views see is labelled."}};
    if (recognition >= 0)
        parts.push_back({"recognition", recognition, "the word fits better than {} of those the model knows",
                         "The pictures fit the word better than {} of the others the model knows."});
    return parts;
}

SearchVerdict refusal(SearchProblem problem, std::string message, std::string remedy) {
    return {{0, parts_of(0, 0, 0, -1)}, problem, std::move(message), std::move(remedy)};
}

}  // namespace

GroundEvidence ground_seen(const std::vector<ViewEvidence>& views, const std::vector<Image>& grounds) {
    GroundEvidence ground;
    for (std::size_t v = 0; v < grounds.size(); ++v)
        for (std::size_t i = 0; !views[v].failed && i < grounds[v].data.size(); ++i) {
            ground.seen += grounds[v].data[i];
            ground.inside += views[v].mask.data[i] != 0 ? grounds[v].data[i] : 0;
        }
    return ground;
}

double Confidence::part(const std::string& key) const {
    const auto found =
        std::find_if(parts.begin(), parts.end(), [&](const auto& one) { return key == one.key; });
    return found == parts.end() ? -1 : found->value;
}

std::string confidence_text(const Confidence& confidence) {
    if (confidence.value < 0) return "nothing was looked for: the label says where";
    std::string text = fmt::format("confidence {:.2f}", confidence.value);
    for (const auto& part : confidence.parts)
        text += (&part == &confidence.parts.front() ? ": " : ", ") +
                fmt::format(fmt::runtime(part.phrase), fmt::format("{:.2f}", part.value));
    return text;
}

std::optional<SearchVerdict> refuse_views(const std::string& word, const std::vector<ViewEvidence>& views) {
    std::ptrdiff_t asked = 0, voting = 0;
    std::vector<ViewStep> steps;
    for (const auto& view : views) {
        steps.push_back(view.step);
        if (view.step == ViewStep::LeftOut) continue;
        ++asked;
        voting += view.failed ? 0 : 1;
    }
    if (voting >= LeastVotingViews && voting * 2 >= asked) return std::nullopt;
    return refusal(SearchProblem::FewViews,
                   fmt::format("\"{}\" was found in only {} of {} views", word, voting, asked),
                   voting * 2 < asked ? search_remedy(steps) : "look from more views");
}

std::optional<SearchVerdict> refuse_label(const std::string& word, const Label& label) {
    const auto labelled =
        static_cast<std::size_t>(std::count(label.bits->begin(), label.bits->end(), std::uint8_t{1}));
    if (labelled >= LeastSplats || labelled * 2 >= label.bits->size()) return std::nullopt;
    return refusal(
        SearchProblem::NothingLabelled,
        fmt::format("the views agree on {} splat for \"{}\"", labelled == 0 ? "no" : "hardly a", word),
        "name something the scene shows and the model knows, or lower label_threshold");
}

SearchVerdict judge(const SearchEvidence& evidence, double least) {
    const Attention attention = attention_of(evidence.views);
    const double agreement = agreement_of(evidence.field, *evidence.label.weight, evidence.ground),
                 share = share_of(evidence.field, *evidence.label.bits, evidence.ground),
                 recognition = evidence.recognition;
    SearchVerdict verdict;
    Confidence& confidence = verdict.confidence;
    confidence.parts = parts_of(agreement, attention.inside, share, recognition);
    // Each part can refuse: views at odds, attention all over the picture, a word that others fit better.
    confidence.value =
        above_half(agreement) * above_half(attention.focus) * (recognition < 0 ? 1 : recognition);
    // A word that is found everywhere leaves nothing of the scene to the other things that the sentence
    // names.
    if (evidence.names_others && share > LargestLabelShare) confidence.value = 0;
    if (confidence.value < least) {
        verdict.problem = SearchProblem::Unsure;
        verdict.message =
            fmt::format("it is not sure that \"{}\" was found (confidence {:.2f}, at least {:.2f} is needed)",
                        evidence.word, confidence.value, least);
        verdict.remedy = "name something the scene shows, look at what was found, or label it by hand";
    }
    return verdict;
}

SearchVerdict reconsider(SearchVerdict verdict, const std::string& word, const SecondLook& look,
                         double least) {
    Confidence& confidence = verdict.confidence;
    const double witness = agreement_of_encoder(look);
    const bool cut = look.cut > MostCut;
    confidence.parts.push_back({"first_look", confidence.value, "the views alone are sure to {}",
                                "The views alone are sure to {}."});
    confidence.value *= cut ? 0 : witness;
    if (look.lead)
        confidence.parts.push_back({"second_witness", witness, "the picture encoder agrees to {}",
                                    "A second look by the picture encoder agrees to {}."});
    confidence.parts.push_back({"border_cut", look.cut, "{} of its border is the pictures' edge",
                                "The edges of the pictures make {} of its border."});
    if (!verdict.sure() || confidence.value >= least) return verdict;
    verdict.problem = SearchProblem::Unsure;
    if (cut) {
        verdict.message = fmt::format(
            "it is not sure that all of \"{}\" was found: it goes on beyond the "
            "picture in {} of {} views",
            word, look.cut_views, look.views);
        verdict.remedy = "cut it out with a box, or correct the label by hand";
        return verdict;
    }
    verdict.message =
        look.better.empty()
            ? fmt::format("it is not sure that \"{}\" was found: the picture encoder sees none there", word)
            : fmt::format("it is not sure that \"{}\" was found: the picture encoder sees \"{}\" there", word,
                          look.better);
    verdict.remedy =
        (look.better.empty() ? "name" : fmt::format("name it \"{}\" if you mean that, name", look.better)) +
        std::string(" something else that the scene shows, or label it by hand");
    return verdict;
}

}  // namespace gse::edit
