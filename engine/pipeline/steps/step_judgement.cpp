// Renders before and after, and thresholds on what they show.
#include "engine/pipeline/steps/step_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/evaluate/metrics.h"
#include "engine/pipeline/run/edit_quality.h"

namespace gse::pipeline {
namespace {

constexpr std::size_t JudgedViews = 8;  // renders that tell as much as all of them
constexpr double ShownShare = 0.5;      // a pixel shows splats that make up more than half of it
constexpr double ClearChange = 0.1;     // difference of display values that an artist sees
constexpr double LeastOfView = 0.002;   // share of a picture's pixels in which something is seen

// Thresholds lie far from the figures of right edits, which must not be refused (METHOD.md, Judging what came
// of it).
constexpr double LeastChanged = 0.25;     // right edits change most of the thing
constexpr double LeastDyed = 0.05;        // a dye near the old colour (gray, of stone) hardly shows
constexpr double LeastAddedChange = 0.1;  // what is added may look like what is behind it
constexpr double MostSpilled = 0.02;      // soft edges of splats reach out of the masks
constexpr double MostOldLeft = 0.25;      // right edits leave nothing
constexpr double LeastNewShown = 0.15;    // what comes may be smaller
constexpr double MostGone = 0.9;          // what carries a thing and lies around it is more than the rest
constexpr double LeastSeen = 0.25;        // what is on one side is seen from about half of the views
constexpr double MostOnThing = 0.5;       // what stands beside hides the thing from two sides only
constexpr double LeastLikeness = 0.15;  // what keeps the old thing's colour scores half of what another does
constexpr double LeastScore = 0.1;      // no change scores about zero

constexpr double Percent = 100;

struct Shares {
    double thing = 0, changed = 0;       // pixels
    double outside = 0, spilled = 0;     // pixels
    double old_left = 0, new_shown = 0;  // pixels
    double views = 0, seen = 0, on_thing = 0;
};

double share(double part, double all) { return all > 0 ? part / all : 0; }

/// Rows of the result that are new, without ground that an old thing hid.
std::vector<std::uint8_t> new_rows(const edit::EditResult& result) {
    auto bits = result.label;
    for (std::size_t row = 0; row < bits.size(); ++row)
        if (row < result.hole_fill.size() && result.hole_fill[row] != 0) bits[row] = 0;
    for (const auto row : result.base_to_new)
        if (row >= 0) bits[static_cast<std::size_t>(row)] = 0;
    return bits;
}

/// Labelled rows of the scene that are still there, as rows of the result.
std::vector<std::uint8_t> old_rows(const edit::EditResult& result, const std::vector<std::uint8_t>& label) {
    std::vector<std::uint8_t> bits(result.set.size(), 0);
    for (std::size_t row = 0; row < label.size(); ++row)
        if (label[row] != 0 && result.base_to_new[row] >= 0)
            bits[static_cast<std::size_t>(result.base_to_new[row])] = 1;
    return bits;
}

/// Looks at a job's scene before and after from one view after the other.
class StepView {
public:
    explicit StepView(EditJob& job)
        : job_(job), label_(*job.located().label.bits), new_(new_rows(job.result())),
          old_(old_rows(job.result(), label_)) {}

    void look(std::size_t view) {
        const auto& camera = job_.views()[view].camera;
        before_.push_back(paint(job_.drawn(), camera));
        after_.push_back(paint(job_.drawn_result(), camera));
        const Mask changed = evaluate::changed_pixels(before_.back(), after_.back(), ClearChange);
        const bool adds = job_.located().mode == edit::EditMode::Add;
        const Mask thing =
            adds ? shown(job_.result().set, new_, camera) : shown(job_.scene().gaussians, label_, camera);
        const Mask& inside = job_.changed_masks()[view];
        for (std::size_t p = 0; p < changed.data.size(); ++p) {
            shares_.thing += thing.data[p];
            shares_.changed += thing.data[p] & changed.data[p];
            shares_.outside += inside.data[p] == 0 ? 1 : 0;
            shares_.spilled += inside.data[p] == 0 ? changed.data[p] : 0;
        }
        shares_.views += 1;
        const auto least = LeastOfView * static_cast<double>(thing.data.size());
        shares_.seen += static_cast<double>(thing.count()) > least ? 1 : 0;
        if (adds) look_behind(thing, camera);
        if (job_.located().mode != edit::EditMode::Replace) return;
        const Mask left = shown(job_.result().set, old_, camera);
        for (std::size_t p = 0; p < left.data.size(); ++p) shares_.old_left += left.data[p] & thing.data[p];
        shares_.new_shown += static_cast<double>(shown(job_.result().set, new_, camera).count());
    }

