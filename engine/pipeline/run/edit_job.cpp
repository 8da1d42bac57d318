// Loads, locates, edits.
#include "engine/pipeline/run/edit_job.h"
#include "engine/edit/request/edit_method.h"
#include "engine/edit/request/sentence_plan.h"
#include "engine/edit/search/thing_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/clock.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/base/log_quiet.h"
#include "engine/edit/request/vocabulary.h"
#include "engine/edit/words/dye_words.h"
#include "engine/evaluate/metrics.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/project/project_file.h"
#include "engine/language/grammar.h"
#include "engine/language/news.h"
#include "engine/language/vocabulary.h"
#include "engine/language/words.h"
#include "engine/localize/focus.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/probe.h"
#include "engine/pipeline/run/scene_words.h"
#include "engine/pipeline/scene/label_names.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/pipeline/select/cut_out.h"
#include "engine/pipeline/select/point_out.h"
#include "engine/pipeline/select/scene_ground.h"

namespace gse::pipeline {
namespace {

constexpr std::size_t InstanceViews = 12;  // renders a tuning learns from (METHOD.md, DreamBooth: 8 to 16)
// Share of the fitted distance of every other one, where views are automatic.
constexpr double NearInstance = 0.6;
constexpr double SameGround = 1.0 / 3, BorneOut = 0.75;  // IoU of a ground by shape with one by word

/// The label of a scene file that is named like the source, else the first.
std::vector<std::uint8_t> label_of(const Scene& scene, const std::filesystem::path& path,
                                   const std::string& source) {
    const auto& labels = scene.labels.labels;
    if (!labels.empty()) {
        const auto named = std::find_if(labels.begin(), labels.end(),
                                        [&](const auto& label) { return label.name == source; });
        const auto& bits = *(named == labels.end() ? labels.front() : *named).bits;
        if (std::find(bits.begin(), bits.end(), std::uint8_t{1}) != bits.end()) return bits;
    }
    throw Error(ErrorCode::InvalidArgument, "no splat of the scene is labelled",
                "use a PLY whose float column \"label\" is 1 where the edit may change something", path);
}

/// Thing in the box of --cut-out.
CutOutThing labelled_by_box(const Scene& scene, const CheckedRecipe& recipe, edit::Segmenter* segmenter,
                            const JobControl& control) {
    const auto& job = recipe.job;
    auto request = cut_out_request(job.cut_out, scene, job.up);
    request.ground = language::names_ground(recipe.request.source());
    request.nature = edit::nature_of(recipe.request.source());
    request.part = edit::is_about_part(recipe.request);
    auto thing = cut_out(drawable(scene.gaussians), request, segmenter, control);
    if (const auto text = cut_text(thing); !text.empty())
        log::warning("\"{}\": {}", recipe.request.source(), text);
    if (std::find(thing.rows.begin(), thing.rows.end(), std::uint8_t{1}) != thing.rows.end()) return thing;
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("nothing is seen in the box \"{}\" of --cut-out", job.cut_out),
                "look at what gseditpro render shows with the same azimuth, elevation and zoom");
}

/// Rows of --at or --the-thing, and the reason to look at them, if any.
std::pair<std::vector<std::uint8_t>, std::string> labelled_by_pointing(const Scene& scene,
                                                                       const CheckedRecipe& recipe,
                                                                       const JobControl& control) {
    const auto& job = recipe.job;
    const auto set = drawable(scene.gaussians);
    localize::GrownThing thing;
    std::string doubt;
    if (job.at.empty()) {
        thing = largest_thing(set, parse_up(job.up, scene.info), control);
    } else {
        auto request = click_request(job.at, scene, job.up);
        request.ground = language::names_ground(recipe.request.source());
        request.nature = edit::nature_of(recipe.request.source());
        request.part = edit::is_about_part(recipe.request);
        thing = thing_at(set, request, control);
        doubt = part_doubt(thing, request);
    }
    const auto rows = std::count(thing.rows.begin(), thing.rows.end(), std::uint8_t{1});
    if (rows == 0)
        throw Error(ErrorCode::InvalidArgument,
                    job.at.empty() ? "nothing stands alone in the scene"
                                   : fmt::format("nothing is seen at \"{}\" of --at", job.at),
                    "look at what gseditpro render shows with the same azimuth, elevation and zoom");
    const auto parted = parted_text(thing);
    log::info("\"{}\" is {}: {} of {} splats{}{}", recipe.request.source(),
              job.at.empty() ? "the largest thing that stands alone" : "what was clicked", rows, set.size(),
              parted.empty() ? "" : ", ", parted);
    if (!doubt.empty()) log::warning("\"{}\": {}", recipe.request.source(), doubt);
    return {std::move(thing.rows), std::move(doubt)};
}

/// More than one word of what may change contradict each other. Throws Error.
void require_one_label(const JobParameters& job) {
    std::vector<std::string> options;
    if (job.use_label) options.emplace_back("--use-label");
    if (!job.cut_out.empty()) options.emplace_back("--cut-out");
    if (!job.at.empty()) options.emplace_back("--at");
    if (job.the_thing) options.emplace_back("--the-thing");
    if (options.size() > 1)
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("{} and {} both say what may change", options[0], options[1]),
                    "leave one of them out");
}

