// Edits that hardly come out are drawn in other ways before anything is fitted; the best of them is used.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/project/load_scene.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/run/edit_job.h"
#include "tests/test_paths.h"

namespace restyle_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

/// Gives the views back as they are.
class Idle final : public edit::MultiViewEditor {
public:
    explicit Idle(bool supports_appearance_editing) : restyles_(supports_appearance_editing) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest&,
                           const JobControl&) override {
        ++rounds;
        edit::EditedViews targets;
        for (const auto& view : views) targets.images.push_back(view.rendered);
        return targets;
    }
    bool supports_appearance_editing() const override { return restyles_; }
    static inline int rounds = 0;  // of all that were asked

private:
    bool restyles_;
};

/// The starter, but what it is shown the scene with draws nothing, and on demand it itself neither.
class Misled : public neural::TextToImage {
public:
    Misled(std::shared_ptr<neural::TextToImage> model, bool both) : model_(std::move(model)), both_(both) {}
    std::unique_ptr<edit::AttentionSource> attention(
        const neural::AttentionParameters& parameters) const override {
        return model_->attention(parameters);
    }
    std::unique_ptr<edit::Guidance> guidance(const std::string& prompt,
                                             const neural::SdsParameters& parameters) const override {
        return model_->guidance(prompt, parameters);
    }
    std::unique_ptr<edit::MultiViewEditor> views(const std::string& prompt,
                                                 const neural::SdsParameters& parameters) const override {
        asked.push_back(parameters.restyle);
        if (parameters.restyle || both_) return std::make_unique<Idle>(parameters.restyle);
        return model_->views(prompt, parameters);
    }
    bool supports_scene_conditioning() const override { return model_->supports_scene_conditioning(); }
    bool supports_appearance_editing() const override { return true; }
    std::vector<std::string> known_words() const override { return model_->known_words(); }
    std::vector<std::string> generated_vocabulary() const override { return model_->generated_vocabulary(); }
    int image_size() const override { return model_->image_size(); }
    std::string name() const override { return model_->name(); }
    neural::BundleKind kind() const override { return model_->kind(); }
    Image sample(const neural::SampleRequest& request) const override { return model_->sample(request); }
    Image img2img(const Image& image, const neural::SampleRequest& request) const override {
        return model_->img2img(image, request);
    }
    std::unique_ptr<edit::ImageTextEncoder> image_text_encoder() const override {
        return model_->image_text_encoder();
    }
    neural::TunedModel tune(const neural::DreamBoothParameters& parameters, std::span<const Image> instance,
                            const std::string& instance_prompt, const std::string& class_prompt,
                            const JobControl& job, AnswerCache* memory) const override {
        return model_->tune(parameters, instance, instance_prompt, class_prompt, job, memory);
    }
    bool save_tuning(const std::filesystem::path& path, std::uint64_t most_bytes) const override {
        return model_->save_tuning(path, most_bytes);
    }
    std::shared_ptr<neural::TextToImage> load_tuning(const std::filesystem::path& path) const override {
        return model_->load_tuning(path);
    }
    void save_lora(const std::filesystem::path& path) const override { model_->save_lora(path); }
    std::shared_ptr<neural::TextToImage> load_lora(const std::filesystem::path& path,
                                                   double strength) const override {
        return model_->load_lora(path, strength);
    }

    mutable std::vector<bool> asked;  // whether views were to be restyled, each time

protected:
    std::shared_ptr<neural::TextToImage> model_;
    bool both_;
};

/// Draws nothing into scenes, and what the starter does where there is none.
class Shy final : public edit::MultiViewEditor {
public:
    explicit Shy(std::unique_ptr<edit::MultiViewEditor> guidance) : guidance_(std::move(guidance)) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest& input,
                           const JobControl& job) override {
        const auto& first = views.front();
        if (first.rendered.data == first.clean_plate.picture.data) return guidance_->edit(views, input, job);
        edit::EditedViews targets;
        for (const auto& view : views) {
            targets.images.push_back(draws_lumps ? view.rendered : view.clean_plate.picture);
            if (draws_lumps)
                for (std::size_t i = 0; i + 2 < targets.images.back().data.size(); i += 3)
                    std::swap(targets.images.back().data[i], targets.images.back().data[i + 2]);
            targets.outlines.emplace_back(view.mask.width, view.mask.height, 1);
            if (draws_outlines)
                std::copy(view.mask.data.begin(), view.mask.data.end(), targets.outlines.back().data.begin());
        }
        return targets;
    }
    bool supports_appearance_editing() const override { return guidance_->supports_appearance_editing(); }
    bool draws_outlines = true, draws_lumps = false;  // what was there, red for blue

private:
    std::unique_ptr<edit::MultiViewEditor> guidance_;
};

class ShyModel final : public Misled {
public:
    ShyModel(std::shared_ptr<neural::TextToImage> model, bool draws_outlines, bool draws_lumps = false)
        : Misled(std::move(model), false), draws_outlines_(draws_outlines), draws_lumps_(draws_lumps) {}
    std::unique_ptr<edit::MultiViewEditor> views(const std::string& prompt,
                                                 const neural::SdsParameters& parameters) const override {
        asked.push_back(parameters.restyle);
        auto shy = std::make_unique<Shy>(model_->views(prompt, parameters));
        shy->draws_outlines = draws_outlines_;
        shy->draws_lumps = draws_lumps_;
        return shy;
    }

private:
    bool draws_outlines_, draws_lumps_;
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
    std::vector<EditQuality> judged;
    std::vector<bool> asked;
};