    const Shares& shares() const { return shares_; }
    std::size_t added() const {
        return static_cast<std::size_t>(std::count(new_.begin(), new_.end(), std::uint8_t{1}));
    }
    std::vector<PicturePair> pairs() const {
        std::vector<PicturePair> pairs;
        for (std::size_t i = 0; i < before_.size(); ++i) pairs.emplace_back(&before_[i], &after_[i]);
        return pairs;
    }

private:
    /// Counts the pixels of a new thing that showed the source before.
    void look_behind(const Mask& thing, const Camera& camera) {
        const auto& bits = job_.located().source_label.bits;
        if (!bits) return;
        const Mask source = shown(job_.scene().gaussians, *bits, camera);
        for (std::size_t p = 0; p < thing.data.size(); ++p)
            shares_.on_thing += thing.data[p] & source.data[p];
    }

    Image paint(const GaussianSet& set, const Camera& camera) {
        Image image = job_.painter().paint(set.spans(), camera, job_.plan().settings).colour;
        for (auto& value : image.data) value = std::clamp(value, 0.0f, 1.0f);
        return image;
    }

    Mask shown(const GaussianSet& set, const std::vector<std::uint8_t>& bits, const Camera& camera) {
        const std::vector<float> values(bits.begin(), bits.end());
        Image seen;
        job_.painter().rasterizer().forward_values(set.spans(), camera, job_.plan().settings, values, seen);
        Mask mask(camera.width, camera.height);
        for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = seen.data[p] > ShownShare ? 1 : 0;
        return mask;
    }