/// So that a recipe that was written elsewhere names the same files. Throws Error for one that is not there.
std::vector<std::string> absolute_loras(const JobParameters& job) {
    std::vector<std::string> texts;
    for (auto lora : neural::find_loras(job.lora)) {
        lora.file = std::filesystem::absolute(lora.file).lexically_normal();
        texts.push_back(neural::lora_text(lora));
    }
    return texts;
}

}  // namespace

std::vector<float> splat_attention(EditJob& job) {
    const auto& set = job.drawn();
    std::vector<double> inside(set.size()), all(set.size());
    for (std::size_t v = 0; v < job.views().size(); ++v)
        job.painter().rasterizer().contributions(set.spans(), job.views()[v].camera, job.plan().settings,
                                                 job.located().views[v].map, inside, all);
    std::vector<float> result(set.size());
    for (std::size_t row = 0; row < result.size(); ++row)
        result[row] = all[row] > 0 ? static_cast<float>(std::clamp(inside[row] / all[row], 0.0, 1.0)) : 0.0f;
    return result;
}

void warn_unknown_words(const std::vector<std::string>& words, const std::vector<std::string>& known) {
    if (known.empty()) return;
    std::vector<std::string> left_out;
    for (const auto& word : words)
        for (auto& part : language::match_word(word, known).left_out)
            if (!language::contains(left_out, part)) left_out.push_back(std::move(part));
    for (const auto& word : left_out) {
        const auto nearest = language::nearest_words(word, known, 1);
        if (nearest.empty()) log::warning("the model does not know the word \"{}\" and leaves it out", word);
        else
            log::warning(
                "the model does not know the word \"{}\" and leaves it out; the nearest it knows is \"{}\"",
                word, nearest.front());
    }
}

bool keeps_labels(const std::filesystem::path& scene) {
    if (is_project_file(scene)) return true;
    const io::SceneFormat* format = format_written_to(scene);
    return format != nullptr && format->keeps_labels;
}

