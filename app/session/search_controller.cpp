// The request and its search: votes of its views, and the scope of an edit (label or search).
#include "app/session/search_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/session/edit/live_edit.h"
#include "app/session/state/located_label.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/random.h"
#include "engine/edit/request/checked_request.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/excluded_views.h"
#include "engine/language/news.h"
#include "engine/language/plan/words/file_words.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/models/model_words.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/scene/label_ops.h"
#include "ui/state/sentence.h"
#include "ui/widgets/controls.h"

namespace gse::app {
namespace {

namespace command = ui::command;

constexpr double EstimateSeconds = 0.5;  // between two estimates

bool contains_word(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// The settings of a request, without what was typed for a scene.
edit::EditRequest without_words(edit::EditRequest request) {
    request.source.clear();
    request.prompt.clear();
    request.target.clear();
    request.instruction.clear();
    request.excluded_views.clear();
    request.mode = edit::EditRequest{}.mode;
    ui::forget_scope(request);
    return request;
}

Error problem_of(const EditJob& job) {
    return Error(ErrorCode::NotFound, job.located().message, job.located().remedy);
}

/// Tells whether the server may be offered to look for a thing: nothing says where it is, or a search does,
/// which may have been wrong.
bool may_be_searched(const NamedLabel* label) {
    return label == nullptr || (!label->found_for.empty() && !made_by_hand(*label));
}

/// Words about what would be sent if the server looked for the source of a recipe; empty where it cannot, or
/// where the model's words do.
std::string offer_of_search(const ServerController& servers, EditRecipe recipe,
                            const std::vector<std::string>& known) {
    recipe.server = servers.offered();
    const auto& source = recipe.request.source;
    if (!recipe.server.used() || source.empty() || language::unknown_word(known, source).empty()) return {};
    try {
        const auto checked = check(std::move(recipe));
        if (!searches_by_differences(checked, known)) return {};
        return servers.told_of_search(checked.plain().request, pictures_of_differences(checked));
    } catch (const Error&) { return {}; }  // the panel says what is wrong with the sentence
}

/// Work of each step that can be done, the first of which loads the model and uses the last search.
std::vector<PlannedEdit> work_of_steps(const AskedSentence& sentence, PlannedWork work) {
    std::vector<PlannedEdit> edits;
    for (const auto& step : sentence.steps()) {
        if (!step.words) {
            edits.push_back({sentence.request(), work, false});
            continue;
        }
        work.mode = step.words->mode;
        edits.push_back({edit::request_of(sentence.request(), *step.words), work});
        work.loaded = true, work.located = false;
    }
    return edits;
}

}  // namespace

SearchController::SearchController(Workspace& workspace, ViewController& view, ModelController& models,
                                   ServerController& servers, CostBook& costs)
    : workspace_(workspace), view_(view), models_(models), servers_(servers), costs_(costs) {}

// The request

void SearchController::set_request(const edit::EditRequest& request, bool waits) {
    words_wait_ |= waits;
    sentence_.set(request);
    refresh_reading();
}

void SearchController::move_request(const edit::EditRequest& before, const edit::EditRequest& after) {
    auto moved = request();
    move_defaults(moved, before, after);
    sentence_.set(moved);
}

void SearchController::refresh_reading() {
    const auto words = language::words_of(request().prompt);
    const auto read = words.empty() ? 0 : words_read(std::filesystem::path(models_.in_use()), words);
    words_read_ = read < words.size() ? read : 0;
}

void SearchController::follow_document() {
    last_.set_undone(!workspace_.document.includes(last_.step()));
    const auto& state = workspace_.document.state();
    sentence_.set_said(language::words_said(applied_sentences(state.stack)), things_added(state),
                       things_labelled(state));
}

EditRecipe SearchController::recipe() const {
    const NamedLabel* label = scope();
    EditRecipe recipe =
        models_.recipe(sentence_.asked(), label != nullptr ? label->looked_from : looked_from_);
    recipe.request = edit::with_target(std::move(recipe.request), {sentence_.said(), read_target()});
    recipe.server = servers_.server_for(recipe.request);
    return recipe;
}

EditRecipe SearchController::open_recipe(EditRecipe recipe) const {
    if (sentence_.asked().target.empty() && !recipe.request.source.empty()) recipe.request.target.clear();
    return recipe;
}

/// Word that the last search saw to be new, if it was of this sentence and of the scene as it is now.
std::string SearchController::read_target() const {
    const auto& document = workspace_.document;
    const bool fits = !document.empty() && last_.of(document.state().current);
    return fits ? last_.read_target(sentence_.asked()) : std::string();
}

void SearchController::from_json(const nlohmann::json& json) {
    if (!json.contains("request")) return;
    edit::EditRequest read = request();
    edit::read_request(read, json["request"]);
    set_request(read);
    follow_document();
    // Words of an applied edit are no news, even if one was clicked once.
    if (contains_word(sentence_.said(), request().target)) sentence_.forget_target();
}

// Searches

void SearchController::take_document() {
    last_.forget();
    looked_from_.clear();
    wanted_vote_.reset();
    arriving_ = std::make_shared<ArrivingViews>();
    choice_.reset();
    scope_key_ = {};
    scope_ = {};
    labelled_by_hand_ = attention_corrected_ = false;
    last_estimate_ = {};
    costs_.forget_estimate();
    if (!std::exchange(words_wait_, false)) set_request(without_words(request()));
    follow_document();
}

std::shared_ptr<EditJob> SearchController::fitting_job() const {
    const bool fits = last_.job() != nullptr && last_.of(workspace_.document.state().current) &&
                      last_.key() == valid_search_key(recipe());
    return fits ? last_.job() : nullptr;
}

void SearchController::begin_edit() {
    const bool fits = fitting_job() != nullptr;
    if (last_.job() && !fits)
        sentence_.settings().excluded_views.clear();  // they were views of another search
    if (!fitting_job()) looked_from_ = view_.direction();
    if (fits) last_.set_step(workspace_.document.revision());  // an undone search counts again
}

std::shared_ptr<MeasuredRun> SearchController::begin_run() {
    auto run =
        app::begin_run(models_.loaded(), models_.loaded_fits(), models_.load(), costs_.memory(), arriving_);
    run->road = servers_.road();
    return run;
}

SearchGround SearchController::ground(const EditRecipe& recipe) const {
    const auto& state = workspace_.document.state();
    SearchGround ground{workspace_.scene(), state.views,
                        last_.of(state.current) ? last_.tuning(recipe) : std::nullopt, sentence_.said()};
    ground.scene.labels = label_set(state);
    return ground;
}

SearchGround SearchController::ground(const StepChain& chain) const {
    const auto& state = chain.state();
    SearchGround ground{workspace_.scene(), state.views, std::nullopt, sentence_.said()};
    ground.scene.gaussians = state.current;
    ground.scene.extra = current_columns(state);
    ground.scene.labels = label_set(state);
    ground.said.insert(ground.said.end(), chain.words().begin(), chain.words().end());
    ground.found = chain.source_found();
    return ground;
}

template <> void SearchController::on(const command::Locate& locate) {
    if (!workspace_.require_scene() || workspace_.jobs->occupied()) return;
    if (workspace_.results) return workspace_.notices.toast("Apply or discard the edit first.");
    const bool by_server = locate.by_server;
    if (by_server && server_search_.empty()) return;
    const bool alone = !by_server && (locate.source_alone || request().prompt.empty());
    if (by_server) servers_.agree();
    if (!alone && !servers_.may_send(sentence_, [this, locate] { on(locate); })) return;
    const auto run = begin_run();
    take_known_parts(run->measured, costs_.profile(request()));
    sentence_.settings().excluded_views.clear();  // of the search before
    EditRecipe wanted = recipe();
    wanted.job.looked_from = looked_from_ = view_.direction();  // whatever a label was made from
    if (alone) wanted.request = edit::source_alone(std::move(wanted.request)), wanted.server = {};
    try {
        wanted.request = edit::check(std::move(wanted.request)).plain();
    } catch (const Error& error) { return workspace_.notices.report(error); }
    auto searched = ground(wanted);
    if (by_server)  // else the label of that name is taken for what is found
        std::erase_if(searched.scene.labels.labels, [&](const Label& label) {
            return language::normalised_prompt(label.name) == wanted.request.source;
        });
    auto work = [run, wanted, open = alone ? wanted : open_recipe(wanted), ground = std::move(searched),
                 by_server, known = costs_.profile(request()),
                 cache = models_.cache()](const JobControl& control) {
        const auto before = network_use();
        load_model(*run, wanted.job, cache, control);
        connect_to_server(*run, wanted, cache, control);
        const PeakMemory peak;
        auto input = ground.input(*run, {});
        input.server_searches = by_server;
        run->job = std::make_shared<EditJob>(open, std::move(input), control);
        look(*run);
        run->use = network_use() - before;
        if (run->server == nullptr && run->job->found() && !steps_measured(known, *run->job))
            measure_steps(run->measured, *run->job);
        measure_peak(*run, peak);
    };
    auto done = [this, run, wanted, cost_key = costs_.key(request()),
                 ticket = models_.ticket()](const Error* error) {
        models_.take_back(ticket, run->model, run->loaded, error);
        if (error != nullptr) return workspace_.report_end(*error);
        workspace_.cost = cost_of(run->use);
        costs_.remember(cost_key, run->measured);
        take_found(run->job, std::move(run->attention), wanted, true);
    };
    const auto& word = wanted.request.source.empty() ? wanted.request.target : wanted.request.source;
    workspace_.jobs->start_work(JobKind::Search, {fmt::format("Locate \"{}\"", word), work, done, true});
}

void SearchController::take_found(const std::shared_ptr<EditJob>& job, std::vector<float> attention,
                                  EditRecipe recipe, bool relabel) {
    last_.remember(job, recipe);
    take_located(job, std::move(attention));
    if (!job->found()) workspace_.notices.report_of_step(problem_of(*job));
    else if (relabel) label_located(*job, {}, {});
}

void SearchController::take_located(const std::shared_ptr<EditJob>& job, std::vector<float> attention) {
    std::vector<ui::AttentionView> arrived;
    arriving_->take(arrived);  // all of them are in what the job holds
    last_.take_attention(job->scene().gaussians, std::move(attention));
    last_.show_evidence(*job);
    last_.set_step(workspace_.document.revision());
    ++workspace_.content;
}

void SearchController::label_located(const EditJob& job, const std::string& step,
                                     const std::string& merge_key) {
    auto& document = workspace_.document;
    if (!document.state().current.shares_all_with(job.scene().gaussians))
        return;  // the scene changed meanwhile
    const bool edits = workspace_.jobs->works_at(JobKind::Edit);
    DocumentState state = with_located_label(document.state(), job, step.empty());
    const NamedLabel label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (!edits) view_.tint(true);  // where it landed is to be seen
    document.apply(step.empty() ? fmt::format("Locate \"{}\"", label.found_for) : step, std::move(state),
                   merge_key);
    if (step.empty()) last_.set_step(document.revision());
    if (merge_key.empty() && !edits)
        workspace_.toast_step(fmt::format("\"{}\": {} splats are labelled.", label.name,
                                          ui::count_text(count_labelled(label))));
}

template <> void SearchController::on(const command::LabelAnyway&) {
    const auto job = last_.job();
    if (!job || workspace_.jobs->occupied() || workspace_.results || job->found()) return;
    auto attention = std::make_shared<std::vector<float>>();
    auto work = [job, attention](const JobControl& control) {
        job->set_control(control);
        job->locate_anyway();
        *attention = splat_attention(*job);
    };
    auto done = [this, job, attention](const Error* error) {
        if (error != nullptr) return workspace_.report_end(*error);
        take_located(job, std::move(*attention));
        if (job->found()) label_located(*job, {}, {});
    };
    workspace_.jobs->start_work(JobKind::Search, {"Label what was found", work, done, true});
}

// Votes

template <> void SearchController::on(const command::SetAttentionThreshold& one) {
    const bool moved = one.value != request().attention_threshold;
    last_.set_threshold(one.value);
    sentence_.settings().attention_threshold = one.value;
    if (moved)
        wanted_vote_ = Vote{request(), fmt::format("Attention threshold {:.3f}", one.value),
                            fmt::format("attention{}", workspace_.stroke)};
    if (one.drag_ends) ++workspace_.stroke;
    vote_if_wanted();
}

template <> void SearchController::on(const command::LeaveOutView& one) {
    if (one.view >= last_.views().size() || last_.arriving()) return;
    sentence_.settings().excluded_views = edit::with_view(request().excluded_views, one.view, one.out);
    last_.leave_out(one.view, one.out);  // at once; what comes of it follows
    wanted_vote_ =
        Vote{request(),
             fmt::format("{} {}", one.out ? "Leave out" : "Put back", last_.views()[one.view].name),
             {}};
    vote_if_wanted();
}

/// Tells the last search what its views are to vote with; values that come while it works replace each other.
void SearchController::vote_if_wanted() {
    if (!wanted_vote_ || workspace_.jobs->occupied() || workspace_.results) return;  // taken up by refresh()
    const Vote wanted = *std::exchange(wanted_vote_, std::nullopt);
    const auto job = last_.job();
    if (!job || !last_.of(workspace_.document.state().current) || same_vote(wanted.with, last_.voted_with()))
        return;
    auto work = [job, wanted](const JobControl& control) {
        job->set_control(control);
        job->locate_again(wanted.with.attention_threshold, wanted.with.excluded_views);
    };
    auto done = [this, job, wanted](const Error* error) { end_vote(job, wanted, error); };
    workspace_.jobs->start_work(JobKind::Vote, {"New vote", work, done, true});
}

void SearchController::end_vote(const std::shared_ptr<EditJob>& job, const Vote& vote, const Error* error) {
    last_.set_voted_with(vote.with);
    if (error != nullptr) return workspace_.report_end(*error);
    last_.show_evidence(*job);
    ++workspace_.content;
    if (!job->found()) return workspace_.notices.report_of_step(problem_of(*job));
    if (!vote.step.empty()) label_located(*job, vote.step, vote.merge_key);
}

void SearchController::travel(const std::function<void()>& move) {
    const FoundWith before = found_with(workspace_.document.state());
    move();
    const auto [label, with] = found_with(workspace_.document.state());
    if (before.with.attention_threshold < 0 || with.attention_threshold < 0 || before.label != label) return;
    if (with.label_threshold != before.with.label_threshold)
        sentence_.settings().label_threshold = with.label_threshold;
    if (same_vote(with, before.with)) return;
    sentence_.settings().attention_threshold = with.attention_threshold;
    sentence_.settings().excluded_views = with.excluded_views;
    if (with.attention_threshold > 0) last_.set_threshold(with.attention_threshold);
    wanted_vote_ = Vote{with, {}, {}};
    vote_if_wanted();
}

// Label or search

const NamedLabel* SearchController::scope() const {
    return workspace_.document.empty() ? nullptr : scope(workspace_.document.state());
}

const NamedLabel* SearchController::scope(const DocumentState& state) const {
    const auto index = scope_label(state, sentence_.asked(), models_.list().known_words(), choice_);
    return index ? &state.labels[*index] : nullptr;
}

void SearchController::show_scope() {
    const NamedLabel* label = scope();
    if (label == nullptr || label == workspace_.active_label()) return;
    DocumentState next = workspace_.document.state();
    next.active_label = static_cast<int>(label - workspace_.document.state().labels.data());
    workspace_.document.apply("Choose label", std::move(next), "choose-label");
}

void SearchController::set_scope(bool by_label) {
    const NamedLabel* used = by_label ? nullptr : scope();
    if (const NamedLabel* label = used != nullptr ? used : workspace_.active_label())
        choice_ = ScopeChoice{by_label, label->name, language::normalised_prompt(sentence_.asked().source)};
}

/// A label that is named for another thing of the sentence says nothing of its source.
void SearchController::choose_label_by_hand() {
    const NamedLabel* label = workspace_.active_label();
    if (label == nullptr || sentence_.speaks_of(language::normalised_prompt(label->name))) return;
    const auto thing = language::plan::thing_of_file_name(label->name);
    if (!thing.empty() && sentence_.speaks_of(thing)) return;
    if (made_by_hand(*label) || count_labelled(*label) == 0) set_scope(true);
}

void SearchController::choose_for_source() {
    if (choice_ && choice_->source.empty())
        choice_->source = language::normalised_prompt(sentence_.asked().source);
}

void SearchController::rename_label(const std::string& from, const std::string& to) {
    if (choice_ && choice_->label == from) choice_->label = to;
}

/// Made anew only when words, label or choice are others.
void SearchController::refresh_scope() {
    ContentHash hash;
    hash.numbers(workspace_.document.revision(), last_.number(), choice_.has_value());
    const auto words = sentence_.asked();
    hash.texts({words.source, words.target, words.prompt, words.mode, models_.path()});
    hash.fields(servers_.offered());
    hash.numbers(models_.list().known_words().size());
    if (choice_) {
        hash.numbers(choice_->by_label);
        hash.texts({choice_->label, choice_->source});
    }
    if (scope_key_ == hash.key()) return;
    scope_key_ = hash.key();
    const auto source = language::normalised_prompt(last_.words().source);
    attention_corrected_ = !last_.views().empty() &&
                           corrected_after_search(workspace_.document.state().labels, {last_.word(), source});
    scope_ = {};
    labelled_by_hand_ = false;
    server_search_ = may_be_searched(scope())
                         ? offer_of_search(servers_, recipe(), models_.list().known_words())
                         : std::string();
    scope_.present = present_already(workspace_.document.state(), recipe().request, read_target());
    const NamedLabel *active = workspace_.active_label(), *used = scope();
    const NamedLabel* label = used != nullptr ? used : active;
    if (label == nullptr || count_labelled(*label) == 0) return;
    scope_.label = label->name;
    scope_.splats = count_labelled(*label);
    scope_.by_label = used != nullptr;
    scope_.corrected = !label->found_for.empty() && corrected_by_hand(*label);
    if (used != nullptr && active != nullptr && active != used) scope_.shown = active->name;
    labelled_by_hand_ = scope_.by_label && stands_alone(*label, words, models_.list().known_words());
}

// Frames

void SearchController::refresh() {
    if (last_.take_arriving(*arriving_, workspace_.jobs->works())) ++workspace_.content;
    vote_if_wanted();
    sentence_.set_known_words(models_.list().known_words(), servers_.on());
    if (workspace_.document.empty()) return;
    refresh_scope();
    if (!costs_.is_stale() && seconds_since(last_estimate_) <= EstimateSeconds) return;
    last_estimate_ = Clock::now();
    refresh_estimate();
}

void SearchController::refresh_estimate() {
    const EditRecipe wanted = recipe();
    const auto& settings = models_.settings();
    const auto& current = workspace_.document.state().current;
    PlannedWork work;
    work.loaded = models_.loaded_fits();
    work.located = fitting_job() != nullptr;
    work.shows_idea = settings.gate && !edit::method_of(request()).draws_views();
    const bool learned = last_.of(current) && last_.tuning(wanted);
    work.tune_steps = settings.learn_scene && !work.located && !learned ? settings.learning.steps : 0;
    work.rows = current.size();
    work.traits = models_.traits();
    work.words = models_.list().words_to_say();
    const auto estimate = [&](const std::vector<PlannedEdit>& edits) {
        costs_.estimate(edits, servers_.cost_of(edits));
    };
    if (sentence_.steps().size() > 1) return estimate(work_of_steps(sentence_, std::move(work)));
    try {
        work.mode = edit::decide_mode(edit::check(sentence_.asked()), std::nullopt).first;
    } catch (const Error&) {  // not a sentence yet
    }
    estimate({{request(), std::move(work)}});
}

void SearchController::show(ui::SearchPart& model) const {
    model.request = request();
    model.said_words = sentence_.said();
    model.made_things = sentence_.made();
    model.words_read = words_read_;
    model.read_target = read_target();
    model.scope = scope_;
    model.labelled_by_hand = labelled_by_hand_;
    model.attention_corrected = attention_corrected_;
    model.voting = workspace_.jobs->works_at(JobKind::Vote);
    model.server_search = server_search_;
    last_.show(model);
}

// Commands

template <> void SearchController::on(const command::SetRequest& one) { set_request(one.request); }

template <> void SearchController::on(const command::SetScope& one) { set_scope(one.by_label); }

template <> void SearchController::on(const command::RepeatEdit& one) {
    if (workspace_.document.empty()) return;
    for (const auto& node : workspace_.document.state().stack) {
        if (node.id != one.id) continue;
        try {
            auto request = recorded_request(node);
            if (!request) return;
            request->seed = Random::stream(request->seed, 77).next() % 1000000;
            set_request(*request);
            workspace_.notices.toast("The settings are in the prompt, with a new seed.");
        } catch (const Error& error) { workspace_.notices.report(error); }
        return;
    }
}

void SearchController::run(const ui::SearchCommand& command) {
    std::visit([this](const auto& one) { on(one); }, command);
}

}  // namespace gse::app