Outcome edited(const EditRecipe& recipe, const std::shared_ptr<Misled>& model) {
    EditJob job(recipe, EditJobInput{load_scene(assets_path() / "scenes/bear/scene.ply"), {}, model},
                JobControl{});
    job.locate();
    DOCTEST_REQUIRE(job.found());
    model->asked.clear();  // by the search
    Outcome outcome;
    EditObserver observer;
    observer.judged = [&](const EditQuality& verdict, const edit::ViewTargets&) {
        outcome.judged.push_back(verdict);
    };
    job.run(observer);
    DOCTEST_CHECK(job.result().changed_outside_label == 0);
    outcome.set = job.result().set;
    outcome.asked = model->asked;
    return outcome;
}

Outcome edited(const EditRecipe& recipe, bool both) {
    return edited(recipe, std::make_shared<Misled>(load_recipe_model({}), both));
}

bool same(const GaussianSet& a, const GaussianSet& b) {
    return a.size() == b.size() && std::equal(a.sh().begin(), a.sh().end(), b.sh().begin()) &&
           std::equal(a.position().begin(), a.position().end(), b.position().begin());
}

}  // namespace

DOCTEST_TEST_CASE(
    "what restyles and hardly shows what was asked gives way to the model itself, before anything is "
    "fitted") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    const auto found = edited(blue_bear(), false);
    // In the scene, on a plain ground, by itself.
    DOCTEST_CHECK(found.asked == std::vector<bool>{true, true, false});
    DOCTEST_REQUIRE(found.judged.size() == 1);  // the artist sees the pictures that are used
    DOCTEST_CHECK_FALSE(found.judged[0].warns);
    auto itself = blue_bear();
    itself.guidance.restyle = false;
    const auto told = edited(itself, false);
    DOCTEST_CHECK(told.asked == std::vector<bool>{false});
    DOCTEST_CHECK(same(found.set, told.set));
}

DOCTEST_TEST_CASE("a ground that the model cannot restyle gets the colour that such a ground has") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    for (const char* word : {"snow", "ice"}) {  // the encoder has a word for the first only
        auto recipe = blue_bear();
        recipe.request.source = "grass";
        recipe.request.prompt = std::string("a bear on the ") + word;
        recipe.request.target = word;
        const auto found = edited(recipe, false);
        DOCTEST_CHECK(found.asked == std::vector<bool>{true});  // in the scene; the colour takes no model
        DOCTEST_REQUIRE(found.judged.size() == 1);
        DOCTEST_CHECK_FALSE(found.judged[0].is_poor());
        DOCTEST_CHECK(found.judged[0].score.has_value() == (recipe.request.target == "snow"));
    }
}

DOCTEST_TEST_CASE("where the model itself does no better the first pictures are used, with their warning") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    Idle::rounds = 0;
    const auto found = edited(blue_bear(), true);
    // One each in the scene and on a plain ground, for the model itself another with more strength; none for
    // what was drawn already.
    DOCTEST_CHECK(Idle::rounds <= 4);
    DOCTEST_CHECK(Idle::rounds >= 3);
    DOCTEST_CHECK(found.asked.size() <= 4);
    DOCTEST_CHECK(found.asked.front());
    DOCTEST_REQUIRE(found.judged.size() == 1);
    DOCTEST_CHECK(found.judged[0].warns);
}

DOCTEST_TEST_CASE(
    "a thing that the model cannot draw into the scene is drawn on a plain ground, and nothing of that "
    "reaches the scene") {
    if (neural_library().empty() || !test::available(starter_model_path() / "model_index.json")) return;
    auto recipe = blue_bear();
    recipe.request.prompt = "a yellow mushroom on the grass";
    recipe.request.target = "mushroom";
    for (const bool draws_outlines : {true, false}) {  // without any it "drew into 0 of 4 views"
        const auto found = edited(recipe, std::make_shared<ShyModel>(load_recipe_model({}), draws_outlines));
        DOCTEST_CHECK(found.asked.size() == 2);
        DOCTEST_REQUIRE(found.judged.size() == 1);
        DOCTEST_CHECK_FALSE(found.judged[0].warns);
    }
    // Of what its encoder has no word for nothing is said, but what is like nothing gives way all the same.
    auto drawn_only = recipe;
    drawn_only.request.prompt = "a red rabbit on the grass";
    drawn_only.request.target = "rabbit";
    const auto rabbit = edited(drawn_only, std::make_shared<ShyModel>(load_recipe_model({}), true, true));
    DOCTEST_CHECK(rabbit.asked.size() == 2);
    DOCTEST_REQUIRE(rabbit.judged.size() == 1);
    DOCTEST_CHECK_FALSE(rabbit.judged[0].score);
    DOCTEST_CHECK_FALSE(rabbit.judged[0].warns);
    DOCTEST_CHECK(rabbit.judged[0].likeness.value_or(0) > 0);
    recipe.guidance.plain_ground = false;
    const auto warned = edited(recipe, std::make_shared<ShyModel>(load_recipe_model({}), true));
    DOCTEST_CHECK(warned.asked.size() == 1);
    DOCTEST_REQUIRE(warned.judged.size() == 1);
    DOCTEST_CHECK(warned.judged[0].warns);
}

}  // namespace restyle_test