EditJob::EditJob(EditRecipe recipe, JobControl control, std::shared_ptr<DiskCache> cache)
    : recipe_(check(std::move(recipe))), control_(std::move(control)) {
    check_recipe();
    require_one_label(recipe_.job);
    server_searches_ = true;
    hints_.by_differences = searches_by_differences(recipe_, model_words(model_path(recipe_.job)));
    if (!keeps_labels(recipe_.job.scene)) check_words(nullptr, {});  // before any work
    times_.begin("load_scene");
    recipe_.job.scene = std::filesystem::absolute(recipe_.job.scene).lexically_normal().string();
    recipe_.job.lora = absolute_loras(recipe_.job);
    for (auto* file : {&recipe_.job.segmenter, &recipe_.job.text_segmenter})
        if (!file->empty()) *file = std::filesystem::absolute(*file).lexically_normal().string();
    make_files_absolute(recipe_.server);
    auto [scene, cameras, notes, up] =
        load_scene_with_cameras(recipe_.job.scene, recipe_.job.cameras, {.activated = recipe_.job.activated});
    if (recipe_.job.up == "auto" && !up.empty()) notes.push_back(up);
    for (const auto& note : notes) log::warning("{}", note);
    if (recipe_.job.use_label) hints_.label = label_of(scene, recipe_.job.scene, recipe_.request.source());
    times_.end();
    check_words(nullptr, scene.labels);
    GivenCameras given;
    given.cameras = std::move(cameras);
    times_.begin("load_model");
    auto model = open_recipe_model(recipe_.job, cache);
    auto segmenters = open_segmenters(recipe_.job, cache);
    std::shared_ptr<ViewServer> server;  // not asked where nothing is drawn
    if (!recipe_.request.is_rearranged()) server = open_view_server(recipe_.server, cache, control_);
    times_.end();
    if (!recipe_.job.cut_out.empty()) {
        times_.begin("cut_out");
        auto thing = labelled_by_box(scene, recipe_, segmenters.clicks.get(), control_);
        hints_.label_doubt = cut_text(thing);
        hints_.label = std::move(thing.rows);
        times_.end();
    } else if (!recipe_.job.at.empty() || recipe_.job.the_thing) {
        times_.begin("cut_out");
        std::tie(hints_.label, hints_.label_doubt) = labelled_by_pointing(scene, recipe_, control_);
        times_.end();
    }
    begin(std::move(scene), std::move(model), std::move(segmenters), std::move(server), given);
}

EditJob::EditJob(EditRecipe recipe, EditJobInput input, JobControl control)
    : recipe_(check(std::move(recipe), {input.said})), control_(std::move(control)) {
    hints_.said = std::move(input.said);
    hints_.label = std::move(input.label);
    hints_.found = std::move(input.found);
    auto model = std::move(input.model);
    if (recipe_.use_dreambooth && input.tuned) {
        model = std::move(input.tuned->model);
        tuning_ = std::move(input.tuned->report);
    }
    if (recipe_.server.used() && !input.server) {
        log::warning("the recipe names an image server ({}), which is not asked: the model here draws",
                     remote::without_secrets(recipe_.server.url));
        recipe_.server = {};
    }
    check_recipe();
    server_searches_ = input.server && input.server_searches;
    if (server_searches_ && hints_.label.empty() && hints_.found.empty())
        hints_.by_differences = searches_by_differences(recipe_, model->known_words());
    check_words(model.get(), input.scene.labels);
    GSE_CHECK(input.view_words.empty() || input.view_words.size() == input.cameras.size());
    GivenCameras given;
    for (std::size_t i = 0; i < input.view_words.size(); ++i)
        given.words[input.cameras[i].name] = input.view_words[i];
    given.cameras = std::move(input.cameras);
    begin(std::move(input.scene), std::move(model), std::move(input.segmenters), std::move(input.server),
          given);
}

void EditJob::check_recipe() const {
    check_fields(recipe_.job);
    check_fields(recipe_.guidance);
    check_fields(recipe_.attention);
    check_fields(recipe_.dreambooth);
    check_fields(recipe_.server);
    check_length();
    parse_colour(recipe_.request.background);
    parse_up(recipe_.job.up, {});
    parse_front(recipe_.job.front);
    parse_front(recipe_.job.looked_from, "--looked-from");
    raster::require_rasterizer(recipe_.job.rasterizer);
    if (!recipe_.server.used()) return;
    if (!edit::method_of(recipe_.request).draws_views())
        throw Error(ErrorCode::InvalidArgument, "a server draws views, and this method follows a gradient",
                    "leave the method (--method) or the server (--server) out");
    if (recipe_.use_dreambooth)
        throw Error(ErrorCode::InvalidArgument, "a server's model cannot be tuned from here",
                    "leave learning the scene (--dreambooth) or the server (--server) out");
}

