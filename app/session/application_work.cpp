// Locate and edit: jobs on the work thread, live states while they run, and the result that waits to be
// applied.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/cli/engine_names.h"
#include "app/session/application.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/memory.h"
#include "engine/base/path_text.h"
#include "engine/base/process_memory.h"
#include "engine/localize/clusters.h"
#include "engine/pipeline/models/model_settings.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/report/edit_output.h"
#include "engine/pipeline/run/preview_check.h"
#include "engine/pipeline/run/scene_tools.h"
#include "engine/pipeline/session/cost_profile.h"
#include "engine/scene/label_ops.h"
#include "engine/scene/stack_edits.h"
#include "ui/sentence.h"

namespace gse::app {
namespace {

constexpr double SnapshotSeconds = 0.7;  // a running edit is seen at least every second
constexpr int LeastSteps = 8;            // of a run that tells how long the next one takes

}  // namespace

EditRecipe Application::current_recipe() const {
    EditRecipe recipe = defaults_;
    recipe.job.scene = scene_path_;
    recipe.job.model = model_path_;
    recipe.job.lora = loras_;
    recipe.job.segmenter = segmenter_path_;
    recipe.job.text_segmenter = text_segmenter_path_;
    recipe.request = model_.request;
    recipe.use_dreambooth = model_.model_settings.learn_scene;
    recipe.dreambooth = model_.model_settings.learning;
    recipe.guidance = model_.model_settings.guidance;
    recipe.attention = model_.model_settings.attention;
    recipe.job.device = model_.model_settings.device,
    recipe.job.rasterizer = model_.model_settings.rasterizer;
    recipe.job.precision = model_.model_settings.precision;
    recipe.job.threads = model_.model_settings.threads;
    recipe.job.front = model_.model_settings.front;
    recipe.job.looked_from = label_drives_edit() ? active_label()->looked_from : looked_from_;
    apply_profile(profile_, recipe, changed_settings(recipe, defaults_));
    recipe.request = ui::with_target(std::move(recipe.request), model_.said_words, read_target());
    return recipe;
}

/// What the last search saw to be new, where it was of this sentence and of the scene as it is now.
std::string Application::read_target() const {
    if (!searched_.target_read || !job_set_.shares_all_with(document_.state().current)) return {};
    const auto& words = searched_.words;
    const bool same = edit::as_told(words.source) == edit::as_told(model_.request.source) &&
                      edit::as_told(words.prompt) == edit::as_told(model_.request.prompt);
    return same ? words.target : std::string();
}

/// A search is the last one. Nothing may be changing the job meanwhile.
void Application::remember_search(std::shared_ptr<EditJob> job) {
    job_ = std::move(job);
    job_set_ = job_->scene().gaussians;
    searched_ = {job_->recipe().request, job_->target_read(), tuning_key(job_->recipe()), job_->tuned()};
}

/// The recipe for a job: a target that nobody has chosen is left to the pictures.
EditRecipe Application::open_recipe(EditRecipe recipe) const {
    if (model_.request.target.empty() && !recipe.request.source.empty()) recipe.request.target.clear();
    return recipe;
}

/// What the loaded model depends on.
std::string Application::model_key() const {
    return fmt::format("{}\n{}\n{}\n{}", model_path_, model_.model_settings.device,
                       model_.model_settings.precision, fmt::join(loras_, "\n"));
}

Scene Application::working_scene() const {
    Scene scene;
    scene.gaussians = document_.state().current;
    scene.info = document_.state().info;
    return scene;
}

bool Application::job_fits() const {
    return job_ != nullptr && job_set_.shares_all_with(document_.state().current) &&
           job_key_ == valid_search_key(current_recipe());
}

/// What the last search's model learned, where it is what this recipe's would learn.
std::optional<neural::TunedModel> Application::known_tuning(const EditRecipe& recipe) const {
    const bool same = recipe.use_dreambooth && job_set_.shares_all_with(document_.state().current) &&
                      searched_.tuning_key == tuning_key(recipe);
    return same ? searched_.tuned : std::nullopt;
}

void Application::locate() {
    if (!require_scene() || work_.running()) return;
    if (pending_) return toast("Apply or discard the edit first.");
    const auto search =
        begin_run(text_model_, text_model_key_ == model_key(), model_load_, planned_memory(), arriving_);
    model_.request.left_out.clear();  // of the search before
    EditRecipe recipe = current_recipe();
    recipe.job.looked_from = looked_from_ =
        turned_to(camera_, document_.state().info.up);  // whatever a label was made from
    if (recipe.request.prompt.empty() && !recipe.request.source.empty())
        recipe.request.prompt = "a " + recipe.request.source;
    try {
        recipe.request = edit::validated(recipe.request);
    } catch (const Error& error) { return report_error(error); }
    const Measured measured = measured_now();
    auto work = [search, recipe = open_recipe(recipe), said = model_.said_words, measured,
                 tuned = known_tuning(recipe), scene = working_scene(), cache = cache_,
                 views = document_.state().views](const JobControl& control) {
        const auto before = network_use();
        load_model(*search, recipe.job, cache, control);
        const PeakMemory peak;
        search->job = std::make_shared<EditJob>(
            recipe, EditJobInput{scene, views, search->model, {}, {}, tuned, said, search->segmenters},
            control);
        look(*search);
        search->use = network_use() - before;
        if (search->job->found() && !steps_measured(measured, *search->job))
            measure_steps(search->measured, *search->job);
        measure_peak(*search, peak);
    };
    auto done = [this, search, recipe, recipe_key = measured_key(), key = model_key(), model = model_path_,
                 on_cpu = model_.model_settings.device == "cpu"](const Error* error) {
        model_load_ = search->loaded;
        if (search->model) text_model_ = search->model, text_model_key_ = key;
        else if (error != nullptr && error->code() != ErrorCode::Cancelled && on_cpu)
            drop_model(model, *error);
        if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
        remember_search(search->job);
        model_.cost = cost_of(search->use);
        EditRecipe searched = recipe;
        searched.request.target = searched_.words.target;
        job_key_ = search_key(searched);
        remember_measured(recipe_key, search->measured);
        take_located(search->job, std::move(search->attention));
        const auto& located = search->job->located();
        if (!search->job->found())
            return report_error(Error(ErrorCode::NotFound, located.message, located.remedy));
        label_located(*search->job, {}, {});
    };
    const auto word = recipe.request.source.empty() ? recipe.request.target : recipe.request.source;
    work_.start({fmt::format("Locate \"{}\"", word), work, done, true});
}

bool Application::edit_running() const {
    const JobStatus status = work_.status();
    return status.running && status.title.starts_with("Edit");
}

namespace {

void show_gate(EditJob& job, LiveEdit& live) {
    const PreviewCheck gate = look_through_gate(job);
    ui::GateView view;
    for (const auto& picture : gate.pictures)
        view.pictures.push_back(std::make_shared<const Image>(picture.after));
    view.verdict = gate.verdict;
    view.warns = gate.warns;
    const std::lock_guard lock(live.mutex);
    live.gate = std::move(view);
    live.use = network_use();
    ++live.version;
}

}  // namespace

/// What is running, for whoever has to tell about it.
void describe(LiveEdit& live, const EditRecipe& recipe) {
    live.name = recipe.request.prompt;
    live.target = recipe.request.target;
    live.recipe = json_text(recipe_to_json(recipe));
    live.iterations = edit::planned_steps(recipe.request);
}

namespace {

/// PreviewCheck, loop and what the window makes of the result, each measured.
void run_measured(MeasuredRun& search, const std::vector<std::uint8_t>& label, LiveEdit& live,
                  PendingResult& pending, const PeakMemory& peak) {
    const double idea = search.job->times().seconds("gate");
    const auto idea_use = search.job->times().networks("gate");
    run_live(search.job, label, search.attention, live);
    if (live.wants_gate) {
        search.measured.idea = search.job->times().seconds("gate") - idea;
        search.measured.idea_tflop = (search.job->times().networks("gate") - idea_use).flop * 1e-12;
    }
    measure_loop(search.measured, *search.job, LeastSteps);
    const auto finishing = std::chrono::steady_clock::now();
    fill_pending(*search.job, pending);
    search.measured.finish = seconds_since(finishing);
    measure_peak(search, peak);
}

}  // namespace

void Application::edit() {
    if (!require_scene() || work_.running()) return;
    if (pending_) return toast("Apply or discard the last edit first.");
    forget_snapshots();
    tint_before_.reset();
    model_.losses.clear();
    if (reach_choice_)
        reach_choice_->source = edit::as_told(model_.request.source);  // another source is another matter
    start_edit(std::nullopt);
}

void Application::start_edit(std::optional<edit::EditSnapshot> start) {
    if (job_ && !job_fits()) model_.request.left_out.clear();  // they were views of another search
    if (!job_fits()) looked_from_ = turned_to(camera_, document_.state().info.up);
    compare_as_usual();
    EditRecipe recipe = current_recipe();
    try {
        recipe.request = edit::validated(recipe.request);
    } catch (const Error& error) { return report_error(error); }
    const auto search =
        begin_run(text_model_, text_model_key_ == model_key(), model_load_, planned_memory(), arriving_);
    if (job_fits()) search->job = job_;
    live_recipe_ = recipe;
    take_known_parts(search->measured, measured_now());
    const auto& state = document_.state();
    const auto label = label_drives_edit() ? *state.labels[static_cast<std::size_t>(state.active_label)].bits
                                           : std::vector<std::uint8_t>{};
    live_ = std::make_shared<LiveEdit>();
    live_->wants_gate = model_.model_settings.gate && !start && !edit::edits_by_views(recipe.request);
    live_->reviews = model_.model_settings.review;
    describe(*live_, recipe);
    live_->snapshots = snapshots_;
    live_->losses = model_.losses;
    live_->start = std::move(start);
    live_seen_ = 0;
    if (!live_->start) model_.gate = {};
    model_.target_rounds.clear();
    list_snapshots();
    model_.shown_snapshot = -1;
    snapshot_base_ = state.current;
    auto pending = std::make_shared<PendingResult>();
    auto work = [search, recipe, label, pending, live = live_, open = open_recipe(recipe),
                 said = model_.said_words, tuned = known_tuning(recipe), scene = working_scene(),
                 views = state.views, cache = cache_](const JobControl& control) {
        live->use_before = live->use = network_use();
        load_model(*search, recipe.job, cache, control);
        const PeakMemory peak;
        if (search->job) {
            search->job->set_control(control);
            search->job->take_settings(recipe, label.empty());
            if (!search->job->found() && !label.empty()) search->job->use_label(label);
        } else {
            search->job = std::make_shared<EditJob>(
                open, EditJobInput{scene, views, search->model, label, {}, tuned, said, search->segmenters},
                control);
            look(*search);
        }
        run_measured(*search, label, *live, *pending, peak);
        throw_what_ended(search->job->result());
    };
    auto done = [this, search, pending, recipe_key = measured_key(), key = model_key(), model = model_path_,
                 on_cpu = model_.model_settings.device == "cpu"](const Error* error) {
        model_load_ = search->loaded;
        if (search->model) text_model_ = search->model, text_model_key_ = key;
        else if (error != nullptr && error->code() != ErrorCode::Cancelled && on_cpu)
            drop_model(model, *error);
        remember_measured(recipe_key, search->measured);
        refresh_live();  // what was found last, and the last steps
        if (branch_) return go_on_from_branch();
        if (pending->set.size() > 0)
            pending_.add(std::move(*pending));  // also what a shortage or a failure left
        pending_.come_back();
        finish_edit(error);
    };
    work_.start({fmt::format("Edit: {}", recipe.request.prompt), work, done, true});
}

void run_live(const std::shared_ptr<EditJob>& job, const std::vector<std::uint8_t>& label,
              const std::vector<float>& attention, LiveEdit& live) {
    const bool adds = job->located().mode == edit::EditMode::Add;
    if (!adds && !label.empty() && label != *job->located().label.bits) job->correct_label(label);
    if (adds && !label.empty() && label != *job->located().source_label.bits)
        log::warning("{}", AddsElsewhere);  // a toast, too
    {
        const std::lock_guard lock(live.mutex);
        live.adds = adds;
        live.renamed = renamed_by(*job);
    }
    if (!attention.empty()) {  // from here on the loop leaves alone what the search found: it can be read
        const std::lock_guard lock(live.mutex);
        live.found = job;
        live.attention = attention;
        live.relabel = label.empty();
        ++live.version;
    }
    edit::require_found(job->located());
    if (live.wants_gate) show_gate(*job, live);
    EditObserver observer;
    watch_targets(*job, live, observer);
    observer.start = live.start;
    observer.snapshot_seconds = SnapshotSeconds;
    observer.snapshot = [&live](edit::EditSnapshot snapshot) {
        SnapshotSet newest{snapshot.rows, snapshot.materialise()};  // here, so that the window need not
        const std::lock_guard lock(live.mutex);
        live.newest = std::move(newest);
        live.snapshots.push_back(std::move(snapshot));
        edit::thin_out(live.snapshots, MostSnapshots, MostSnapshotBytes);
        ++live.version;
    };
    observer.iteration = [&live](const edit::IterationRecord& record) {
        ui::LossPoint point;
        point.iteration = record.iteration;
        point.preservation = static_cast<float>(record.preservation);
        point.anchor = static_cast<float>(record.anchor);
        point.guidance_norm = static_cast<float>(record.guidance_norm);
        point.preservation_norm = static_cast<float>(record.preservation_norm);
        const auto loss = record.guidance.find("loss");
        if (loss != record.guidance.end()) point.guidance_loss = static_cast<float>(loss->second);
        const std::lock_guard lock(live.mutex);
        live.losses.push_back(point);
        live.use = network_use();
        ++live.version;
    };
    if (!adds)
        observer.new_label = [&live] {
            const std::lock_guard lock(live.mutex);
            return std::exchange(live.label, std::nullopt);
        };
    job->run(observer);
    const std::lock_guard lock(live.mutex);
    live.use = network_use();
    live.waits = false;
    ++live.version;
}

void Application::finish_edit(const Error* error) {
    ++content_;
    const bool said = job_ && !job_->found();  // with its evidence
    if (error != nullptr && error->code() != ErrorCode::Cancelled && !said) report_error(*error);
    if (pending_) untint();
}

void Application::apply_result() {
    if (!pending_) return;
    const auto& before = document_.state();
    if (!before.current.shares_all_with(pending_->before))
        return toast("The scene was changed since: undo that to apply the edit, or discard the edit.", true);
    const PendingResult result = std::move(*pending_);
    pending_.reset();
    ++content_;
    EditNode node = node_of(result);
    node.id = next_edit_id_++;
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(result.before, *before.row_ids, result.set, *result.base_to_new, node.id));
    DocumentState state = with_result(before, std::move(node), result);
    if (state.labels.size() > before.labels.size() || !result.renamed.to.empty())
        reach_choice_.reset();  // nobody has chosen the new label, or name
    document_.apply(fmt::format("Edit: {}", result.name), std::move(state));
    toast_step(fmt::format("The edit \"{}\" is kept.", result.name));
    model_.request.target.clear();    // it is done: the next sentence has news of its own
    model_.view.tint_labels = false;  // what was made is to be seen, not where
}

/// What is made is to be seen, not where; from here on the tint is the artist's, until the next edit.
void Application::untint() {
    if (!tint_before_) tint_before_ = std::exchange(model_.view.tint_labels, false);
}

void Application::discard_result() {
    pending_.reset();
    model_.view.tint_labels |=
        std::exchange(tint_before_, std::nullopt).value_or(false);  // what is labelled can be seen again
    ++content_;
}

void Application::another_result() {
    if (!pending_ || work_.running()) return;
    model_.request.seed = pending_.next_seed();
    pending_.set_aside();
    const auto tint = tint_before_;  // as before the first of them
    edit();
    tint_before_ = tint;
    if (!work_.running()) pending_.come_back();
}

void Application::show_result(std::size_t index) {
    if (!pending_) return;
    pending_.show(index);
    model_.request.seed = pending_->seed;
    model_.shown_snapshot = -1;
    ++content_;
}

void Application::pause(bool paused) { work_.pause(paused); }

void Application::cancel() { work_.cancel(); }

}  // namespace gse::app
