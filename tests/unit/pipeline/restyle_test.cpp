// Another look that hardly comes out as asked is drawn by the model itself, and the better of both is used.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/scene_io.h"
#include "engine/pipeline/edit_job.h"
#include "engine/pipeline/installed.h"
#include "engine/pipeline/neural_loader.h"
#include "tests/test_paths.h"

namespace {

using namespace gse;
using namespace gse::pipeline;

/// Gives the views back as they are.
class Idle final : public edit::ViewGuidance {
public:
    explicit Idle(bool restyles) : restyles_(restyles) {}
    edit::RoundTargets edit(const std::vector<edit::RoundView>& views, const edit::RoundInput&, const JobControl&) override {
        edit::RoundTargets targets;
        for (const auto& view : views) targets.images.push_back(view.rendered);
        return targets;
    }
    bool restyles() const override { return restyles_; }

private:
    bool restyles_;
};

/// The starter, but what it is shown the scene with draws nothing, and on demand it itself neither.
class Misled final : public neural::TextToImage {
public:
    Misled(std::shared_ptr<neural::TextToImage> model, bool both) : model_(std::move(model)), both_(both) {}
    std::unique_ptr<edit::AttentionSource> attention(const neural::AttentionParameters& parameters) const override { return model_->attention(parameters); }
    std::unique_ptr<edit::Guidance> guidance(const std::string& prompt, const neural::SdsParameters& parameters) const override { return model_->guidance(prompt, parameters); }
    std::unique_ptr<edit::ViewGuidance> views(const std::string& prompt, const neural::SdsParameters& parameters) const override {
        asked.push_back(parameters.restyle);
        if (parameters.restyle || both_) return std::make_unique<Idle>(parameters.restyle);
        return model_->views(prompt, parameters);
    }
    bool knows_scene() const override { return model_->knows_scene(); }
    bool restyles() const override { return true; }
    std::vector<std::string> known_words() const override { return model_->known_words(); }
    int image_size() const override { return model_->image_size(); }
    std::string name() const override { return model_->name(); }
    neural::BundleKind kind() const override { return model_->kind(); }
    Image sample(const neural::SampleRequest& request) const override { return model_->sample(request); }
    Image img2img(const Image& image, const neural::SampleRequest& request) const override { return model_->img2img(image, request); }
    std::unique_ptr<edit::TextImageScore> text_image_score() const override { return model_->text_image_score(); }
    neural::TunedModel tune(const neural::DreamBoothParameters& parameters, std::span<const Image> instance, const std::string& instance_prompt,
                            const std::string& class_prompt, const JobControl& job, AnswerMemory* memory) const override {
        return model_->tune(parameters, instance, instance_prompt, class_prompt, job, memory);
    }
    bool save_tuning(const std::filesystem::path& path, std::uint64_t most_bytes) const override { return model_->save_tuning(path, most_bytes); }
    std::shared_ptr<neural::TextToImage> load_tuning(const std::filesystem::path& path) const override { return model_->load_tuning(path); }
    void save_lora(const std::filesystem::path& path) const override { model_->save_lora(path); }
    std::shared_ptr<neural::TextToImage> load_lora(const std::filesystem::path& path, double strength) const override { return model_->load_lora(path, strength); }

    mutable std::vector<bool> asked;   // whether views were to be restyled, each time

private:
    std::shared_ptr<neural::TextToImage> model_;
    bool both_;
};

EditRecipe blue_bear() {
    EditRecipe recipe;
    recipe.job.front = "0";
    recipe.request.source = "bear";
    recipe.request.prompt = "a blue bear on the grass";
    recipe.request.target = "blue";
    recipe.request.views = 8;
    recipe.request.image_size = 64;
    recipe.request.edited_views = 4;
    recipe.request.fit_steps = 6;
    return recipe;
}

struct Outcome {
    GaussianSet set;
    std::vector<Verdict> judged;
    std::vector<bool> asked;
};

Outcome edited(const EditRecipe& recipe, bool both) {
    const auto model = std::make_shared<Misled>(load_recipe_model({}), both);
    EditJob job(recipe, EditJobInput{load_scene(assets_path() / "scenes/bear/scene.ply"), {}, model}, JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    model->asked.clear();   // by the search
    Outcome outcome;
    EditObserver observer;
    observer.judged = [&](const Verdict& verdict, const edit::ViewTargets&) { outcome.judged.push_back(verdict); };
    job.run(observer);
    DOCTEST_CHECK(job.result().changed_outside_label == 0);
    outcome.set = job.result().set;
    outcome.asked = model->asked;
    return outcome;
}

bool same(const GaussianSet& a, const GaussianSet& b) {
    return a.size() == b.size() && std::equal(a.sh().begin(), a.sh().end(), b.sh().begin()) && std::equal(a.position().begin(), a.position().end(), b.position().begin());
}

}  // namespace

DOCTEST_TEST_CASE("what restyles and hardly shows what was asked gives way to the model itself, before anything is fitted") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto found = edited(blue_bear(), false);
    DOCTEST_CHECK(found.asked == std::vector<bool>{true, false});
    DOCTEST_REQUIRE(found.judged.size() == 1);   // the artist sees the pictures that are used
    DOCTEST_CHECK_FALSE(found.judged[0].warns);
    auto itself = blue_bear();
    itself.guidance.restyle = false;
    const auto told = edited(itself, false);
    DOCTEST_CHECK(told.asked == std::vector<bool>{false});
    DOCTEST_CHECK(same(found.set, told.set));
}

DOCTEST_TEST_CASE("where the model itself does no better the first pictures are used, with their warning") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto found = edited(blue_bear(), true);
    DOCTEST_CHECK(found.asked.size() <= 3);
    DOCTEST_CHECK(found.asked.front());
    DOCTEST_REQUIRE(found.judged.size() == 1);
    DOCTEST_CHECK(found.judged[0].warns);
}