/// Checks the words, after it has taken the label that one of them is the name of. A word that the model can
/// find is looked for all the same.
void EditJob::check_words(const neural::TextToImage* model, const LabelSet& labels) {
    const auto known = model != nullptr ? model->known_words() : model_words(model_path(recipe_.job));
    const auto drawn = !edit::method_of(recipe_.request).draws_views() ? std::vector<std::string>{}
                       : model != nullptr ? edit::with_dyes(model->generated_vocabulary(), known)
                                          : generated_vocabulary(model_path(recipe_.job));
    const auto& source = recipe_.request.source();
    const bool looked_for = hints_.label.empty() && hints_.found.empty() && recipe_.request.part_of().empty();
    if (looked_for && !recipe_.job.brings_label()) {
        if (const Label* label = label_for(labels, source, known)) hints_.label = *label->bits;
        else if (label_named(labels, source) != nullptr)
            log::info("\"{}\" is looked for by its word; --use-label takes the label of that name", source);
    }
    const bool labelled =
        recipe_.job.brings_label() || !hints_.label.empty() || !hints_.found.empty() || hints_.by_differences;
    const auto require = recipe_.server.used() ? edit::require_findable_words : edit::require_known_words;
    require(recipe_.request, known, drawn, labelled, label_names(labels));
}

/// The text encoder has so many places; what stands behind them has no effect.
void EditJob::check_length() const {
    if (recipe_.server.used()) return;
    const auto& sentence = recipe_.request.sentence().sentence();
    const auto& words = sentence.words();
    const auto read = words_read(model_path(recipe_.job), words);
    if (read >= words.size()) return;
    for (const auto& word : {recipe_.request.source(), recipe_.request.target()}) {
        const auto first = sentence.position_of(word);
        if (first < words.size() && first + language::words_of(word).size() > read)
            throw Error(
                ErrorCode::InvalidArgument,
                fmt::format("the model reads {} words of a sentence and stops before \"{}\"", read, word),
                "shorten the sentence, or move the word forward");
    }
    log::warning("the model reads {} words of the sentence: from \"{}\" on nothing counts", read,
                 words[read]);
}

namespace {

/// Words of a sentence that name or describe something: "beside" and "left of" say where, which is read from
/// the sentence and not by the model.
std::vector<std::string> telling_words(const language::Sentence& sentence) {
    std::vector<std::string> words;
    for (const auto& term : language::noun_terms(sentence.words(), {}))
        if (language::says_something(term))
            for (auto& word : language::words_of(term)) words.push_back(std::move(word));
    return words;
}

/// Words that the model is told and must know, each once. `labelled`: the source is found without it.
std::vector<std::string> told_words(const edit::CheckedRequest& request, bool labelled) {
    if (request.is_rearranged()) return {};  // nothing is drawn, and what is looked for was checked
    auto words = telling_words(request.sentence().sentence());
    const auto of_source = language::words_of(request.source());
    if (!request.whole_scene()) words.insert(words.end(), of_source.begin(), of_source.end());
    // A part is told by its thing's shape, where it has no word.
    if (labelled || !request.part_of().empty())
        for (const auto& word : of_source) std::erase(words, word);
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    return words;
}

}  // namespace

void EditJob::begin(Scene scene, std::shared_ptr<neural::TextToImage> model, Segmenters segmenters,
                    std::shared_ptr<ViewServer> server, const GivenCameras& given) {
    context_ =
        std::make_unique<RunContext>(std::move(scene), std::move(model), recipe_.job, std::move(segmenters));
    context_->draw_with(std::move(server));
    const auto known = context_->model().known_words();
    if (context_->server() == nullptr)
        warn_unknown_words(told_words(recipe_.request, !hints_.label.empty() || !hints_.found.empty()),
                           edit::method_of(recipe_.request).draws_views()
                               ? language::promptable_vocabulary(
                                     known, edit::with_dyes(context_->model().generated_vocabulary(), known))
                               : known);
    views_ = std::make_shared<const Views>(choose_views(context_->scene(), recipe_, given));
    if (views_->automatic && !given.cameras.empty())
        log::info("{} stored views are too few to search from: an orbit around the scene is used",
                  given.cameras.size());
    located_ = std::make_shared<const Located>(Located{*views_, recipe_, {}, {}, false, {}});
    edited_ = std::make_shared<const Edited>();
}

