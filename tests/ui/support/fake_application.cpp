// An application that only remembers what it was asked for, with a small real scene behind its view model.
#include "tests/ui/support/fake_application.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/random.h"
#include "engine/base/thread_pool.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/raster/rasterizer.h"
#include "engine/scene/framing.h"
#include "engine/scene/viewpoints.h"

namespace gse::test {

/// The engine's rasterizer on one thread.
struct FakeApplication::Renderer {
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);
    raster::ForwardOutput output;
    Image values;

    const raster::ForwardOutput& draw(const GaussianSet& set, const Camera& camera) {
        raster::Settings settings;
        settings.background = {0.114f, 0.122f, 0.141f};
        rasterizer->forward(set.spans(), camera, settings, output);
        return output;
    }
    const Image& draw_values(const GaussianSet& set, const Camera& camera, std::span<const float> of) {
        rasterizer->forward_values(set.spans(), camera, {}, of, values);
        return values;
    }
};

namespace {

constexpr int ViewCount = 24, ViewSide = 96;

synth::SynthScene make_synth() {
    synth::SceneSpec spec;
    spec.object = "bear";
    spec.material = "red";
    spec.accessory = "hat";
    spec.seed = 3;
    spec.gaussian_budget = 6000;
    return synth::generate(spec);
}

/// Blue over green to yellow, as attention is usually shown.
std::array<float, 3> false_colour(float v) {
    return {std::clamp(1.8f * v - 0.5f, 0.0f, 1.0f), std::clamp(1.4f * v, 0.0f, 1.0f) * 0.9f,
            std::clamp(0.55f + 0.6f * v - 1.6f * v * v, 0.05f, 0.8f)};
}

Image coloured_map(const Image& render, const Image& map) {
    Image result(render.width, render.height, 3);
    for (int y = 0; y < render.height; ++y)
        for (int x = 0; x < render.width; ++x) {
            const auto colour = false_colour(map.at(x, y, 0));
            for (int c = 0; c < 3; ++c)
                result.at(x, y, c) = 0.35f * render.at(x, y, c) + 0.65f * colour[static_cast<std::size_t>(c)];
        }
    return result;
}

Image masked(const Image& render, const Image& values) {
    Image result = render;
    for (int y = 0; y < render.height; ++y)
        for (int x = 0; x < render.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const bool inside = values.at(x, y, 0) > 0.5f;
                result.at(x, y, c) =
                    inside ? render.at(x, y, c) * 0.5f + (c == 1 ? 0.4f : 0.1f) : render.at(x, y, c) * 0.4f;
            }
    return result;
}

}  // namespace

ui::RecoveryView recovery_of(const std::string& scene) {
    auto picture = std::make_shared<Image>(160, 120, 3, 0.3f);
    for (std::size_t i = 0; i < picture->pixel_count(); ++i)
        picture->data[i * 3 + 1] =
            0.3f + 0.4f * static_cast<float>(i) / static_cast<float>(picture->pixel_count());
    return {"/home/mira/.local/state/gseditpro/autosave/" + scene + ".gsep",
            scene + ".ply",
            "/home/mira/scenes/" + scene + ".ply",
            "today 14:02, 6 000 splats, 2 edits",
            "\"a bear wearing a red hat\" was being edited, iteration 412",
            picture,
            true};
}

FakeApplication::FakeApplication(Situation situation)
    : document_(std::make_unique<Document>()), renderer_(std::make_unique<Renderer>()) {
    model_.recent = {"/home/mira/scenes/garden.ply", "/home/mira/scenes/b\xC3\xA4r im Wald.gsep",
                     "/home/mira/scenes/kitchen.spz"};
    make_rest();
    if (situation == Situation::Nothing) {
        model_.recoverable = {recovery_of("garden")};
        return;
    }
    make_scene();
    if (situation != Situation::Scene) make_attention();
    if (situation == Situation::Editing) make_work(true);
    if (situation == Situation::ResultWaiting) make_work(false);
    if (situation != Situation::Scene) {
        model_.search.number = 1;
        model_.search.confidence = {
            0.74,
            {{"agreement", 0.81, "the views agree to {}", "The views agree to {}."},
             {"attention_inside", 0.68, "{} of the attention is inside", "{} of the attention is inside."}}};
        model_.search.front = 345;
    }
    if (situation == Situation::Failed) {
        model_.search.confidence.value = 0.21;
        model_.search.problem = edit::SearchProblem::Unsure;
        model_.search.message =
            "it is not sure that \"car\" was found (confidence 0.21, at least 0.35 is needed)";
        model_.search.remedy = "name something the scene shows, look at what was found, or label it by hand";
        model_.attention[1].failed = true;
        model_.attention[1].step = edit::ViewStep::TooLittle;
        model_.job.title = "Edit: a bear wearing a red hat";
        model_.job.error =
            "The word \"hta\" was found in none of the views; check its spelling, or click another word of "
            "the sentence.";
        model_.toasts.push_back({model_.job.error, true, 2, {}});
    }
}

