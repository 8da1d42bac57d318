// An edit on the work thread: the roads between it and the window, and what the window knows of it.
#include "app/session/edit/live_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/session/state/located_label.h"
#include "engine/base/clock.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/view_server.h"
#include "engine/pipeline/recipe/recipe.h"
#include "engine/pipeline/run/preview_check.h"
#include "engine/pipeline/steps/step_judgement.h"

namespace gse::app {
namespace {

constexpr double SnapshotSeconds = 0.7;  // a running edit is seen at least every second
constexpr int LeastSteps = 8;            // of a run that tells how long the next one takes
constexpr std::size_t MostPreviews = 4;  // pictures beside a verdict

/// Tells the window what happens on the edit's thread.
class Teller {
public:
    Teller(const EditJob& job, const EditStart& start, const neural::NetworkUse& before, EditRoads& roads)
        : job_(job), before_(before), roads_(roads), reviews_(start.reviews) {}

    void tell(EditNews news) { roads_.news.push(std::move(news)); }
    void tell_use() { tell(edit_news::Use{network_use() - before_}); }

    void state(edit::EditSnapshot snapshot) {
        GaussianSet set = snapshot.materialise();  // here, so that the window need not
        tell(edit_news::State{std::move(snapshot), std::move(set)});
    }
    void step(const edit::IterationRecord& record) {
        ui::LossPoint point;
        point.iteration = record.iteration;
        point.preservation = static_cast<float>(record.preservation);
        point.anchor = static_cast<float>(record.anchor);
        point.guidance_norm = static_cast<float>(record.guidance_norm);
        point.preservation_norm = static_cast<float>(record.preservation_norm);
        const auto loss = record.guidance.find("loss");
        if (loss != record.guidance.end()) point.guidance_loss = static_cast<float>(loss->second);
        tell(edit_news::Step{point});
        tell_use();
    }
    void judged(const EditQuality& verdict, const edit::ViewTargets& sheet) {
        ui::GateView gate;
        const std::size_t every = std::max<std::size_t>(1, sheet.views.size() / MostPreviews);
        for (std::size_t i = 0; i < sheet.views.size() && gate.pictures.size() < MostPreviews; i += every)
            gate.pictures.push_back(sheet.views[i].after);
        gate.verdict = verdict.verdict;
        gate.warns = verdict.warns;
        tell(edit_news::Preview{std::move(gate)});
    }
    void targets(const edit::ViewTargets& sheet) {
        if (sheet.round != round_) waits_ = reviews_;
        round_ = sheet.round;
        ui::TargetRound round{sheet.round, sheet.rounds, {}, sheet.sentence, sheet.warnings};
        for (const auto& target : sheet.views) {
            const View& view = job_.views()[target.view];
            round.targets.push_back({target.view,
                                     view.name.empty() ? fmt::format("view {}", target.view) : view.name,
                                     target.before, target.after, view.camera, target.attempt, target.dropped,
                                     false, target.missing});
        }
        tell(edit_news::Targets{std::move(round), waits_});
    }
    /// The artist's orders so far; where a round waits to be looked at, the first word that comes.
    std::vector<edit::TargetOrder> orders() {
        std::vector<edit::TargetOrder> orders;
        const auto take = [&](const EditRoads::Word& word) {
            if (word) orders.push_back(*word);
            else waits_ = false;
        };
        for (const auto& word : roads_.words.take()) take(word);
        if (waits_ && orders.empty())
            job_.control().report("waiting for your look at the redrawn views", 0, 0);
        while (waits_ && orders.empty()) {
            const auto word = roads_.words.wait(job_.control().stop);
            if (!word) break;
            take(*word);
        }
        if (!orders.empty()) tell(edit_news::OrdersTaken{});
        return orders;
    }