std::string EditJob::model_prompt() const { return recipe_.request.sentence().prompt(); }

std::vector<Image> EditJob::instance_pictures() {
    const Views& chosen = *views_;
    std::vector<View> views = farthest_views(chosen.views, InstanceViews);
    if (chosen.automatic) {
        const int side = recipe_.request.image_size;
        const auto closer =
            orbit_views(nearer(chosen.orbit, NearInstance), static_cast<int>(views.size()), side, side);
        for (std::size_t i = 1; i < views.size(); i += 2) views[i] = closer[i];
    }
    std::vector<Image> pictures;
    for (const auto& view : views)
        pictures.push_back(context_->painter().paint(drawn().spans(), view.camera, render_settings()).colour);
    return pictures;
}

void EditJob::tune() {
    times_.begin("dreambooth");
    auto tuned = model().tune(recipe_.dreambooth, instance_pictures(),
                              language::instance_prompt(recipe_.request.sentence()),
                              language::without_identifier(model_prompt()), control_);
    context_->take_model(std::move(tuned.model));
    tuning_ = std::move(tuned.report);
    times_.end();
    log::info(
        "{} {:.0f} s: loss on the scene {:.3f} to {:.3f}, on what the model knew {:.3f} to {:.3f}",
        times_.networks("dreambooth").flop > 0 ? "tuned in" : "the tuning was read from the cache; it took",
        tuning_->seconds, tuning_->instance_before, tuning_->instance_after, tuning_->prior_before,
        tuning_->prior_after);
}

std::optional<neural::TunedModel> EditJob::tuned() const {
    return tuning_ ? std::optional(neural::TunedModel{context_->shared_model(), *tuning_}) : std::nullopt;
}

/// Puts a new search in place of the old one, with the settings it was made for.
void EditJob::take(Located located) {
    recipe_ = located.recipe;
    views_ = std::make_shared<const Views>(located.views);
    located_ = std::make_shared<const Located>(std::move(located));
    plan_.reset();
}

language::plan::SceneWords EditJob::words_shown(language::plan::SceneWords assumed) {
    context_->ask_anew(recipe_.attention);
    return scene_words_shown(*context_, recipe_, *views_, std::move(assumed), control_);
}

std::vector<std::uint8_t> EditJob::source_in_result() const {
    const auto mode = located().mode;
    if (edited_ == nullptr || mode == edit::EditMode::Replace || mode == edit::EditMode::Remove) return {};
    const auto& after = result();
    if (mode == edit::EditMode::Modify) return after.label;  // with rows that came while it ran
    std::vector<std::uint8_t> source(after.set.size(), 0);
    const auto& before = *located().source_label.bits;
    for (std::size_t row = 0; row < before.size(); ++row)
        if (before[row] != 0 && after.base_to_new[row] >= 0)
            source[static_cast<std::size_t>(after.base_to_new[row])] = 1;
    return source;
}

/// Takes the flat that things stand on for a ground that no word finds, or none that another witness bears
/// out (METHOD.md, Things from a click). Returns false where the words are to tell.
bool EditJob::take_scene_ground(const Located* found) {
    const auto& source = recipe_.request.source();
    if (!hints_.label.empty() || !hints_.found.empty() || hints_.by_differences ||
        recipe_.request.whole_scene() || !recipe_.request.part_of().empty() ||
        !language::names_scene_ground(source))
        return false;
    auto& encoder = context_->recognition();
    if (found != nullptr &&
        (encoder.available() ? edit::encoder_knows(finding_of(*context_, *found), encoder) : found->found()))
        return false;
    auto rows = scene_ground(context_->drawn(), views_->orbit.up, control_);
    const bool any = std::find(rows.begin(), rows.end(), std::uint8_t{1}) != rows.end();
    if (found == nullptr && !any)
        throw Error(ErrorCode::NotFound,
                    fmt::format("no ground is told by the scene's shape for \"{}\"", source),
                    "label it by hand: --at X,Y clicks on it, --cut-out puts a box around it");
    const auto* other = found != nullptr && found->found() ? found->result.source_label.bits.get() : nullptr;
    const double alike = other != nullptr ? evaluate::row_overlap(rows, *other).iou : SameGround;
    if (!any || alike < SameGround || alike > BorneOut) return false;
    hints_.label = std::move(rows);
    hints_.label_alone = true;
    hints_.label_doubt =
        "the flat that things stand on is taken for it, since no picture says so surely; look at "
        "the label, and correct it where it is wrong";
    log::warning("\"{}\": {}", source, hints_.label_doubt);
    return true;
}