FakeApplication::~FakeApplication() = default;

void FakeApplication::make_scene() {
    const auto synth = make_synth();
    model_.statistics = compute_statistics(synth.scene.gaussians);
    model_.framing = framing_bounds(synth.scene.gaussians);
    std::vector<std::uint8_t> standing(synth.parts.size());
    std::transform(synth.parts.begin(), synth.parts.end(), standing.begin(),
                   [](synth::Part part) { return part == synth::Part::Ground ? 0 : 1; });
    model_.home = framing_bounds(synth.scene.gaussians, standing);
    model_.statistics.invisible_rows = 12;
    model_.orbit = fit_orbit(model_.statistics, synth.scene.info.up);
    auto views = orbit_views(model_.orbit, ViewCount, ViewSide, ViewSide);
    auto state = initial_state(synth.scene, std::move(views));
    std::vector<float> weight(synth.parts.size());
    Random random(1);
    for (std::size_t row = 0; row < weight.size(); ++row) {
        const bool object = synth.parts[row] == synth::Part::Object;
        weight[row] = static_cast<float>(object ? 1 - 0.35 * std::pow(random.uniform(), 2)
                                                : 0.25 * std::pow(random.uniform(), 3));
    }
    NamedLabel label;
    label.name = "bear";
    label.weight = std::make_shared<const std::vector<float>>(std::move(weight));
    NamedLabel empty;
    empty.name = "hat";
    empty.bits = std::make_shared<const std::vector<std::uint8_t>>(synth.parts.size(), std::uint8_t{0});
    state.labels = {with_bits(label), empty};
    state.active_label = 0;
    *document_ = Document(state);
    EditNode node;
    node.id = 7;
    node.name = "a red bear on the grass";
    node.recipe = "{}";
    node.seconds = 61;
    node.psnr_outside_db = 61.3;
    node.delta = std::make_shared<const SceneDelta>();
    node.thumbnail =
        std::make_shared<const Image>(renderer_->draw(state.current, state.views[0].camera).colour);
    state.stack.push_back(node);
    document_->apply("Edit: a red bear on the grass", state);
    document_->apply("Grow the label", state);
    document_->apply("Brush", state);
    document_->undo();
    model_.document = document_.get();
    model_.scene_path = "/home/mira/scenes/bear/scene.ply";
    model_.project_path = "/home/mira/scenes/bear.gsep";
    model_.unsaved = true;
    model_.saved_at = "saved 14:02 (autosave on)";
    model_.labelled =
        static_cast<std::size_t>(std::count(state.labels[0].bits->begin(), state.labels[0].bits->end(), 1));
    model_.camera = orbit_camera(model_.orbit, 0.5, 640, 480);
    model_.frames_per_second = 60;
    model_.render_ms = 6.2;
    model_.renderer = "native AVX-512";
    model_.cannot_edit.clear();
}

