// Remembers renders and answers.
#include "engine/pipeline/run/run_context.h"
#include "engine/pipeline/models/model_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/error.h"
#include "engine/base/log.h"
#include "engine/edit/interfaces/stage_timer.h"
#include "engine/edit/request/decide_mode.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/language/vocabulary.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/scene/scene_loading.h"
#include "engine/remote/views/view_frame.h"

namespace gse::pipeline {
namespace {

/// Adds up what a guidance takes.
class MeteredViews final : public edit::MultiViewEditor {
public:
    MeteredViews(std::unique_ptr<edit::MultiViewEditor> views, PlaceCost& cost)
        : views_(std::move(views)), cost_(cost) {}

    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override {
        const auto before = network_use();
        const edit::StageTimer timer(cost_.seconds);
        auto targets = views_->edit(views, input, job);
        cost_.views += views.size();
        cost_.use += network_use() - before;
        return targets;
    }

private:
    std::unique_ptr<edit::MultiViewEditor> views_;
    PlaceCost& cost_;
};

/// Shows a server the unedited scene at the server's size.
class UneditedAtServer final : public edit::MultiViewEditor {
public:
    UneditedAtServer(std::unique_ptr<edit::MultiViewEditor> editor, int side, Painter& painter,
                     const GaussianSet& set, const raster::Settings& settings)
        : editor_(std::move(editor)), side_(side), painter_(painter), set_(set), settings_(settings) {}

    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& request,
                           const JobControl& job) override {
        auto larger = views;
        for (auto& view : larger) {
            view.view.camera = view.view.camera.resized(side_, side_);
            view.rendered = painter_.paint(set_.spans(), view.view.camera, settings_).colour;
            for (auto& value : view.rendered.data) value = std::clamp(value, 0.0f, 1.0f);
            view.original = view.clean_plate.picture = view.rendered;
            view.mask = remote::at_side(view.mask, side_);
        }
        auto drawn = editor_->edit(larger, request, job);
        for (auto* pictures : {&drawn.images, &drawn.outlines})
            for (std::size_t v = 0; v < pictures->size(); ++v)
                (*pictures)[v] = remote::at_side((*pictures)[v], views[v].rendered.width);
        return drawn;
    }

private:
    std::unique_ptr<edit::MultiViewEditor> editor_;
    const int side_;
    Painter& painter_;
    const GaussianSet& set_;
    const raster::Settings settings_;
};

}  // namespace

RunContext::RunContext(Scene scene, std::shared_ptr<neural::TextToImage> model, const JobParameters& job,
                       Segmenters segmenters)
    : scene_(std::move(scene)), traits_(traits_of(job)), model_(std::move(model)),
      painter_(0, job.rasterizer), segmenters_(std::move(segmenters)) {
    if (!segmenters_.clicks) segmenters_.clicks = edit::make_default_segmenter();
    const auto statistics = compute_statistics(scene_.gaussians);
    if (statistics.visible_rows == 0)
        throw Error(ErrorCode::InvalidArgument, "the scene has no splat that can be seen",
                    "open another scene", job.scene);
    drawn_ = drawable(scene_.gaussians);
    unusable_ = statistics.nan_rows + statistics.infinite_rows;
    if (unusable_ > 0)
        log::warning(
            "{} of {} splats hold values that cannot be drawn ({} NaN, {} infinite or absurd); they stay as "
            "they are "
            "and count nowhere",
            unusable_, statistics.count, statistics.nan_rows, statistics.infinite_rows);
    if (const auto note = surroundings_note(statistics); !note.empty()) log::info("{}", note);
    scene_.info.up = parse_up(job.up, scene_.info);
}

void RunContext::take_model(std::shared_ptr<neural::TextToImage> model) {
    model_ = std::move(model);
    attention_ = nullptr;
    recognition_ = nullptr;
    differences_ = nullptr;
}

void RunContext::ask_anew(const neural::AttentionParameters& attention) {
    attention_ = std::make_unique<edit::CachedAttention>(model_->attention(attention));
    recognition_ =
        std::make_unique<edit::VocabularyRanker>(model_->image_text_encoder(), model_->known_words());
    differences_ = nullptr;
    renders_.asked_again.clear();
    renders_.drawn.clear();
    place_cost_ = {};
}