bool EditJob::knows_source() const {
    return language::vocabulary_contains(context_->model().known_words(), recipe_.request.source());
}

void EditJob::locate() {
    if (recipe_.use_dreambooth && !tuning_ && !recipe_.request.is_rearranged()) tune();
    times_.begin("locate");
    if (!context_->model().known_words().empty() && !knows_source()) take_scene_ground(nullptr);
    auto found = pipeline::locate(*context_, recipe_, *views_, hints_, control_);
    if (take_scene_ground(&found)) found = pipeline::locate(*context_, recipe_, *views_, hints_, control_);
    if (!found.found() && server_searches_ && context_->server() != nullptr && !found.by_differences &&
        found.result.mode != edit::EditMode::Add)
        found.result.remedy += ", or let the server look for it (--server-search differences)";
    take(std::move(found));
    plan();
    times_.end();
    const auto& result = located();
    const auto labelled = std::count(result.label.bits->begin(), result.label.bits->end(), std::uint8_t{1});
    log::info("mode {} ({}); {} of {} splats labelled, {} new", edit::mode_name(result.mode), result.reason,
              labelled, scene().gaussians.size(), result.seeds.size());
    if (const auto use = times_.networks("locate"); use.cached > 0)
        log::info("located with {}", use_text(use));
}

/// Locates again from the views chosen already. The networks are asked only about pictures they have not
/// seen.
void EditJob::relocate(const CheckedRecipe& recipe) {
    times_.begin("locate");
    take(pipeline::locate_again(*context_, *located_, recipe, control_));
    times_.end();
}

double EditJob::attention_threshold() const {
    const double asked = recipe_.request.attention_threshold;
    return asked > 0 ? asked : context_->stated_threshold();
}

void EditJob::locate_again(double attention_threshold, const std::string& excluded_views) {
    CheckedRecipe recipe = recipe_;
    recipe.request.excluded_views = excluded_views;
    recipe.request.attention_threshold = attention_threshold;
    relocate(recipe);
}

void EditJob::locate_anyway() {
    CheckedRecipe recipe = recipe_;
    recipe.request.least_confidence = 0;
    relocate(recipe);
}

void EditJob::correct_label(const std::vector<std::uint8_t>& bits) {
    GSE_CHECK_EQ(bits.size(), scene().gaussians.size());
    Located corrected = with_label(*located_, bits);
    corrected.recipe = recipe_;
    take(std::move(corrected));
}

void EditJob::use_label(const std::vector<std::uint8_t>& bits) {
    GSE_CHECK_EQ(bits.size(), scene().gaussians.size());
    times_.begin("locate");
    take(locate_by_label(*context_, *located_, bits, control_));
    times_.end();
}

void EditJob::take_settings(const CheckedRecipe& recipe, bool relabels) {
    const edit::LoopSettings& loop = recipe.request;
    const edit::LabelThresholds before = recipe_.request, &after = recipe.request;
    static_cast<edit::LoopSettings&>(recipe_.request) = loop;
    static_cast<edit::RearrangeSettings&>(recipe_.request) = recipe.request;
    recipe_.request.label_threshold = after.label_threshold;
    recipe_.guidance = recipe.guidance;
    plan_.reset();  // how far masks are grown, and whether the label counts at all
    if (before.attention_threshold != after.attention_threshold ||
        before.excluded_views != after.excluded_views ||
        (relabels && before.label_threshold != after.label_threshold))
        locate_again(after.attention_threshold, after.excluded_views);
}

const edit::EditPlan& EditJob::plan() {
    if (!plan_) plan_ = plan_of(*context_, *located_, recipe_);
    return *plan_;
}