void FakeApplication::make_attention() {
    const auto& state = document_->state();
    const auto& bits = *state.labels[0].bits;
    std::vector<float> values(bits.begin(), bits.end());
    Random random(5);
    for (std::size_t index = 0; index < state.views.size(); ++index) {
        const auto& view = state.views[index];
        ui::AttentionView shown;
        shown.name = view.name.empty() ? fmt::format("view {:02}", index) : view.name;
        shown.camera = view.camera;
        const Image render = renderer_->draw(state.current, view.camera).colour;
        const Image& object = renderer_->draw_values(state.current, view.camera, values);
        Image map(render.width, render.height, 1);
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x) {
                const float dx = static_cast<float>(x - map.width / 2) / 30,
                            dy = static_cast<float>(y - map.height / 2) / 30;
                map.at(x, y, 0) =
                    std::clamp((0.15f + 0.85f * object.at(x, y, 0)) * std::exp(-(dx * dx + dy * dy)) +
                                   0.05f * static_cast<float>(random.uniform()),
                               0.0f, 1.0f);
            }
        shown.render = std::make_shared<const Image>(render);
        shown.map_coloured = std::make_shared<const Image>(coloured_map(render, map));
        shown.mask_picture = std::make_shared<const Image>(masked(render, object));
        Mask mask(render.width, render.height);
        for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = object.data[i] > 0.5f ? 1 : 0;
        shown.mask = std::make_shared<const Mask>(std::move(mask));
        shown.map = std::make_shared<const Image>(std::move(map));
        for (int point = 0; point < 4; ++point)
            shown.points.push_back({38.0 + 7 * point, 44.0 + 5 * (point % 2), true});
        for (int point = 0; point < 3; ++point) shown.points.push_back({12.0 + 32 * point, 82.0, false});
        shown.branch = index % 5 == 3 ? "attention" : "points";
        shown.captured = index % 5 == 3 ? 0.46 : 0.83;
        shown.failed = index == 10;
        model_.attention.push_back(std::move(shown));
    }
    model_.attention_word = "bear";
    model_.attention_mode = "modify: the scene shows a bear";
    model_.attention_threshold = 0.35;
    model_.job.title = "Locate";
    model_.job.outcome = "done in 8.4 s";
}

void FakeApplication::make_work(bool running) {
    Random random(9);
    for (int iteration = 0; iteration < (running ? 212 : 400); ++iteration) {
        const auto fall = static_cast<float>(std::exp(-iteration / 120.0));
        model_.losses.push_back(
            {iteration, 0.02f + 0.05f * fall + 0.004f * static_cast<float>(random.uniform()),
             0.003f * (1 - fall), 0.4f + 0.6f * fall + 0.2f * static_cast<float>(random.uniform()),
             1.5f * fall + 0.4f * static_cast<float>(random.uniform()), 0.3f + 0.1f * fall});
        if (iteration % 20 == 0)
            model_.snapshots.push_back({iteration, 6000u + static_cast<std::size_t>(iteration) * 3});
    }
    for (int view = 0; view < 4; ++view) {
        auto picture = std::make_shared<Image>(64, 64, 3);
        for (std::size_t i = 0; i < picture->data.size(); ++i)
            picture->data[i] =
                static_cast<float>(random.uniform(0.2, 0.3) + 0.15 * view * static_cast<double>(i % 3));
        model_.gate.pictures.push_back(picture);
    }
    model_.gate.verdict = "The model shows the edit in 4 of 4 views.";
    model_.cost = {144, 16, 16, 0.167};
    make_targets();
    model_.job = {};
    model_.job.title = "Edit: a bear wearing a red hat";
    if (running) {
        model_.job.running = model_.job.can_pause = model_.edit_running = true;
        model_.job.stage = "edit";
        model_.job.step = 212;
        model_.job.total = 400;
        model_.job.seconds = 33;
        model_.job.eta_seconds = 29;
        model_.file_job.running = true;
        model_.file_job.title = "Turntable turn.mp4";
        model_.file_job.stage = "frames";
        model_.file_job.step = 31;
        model_.file_job.total = 120;
        model_.file_job.eta_seconds = 40;
        return;
    }
    model_.job.outcome = "done in 61 s";
    model_.result_waiting = true;
    model_.result_splats = 8550;
    model_.result_seconds = 41;
}

/// Two rounds of eight views in blue; one of the last is dropped, one redrawn.
void FakeApplication::make_targets() {
    for (int round = 0; round < 2; ++round) {
        ui::TargetRound shown{round, 2, {}};
        for (std::size_t i = 0; i < 8; ++i) {
            const auto& view = model_.attention[3 * i];
            auto after = std::make_shared<Image>(*view.render);
            for (std::size_t at = 0; at < after->pixel_count(); ++at)
                if (view.map->data[at] > 0.2f) std::swap(after->data[at * 3], after->data[at * 3 + 2]);
            shown.targets.push_back({3 * i, view.name, view.render, after, view.camera});
        }
        model_.target_rounds.push_back(std::move(shown));
    }
    model_.target_rounds.back().targets[2].dropped = true;
    model_.target_rounds.back().targets[5].attempt = 1;
}