void RunContext::ask_server(const CheckedRecipe& recipe, const JobControl& control) {
    GSE_CHECK(server_ != nullptr);
    const auto mode = edit::decide_mode(recipe.request, std::nullopt).first;
    const bool paints = remote::server_search_of(recipe.server.search) == remote::ServerSearch::Paint;
    differences_ = std::make_unique<edit::CachedAttention>(
        server_->differences(recipe.request, mode, recipe.guidance.negative_prompt, paints, control));
}

std::unique_ptr<edit::MultiViewEditor> RunContext::place_drawing(const CheckedRecipe& recipe) {
    const auto& sentence = recipe.request.sentence();
    const auto known = language::promptable_vocabulary(model_->known_words(), model_->generated_vocabulary());
    if (server_ && !language::vocabulary_contains(known, sentence.target()))
        return std::make_unique<UneditedAtServer>(
            server_->editor(recipe.request, edit::EditMode::Add, recipe.guidance.negative_prompt),
            server_->side(), painter_, drawn_, render_settings(scene_, recipe.request));
    if (!model_->supports_scene_conditioning()) return nullptr;
    auto views = model_->views(sentence.prompt(), neural::SdsParameters{});
    return views ? std::make_unique<MeteredViews>(std::move(views), place_cost_) : nullptr;
}

void RunContext::ask(const neural::AttentionParameters& attention) {
    if (attention_ == nullptr) ask_anew(attention);
}

void RunContext::look_for_ground(const std::vector<View>& views) {
    if (looked_for_ground_ || !model_->supports_scene_conditioning()) return;
    looked_for_ground_ = true;
    ground_ = edit::ground_below({}, drawn_, views, scene_.info.up, painter_.rasterizer(), traits_);
    if (ground_) log::info("the scene has hardly any ground: the model is shown it on a plain one");
}

std::optional<edit::StudioBackground> RunContext::ground(const std::string& sentence) const {
    if (!ground_ || !model_->supports_scene_conditioning()) return std::nullopt;
    return edit::plain_ground(sentence, ground_->standing, scene_.info.up, traits_);
}

edit::LocateTools RunContext::tools(const Views& views, const std::optional<edit::StudioBackground>& ground,
                                    const JobControl& control) {
    auto job = control;
    if (differences_ && control.progress)
        job.progress = [control, host = server_->nickname()](std::string_view stage, int step, int total) {
            control.report(fmt::format("{} at {}", stage, host), step, total);
        };
    const std::string key = ground ? fmt::format("{} on {}", views.key, ground->ground) : views.key;
    if (renders_key_ != key) renders_ = {};
    renders_key_ = key;
    edit::AttentionSource& attention = differences_ ? *differences_ : *attention_;
    edit::LocateTools tools{painter_.rasterizer(), attention, segmenters_.clicks.get(),
                            segmenters_.words.get(), job};
    tools.cache = &renders_;
    tools.threads = &threads_;
    tools.recognition = differences_ ? nullptr : recognition_.get();  // it may not know the word
    if (watch_)
        tools.seen = [watch = watch_, list = &views.views](std::size_t view,
                                                           const edit::ViewEvidence& evidence) {
            watch((*list)[view], view, list->size(), evidence);
        };
    return tools;
}

std::vector<Image> RunContext::pictures(const std::vector<View>& views, const raster::Settings& settings,
                                        const std::optional<edit::StudioBackground>& ground,
                                        const JobControl& control) {
    std::vector<Image> pictures;
    for (const auto& view : views) {
        if (control.stop_requested()) throw Error(ErrorCode::Cancelled, "the search was stopped");
        const auto& painted = painter_.paint(drawn_.spans(), view.camera, settings);
        pictures.push_back(ground ? edit::before_plain(*ground, view.camera, painted.colour, painted.alpha,
                                                       settings.background)
                                  : painted.colour);
        for (auto& value : pictures.back().data) value = std::clamp(value, 0.0f, 1.0f);
    }
    return pictures;
}

}  // namespace gse::pipeline
