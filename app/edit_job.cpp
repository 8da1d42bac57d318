// Loads, locates, edits.
#include "app/edit_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/neural_loader.h"
#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/log.h"
#include "engine/base/spelling.h"
#include "engine/edit/grabcut_segmenter.h"
#include "engine/io/scene_io.h"
#include "engine/localize/focus.h"

namespace gse::app {
namespace {

constexpr double Degree = std::numbers::pi / 180;
constexpr int RecipeVersion = 1;
constexpr std::size_t InstanceViews = 12;   // renders a tuning learns from (method 2.6: 8 to 16)
constexpr double NearInstance = 0.6;        // share of the fitted distance of every other one, where views are automatic

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

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

std::string join_prompt(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

}  // namespace

std::filesystem::path assets_path() {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const auto installed = program / "../share/gseditpro";
    return std::filesystem::exists(installed) ? installed : std::filesystem::path(GSE_ASSETS);
}

std::filesystem::path starter_model_path() { return assets_path() / "models/starter"; }

void warn_unknown_words(const std::vector<std::string>& words, const std::vector<std::string>& known) {
    if (known.empty()) return;
    for (const auto& word : words) {
        if (std::find(known.begin(), known.end(), word) != known.end()) continue;
        const auto nearest = nearest_word(word, known);
        if (nearest.empty()) log::warning("the model does not know the word \"{}\"", word);
        else log::warning("the model does not know the word \"{}\"; the nearest it knows is \"{}\"", word, nearest);
    }
}

nlohmann::ordered_json recipe_to_json(const EditRecipe& recipe) {
    nlohmann::ordered_json json;
    json["version"] = RecipeVersion;
    json["job"] = fields_to_json(recipe.job);
    json["request"] = fields_to_json(recipe.request);
    json["guidance"] = fields_to_json(recipe.guidance);
    if (recipe.use_dreambooth) json["dreambooth"] = fields_to_json(recipe.dreambooth);
    return json;
}

EditRecipe read_recipe(const std::filesystem::path& path) {
    const auto json = nlohmann::ordered_json::parse(read_file(path), nullptr, false);
    if (!json.is_object() || json.value("version", 0) != RecipeVersion)
        throw Error(ErrorCode::Malformed, "this is not a recipe of this version", "use the recipe.json of an edit", path);
    EditRecipe recipe;
    fields_from_json(recipe.job, json.value("job", nlohmann::ordered_json::object()));
    fields_from_json(recipe.request, json.value("request", nlohmann::ordered_json::object()));
    fields_from_json(recipe.guidance, json.value("guidance", nlohmann::ordered_json::object()));
    recipe.use_dreambooth = json.contains("dreambooth");
    fields_from_json(recipe.dreambooth, json.value("dreambooth", nlohmann::ordered_json::object()));
    for (auto* name : {&recipe.job.scene, &recipe.job.cameras, &recipe.job.model}) {
        if (name->empty() || *name == "none" || std::filesystem::path(*name).is_absolute()) continue;
        *name = std::filesystem::weakly_canonical(path.parent_path() / *name).string();
    }
    return recipe;
}

void StageTimes::begin(const std::string& stage) {
    open_ = stage;
    start_ = now_seconds();
}

void StageTimes::end() {
    const auto found = std::find_if(stages_.begin(), stages_.end(), [&](const auto& entry) { return entry.first == open_; });
    if (found != stages_.end()) found->second += now_seconds() - start_;
    else stages_.emplace_back(open_, now_seconds() - start_);
}

nlohmann::ordered_json StageTimes::to_json() const {
    nlohmann::ordered_json json;
    double total = 0;
    for (const auto& [stage, seconds] : stages_) {
        json[stage] = seconds;
        total += seconds;
    }
    json["total"] = total;
    return json;
}

std::shared_ptr<neural::TextToImage> load_recipe_model(const JobParameters& job) {
    const auto path = job.model.empty() ? starter_model_path() : std::filesystem::path(job.model);
    neural_api().set_threads(job.threads);
    return neural_api().load_model(path, job.device);
}

EditJob::EditJob(EditRecipe recipe, JobControl control) : recipe_(std::move(recipe)), control_(std::move(control)) {
    check_recipe();
    times_.begin("load_scene");
    recipe_.job.scene = std::filesystem::absolute(recipe_.job.scene).lexically_normal().string();
    scene_ = load_scene(recipe_.job.scene);
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
      model_(std::move(input.model)) {
    check_recipe();
    begin(std::move(input.cameras));
}

void EditJob::check_recipe() {
    recipe_.request = edit::validated(recipe_.request);
    parse_colour(recipe_.request.background);
    parse_up(recipe_.job.up, {});
    if (!recipe_.job.front.empty()) parse_front(recipe_.job.front);
}

void EditJob::begin(std::vector<View> cameras) {
    const auto statistics = compute_statistics(scene_.gaussians);
    if (statistics.count <= statistics.nan_rows + statistics.invisible_rows)
        throw Error(ErrorCode::InvalidArgument, "the scene has no splat that can be seen", "open another scene",
                    recipe_.job.scene);
    scene_.info.up = parse_up(recipe_.job.up, scene_.info);
    auto words = edit::words_of(recipe_.request.prompt);
    words.push_back(recipe_.request.source);
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
    name_views();
}

void EditJob::name_views() {
    view_words_.clear();
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

std::string EditJob::model_prompt() const { return join_prompt(edit::words_of(recipe_.request.prompt)); }

std::vector<Image> EditJob::instance_pictures() {
    const raster::Settings settings = render_settings();
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
        pictures.push_back(painter_.paint(scene_.gaussians.spans(), view.camera, settings).colour);
    return pictures;
}

void EditJob::tune() {
    times_.begin("dreambooth");
    tuning_ = model_->tune(recipe_.dreambooth, instance_pictures(), "a photo of a " + recipe_.request.source,
                           model_prompt(), control_);
    untune_ = std::shared_ptr<void>(nullptr, [model = model_, tuning = model_->tuning()](void*) {
        if (model->tuning() == tuning) model->untune();   // another job may have tuned it since
    });
    times_.end();
    log::info("tuned in {:.0f} s: loss on the scene {:.3f} to {:.3f}, on what the model knew {:.3f} to {:.3f}",
              tuning_->seconds, tuning_->instance_before, tuning_->instance_after, tuning_->prior_before,
              tuning_->prior_after);
}

edit::LocateInput EditJob::locate_input() const {
    const raster::Settings settings = render_settings();
    const double front = recipe_.job.front.empty() ? 0 : parse_front(recipe_.job.front);
    return {scene_.gaussians, views_, view_words_, recipe_.request, settings, scene_.info.up, direction_at(orbit_, front)};
}

/// How decided the views are: 1 when every splat is either always or never inside the masks.
static double decidedness(const localize::LabelWeights& weights) {
    double decided = 0, all = 0;
    for (std::size_t row = 0; row < weights.weight.size(); ++row) {
        decided += weights.evidence[row] * std::abs(2.0 * weights.weight[row] - 1);
        all += weights.evidence[row];
    }
    return all > 0 ? decided / all : 0;
}

void EditJob::choose_distance(const edit::LocateTools& tools) {
    // The fitted orbit shows the whole scene; what the words mean may be a small part of it. The distance at which the
    // views agree best on what is meant wins; a few views tell.
    constexpr std::array<double, 4> distances{1.0, 0.7, 0.45, 0.3};
    constexpr int scan_views = 6;
    const OrbitParameters fitted = orbit_;
    const int views = recipe_.request.views;
    recipe_.request.views = std::min(views, scan_views);
    double best = -1;
    OrbitParameters chosen = fitted;
    for (const double distance : distances) {
        orbit_ = fitted;
        orbit_.radius *= distance;
        set_orbit_views();
        try {
            const auto found = edit::locate(locate_input(), tools);
            const double score = decidedness(found.weights);
            log::debug("orbit at {:.2f} of the fitted distance: views agree {:.3f}", distance, score);
            if (score > best) {
                best = score;
                chosen = orbit_;
            }
        } catch (const Error& error) {
            if (error.code() == ErrorCode::Cancelled) throw;   // not found from here: try nearer
        }
    }
    recipe_.request.views = views;
    orbit_ = chosen;
    set_orbit_views();
}

void EditJob::locate() {
    if (recipe_.use_dreambooth && !tuning_) tune();
    times_.begin("locate");
    attention_ = std::make_unique<edit::CachedAttention>(model_->attention());
    const auto segmenter = edit::make_default_segmenter();
    const edit::LocateTools tools{painter_.rasterizer(), *attention_, segmenter.get(), nullptr, control_};
    const bool moves = automatic_views_ && recipe_.request.focus;
    if (moves) choose_distance(tools);
    located_ = edit::locate(locate_input(), tools);
    if (moves) {
        const auto& label = located_.mode == edit::EditMode::Add ? located_.source_label : located_.label;
        auto focused = localize::focus_orbit(scene_.gaussians, *label.bits, orbit_);
        // What is added needs room around what is there.
        if (located_.mode == edit::EditMode::Add) focused.radius *= 1.35;
        if (localize::worth_refocusing(orbit_, focused)) {
            orbit_ = focused;
            set_orbit_views();
            located_ = edit::locate(locate_input(), tools);
        }
    }
    finish_locate();
}

void EditJob::locate_again(double attention_threshold) {
    GSE_CHECK(attention_ != nullptr);
    times_.begin("locate");
    recipe_.request.attention_threshold = attention_threshold;
    const auto segmenter = edit::make_default_segmenter();
    located_ = edit::locate(locate_input(), {painter_.rasterizer(), *attention_, segmenter.get(), nullptr, control_});
    finish_locate();
}

void EditJob::finish_locate() {
    plan_ = edit::make_plan(locate_input(), located_, painter_.rasterizer());
    times_.end();
    const auto labelled = std::count(located_.label.bits->begin(), located_.label.bits->end(), std::uint8_t{1});
    log::info("mode {} ({}); {} of {} splats labelled, {} new", located_.mode == edit::EditMode::Add ? "add" : "modify",
              located_.reason, labelled, scene_.gaussians.size(), located_.seeds.size());
}

void EditJob::correct_label(const std::vector<std::uint8_t>& bits) {
    GSE_CHECK_EQ(bits.size(), scene_.gaussians.size());
    located_.label.bits = std::make_shared<const std::vector<std::uint8_t>>(bits);
    plan_ = edit::make_plan(locate_input(), located_, painter_.rasterizer());
}

void EditJob::use_label_alone() {
    located_ = {};
    located_.word = recipe_.request.source;
    located_.reason = "what is labelled is changed";
    const std::size_t rows = scene_.gaussians.size();
    located_.label = make_label(located_.word, std::vector<float>(rows, 0.0f), 0.5f);
    located_.weights.weight.assign(rows, 0.0f);
    located_.weights.evidence.assign(rows, 0.0);
    const raster::Settings settings = locate_input().settings;
    for (const auto& view : views_) {
        edit::ViewEvidence evidence;
        evidence.render = painter_.paint(scene_.gaussians.spans(), view.camera, settings).colour;
        evidence.map = Image(view.camera.width, view.camera.height, 1);
        evidence.region = evidence.mask = Mask(view.camera.width, view.camera.height);
        evidence.branch = "none";
        evidence.failed = true;
        located_.views.push_back(std::move(evidence));
    }
    located_.failed_views = static_cast<int>(views_.size());
    plan_ = edit::make_plan(locate_input(), located_, painter_.rasterizer());
}

void EditJob::set_loop_settings(const edit::EditRequest& request) {
    edit::EditRequest next = edit::validated(request);
    const auto& old = recipe_.request;
    next.source = old.source;
    next.prompt = old.prompt;
    next.target = old.target;
    next.mode = old.mode;
    next.views = old.views;
    next.image_size = old.image_size;
    next.attention_threshold = old.attention_threshold;
    recipe_.request = next;
}

OrbitParameters EditJob::film_orbit() const {
    // What was changed or added, and what it belongs to, with room around.
    std::vector<std::uint8_t> bits = result_.label;
    const auto& source = located_.source_label.bits;
    if (source)
        for (std::size_t row = 0; row < source->size(); ++row)
            if ((*source)[row] != 0 && result_.base_to_new[row] >= 0)
                bits[static_cast<std::size_t>(result_.base_to_new[row])] = 1;
    OrbitParameters orbit = localize::focus_orbit(result_.set, bits, orbit_);
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
    const auto guidance =
        model_->guidance(model_prompt(), with_sentence_before(recipe_.guidance, recipe_.request));
    edit::EditTools tools{painter_.rasterizer(), *guidance, observer.snapshot, control_, observer.iteration};
    tools.snapshot_seconds = observer.snapshot_seconds;
    tools.new_label = observer.new_label;
    const auto attention = model_->attention();   // not the one that remembers: every render is another question
    const auto segmenter = edit::make_default_segmenter();
    tools.attention = attention.get();
    tools.segmenter = segmenter.get();
    tools.word = dynamic_word();
    result_ = edit::run_edit(scene_.gaussians, plan_, recipe_.request, tools);
    times_.end();
}

}  // namespace gse::app