void FakeApplication::make_rest() {
    model_.cannot_edit = "";
    model_.request.source = "bear";
    model_.request.prompt = "a bear wearing a red hta";
    model_.request.target = "";
    for (const char* word : {"a", "bear", "wearing", "red", "hat", "blue", "golden", "statue", "on", "the",
                             "grass", "dog", "made", "of", "stone"})
        model_.known_words.emplace_back(word);
    model_.words_known = true;
    model_.estimate = {62, 0.42, 850, 14200};
    model_.models = {
        {"starter", "/usr/share/gseditpro/models/starter", "starter, 64 px", "", 48u << 20, true, "", true},
        {"stable-diffusion-v1-5", "/home/mira/ComfyUI/models/checkpoints/v1-5-pruned-emaonly.safetensors",
         "Stable Diffusion 1.x", "predicts noise", 4270000000u, true,
         "Slow without a graphics card: about 40 min for an edit.", false},
        {"sd_xl_base", "/home/mira/ComfyUI/models/checkpoints/sd_xl_base_1.0.safetensors",
         "Stable Diffusion XL", "", 6900000000u, false,
         "SDXL is not supported; use a Stable Diffusion 1.x or 2.x model.", false}};
    using log::Level;
    log_ = {
        {Level::Info, "14:01:12", "opened /home/mira/scenes/bear/scene.ply: 6 000 splats in 0.04 s"},
        {Level::Warning, "14:01:12", "the file does not state an up axis; -y is taken, as in COLMAP worlds"},
        {Level::Info, "14:02:07", "autosaved to /home/mira/scenes/.bear.gsep.autosave"},
        {Level::Error, "14:03:20", "could not write /mnt/full/turn.mp4: no space is left on the device"},
        {Level::Debug, "14:03:21", "preview: 6000 splats, 3412 pairs"}};
    model_.log = log_;
    model_.toasts = {{"Up axis guessed from 24 cameras", false, 1, "Flip"}};
    model_.camera_keys = {{0, {}}, {1, {}}};
}

void FakeApplication::refresh(bool pictures) {
    if (!pictures || document_->empty()) return;
    const Camera camera = model_.viewport_width > 0
                              ? model_.camera.resized(model_.viewport_width, model_.viewport_height)
                              : model_.camera;
    if (viewport_picture_ != nullptr && camera.width == rendered_.width &&
        camera.height == rendered_.height && camera.rotation == rendered_.rotation &&
        camera.translation == rendered_.translation)
        return;
    const auto& output = renderer_->draw(document_->state().current, camera);
    auto depth = std::make_shared<Image>(output.depth);
    for (std::size_t at = 0; at < depth->data.size(); ++at)
        depth->data[at] = output.alpha.data[at] > 0.5f ? depth->data[at] / output.alpha.data[at] : 0.0f;
    Image picture = output.colour;
    const auto& bits = *document_->state().labels[0].bits;
    const std::vector<float> values(bits.begin(), bits.end());
    const Image& tint = renderer_->draw_values(document_->state().current, camera, values);
    for (std::size_t at = 0; at < picture.pixel_count(); ++at)
        for (std::size_t c = 0; c < 3; ++c)
            picture.data[at * 3 + c] += 0.35f * tint.data[at] *
                                        ((c == 2   ? 0.95f
                                          : c == 1 ? 0.6f
                                                   : 0.2f) -
                                         picture.data[at * 3 + c]);
    model_.viewport_depth = depth;
    viewport_picture_ = std::make_shared<const Image>(std::move(picture));
    model_.viewport = texture(viewport_picture_);
    model_.camera = rendered_ = camera;
}

const Image* FakeApplication::picture(std::uint64_t id) const {
    const auto found = textures_.find(id);
    return found == textures_.end() ? nullptr : found->second.get();
}

ui::TextureId FakeApplication::texture(const std::shared_ptr<const Image>& image) {
    if (image == nullptr) return 0;
    const auto found = ids_.find(image.get());
    if (found != ids_.end()) return found->second;
    textures_[next_id_] = image;
    ids_[image.get()] = next_id_;
    return next_id_++;
}

bool FakeApplication::asked(const std::string& start) const {
    return std::any_of(calls.begin(), calls.end(),
                       [&start](const std::string& call) { return call.starts_with(start); });
}

}  // namespace gse::test
