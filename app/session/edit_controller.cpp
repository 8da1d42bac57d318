// Edits and their results: what runs, its states, and what waits to be applied or discarded.
#include "app/session/edit_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/unchecked_request.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/scene/stack_edits.h"

namespace gse::app {
namespace {

namespace command = ui::command;

ui::ResultVerdict verdict_of(const PendingResult& result) {
    ui::ResultVerdict verdict{result.verdict, result.warns, result.stopped_at,
                              result.steps,   {},           result.asked};
    for (const auto& change : result.changes) verdict.changes.push_back(change.name);
    if (result.asked > 1 && result.changes.empty()) verdict.changes.push_back(result.name);
    verdict.kept_out = result.kept_out;
    if (!result.kept_out.empty()) verdict.text = fmt::format("Kept out: {}", result.kept_out.front());
    if (!result.failed.empty()) verdict.text = result.failed, verdict.warns = true;
    return verdict;
}

constexpr std::uint64_t WaitingEdit = std::uint64_t{1} << 63, RunningEdit = std::uint64_t{1} << 62;

}  // namespace

// Runs

template <> void EditController::on(const command::Edit& one) {
    if (!workspace_.require_scene() || workspace_.jobs->occupied()) return;
    if (workspace_.results) return workspace_.notices.toast("Apply or discard the last edit first.");
    if (!servers_.may_send(search_.sentence(), [this, one] { on(one); })) return;
    snapshots_.forget();
    view_.forget_tint();
    live_.losses.clear();
    left_out_ = one.left_out;
    search_.sentence().set_step(std::nullopt);
    search_.choose_for_source();  // another source is another matter
    if (!search_.sentence().follows_plan()) return start(std::nullopt);
    if (edit::pictures_decide(search_.request(), models_.list().words_to_say())) return read_steps();
    begin_steps(search_.sentence().scene());
}

/// Pictures of the scene tell which of the looks that the sentence names are there already.
void EditController::read_steps() {
    const auto run = search_.begin_run();
    EditRecipe recipe = search_.recipe();
    const auto typed = search_.request();
    recipe.request = edit::source_alone(typed);
    recipe.server = {};  // nothing is drawn yet
    try {
        recipe.request = edit::check(std::move(recipe.request)).plain();
    } catch (const Error& error) { return workspace_.notices.report(error); }
    auto scene = std::make_shared<language::plan::SceneWords>(search_.sentence().scene());
    auto work = [run, recipe, scene, ground = search_.ground(recipe),
                 cache = models_.cache()](const JobControl& control) {
        load_model(*run, recipe.job, cache, control);
        run->job = std::make_shared<EditJob>(recipe, ground.input(*run, {}), control);
        *scene = run->job->words_shown(std::move(*scene));
    };
    auto done = [this, run, scene, typed, ticket = models_.ticket()](const Error* error) {
        models_.take_back(ticket, run->model, run->loaded, error);
        if (error == nullptr) begin_steps(*scene);
        if (workspace_.jobs->works()) return;
        workspace_.results.come_back();
        if (error != nullptr) end(error);
    };
    workspace_.jobs->start_work(JobKind::Edit, {"Read the scene", work, done, true});
}

/// Makes the steps that can be done and are not left out, one after another, in a scene of these words.
void EditController::begin_steps(const language::plan::SceneWords& scene) {
    auto steps = search_.sentence().steps_in(scene, left_out_);
    if (steps.size() == 0) return say_why_nothing_runs();
    chain_.begin(search_.request().prompt, std::move(steps), workspace_.document.state(),
                 workspace_.next_edit_id);
    search_.sentence().set_step(chain_.step());
    start(std::nullopt);
}

void EditController::say_why_nothing_runs() {
    const auto& planned = search_.sentence().steps();
    const auto undone =
        std::find_if(planned.begin(), planned.end(), [](const auto& step) { return !step.words; });
    if (undone == planned.end())
        return workspace_.notices.toast("Nothing to change: the scene shows what the sentence says.");
    workspace_.notices.report(
        Error(ErrorCode::InvalidArgument, undone->problem.reason, undone->problem.remedy));
}

/// Inputs of the edit that begins, with the label that is its scope.
EditStart EditController::start_from(std::optional<edit::EditSnapshot> from) const {
    EditStart start;
    const bool later = chain_.beyond_first();
    if (const NamedLabel* label = later ? search_.scope(chain_.state()) : search_.scope()) {
        start.label = *label->bits;
        start.corrected = !label->found_for.empty() && corrected_by_hand(*label);
    }
    start.brings_label = chain_.runs() && start.label.empty();
    start.shows_preview = models_.settings().gate && !from && !edit::method_of(recipe_.request).draws_views();
    start.reviews = models_.settings().review;
    start.snapshot = std::move(from);
    return start;
}

namespace {

/// All that an edit needs on its thread, and the place of its outcome.
struct EditWork {
    std::shared_ptr<MeasuredRun> run;
    CheckedRecipe recipe;
    EditRecipe open;  // with the target that pictures may decide
    EditStart start;
    std::shared_ptr<PendingResult> pending;
    std::shared_ptr<EditRoads> roads;
};

auto edit_work(EditWork work, SearchGround ground, std::shared_ptr<DiskCache> cache) {
    return [work = std::move(work), ground = std::move(ground),
            cache = std::move(cache)](const JobControl& control) {
        auto& [run, recipe, open, start, pending, roads] = work;
        const auto before = network_use();
        load_model(*run, recipe.job, cache, control);
        if (!run->job) connect_to_server(*run, open, cache, control);
        const PeakMemory peak;
        if (run->job) {
            run->job->set_control(control);
            run->job->take_settings(recipe, start.label.empty());
            if (!run->job->found() && !start.label.empty()) run->job->use_label(start.label);
        } else {
            run->job = std::make_shared<EditJob>(open, ground.input(*run, start.label), control);
            look(*run);
        }
        run_edit(*run, start, before, *roads, *pending, peak);
        throw_what_ended(run->job->result());
    };
}

}  // namespace

void EditController::start(std::optional<edit::EditSnapshot> from) {
    const bool later = chain_.beyond_first();
    if (!later) search_.show_scope();
    search_.begin_edit();
    view_.compare_as_usual();
    std::optional<CheckedRecipe> checked;
    try {
        checked = check(search_.recipe());
    } catch (const Error& error) {
        end_steps();
        return workspace_.notices.report(error);
    }
    const EditRecipe recipe = checked->plain();
    const auto run = search_.begin_run();
    if (!later) run->job = search_.fitting_job();
    take_known_parts(run->measured, costs_.profile(search_.request()));
    recipe_ = recipe;
    LiveEdit live;
    live.describe(recipe);
    live.losses = std::move(live_.losses);
    if (from) live.gate = std::move(live_.gate);
    const EditStart start = start_from(std::move(from));
    live_ = std::move(live);
    if (later) snapshots_.begin(chain_.state().current, chain_.rows());
    else snapshots_.begin(workspace_.document.state().current);
    auto pending = std::make_shared<PendingResult>();
    auto work = edit_work({run, *checked, search_.open_recipe(recipe), start, pending, live_.roads},
                          later ? search_.ground(chain_) : search_.ground(recipe), models_.cache());
    auto done = [this, run, pending, cost_key = costs_.key(search_.request()),
                 ticket = models_.ticket()](const Error* error) {
        models_.take_back(ticket, run->model, run->loaded, error);
        costs_.remember(cost_key, run->measured);
        servers_.refresh();  // times of the last pictures
        refresh();           // what was found last, and the last steps
        if (branch_) return go_on_from_branch();
        if (pending->set.size() > 0) {  // also what a shortage or a failure left
            pending->seconds = workspace_.jobs->work.status().seconds;  // the clock of the job's own line
            pending->verdict = live_.gate.verdict;
            pending->warns = live_.gate.warns;
        }
        if (take_step(std::move(*pending), error)) return;
        workspace_.results.come_back();
        end(error);
    };
    workspace_.jobs->start_work(JobKind::Edit, {title_of(recipe), work, done, true});
}

std::string EditController::title_of(const EditRecipe& recipe) const {
    const std::string said = chain_.said();
    return fmt::format("Edit: {}{}", recipe.request.prompt, said.empty() ? "" : fmt::format(" ({})", said));
}

/// Takes the outcome of the edit that ended, if it has one. True where the next step of its sentence runs.
bool EditController::take_step(PendingResult pending, const Error* error) {
    const bool came = pending.set.size() > 0;
    if (!chain_.runs()) {
        if (came) workspace_.results.add(std::move(pending));
        return false;
    }
    if (came && chain_.take(std::move(pending)) && error == nullptr) {
        search_.sentence().set_step(chain_.step());
        snapshots_.forget();
        live_.losses.clear();
        start(std::nullopt);
        if (workspace_.jobs->works()) return true;
    }
    end_steps();
    return false;
}

/// The finished steps wait to be applied, as one result.
void EditController::end_steps() {
    if (auto whole = chain_.end(); whole.set.size() > 0) workspace_.results.add(std::move(whole));
}

void EditController::end(const Error* error) {
    ++workspace_.content;
    const auto& job = search_.last().job();
    const bool said = job && !job->found();  // with its evidence
    if (error != nullptr && !said) workspace_.report_end(*error);
    if (workspace_.results) view_.untint();
}

void EditController::correct_label(const std::vector<std::uint8_t>& bits) {
    if (chain_.beyond_first())
        workspace_.notices.toast("The labels are those of the scene before the first change.");
    else if (live_.adds) workspace_.notices.toast(AddsElsewhere);
    else live_.roads->label.put(bits);
}

// News of the running edit

template <> void EditController::take(edit_news::Located&& news) {
    live_.adds = news.adds;
    live_.renamed = std::move(news.renamed);
}

template <> void EditController::take(edit_news::Found&& news) {
    search_.take_found(news.job, std::move(news.attention), recipe_, news.relabel);
    recipe_.request.target = search_.last().words().target;
    live_.describe(recipe_);
}

template <> void EditController::take(edit_news::Preview&& news) {
    live_.gate = std::move(news.gate);
    if (live_.gate.warns) workspace_.notices.toast_of_step(live_.gate.verdict);
}

template <> void EditController::take(edit_news::Targets&& news) { live_.take(news); }

template <> void EditController::take(edit_news::OrdersTaken&&) { live_.orders.clear(); }

template <> void EditController::take(edit_news::State&& news) {
    view_.untint();
    snapshots_.add(std::move(news.snapshot), std::move(news.set));
    ++workspace_.content;
}

template <> void EditController::take(edit_news::Step&& news) { live_.losses.push_back(news.point); }

template <> void EditController::take(edit_news::Partial&& news) {
    const auto& round = news.round;
    const bool ended = round.reason.empty();  // by the artist
    const auto roads = live_.roads;
    const auto go_on = [roads] { roads->fits.push(true); };
    const auto stop = [this, roads, ended] {
        if (ended && runs() && live_.roads == roads) workspace_.jobs->work.cancel();
        roads->fits.push(false);
    };
    workspace_.notices.ask(
        "Fit the scene to a part of the views?",
        fmt::format("{}{}. Views that are missing are left out; Redo in Targets has one drawn.",
                    ended ? "" : round.reason + ". ", remote::partial_text(round)),
        {{{fmt::format("Fit with {} of {} views", round.drawn, round.wanted)}, go_on}, {{"Stop"}, stop}});
}

template <> void EditController::take(edit_news::Use&& news) { workspace_.cost = cost_of(news.use); }

void EditController::refresh() {
    for (auto& news : live_.roads->news.take())
        std::visit([this](auto&& one) { take(std::move(one)); }, std::move(news));
}

// States

/// The snapshot of that iteration, else the last before it; null (and said) where it cannot be used.
const edit::EditSnapshot* EditController::usable_snapshot(int iteration) {
    const auto* snapshot = snapshots_.at_or_before(iteration);
    if (snapshot == nullptr) return nullptr;
    const auto& document = workspace_.document;
    if (workspace_.results && !workspace_.results->changes.empty()) {
        workspace_.notices.toast(
            "Those are states of the last of several changes: they are not the whole edit.");
        return nullptr;
    }
    if (!document.empty() && snapshots_.base().shares_all_with(document.state().current)) return snapshot;
    workspace_.notices.toast("The scene was changed since; the snapshots do not fit it any more.");
    return nullptr;
}

template <> void EditController::on(const command::ShowSnapshot& one) {
    snapshots_.look_at(one.index, workspace_.results.has_value());
    ++workspace_.content;
}

template <> void EditController::on(const command::TakeSnapshot& one) {
    auto& results = workspace_.results;
    if (results && !results.shows_last())
        return workspace_.notices.toast("Those states are of the last result: show that one first.");
    const auto* snapshot = results && !workspace_.jobs->works() ? usable_snapshot(one.iteration) : nullptr;
    if (snapshot == nullptr) return;
    results->set = snapshots_.set_of(*snapshot);
    results->base_to_new = std::make_shared<const std::vector<std::int64_t>>(snapshot->base_to_new());
    results->name = fmt::format("{} (iteration {})", search_.request().prompt, snapshot->iteration);
    snapshots_.look_at_newest();
    ++workspace_.content;
    workspace_.notices.toast(
        fmt::format("The state of iteration {} is the result now. Apply keeps it.", snapshot->iteration));
}

template <> void EditController::on(const command::BranchFromSnapshot& one) {
    if (!servers_.may_send(search_.sentence(), [this, one] { on(one); })) return;
    if (workspace_.jobs->works() && !runs())
        return workspace_.notices.toast("An edit can go on when the job is done.");
    const auto* snapshot = usable_snapshot(one.iteration);
    if (snapshot == nullptr) return;
    if (const int steps = edit::planned_steps(search_.recipe().request); steps <= snapshot->iteration)
        return workspace_.notices.toast(fmt::format(
            "The edit has {} iterations: set more than {} to go on from there.", steps, snapshot->iteration));
    branch_ = *snapshot;
    if (workspace_.jobs->works())
        workspace_.jobs->work.cancel();  // it ends after its step; then the branch begins
    else go_on_from_branch();
}

void EditController::go_on_from_branch() {
    const edit::EditSnapshot from = *std::exchange(branch_, std::nullopt);
    workspace_.results.reset();
    ++workspace_.content;
    snapshots_.drop_after(from.iteration);
    std::erase_if(live_.losses, [&](const auto& point) { return point.iteration >= from.iteration; });
    start(from);
}

// Results

template <> void EditController::on(const command::ApplyResult&) {
    auto& results = workspace_.results;
    if (!results) return;
    const auto& before = workspace_.document.state();
    if (!before.current.shares_all_with(results->before))
        return workspace_.notices.toast(
            "The scene was changed since: undo that to apply the edit, or discard the edit.", true);
    const PendingResult result = *results;
    auto changes = result.changes.empty() ? std::vector{result} : result.changes;
    changes.front().label.reset();  // the document has it, as it was corrected since
    for (const auto& step : changes) {
        DocumentState state = applied(workspace_.document.state(), step, workspace_.next_edit_id++);
        if (result.changes.empty()) workspace_.variations.keep(results, state.stack.back(), before);
        if (!step.renamed.to.empty()) search_.forget_choice();
        workspace_.document.apply(fmt::format("Edit: {}", step.name), std::move(state));
    }
    results.reset();
    ++workspace_.content;
    workspace_.worked_at = workspace_.document.revision();  // undone, its pictures and its status go
    workspace_.toast_step(changes.size() == 1
                              ? fmt::format("The edit \"{}\" is kept.", result.name)
                              : fmt::format("The {} edits of \"{}\" are kept, each under History.",
                                            changes.size(), result.name));
    search_.sentence().forget_target();  // it is done: the next sentence has news of its own
    search_.sentence().set_step(std::nullopt);
    view_.tint(false);  // what was made is to be seen, not where
}

void EditController::discard_result() {
    workspace_.results.reset();
    view_.tint_again();  // what is labelled can be seen again
    ++workspace_.content;
}

template <> void EditController::on(const command::DiscardResult&) { discard_result(); }

template <> void EditController::on(const command::AnotherResult&) {
    auto& results = workspace_.results;
    if (!results || workspace_.jobs->occupied()) return;
    if (!servers_.may_send(search_.sentence(), [this, again = command::AnotherResult{}] { on(again); }))
        return;
    search_.sentence().settings().seed = results.next_seed();
    results.set_aside();
    const auto tint = view_.forget_tint();  // as before the first of them
    on(command::Edit{left_out_});
    view_.keep_tint(tint);
    if (!workspace_.jobs->works()) results.come_back();
}

template <> void EditController::on(const command::ShowResult& one) {
    auto& results = workspace_.results;
    if (!results) return;
    results.show(one.index);
    search_.sentence().settings().seed = results->seed;
    snapshots_.look_at_newest();
    ++workspace_.content;
}

void EditController::take_document(std::optional<PendingResult> pending) {
    forget_run();
    workspace_.results.reset(std::move(pending));
    if (workspace_.results) workspace_.results->before = workspace_.document.state().current;
}

void EditController::forget_run() {
    live_ = {};
    recipe_ = {};
    snapshots_ = {};
    chain_ = {};
    branch_.reset();
    ++workspace_.content;
}

// Frames

bool EditController::shows_states() const {
    return (runs() || workspace_.results) && !snapshots_.empty();  // a search has none
}

Stage EditController::stage() {
    const auto& state = workspace_.document.state();
    const auto& results = workspace_.results;
    Stage stage;
    stage.result = results.shown();
    stage.attention = search_.attention();
    const bool live = shows_states();
    stage.before = live || results ? state.current : state.base;
    const auto* looked_at = live ? snapshots_.shown() : nullptr;
    if (looked_at == nullptr && results) {
        stage.set = results->set;
        stage.base_to_new = results->base_to_new;
        return stage;
    }
    const bool later = chain_.beyond_first();
    stage.snapshot = live ? (looked_at != nullptr ? looked_at : &snapshots_.newest()) : nullptr;
    const auto& last = later ? chain_.state().current : state.current;
    stage.set = stage.snapshot != nullptr ? snapshots_.set_of(*stage.snapshot) : last;
    if (stage.snapshot != nullptr) stage.rows = snapshots_.rows_of(*stage.snapshot);
    else if (later) stage.rows = chain_.rows();
    return stage;
}

std::string EditController::said_of_stage() const {
    const auto* looked_at = snapshots_.shown();
    if (shows_states() && (looked_at != nullptr || !workspace_.results))
        return fmt::format(", as the edit was at iteration {}: it is not applied",
                           (looked_at != nullptr ? *looked_at : snapshots_.newest()).iteration);
    return workspace_.results ? ", with the edit that is not applied yet" : "";
}

void EditController::show(ui::EditPart& model) const {
    const auto& results = workspace_.results;
    live_.show(model);
    snapshots_.show(model);
    model.cost = workspace_.cost;
    model.edit_running = runs();
    model.targets_wait &= model.edit_running;
    model.result_waiting = results.has_value() && !workspace_.jobs->works();
    model.result_splats = results ? results->set.size() : 0;
    model.result_changed_outside = results ? results->changed_outside_label : 0;
    model.result_psnr_outside_db = results ? results->psnr_outside_db : 0;
    model.result_seconds = results ? results->seconds : 0;
    model.verdict = results ? verdict_of(*results) : ui::ResultVerdict{};
    model.results.clear();
    for (const auto& result : results.all()) model.results.push_back({result.thumbnail, result.seed});
    model.shown_result = results.shown().value_or(0);
    model.variations.clear();
    if (workspace_.document.empty()) return;
    const auto& stack = workspace_.document.state().stack;
    for (const auto& kept : workspace_.variations.all()) {
        const auto applied = kept.applied(stack);
        if (!applied) continue;
        ui::VariationsView view{kept.edit, {}, *applied};
        for (std::size_t i = 0; i < kept.nodes.size(); ++i)
            view.results.push_back({kept.nodes[i].thumbnail, kept.seeds[i]});
        model.variations.push_back(std::move(view));
    }
}

// The recovery folder

std::uint64_t EditController::kept_number() const {
    if (workspace_.results.kept() != nullptr) return WaitingEdit | workspace_.content;
    if (!runs()) return 0;
    return RunningEdit |
           static_cast<std::uint64_t>(snapshots_.empty() ? 0 : snapshots_.newest().iteration + 1);
}

nlohmann::json EditController::kept_json() const {
    if (kept_number() == 0) return {};
    const auto* whole = workspace_.results.kept();  // also while another edit runs
    const auto id = workspace_.next_edit_id + steps_before(whole);
    if (whole) whole = &whole->last_change();
    const auto& renamed = whole ? whole->renamed : live_.renamed;
    nlohmann::json json;
    json["waits"] = whole != nullptr;
    json["name"] = whole ? whole->name : live_.name;
    json["target"] = whole ? whole->target : live_.target;
    if (whole) json["seed"] = whole->seed;
    json["iterations"] = live_.iterations;
    json["id"] = whole || !snapshots_.empty() ? id : 0;
    if (!live_.losses.empty()) json["iteration"] = live_.losses.back().iteration;
    json["adds"] = whole ? whole->adds : live_.adds;
    if (whole) json["verdict"] = whole->verdict, json["warns"] = whole->warns;
    if (whole) json["stopped_at"] = whole->stopped_at, json["steps"] = whole->steps;
    json["source"] = renamed.from;
    json["becomes"] = renamed.to;
    return json;
}

/// Steps of the sentence that are on the stack below what is kept.
std::size_t EditController::steps_before(const PendingResult* whole) const {
    if (whole == nullptr) return chain_.finished();
    return whole->changes.empty() ? 0 : whole->changes.size() - 1;
}

std::function<DocumentState()> EditController::kept_state() const {
    const auto* whole = workspace_.results.kept();
    DocumentState state = whole || !chain_.beyond_first() ? workspace_.document.state() : chain_.state();
    if (!whole && (!runs() || snapshots_.empty())) return [state] { return state; };
    GaussianSet after;
    std::shared_ptr<const std::vector<std::int64_t>> rows;
    std::optional<edit::EditSnapshot> snapshot;  // what waits to be applied goes before what ran
    const std::uint64_t id = workspace_.next_edit_id + steps_before(whole);
    if (whole) {
        for (std::uint64_t i = 0; i + 1 < whole->changes.size(); ++i)
            state = applied(state, whole->changes[i], workspace_.next_edit_id + i);
        whole = &whole->last_change();
    }
    if (whole) after = whole->set, rows = whole->base_to_new;
    else snapshot = snapshots_.newest();
    if (snapshot && snapshots_.newest_set().of == snapshot->rows) after = snapshots_.newest_set().set;
    EditNode node = whole ? node_of(*whole) : EditNode{};
    node.id = id;
    if (!whole) {
        node.name = fmt::format("{} (interrupted at iteration {})", live_.name, snapshot->iteration);
        node.recipe = live_.recipe;
    }
    return [state, after, rows, snapshot, node]() mutable {
        if (snapshot) {
            if (after.empty()) after = snapshot->materialise();
            rows = std::make_shared<const std::vector<std::int64_t>>(snapshot->base_to_new());
        }
        if (rows->size() != state.current.size()) return state;
        node.delta = std::make_shared<const SceneDelta>(
            make_delta(state.current, *state.row_ids, after, *rows, node.id));
        auto stack = state.stack;
        stack.push_back(node);
        return with_stack(state, std::move(stack));
    };
}

// Commands

template <> void EditController::on(const command::Pause& one) { workspace_.jobs->work.pause(one.paused); }

/// A drawing that has enough views is ended by itself: the edit asks whether it goes on with those.
template <> void EditController::on(const command::Cancel&) {
    if (runs() && live_.roads->drawing->request()) return;
    workspace_.jobs->work.cancel();
}

template <> void EditController::on(const command::OrderTarget& one) {
    if (!runs())
        return workspace_.notices.toast(
            "The edit is over: branch from a snapshot to go on with other views.");
    live_.order(one.order);
}

template <> void EditController::on(const command::FitToTargets&) { live_.fit(); }

void EditController::run(const ui::EditCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
