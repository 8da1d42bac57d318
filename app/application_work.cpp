// Locate and edit: jobs on the work thread, live states while they run, and the result that waits to be applied.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "app/application.h"
#include "app/edit_output.h"
#include "app/gate.h"
#include "app/process.h"
#include "app/scene_tools.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/localize/clusters.h"
#include "engine/scene/label_ops.h"

namespace gse::app {
namespace {

constexpr std::size_t MostSnapshots = 24;         // kept for the scrubber; thinned out beyond
constexpr double SnapshotSeconds = 0.7;           // a running edit is seen at least every second
constexpr double FirstSecondsPerIteration = 0.04; // of the starter model on a common processor, until one run was measured
constexpr double FirstSecondsPerView = 0.12;
constexpr double SecondsPerTuningStep = 0.3;
constexpr double NetworkMb = 320;                 // libtorch and the starter model

/// Attention in false colour (dark blue to yellow) over a dimmed render.
std::shared_ptr<const Image> coloured_map(const Image& render, const Image& map) {
    auto picture = std::make_shared<Image>(render.width, render.height, 3);
    for (std::size_t i = 0; i < picture->pixel_count(); ++i) {
        const float m = std::clamp(map.data[i], 0.0f, 1.0f);
        const float colour[3] = {std::min(1.0f, 1.7f * m), m * m, 0.35f + 0.4f * m * (1 - m) - 0.35f * m};
        for (std::size_t c = 0; c < 3; ++c)
            picture->data[i * 3 + c] = 0.35f * (1 - m) * render.data[i * 3 + c] + (0.25f + 0.75f * m) * colour[c];
    }
    return picture;
}

std::shared_ptr<const Image> masked_picture(const Image& render, const Mask& mask) {
    auto picture = std::make_shared<Image>(render);
    constexpr float tint[3] = {1.0f, 0.55f, 0.1f};
    const bool any = mask.data.size() == picture->pixel_count();
    for (std::size_t i = 0; i < picture->pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            float& value = picture->data[i * 3 + c];
            value = any && mask.data[i] != 0 ? 0.45f * value + 0.55f * tint[c] : 0.6f * value;
        }
    return picture;
}

ui::AttentionView attention_view(const edit::ViewEvidence& evidence, const View& view) {
    ui::AttentionView shown;
    shown.name = view.name;
    shown.render = std::make_shared<const Image>(evidence.render);
    shown.map = std::make_shared<const Image>(evidence.map);
    shown.map_coloured = coloured_map(evidence.render, evidence.map);
    shown.mask_picture = masked_picture(evidence.render, evidence.mask);
    shown.points = evidence.points;
    shown.branch = evidence.branch;
    shown.captured = evidence.captured;
    shown.failed = evidence.failed;
    shown.camera = view.camera;
    return shown;
}

/// The attention itself on the splats: sum(alpha T map) / sum(alpha T) over the views.
std::vector<float> splat_attention(EditJob& job) {
    const auto& set = job.scene().gaussians;
    std::vector<double> inside(set.size()), all(set.size());
    for (std::size_t v = 0; v < job.views().size(); ++v)
        job.painter().rasterizer().contributions(set.spans(), job.views()[v].camera, job.plan().settings,
                                                 job.located().views[v].map, inside, all);
    std::vector<float> result(set.size());
    for (std::size_t row = 0; row < result.size(); ++row)
        result[row] = all[row] > 0 ? static_cast<float>(std::clamp(inside[row] / all[row], 0.0, 1.0)) : 0.0f;
    return result;
}

double free_memory_mb() {
    std::ifstream file("/proc/meminfo");
    std::string key, unit;
    double kb = 0;
    while (file >> key >> kb >> unit)
        if (key == "MemAvailable:") return kb / 1024;
    return -1;
}

/// Words and views that decide what locate finds; another key asks for another search.
std::string search_key(const EditRecipe& recipe) {
    nlohmann::ordered_json json = fields_to_json(recipe.request);
    for (const char* loop : {"seed", "iterations", "guidance_weight", "attention_threshold"}) json.erase(loop);
    if (recipe.use_dreambooth) json["dreambooth"] = fields_to_json(recipe.dreambooth);
    return json.dump() + recipe.job.model + recipe.job.up;
}

}  // namespace

EditRecipe Application::current_recipe() const {
    EditRecipe recipe;
    recipe.job.scene = scene_path_;
    recipe.job.model = model_path_;
    recipe.request = model_.request;
    recipe.use_dreambooth = model_.model_settings.learn_scene;
    recipe.dreambooth.steps = model_.model_settings.learn_steps;
    recipe.dreambooth.rank = model_.model_settings.learn_rank;
    return recipe;
}

Scene Application::working_scene() const {
    Scene scene;
    scene.gaussians = document_.state().current;
    scene.info = document_.state().info;
    return scene;
}

bool Application::job_fits() const {
    return job_ != nullptr && job_set_.shares_all_with(document_.state().current) && job_key_ == search_key(current_recipe());
}

void Application::take_located(std::shared_ptr<EditJob> job, std::vector<float> attention, bool relabel) {
    const auto& located = job->located();
    model_.attention.clear();
    for (std::size_t v = 0; v < located.views.size(); ++v)
        model_.attention.push_back(attention_view(located.views[v], job->views()[v]));
    model_.attention_word = located.word;
    model_.attention_mode = fmt::format("{}: {}", located.mode == edit::EditMode::Add ? "add" : "modify", located.reason);
    attention_values_ = std::make_shared<const std::vector<float>>(std::move(attention));
    attention_set_ = job->scene().gaussians;
    ++content_;
    if (!relabel) return;
    if (!document_.state().current.shares_all_with(job->scene().gaussians)) return;   // the scene changed meanwhile
    const bool adds = located.mode == edit::EditMode::Add;
    const auto& bits = *(adds ? located.source_label : located.label).bits;
    const auto& weights = located.weights;
    std::vector<float> weight(weights.weight);
    const double tau = job->recipe().request.tau;
    for (std::size_t row = 0; row < weight.size(); ++row)   // what no view told about stays out at any threshold
        if (bits[row] == 0 && weight[row] > tau) weight[row] = 0;
    DocumentState state = document_.state();
    const std::string name = adds ? job->recipe().request.source : located.word;
    auto found = std::find_if(state.labels.begin(), state.labels.end(), [&](const auto& label) { return label.name == name; });
    if (found == state.labels.end()) found = state.labels.insert(state.labels.end(), empty_label(name, weight.size()));
    *found = empty_label(name, weight.size());
    found->threshold = static_cast<float>(tau);
    found->weight = std::make_shared<const std::vector<float>>(std::move(weight));
    *found = with_bits(*found);
    state.active_label = static_cast<int>(found - state.labels.begin());
    if (!edit_running()) model_.view.tint_labels = true;   // where it landed is to be seen
    document_.apply(fmt::format("Locate \"{}\"", name), std::move(state));
}

namespace {

/// What a search leaves for the main thread.
struct Search {
    std::shared_ptr<EditJob> job;
    std::shared_ptr<neural::TextToImage> model;
    std::vector<float> attention;
    double seconds_per_view = 0;
};

}  // namespace

void Application::locate() {
    if (!require_scene() || work_.running()) return;
    if (pending_) return toast("Apply or discard the edit first.");
    auto search = std::make_shared<Search>();
    search->model = text_model_path_ == model_path_ ? text_model_ : nullptr;
    EditRecipe recipe = current_recipe();
    if (recipe.request.prompt.empty() && !recipe.request.source.empty()) recipe.request.prompt = "a " + recipe.request.source;
    try {
        recipe.request = edit::validated(recipe.request);
    } catch (const Error& error) {
        return report_error(error);
    }
    const auto key = search_key(recipe);
    auto work = [search, recipe, scene = working_scene(), views = document_.state().views](const JobControl& control) {
        control.report("loading the model", 0, 0);
        if (!search->model) search->model = load_recipe_model(recipe.job);
        search->job = std::make_shared<EditJob>(recipe, EditJobInput{scene, views, search->model}, control);
        const auto start = std::chrono::steady_clock::now();
        search->job->locate();
        search->seconds_per_view = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
                                   static_cast<double>(search->job->views().size());
        search->attention = splat_attention(*search->job);
    };
    auto done = [this, search, key, model = model_path_](const Error* error) {
        if (search->model) text_model_ = search->model, text_model_path_ = model;
        if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
        job_ = search->job;
        job_key_ = key;
        job_set_ = search->job->scene().gaussians;
        seconds_per_view_ = search->seconds_per_view;
        take_located(search->job, std::move(search->attention), true);
    };
    const auto word = recipe.request.source.empty() ? recipe.request.target : recipe.request.source;
    work_.start({fmt::format("Locate \"{}\"", word), work, done, true});
}

void Application::set_attention_threshold(double value) {
    model_.attention_threshold = value;
    model_.request.attention_threshold = value;
    wanted_threshold_ = value;
    if (!job_ || work_.running() || pending_) return;   // taken up when the job is done (refresh_jobs)
    wanted_threshold_ = -1;
    auto attention = std::make_shared<std::vector<float>>();
    work_.start({"New threshold",
                 [job = job_, value, attention](const JobControl& control) {
                     job->set_control(control);
                     job->locate_again(value);
                     *attention = splat_attention(*job);
                 },
                 [this, job = job_, attention](const Error* error) {
                     if (error != nullptr) return error->code() == ErrorCode::Cancelled ? void() : report_error(*error);
                     take_located(job, std::move(*attention), true);
                 },
                 true});
}

/// True when what is labelled, and not a new search, says what the edit may change.
bool Application::label_drives_edit() const {
    const auto& state = document_.state();
    if (state.active_label < 0) return false;
    const auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
    if (count_labelled(label) == 0) return false;
    const auto& request = model_.request;
    const bool by_hand = !label.weight || std::all_of(label.weight->begin(), label.weight->end(), [](float w) { return w == 0; });
    return by_hand || label.name == request.source || label.name == request.target;
}

bool Application::edit_running() const { return work_.running() && model_.job.title.rfind("Edit", 0) == 0; }

namespace {

void show_gate(EditJob& job, LiveEdit& live) {
    const Gate gate = look_through_gate(job);
    ui::GateView view;
    for (const auto& picture : gate.pictures) view.pictures.push_back(std::make_shared<const Image>(picture.after));
    view.verdict = gate.verdict;
    view.warns = gate.warns;
    const std::lock_guard lock(live.mutex);
    live.gate = std::move(view);
    ++live.version;
}

}  // namespace

void Application::edit() {
    if (!require_scene() || work_.running()) return;
    if (pending_) return toast("Apply or discard the last edit first.");
    EditRecipe recipe = current_recipe();
    try {
        recipe.request = edit::validated(recipe.request);
    } catch (const Error& error) {
        return report_error(error);
    }
    auto search = std::make_shared<Search>();
    if (job_fits()) search->job = job_;
    live_key_ = search_key(recipe);
    search->model = text_model_path_ == model_path_ ? text_model_ : nullptr;
    std::vector<std::uint8_t> label;
    if (label_drives_edit()) label = *document_.state().labels[static_cast<std::size_t>(document_.state().active_label)].bits;
    live_ = std::make_shared<LiveEdit>();
    live_->wants_gate = model_.model_settings.gate;
    live_seen_ = 0;
    snapshots_.clear();
    model_.losses.clear();
    model_.gate = {};
    model_.snapshots.clear();
    model_.shown_snapshot = -1;
    auto pending = std::make_shared<PendingResult>();
    auto work = [search, recipe, label, pending, live = live_, scene = working_scene(),
                 views = document_.state().views](const JobControl& control) {
        control.report("loading the model", 0, 0);
        if (!search->model) search->model = load_recipe_model(recipe.job);
        if (search->job) {
            search->job->set_control(control);
        } else {
            search->job = std::make_shared<EditJob>(recipe, EditJobInput{scene, views, search->model}, control);
            try {
                search->job->locate();
                search->attention = splat_attention(*search->job);
            } catch (const Error& error) {
                if (error.code() == ErrorCode::Cancelled || label.empty()) throw;
                log::info("the words were not found ({}); the label alone says what may change", error.message());
                search->job->use_label_alone();
            }
        }
        search->job->set_loop_settings(recipe.request);
        run_live(search->job, label, search->attention, *live);
        fill_pending(*search->job, *pending);
    };
    auto done = [this, search, pending, model = model_path_](const Error* error) {
        if (search->model) text_model_ = search->model, text_model_path_ = model;
        refresh_live();   // what was found last, and the last steps
        if (error == nullptr && pending->set.size() > 0) pending_ = std::move(*pending);
        finish_edit(error);
    };
    work_.start({fmt::format("Edit: {}", recipe.request.prompt), work, done, true});
}

void run_live(const std::shared_ptr<EditJob>& job, const std::vector<std::uint8_t>& label,
              const std::vector<float>& attention, LiveEdit& live) {
    const bool adds = job->located().mode == edit::EditMode::Add;
    if (!adds && !label.empty() && label != *job->located().label.bits) job->correct_label(label);
    if (!attention.empty()) {   // from here on the loop leaves alone what the search found: it can be read
        const std::lock_guard lock(live.mutex);
        live.found = job;
        live.attention = attention;
        live.relabel = label.empty();
        ++live.version;
    }
    if (live.wants_gate) show_gate(*job, live);
    EditObserver observer;
    observer.snapshot_seconds = SnapshotSeconds;
    observer.snapshot = [&live](edit::EditSnapshot snapshot) {
        const std::lock_guard lock(live.mutex);
        live.snapshots.push_back(std::move(snapshot));
        if (live.snapshots.size() > MostSnapshots)   // every second of the older half goes
            for (std::size_t i = 0; i < live.snapshots.size() / 2; ++i)
                live.snapshots.erase(live.snapshots.begin() + static_cast<std::ptrdiff_t>(i));
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
        ++live.version;
    };
    if (!adds)
        observer.new_label = [&live] {
            const std::lock_guard lock(live.mutex);
            return std::exchange(live.label, std::nullopt);
        };
    job->run(observer);
}

void fill_pending(EditJob& job, PendingResult& pending) {
    const auto& result = job.result();
    if (result.iterations == 0) throw Error(ErrorCode::Cancelled, "the edit was stopped before its first step");
    const auto report = make_report(job);
    pending.before = job.scene().gaussians;
    pending.set = result.set;
    pending.base_to_new = std::make_shared<const std::vector<std::int64_t>>(result.base_to_new);
    pending.name = job.recipe().request.prompt;
    pending.target = job.recipe().request.target;
    pending.adds = job.located().mode == edit::EditMode::Add;
    pending.recipe = recipe_to_json(job.recipe()).dump();
    pending.seconds = report["seconds"]["edit"].get<double>();
    pending.psnr_outside_db = report["psnr_outside_db"].get<double>();
    pending.changed_outside_label = result.changed_outside_label;
    constexpr int thumbnail_px = 96;
    const Camera camera = orbit_camera(job.film_orbit(), 0.35, thumbnail_px, thumbnail_px);
    pending.thumbnail = std::make_shared<const Image>(job.painter().paint(result.set.spans(), camera, job.plan().settings).colour);
}

void Application::finish_edit(const Error* error) {
    ++content_;
    if (error != nullptr && error->code() != ErrorCode::Cancelled) report_error(*error);
    if (!pending_) return;
    const auto iterations = model_.losses.empty() ? 1.0 : static_cast<double>(model_.losses.back().iteration + 1);
    seconds_per_iteration_ = pending_->seconds / iterations;
    save_settings();
    toast(fmt::format("Outside the label {} splats changed, PSNR {:.1f} dB. Apply keeps the edit.",
                      pending_->changed_outside_label, pending_->psnr_outside_db));
}

void Application::apply_result() {
    if (!pending_) return;
    const PendingResult result = std::move(*pending_);
    pending_.reset();
    ++content_;
    const auto& before = document_.state();
    if (!before.current.shares_all_with(result.before)) {
        toast("The scene was changed since; the edit does not fit it any more.", true);
        return;
    }
    EditNode node;
    node.id = next_edit_id_++;
    node.name = result.name;
    node.recipe = result.recipe;
    node.seconds = result.seconds;
    node.psnr_outside_db = result.psnr_outside_db;
    node.changed_outside_label = result.changed_outside_label;
    node.thumbnail = result.thumbnail;
    node.delta = std::make_shared<const SceneDelta>(
        make_delta(result.before, *before.row_ids, result.set, *result.base_to_new, node.id));
    auto stack = before.stack;
    stack.push_back(node);
    DocumentState state = with_stack(before, std::move(stack));
    // What is new belongs to a label, so that it can be edited further.
    std::vector<std::uint8_t> added(state.current.size(), 0);
    for (std::size_t row = 0; row < added.size(); ++row) added[row] = ((*state.row_ids)[row] >> 32) == node.id ? 1 : 0;
    if (std::any_of(added.begin(), added.end(), [](auto bit) { return bit != 0; })) {
        if (result.adds || state.active_label < 0) {
            state.labels.push_back(empty_label(result.target, added.size()));
            state.active_label = static_cast<int>(state.labels.size()) - 1;
        }
        auto& label = state.labels[static_cast<std::size_t>(state.active_label)];
        label = combine(std::move(label), added, LabelOperation::Add);
    }
    document_.apply(fmt::format("Edit: {}", result.name), std::move(state));
    model_.view.tint_labels = false;   // what was made is to be seen, not where
}

void Application::discard_result() {
    pending_.reset();
    ++content_;
}

void Application::pause(bool paused) { work_.pause(paused); }

void Application::cancel() { work_.cancel(); }

void Application::show_snapshot(int index) {
    const int last = static_cast<int>(snapshots_.size()) - 1;
    model_.shown_snapshot = index >= last || index < 0 ? -1 : index;
    ++content_;
}

void Application::branch_from_snapshot(int index) {
    if (work_.running() || !pending_ || snapshots_.empty()) {
        if (work_.running()) toast("Cancel the edit first; then an earlier state can be taken.");
        return;
    }
    const auto at = index < 0 ? snapshots_.size() - 1 : std::min(static_cast<std::size_t>(index), snapshots_.size() - 1);
    const auto& snapshot = snapshots_[at];
    pending_->set = *snapshot.set;
    pending_->base_to_new = snapshot.base_to_new;
    pending_->name = fmt::format("{} (iteration {})", model_.request.prompt, snapshot.iteration);
    model_.shown_snapshot = -1;
    ++content_;
    toast(fmt::format("The state of iteration {} is the result now. Apply keeps it.", snapshot.iteration));
}

void Application::refresh_estimate() {
    const auto& request = model_.request;
    const double pixels = std::pow(request.image_size / 96.0, 2);
    const double per_iteration = seconds_per_iteration_ > 0 ? seconds_per_iteration_ : FirstSecondsPerIteration * pixels;
    const double per_view = seconds_per_view_ > 0 ? seconds_per_view_ : FirstSecondsPerView * pixels;
    const double learning = model_.model_settings.learn_scene ? SecondsPerTuningStep * model_.model_settings.learn_steps : 0;
    model_.estimate.seconds =
        (job_fits() ? 0 : per_view * request.views + learning) + per_iteration * request.iterations;
    const double scene_mb = static_cast<double>(document_.state().current.byte_size()) / 1e6;
    // Working set, gradients, two moments and anchors of the labelled rows, and the snapshots that are kept.
    model_.estimate.memory_mb = current_rss_mb() + (text_model_ ? 0 : NetworkMb) + 6 * scene_mb +
                                static_cast<double>(MostSnapshots) * scene_mb * 0.25;
    model_.estimate.memory_free_mb = free_memory_mb();
}

}  // namespace gse::app