    /// Asks the artist whether the scene is fitted to a part of the views; waits for the answer.
    bool fits(const remote::PartialRound& round) {
        roads_.fits.take();  // of a question that nobody waits for any more
        tell(edit_news::Partial{round});
        job_.control().report("waiting for your answer about the missing views", 0, 0);
        return roads_.fits.wait(job_.control().stop).value_or(false);
    }

private:
    const EditJob& job_;
    neural::NetworkUse before_;
    EditRoads& roads_;
    bool reviews_ = false;  // every round
    bool waits_ = false;    // this round
    int round_ = -1;
};

/// Has the artist asked about rounds of a server that end early, as long as this lives.
class PartialAsking {
public:
    PartialAsking(ViewServer* server, Teller& teller, EditRoads& roads) : server_(server) {
        if (server_ != nullptr)
            server_->use_partial_rounds(
                {[&teller](const remote::PartialRound& round) { return teller.fits(round); }, roads.drawing});
    }
    ~PartialAsking() {
        if (server_ != nullptr) server_->use_partial_rounds({});
    }
    PartialAsking(const PartialAsking&) = delete;
    PartialAsking& operator=(const PartialAsking&) = delete;

private:
    ViewServer* server_;
};

/// Shows the model's drawing of a few views before the loop.
void show_preview(EditJob& job, Teller& teller) {
    const PreviewCheck check = look_through_gate(job);
    ui::GateView gate;
    for (const auto& picture : check.pictures)
        gate.pictures.push_back(std::make_shared<const Image>(picture.after));
    gate.verdict = check.verdict;
    gate.warns = check.warns;
    teller.tell(edit_news::Preview{std::move(gate)});
    teller.tell_use();
}

EditObserver observer_of(const EditStart& start, Teller& teller, EditRoads& roads, bool adds) {
    EditObserver observer;
    observer.start = start.snapshot;
    observer.snapshot_seconds = SnapshotSeconds;
    observer.snapshot = [&teller](edit::EditSnapshot snapshot) { teller.state(std::move(snapshot)); };
    observer.iteration = [&teller](const edit::IterationRecord& record) { teller.step(record); };
    observer.judged = [&teller](const EditQuality& verdict, const edit::ViewTargets& sheet) {
        teller.judged(verdict, sheet);
    };
    observer.targets = [&teller](const edit::ViewTargets& sheet) { teller.targets(sheet); };
    observer.target_orders = [&teller] { return teller.orders(); };
    if (!adds) observer.new_label = [&roads] { return roads.label.take(); };
    return observer;
}

/// Tells what the search came to and runs the loop.
void run_located(MeasuredRun& run, const EditStart& start, Teller& teller, EditRoads& roads) {
    EditJob& job = *run.job;
    const bool adds = job.located().mode == edit::EditMode::Add;
    const auto& label = start.label;
    if (!adds && !label.empty() && label != *job.located().label.bits) job.correct_label(label);
    if (adds && start.corrected && label != *job.located().source_label.bits)
        log::warning("{}", AddsElsewhere);  // a notice, too
    teller.tell(edit_news::Located{adds, renamed_by(job)});
    if (!run.attention.empty()) teller.tell(edit_news::Found{run.job, run.attention, label.empty()});
    edit::require_found(job.located());
    if (start.shows_preview) show_preview(job, teller);
    const PartialAsking asking(job.shared_server().get(), teller, roads);
    job.run(observer_of(start, teller, roads, adds));
    if (!edit::is_drawn(job.located().mode))
        teller.tell(edit_news::Preview{{{}, "Nothing was drawn: look at the place from all sides.", false}});
    teller.tell_use();
}

}  // namespace

void run_edit(MeasuredRun& run, const EditStart& start, const neural::NetworkUse& before, EditRoads& roads,
              PendingResult& pending, const PeakMemory& peak) {
    const double idea = run.job->times().seconds("gate");
    const auto idea_use = run.job->times().networks("gate");
    Teller teller(*run.job, start, before, roads);
    run_located(run, start, teller, roads);
    if (start.shows_preview) {
        run.measured.idea = run.job->times().seconds("gate") - idea;
        run.measured.idea_tflop = (run.job->times().networks("gate") - idea_use).flop * 1e-12;
    }
    measure_loop(run.measured, *run.job, LeastSteps);
    const auto finishing = std::chrono::steady_clock::now();
    fill_pending(*run.job, pending);
    if (pending.stopped_at < 0 && !run.job->result().failure && !run.job->result().shortage)
        if (const auto judgement = judge_step(*run.job); !judgement.passed())
            pending.failed = fmt::format("{}: {}", judgement.reason, judgement.remedy);
    if (start.brings_label && !run.job->knew_source()) pending.label = located_label(*run.job);
    run.measured.finish = seconds_since(finishing);
    measure_peak(run, peak);
}

ui::NetworkCost cost_of(const neural::NetworkUse& use) {
    return {use.unet, use.encoder, use.decoder, use.flop * 1e-12};
}

void LiveEdit::describe(const EditRecipe& of) {
    name = of.request.prompt;
    target = of.request.target;
    recipe = json_text(recipe_to_json(of));
    iterations = edit::planned_steps(of.request);
}

void LiveEdit::take(const edit_news::Targets& targets) {
    const bool known = !rounds.empty() && rounds.back().round == targets.round.round;
    if (known) rounds.back() = targets.round;
    else rounds.push_back(targets.round);
    if (!known) waits = targets.waits;
}

void LiveEdit::order(const edit::TargetOrder& order) {
    if (rounds.empty() || rounds.back().round != order.round) return;
    orders.push_back(order);
    roads->words.push(order);
}

void LiveEdit::fit() {
    if (!waits) return;
    waits = false;
    roads->words.push(std::nullopt);
}

void LiveEdit::show(ui::EditPart& model) const {
    model.gate = gate;
    model.losses = losses;
    model.target_rounds = rounds;
    model.targets_wait = waits;
    if (rounds.empty()) return;
    for (const auto& order : orders)
        for (auto& one : model.target_rounds.back().targets) one.ordered |= one.view == order.view;
}

}  // namespace gse::app