    EditJob& job_;
    const std::vector<std::uint8_t>& label_;
    std::vector<std::uint8_t> new_, old_;
    std::vector<Image> before_, after_;
    Shares shares_;
};

struct Fault {
    std::string reason, remedy;
};
using Verdict = std::optional<Fault>;

constexpr const char* AnotherTry = "try another seed or a finer quality";
constexpr const char* BetterLabel = "look at the label, and correct it by hand";

Verdict fault_of_rows(const StepFigures& figures) {
    if (figures.changed_rows == 0) return {};
    return Fault{fmt::format("{} splats outside the label changed", figures.changed_rows), AnotherTry};
}

Verdict fault_of_amount(const StepFigures& figures) {
    const bool scored = figures.pictures || figures.scene;
    if (figures.mode == edit::EditMode::Add || figures.mode == edit::EditMode::Transform ||
        figures.changed >= (scored ? LeastChanged : LeastDyed))
        return {};
    if (figures.mode == edit::EditMode::Remove)
        return Fault{fmt::format("the place of the {} looks as before: {:.0f} % of it changed visibly",
                                 figures.thing, Percent * figures.changed),
                     BetterLabel};
    return Fault{
        fmt::format("only {:.0f} % of the {} changed visibly", Percent * figures.changed, figures.thing),
        "raise the strength, or say what differs more: the scene may show it already"};
}

Verdict fault_of_addition(const StepFigures& figures) {
    if (figures.mode != edit::EditMode::Add) return {};
    if (figures.added == 0) return Fault{fmt::format("no {} was added", figures.news), AnotherTry};
    if (figures.seen < LeastSeen)
        return Fault{fmt::format("the {} is seen from {:.0f} % of the views only", figures.news,
                                 Percent * figures.seen),
                     "say where it goes, or try another seed"};
    if (figures.beside && figures.on_thing > MostOnThing)
        return Fault{fmt::format("the {} is on the {}, not beside it", figures.news, figures.thing),
                     "try another seed, or another place"};
    if (figures.changed >= LeastAddedChange) return {};
    return Fault{fmt::format("where the {} is, only {:.0f} % of the pictures changed visibly", figures.news,
                             Percent * figures.changed),
                 "give it a colour that differs from what is behind it"};
}

Verdict fault_of_removal(const StepFigures& figures) {
    if (figures.mode != edit::EditMode::Remove || figures.gone <= MostGone) return {};
    return Fault{
        fmt::format("{:.0f} % of the scene is gone with the {}", Percent * figures.gone, figures.thing),
        BetterLabel};
}

Verdict fault_of_replacement(const StepFigures& figures) {
    if (figures.mode != edit::EditMode::Replace) return {};
    if (figures.old_left > MostOldLeft)
        return Fault{fmt::format("{:.0f} % of the {} still shows", Percent * figures.old_left, figures.thing),
                     BetterLabel};
    if (figures.new_shown >= LeastNewShown) return {};
    return Fault{fmt::format("hardly any {} is there: {:.0f} % of the area of the {}", figures.news,
                             Percent * figures.new_shown, figures.thing),
                 AnotherTry};
}

Verdict fault_of_surroundings(const StepFigures& figures) {
    if (figures.spilled <= MostSpilled) return {};
    return Fault{fmt::format("{:.0f} % of what surrounds the {} changed, too", Percent * figures.spilled,
                             figures.thing),
                 BetterLabel};
}

/// The better of two scores counts: the encoder misses some things in the redrawn views, and others in the
/// scene.
Verdict fault_of_meaning(const StepFigures& figures) {
    if (figures.likeness && *figures.likeness < LeastLikeness)
        return Fault{fmt::format("what came is like no known thing, and hardly like a {}", figures.news),
                     AnotherTry};
    if (figures.look && *figures.look < LeastLook)
        return Fault{fmt::format("only {:.0f} % of the {} looks {}", Percent * *figures.look, figures.thing,
                                 figures.news),
                     AnotherTry};
    if (!figures.pictures && !figures.scene) return {};
    const double score = std::max(figures.pictures.value_or(-1), figures.scene.value_or(-1));
    if (score >= LeastScore) return {};
    return Fault{fmt::format("the result does not show \"{}\" (score {:.2f})", figures.news, score),
                 std::string(AnotherTry) + ", or a model that knows the words better"};
}

/// True for what the sentence puts to a side of the thing. Another one of its kind is never worn by it.
bool is_beside(const language::EditSentence& sentence) {
    using language::Relation;
    const auto relation = sentence.relation();
    return relation == Relation::Beside || relation == Relation::Left || relation == Relation::Right ||
           sentence.target() == sentence.source();
}

}  // namespace

StepFigures measure_step(EditJob& job) {
    StepView seen(job);
    const std::size_t views = job.views().size(), count = std::min(views, JudgedViews);
    for (std::size_t i = 0; i < count; ++i) seen.look(i * views / count);
    const auto& shares = seen.shares();
    const auto& sentence = job.recipe().request.sentence();
    StepFigures figures;
    figures.mode = job.located().mode;
    figures.thing = sentence.source();
    figures.news =
        figures.mode == edit::EditMode::Modify ? sentence.target() : new_thing(sentence, figures.mode);
    if (const auto& verdict = job.edited().verdict) {
        figures.pictures = verdict->score;
        figures.likeness = verdict->likeness;
        figures.look = verdict->look;
    }
    if (edit::is_drawn(figures.mode) && !figures.look)
        figures.scene = judge(job.model(), sentence, sentence.prompt(), seen.pairs()).score;
    figures.changed = share(shares.changed, shares.thing);
    figures.spilled = share(shares.spilled, shares.outside);
    figures.old_left = share(shares.old_left, shares.thing);
    figures.new_shown = share(shares.new_shown, shares.thing);
    const auto rows = static_cast<double>(job.scene().gaussians.size());
    figures.gone = std::max(0.0, 1 - share(static_cast<double>(job.result().set.size()), rows));
    figures.seen = share(shares.seen, shares.views);
    figures.beside = is_beside(sentence);
    figures.on_thing = share(shares.on_thing, shares.thing);
    figures.added = seen.added();
    figures.changed_rows = job.result().changed_outside_label;
    return figures;
}

StepJudgement judge_step(StepFigures figures) {
    StepJudgement judgement{std::move(figures), {}, {}};
    for (const auto check : {fault_of_rows, fault_of_amount, fault_of_addition, fault_of_removal,
                             fault_of_replacement, fault_of_surroundings, fault_of_meaning})
        if (auto fault = check(judgement.figures)) {
            judgement.reason = std::move(fault->reason);
            judgement.remedy = std::move(fault->remedy);
            break;
        }
    return judgement;
}

StepJudgement judge_step(EditJob& job) { return judge_step(measure_step(job)); }

nlohmann::ordered_json judgement_to_json(const StepJudgement& judgement) {
    const auto& figures = judgement.figures;
    const auto score = [](const std::optional<double>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    nlohmann::ordered_json json{{"passed", judgement.passed()}};
    if (!judgement.passed()) json["reason"] = judgement.reason, json["remedy"] = judgement.remedy;
    json["score_pictures"] = score(figures.pictures);
    json["score_scene"] = score(figures.scene);
    if (figures.likeness) json["likeness"] = *figures.likeness;
    if (figures.look) json["look"] = *figures.look;
    json["changed"] = figures.changed;
    json["spilled"] = figures.spilled;
    json["changed_rows_outside"] = figures.changed_rows;
    if (figures.mode == edit::EditMode::Replace)
        json["old_left"] = figures.old_left, json["new_shown"] = figures.new_shown;
    if (figures.mode == edit::EditMode::Remove) json["gone"] = figures.gone;
    if (figures.mode == edit::EditMode::Add) json["seen"] = figures.seen, json["on_thing"] = figures.on_thing;
    if (figures.mode != edit::EditMode::Modify) json["new_splats"] = figures.added;
    return json;
}

}  // namespace gse::pipeline
