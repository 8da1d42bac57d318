// Loads, locates, edits.
#include "engine/pipeline/edit_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/base/path_text.h"
#include "engine/base/spelling.h"
#include "engine/edit/grabcut_segmenter.h"
#include "engine/edit/relation.h"
#include "engine/edit/scene_reading.h"
#include "engine/edit/vocabulary.h"
#include "engine/io/scene_io.h"
#include "engine/localize/focus.h"
#include "engine/pipeline/neural_loader.h"

namespace gse::pipeline {
namespace {

constexpr std::array<double, 5> ScanDistances{1.0, 0.7, 0.45, 0.3, 0.22};   // of the fitted orbit's radius
constexpr int ScanViews = 6;                // per distance
constexpr std::size_t InstanceViews = 12;   // renders a tuning learns from (method 2.6: 8 to 16)
constexpr double NearInstance = 0.6;        // share of the fitted distance of every other one, where views are automatic

/// The same camera, cropped to a centred square of `side` pixels.
Camera square_camera(const Camera& camera, int side) {
    const double shorter = std::min(camera.width, camera.height);
    const double scale = side / shorter;
    Camera result = camera;
    result.width = result.height = side;
    result.fx *= scale;
    result.fy *= scale;
    result.cx = (camera.cx - 0.5 * (camera.width - shorter)) * scale;
    result.cy = (camera.cy - 0.5 * (camera.height - shorter)) * scale;
    return result;
}

/// Farthest-point sample of the cameras (method X9), first camera first, in the order of the file.
std::vector<View> spread_views(const std::vector<View>& views, std::size_t count) {
    if (views.size() <= count) return views;
    std::vector<double> distance(views.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> chosen{0};
    while (chosen.size() < count) {
        const Vec3 last = views[chosen.back()].camera.centre();
        for (std::size_t i = 0; i < views.size(); ++i)
            distance[i] = std::min(distance[i], length(views[i].camera.centre() - last));
        chosen.push_back(
            static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin()));
    }
    std::sort(chosen.begin(), chosen.end());
    std::vector<View> result;
    for (const auto index : chosen) result.push_back(views[index]);
    return result;
}

std::string words_for_azimuth(double azimuth) {
    const double turned = std::abs(std::remainder(azimuth, 2 * std::numbers::pi));
    return turned < 50 * Degree ? "front view" : turned > 130 * Degree ? "back view" : "side view";
}

/// Level unit direction from the orbit's centre to its camera at `azimuth`.
Vec3 direction_at(const OrbitParameters& orbit, double azimuth) {
    OrbitParameters level = orbit;
    level.elevation = 0;
    return normalized(orbit_camera(level, azimuth, 8, 8).centre() - orbit.centre);
}

/// Azimuth from which a camera sees the orbit's centre, in the convention of orbit_camera.
double azimuth_of(const Camera& camera, const OrbitParameters& orbit) {
    const Vec3 front = direction_at(orbit, 0);
    const Vec3 side = cross(normalized(orbit.up), front);
    const Vec3 direction = camera.centre() - orbit.centre;
    return std::atan2(dot(direction, side), dot(direction, front));
}

double parse_front(const std::string& text) {
    std::size_t used = 0;
    double value = 0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (used == 0 || used != text.size() || !std::isfinite(value))
        throw Error(ErrorCode::InvalidArgument, "\"" + text + "\" is not an angle", "give --front in degrees, for example 0");
    return value * Degree;
}

/// What is added needs room around what is there; beside it more than on it.
double room_around(const edit::EditRequest& request) {
    constexpr double OnIt = 1.35, BesideIt = 1.75;
    const auto relation = edit::relation_of(request.prompt, request.source, request.target);
    return edit::place_name(relation).empty() ? OnIt : BesideIt;
}

/// The first label of a scene file.
std::vector<std::uint8_t> label_of(const Scene& scene, const std::filesystem::path& path) {
    if (!scene.labels.labels.empty()) {
        const auto& bits = *scene.labels.labels.front().bits;
        if (std::find(bits.begin(), bits.end(), std::uint8_t{1}) != bits.end()) return bits;
    }
    throw Error(ErrorCode::InvalidArgument, "no splat of the scene is labelled",
                "use a PLY whose float column \"label\" is 1 where the edit may change something", path);
}

}  // namespace

void warn_unknown_words(const std::vector<std::string>& words, const std::vector<std::string>& known) {
    if (known.empty()) return;
    for (const auto& word : words) {
        if (std::find(known.begin(), known.end(), word) != known.end()) continue;
        const auto nearest = nearest_word(word, known);
        if (nearest.empty()) log::warning("the model does not know the word \"{}\"", word);
        else log::warning("the model does not know the word \"{}\"; the nearest it knows is \"{}\"", word, nearest);
    }
}

namespace {

std::filesystem::path model_path(const JobParameters& job) {
    return job.model.empty() ? starter_model_path() : std::filesystem::path(job.model);
}

}  // namespace

void use_threads(const JobParameters& job) { neural_api().set_threads(job.threads); }

std::shared_ptr<neural::TextToImage> load_recipe_model(const JobParameters& job) {
    use_threads(job);
    return neural_api().load_model(model_path(job), job.device);
}

EditJob::EditJob(EditRecipe recipe, JobControl control) : recipe_(std::move(recipe)), control_(std::move(control)) {
    check_recipe();
    times_.begin("load_scene");
    recipe_.job.scene = std::filesystem::absolute(recipe_.job.scene).lexically_normal().string();
    scene_ = load_scene(recipe_.job.scene);
    if (recipe_.job.use_label) label_ = label_of(scene_, recipe_.job.scene);
    times_.end();
    std::vector<View> cameras;
    if (recipe_.job.cameras != "none") cameras = scene_cameras(recipe_.job.scene, recipe_.job.cameras);
    times_.begin("load_model");
    model_ = load_recipe_model(recipe_.job);
    times_.end();
    begin(std::move(cameras));
}

EditJob::EditJob(EditRecipe recipe, EditJobInput input, JobControl control)
    : recipe_(std::move(recipe)),
      control_(std::move(control)),
      scene_(std::move(input.scene)),
      model_(std::move(input.model)),
      said_(std::move(input.said)),
      label_(std::move(input.label)) {
    if (recipe_.use_dreambooth && input.tuned) {
        model_ = std::move(input.tuned->model);
        tuning_ = std::move(input.tuned->report);
    }
    check_recipe();
    GSE_CHECK(input.view_words.empty() || input.view_words.size() == input.cameras.size());
    for (std::size_t i = 0; i < input.view_words.size(); ++i) given_words_[input.cameras[i].name] = input.view_words[i];
    begin(std::move(input.cameras));
}

void EditJob::check_recipe() {
    auto& request = recipe_.request;
    target_open_ = request.target.empty() && !request.source.empty();
    if (target_open_) request.target = edit::guessed_target(request.prompt, edit::as_told(request.source), said_);
    recipe_.request = edit::validated(recipe_.request);
    check_fields(recipe_.job);
    check_fields(recipe_.guidance);
    check_fields(recipe_.attention);
    check_fields(recipe_.dreambooth);
    const auto known = model_ != nullptr ? model_->known_words() : model_words(model_path(recipe_.job));
    edit::require_known_words(recipe_.request, known, recipe_.job.use_label || !label_.empty());
    check_length();
    parse_colour(recipe_.request.background);
    parse_up(recipe_.job.up, {});
    if (!recipe_.job.front.empty()) parse_front(recipe_.job.front);
}

/// The text encoder has so many places; what stands behind them has no effect.
void EditJob::check_length() const {
    const auto words = edit::words_of(recipe_.request.prompt);
    const auto read = words_read(model_path(recipe_.job), words);
    if (read >= words.size()) return;
    for (const auto& word : {recipe_.request.source, recipe_.request.target}) {
        const auto first = edit::first_word(recipe_.request.prompt, word);
        if (first < words.size() && first + edit::words_of(word).size() > read)
            throw Error(ErrorCode::InvalidArgument,
                        fmt::format("the model reads {} words of a sentence and stops before \"{}\"", read, word),
                        "shorten the sentence, or move the word forward");
    }
    log::warning("the model reads {} words of the sentence: from \"{}\" on nothing counts", read, words[read]);
}

void EditJob::begin(std::vector<View> cameras) {
    const auto statistics = compute_statistics(scene_.gaussians);
    if (statistics.visible_rows == 0)
        throw Error(ErrorCode::InvalidArgument, "the scene has no splat that can be seen", "open another scene",
                    recipe_.job.scene);
    drawn_ = drawable(scene_.gaussians);
    unusable_ = statistics.nan_rows + statistics.infinite_rows;
    if (unusable_ > 0)
        log::warning("{} of {} splats hold values that cannot be drawn ({} NaN, {} infinite or absurd); they stay as they are "
                     "and count nowhere",
                     unusable_, statistics.count, statistics.nan_rows, statistics.infinite_rows);
    scene_.info.up = parse_up(recipe_.job.up, scene_.info);
    auto words = edit::words_of(recipe_.request.prompt);
    for (auto& word : edit::words_of(recipe_.request.source)) words.push_back(std::move(word));
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    warn_unknown_words(words, model_->known_words());
    choose_views(std::move(cameras));
}

void EditJob::choose_views(std::vector<View> cameras) {
    RenderParameters render;
    render.up = recipe_.job.up;
    render.elevation = recipe_.request.elevation;
    orbit_ = scene_orbit(scene_, render);
    automatic_views_ = cameras.empty();
    if (automatic_views_) {
        set_orbit_views();
        return;
    }
    views_ = spread_views(cameras, static_cast<std::size_t>(recipe_.request.views));
    for (auto& view : views_) view.camera = square_camera(view.camera, recipe_.request.image_size);
    name_views();
}

void EditJob::set_orbit_views() {
    const int side = recipe_.request.image_size;
    views_ = orbit_views(orbit_, recipe_.request.views, side, side);
    memory_ = {};
    name_views();
}

void EditJob::name_views() {
    view_words_.clear();
    if (!given_words_.empty() && !automatic_views_) {
        for (const auto& view : views_) view_words_.push_back(given_words_.at(view.name));
        return;
    }
    if (recipe_.job.front.empty()) return;
    const double front = parse_front(recipe_.job.front);
    for (const auto& view : views_) view_words_.push_back(words_for_azimuth(azimuth_of(view.camera, orbit_) - front));
}

raster::Settings EditJob::render_settings() const {
    raster::Settings settings;
    settings.background = parse_colour(recipe_.request.background);
    settings.antialiased = scene_.info.antialiased;
    return settings;
}

neural::SdsParameters with_sentence_before(neural::SdsParameters guidance, const edit::EditRequest& request) {
    if (guidance.before_prompt.empty()) guidance.before_prompt = edit::sentence_before(request);
    return guidance;
}

std::string EditJob::model_prompt() const { return edit::as_told(recipe_.request.prompt); }

std::vector<Image> EditJob::instance_pictures() {
    std::vector<View> views = spread_views(views_, InstanceViews);
    if (automatic_views_) {
        OrbitParameters near = orbit_;
        near.radius *= NearInstance;
        const int side = recipe_.request.image_size;
        const auto closer = orbit_views(near, static_cast<int>(views.size()), side, side);
        for (std::size_t i = 1; i < views.size(); i += 2) views[i] = closer[i];
    }
    std::vector<Image> pictures;
    for (const auto& view : views)
        pictures.push_back(painter_.paint(drawn_.spans(), view.camera, render_settings()).colour);
    return pictures;
}

void EditJob::tune() {
    times_.begin("dreambooth");
    auto tuned = model_->tune(recipe_.dreambooth, instance_pictures(), edit::instance_sentence(recipe_.request),
                              edit::without_identifier(model_prompt()), control_);
    model_ = std::move(tuned.model);
    tuning_ = std::move(tuned.report);
    times_.end();
    log::info("tuned in {:.0f} s: loss on the scene {:.3f} to {:.3f}, on what the model knew {:.3f} to {:.3f}",
              tuning_->seconds, tuning_->instance_before, tuning_->instance_after, tuning_->prior_before,
              tuning_->prior_after);
}

std::optional<neural::TunedModel> EditJob::tuned() const {
    return tuning_ ? std::optional(neural::TunedModel{model_, *tuning_}) : std::nullopt;
}

edit::LocateInput EditJob::locate_input() const {
    const raster::Settings settings = render_settings();
    const double front = recipe_.job.front.empty() ? 0 : parse_front(recipe_.job.front);
    return {drawn_,   views_,         view_words_, recipe_.request,
            settings,         scene_.info.up, direction_at(orbit_, front), by_label_ ? &label_ : nullptr, model_->known_words()};
}

std::vector<Image> EditJob::pictures_of(const std::vector<View>& views) {
    std::vector<Image> pictures;
    for (const auto& view : views) {
        if (control_.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
        pictures.push_back(painter_.paint(drawn_.spans(), view.camera, render_settings()).colour);
        for (auto& value : pictures.back().data) value = std::clamp(value, 0.0f, 1.0f);
    }
    return pictures;
}

/// Asks the model's encoders, where it has them, which word is new and which distances are worth a search.
void EditJob::read_scene() {
    const bool moves = automatic_views_ && recipe_.request.focus && !by_label_;
    distances_ = moves ? std::vector<double>(ScanDistances.begin(), ScanDistances.end()) : std::vector<double>{1.0};
    if (!recognition_->compares() || !(moves || target_open_)) return;
    const int side = recipe_.request.image_size;
    std::vector<std::vector<Image>> pictures;
    for (const double distance : distances_) {
        OrbitParameters orbit = orbit_;
        orbit.radius *= distance;
        pictures.push_back(pictures_of(moves ? orbit_views(orbit, ScanViews, side, side) : spread_views(views_, std::size_t{ScanViews})));
        control_.report("comparing the sentence with the scene", static_cast<int>(pictures.size()), static_cast<int>(distances_.size()));
    }
    std::vector<std::string> targets{recipe_.request.target};
    if (target_open_) targets = edit::possible_targets(recipe_.request.prompt, recipe_.request.source, said_);
    std::erase_if(targets, [&](const auto& word) { return !edit::knows(model_->known_words(), word); });
    const auto reading = edit::read_scene(*recognition_, recipe_.request, targets, pictures);
    if (target_open_) log::info("new in the sentence: \"{}\" (what it says without fits the scene to {:.2f})", reading.target, reading.fit);
    recipe_.request.target = reading.target;
    target_read_ = target_open_;
    std::vector<double> worth;
    for (const auto index : reading.distances) worth.push_back(distances_[index]);
    distances_ = std::move(worth);
}

void EditJob::choose_distance(const OrbitParameters& fitted, const std::vector<double>& distances, const edit::LocateTools& tools) {
    // The fitted orbit shows the whole scene; what the words mean may be a small part of it. The distance from which it is
    // found most surely wins; a few views tell, and what something is added to is enough.
    if (distances.size() == 1) {
        orbit_ = fitted;
        orbit_.radius *= distances.front();
        return set_orbit_views();
    }
    const auto asked = std::pair{recipe_.request.views, recipe_.request.mode};
    recipe_.request.views = std::min(asked.first, ScanViews);
    recipe_.request.mode = "modify";
    double best = -1;
    OrbitParameters chosen = fitted;
    for (const double distance : distances) {
        orbit_ = fitted;
        orbit_.radius *= distance;
        set_orbit_views();
        const auto found = edit::locate(locate_input(), tools);
        if (found.problem != edit::SearchProblem::None && found.problem != edit::SearchProblem::Unsure) continue;   // try nearer
        log::debug("orbit at {:.2f} of the fitted distance: confidence {:.3f}", distance, found.confidence.value);
        if (found.confidence.value > best) {
            best = found.confidence.value;
            chosen = orbit_;
        }
    }
    std::tie(recipe_.request.views, recipe_.request.mode) = asked;
    orbit_ = chosen;
    set_orbit_views();
}

/// Looks from the views as they are, and once more from nearer where what was found is small.
void EditJob::look_and_move_in(bool moves, const edit::LocateTools& tools) {
    located_ = edit::locate(locate_input(), tools);
    const auto& label = located_.mode == edit::EditMode::Add ? located_.source_label : located_.label;
    if (!moves || std::find(label.bits->begin(), label.bits->end(), std::uint8_t{1}) == label.bits->end()) return;
    auto focused = localize::focus_orbit(drawn_, *label.bits, orbit_);
    if (located_.mode == edit::EditMode::Add) focused.radius *= room_around(recipe_.request);
    if (!localize::worth_refocusing(orbit_, focused)) return;
    orbit_ = focused;
    set_orbit_views();
    located_ = edit::locate(locate_input(), tools);
}

void EditJob::search(const edit::LocateTools& tools) {
    const bool moves = automatic_views_ && recipe_.request.focus;
    if (!moves || by_label_) return look_and_move_in(moves, tools);
    const OrbitParameters fitted = orbit_;
    choose_distance(fitted, distances_, tools);
    look_and_move_in(moves, tools);
    std::vector<double> others;
    for (const double distance : ScanDistances)
        if (std::find(distances_.begin(), distances_.end(), distance) == distances_.end()) others.push_back(distance);
    if (found() || others.empty()) return;
    // The pictures as a whole fitted best where the word was not found.
    const auto orbit = orbit_;
    const auto located = located_;
    choose_distance(fitted, others, tools);
    look_and_move_in(moves, tools);
    if (found() || located_.confidence.value > located.confidence.value) return;
    orbit_ = orbit;
    set_orbit_views();
    located_ = located;
}

void EditJob::locate() {
    if (recipe_.use_dreambooth && !tuning_) tune();
    times_.begin("locate");
    attention_ = std::make_unique<edit::CachedAttention>(model_->attention(recipe_.attention));
    recognition_ = std::make_unique<edit::Recognition>(model_->text_image_score(), model_->known_words());
    const edit::LocateTools tools = locate_tools();
    by_label_ = !label_.empty() &&
                (recipe_.job.use_label || !edit::knows(model_->known_words(), recipe_.request.source));
    read_scene();
    search(tools);
    if (!found() && !label_.empty() && !by_label_) {
        log::info("{}; the label alone says what may change", located_.message);
        by_label_ = true;
        search(tools);
    }
    finish_locate();
}

/// The same from the views chosen already; the networks are asked only about pictures they have not seen.
void EditJob::look_again() {
    times_.begin("locate");
    if (attention_ == nullptr) attention_ = std::make_unique<edit::CachedAttention>(model_->attention(recipe_.attention));
    located_ = edit::locate(locate_input(), locate_tools());
    label_only_what_was_found();
    plan_stale_ = true;
    times_.end();
}

double EditJob::attention_threshold() const {
    const double asked = recipe_.request.attention_threshold;
    return asked > 0 || attention_ == nullptr ? asked : attention_->threshold();
}

edit::LocateTools EditJob::locate_tools() {
    if (segmenter_ == nullptr) segmenter_ = edit::make_default_segmenter();
    edit::LocateTools tools{painter_.rasterizer(), *attention_, segmenter_.get(), nullptr, control_};
    tools.memory = &memory_;
    tools.threads = &threads_;
    tools.recognition = recognition_.get();
    return tools;
}

void EditJob::locate_again(double attention_threshold) {
    const double before = std::exchange(recipe_.request.attention_threshold, attention_threshold);
    try {
        look_again();
    } catch (...) {   // what was found before stays, with the threshold it was found with
        recipe_.request.attention_threshold = before;
        throw;
    }
}

void EditJob::locate_anyway() {
    recipe_.request.least_confidence = 0;
    look_again();
}

/// What an unsure search found is seen in its views only.
void EditJob::label_only_what_was_found() {
    if (found()) return;
    const std::size_t rows = scene_.gaussians.size();
    for (auto* label : {&located_.label, &located_.source_label})
        *label = make_label(label->name, std::vector<float>(rows, 0.0f), 0.5f);
}

void EditJob::finish_locate() {
    label_only_what_was_found();
    plan_ = edit::make_plan(locate_input(), located_, painter_.rasterizer());
    plan_stale_ = false;
    times_.end();
    const auto labelled = std::count(located_.label.bits->begin(), located_.label.bits->end(), std::uint8_t{1});
    log::info("mode {} ({}); {} of {} splats labelled, {} new", located_.mode == edit::EditMode::Add ? "add" : "modify",
              located_.reason, labelled, scene_.gaussians.size(), located_.seeds.size());
}

void EditJob::correct_label(const std::vector<std::uint8_t>& bits) {
    GSE_CHECK_EQ(bits.size(), scene_.gaussians.size());
    located_.label.bits = std::make_shared<const std::vector<std::uint8_t>>(bits);
    plan_stale_ = true;
}

void EditJob::use_label(const std::vector<std::uint8_t>& bits) {
    GSE_CHECK_EQ(bits.size(), scene_.gaussians.size());
    label_ = bits;
    by_label_ = true;
    look_again();
}

void EditJob::take_settings(const EditRecipe& recipe, bool relabels) {
    const auto request = edit::validated(recipe.request);
    const edit::LabelThresholds before = recipe_.request;
    static_cast<edit::LoopSettings&>(recipe_.request) = request;
    recipe_.request.tau = request.tau;
    recipe_.guidance = recipe.guidance;
    plan_stale_ = true;   // how far masks are grown, and whether the label counts at all
    if (before.attention_threshold != request.attention_threshold || (relabels && before.tau != request.tau))
        locate_again(request.attention_threshold);
}

OrbitParameters EditJob::film_orbit() const {
    // What was changed or added, and what it belongs to, with room around.
    std::vector<std::uint8_t> bits = result_.label;
    const auto& source = located_.source_label.bits;
    if (source)
        for (std::size_t row = 0; row < source->size(); ++row)
            if ((*source)[row] != 0 && result_.base_to_new[row] >= 0)
                bits[static_cast<std::size_t>(result_.base_to_new[row])] = 1;
    OrbitParameters orbit = localize::focus_orbit(drawn_result_, bits, orbit_);
    orbit.radius = std::min(orbit.radius * 1.3, orbit_.radius * 1.25);
    return orbit;
}

/// What the dynamic mask looks for in the changing pictures: the new thing, or the thing that changes by its new name.
std::string EditJob::dynamic_word() const {
    const bool named = edit::has_word(recipe_.request.prompt, located_.word);
    return located_.mode == edit::EditMode::Modify && named ? located_.word : recipe_.request.target;
}

void EditJob::run(const EditObserver& observer) {
    times_.begin("edit");
    run_loop(recipe_.request, observer, control_);
    times_.end();
}

void EditJob::probe(int steps) {
    edit::EditRequest plain = recipe_.request;
    plain.iterations = steps;
    plain.dynamic_mask = plain.look_again = plain.early_stop = false;
    plain.densify_every = 0;
    JobControl quiet;
    quiet.stop = control_.stop;
    run_loop(plain, {}, quiet);
}

void EditJob::run_loop(const edit::EditRequest& request, const EditObserver& observer, const JobControl& control) {
    if (plan_stale_) plan_ = edit::make_plan(locate_input(), located_, painter_.rasterizer());
    plan_stale_ = false;
    const auto guidance =
        model_->guidance(model_prompt(), with_sentence_before(recipe_.guidance, recipe_.request));
    edit::EditTools tools{painter_.rasterizer(), *guidance, observer.snapshot, control, observer.iteration};
    tools.snapshot_seconds = observer.snapshot_seconds;
    tools.new_label = observer.new_label;
    tools.start = observer.start ? &*observer.start : nullptr;
    const auto attention = model_->attention(recipe_.attention);   // not the one that remembers: every render is another question
    const auto segmenter = edit::make_default_segmenter();
    // What the words did not find, their attention does not follow either.
    const bool lost = by_label_ && located_.mode == edit::EditMode::Modify;
    tools.attention = lost ? nullptr : attention.get();
    tools.segmenter = segmenter.get();
    tools.word = dynamic_word();
    result_ = edit::run_edit(scene_.gaussians, plan_, request, tools);
    drawn_result_ = drawable(result_.set);
}

}  // namespace gse::pipeline