const std::vector<Mask>& EditJob::changed_masks() {
    return edited_->touched.empty() ? plan().masks : edited_->touched;
}

/// Orbit that frames a thing where it stood and where it stands.
OrbitParameters EditJob::moved_orbit() const {
    auto now = result().label;
    for (std::size_t row = 0; row < now.size(); ++row)
        if (result().hole_fill[row] != 0) now[row] = 0;
    const auto from = localize::focus_orbit(drawn(), *located().label.bits, views_->orbit);
    OrbitParameters orbit = localize::focus_orbit(drawn_result(), now, views_->orbit);
    const double apart = length(orbit.centre - from.centre);
    orbit.centre = (orbit.centre + from.centre) * 0.5;
    orbit.radius = std::max(orbit.radius, from.radius) + apart / 2 / std::tan(orbit.fov_x / 2);
    return orbit;
}

OrbitParameters EditJob::film_orbit() const {
    if (located().mode == edit::EditMode::Remove)  // what filled the hole may be seen from nowhere
        return localize::focus_orbit(drawn(), *located().label.bits, views_->orbit);
    if (located().mode == edit::EditMode::Transform) return moved_orbit();
    // What was changed or added, and what it belongs to, with room around.
    std::vector<std::uint8_t> bits = result().label;
    const auto& source = located().source_label.bits;
    if (source)
        for (std::size_t row = 0; row < source->size(); ++row)
            if ((*source)[row] != 0 && result().base_to_new[row] >= 0)
                bits[static_cast<std::size_t>(result().base_to_new[row])] = 1;
    constexpr double Around = 1.3, FromViews = 1.25;  // of the radius
    OrbitParameters orbit = localize::focus_orbit(drawn_result(), bits, views_->orbit);
    double most = FromViews * views_->orbit.radius;       // a stray row is not worth stepping back for
    if (source && located().mode == edit::EditMode::Add)  // the views may have been about its head only
        most = std::max(most, Around * localize::focus_orbit(drawn(), *source, views_->orbit).radius);
    orbit.radius = std::min(Around * orbit.radius, most);
    return orbit;
}

double EditJob::film_front() const {
    return views_->front_read ? *views_->front_read : parse_front(recipe_.job.front).value_or(0);
}

void EditJob::run(const EditObserver& observer) {
    times_.begin("edit");
    const double start = wall_seconds();
    Edited edited = edit_scene(*context_, *located_, plan(), recipe_, observer, control_);
    edited.seconds = wall_seconds() - start;
    edited_ = std::make_shared<const Edited>(std::move(edited));
    times_.end();
    log::info("edited in {:.1f} s ({} steps): {}; with what came before it {}", edited_->seconds,
              result().history.size(), use_text(edited_->use), use_text(times_.networks()));
}

Edited EditJob::probe(const ProbeSize& size) {
    const log::Quiet nothing_said;  // of how well a few steps did: they only tell what a step takes
    CheckedRecipe plain = recipe_;
    plain.request.iterations = plain.request.fit_steps = size.steps;
    plain.request.dynamic_mask = plain.request.prune_added = plain.request.early_stop = false;
    plain.request.densify_every = 0;
    plain.request.rounds = plain.request.shape_rounds = plain.request.add_rounds = size.early ? 2 : 1;
    plain.request.shape_fit_steps = size.steps;
    plain.request.edited_views = plain.request.shape_views = size.edited_views;
    plain.request.view_steps = plain.request.restyle_steps = plain.request.shape_steps = size.view_steps;
    JobControl quiet;
    std::stop_source redrawn;
    const std::stop_callback stopped(control_.stop, [&] { redrawn.request_stop(); });
    quiet.stop = redrawn.get_token();
    EditObserver observer;
    if (size.early) observer.targets = [&](const edit::ViewTargets&) { redrawn.request_stop(); };
    const ProbeScene part = probe_scene(scene().gaussians, plan());
    const double start = wall_seconds();
    Edited edited = edit_scene(*context_, part.set, *located_, part.plan, plain, observer, quiet);
    edited.seconds = wall_seconds() - start;
    return edited;
}

}  // namespace gse::pipeline
