// Models with a cache on the disk: answers bit by bit, without networks, for the same question
// only.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/io/project/load_scene.h"
#include "engine/pipeline/models/cached_model.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/model_identity.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/run/edit_job.h"
#include "tests/test_paths.h"

namespace cached_model_test {

namespace {

using namespace gse;
using namespace gse::pipeline;
namespace fs = std::filesystem;

constexpr std::uint64_t Room = std::uint64_t{256} << 20;

/// How often a model was loaded and asked.
struct Asked {
    int loads = 0, maps = 0, pictures = 0, sentences = 0, viewpoints = 0, drawn = 0;
    bool broken = false;    // its maps hold values that are not finite
    bool outlines = false;  // its views tell outlines, not changes
    bool encoder_gone = false;
};

class FakeAttention final : public edit::AttentionSource {
public:
    explicit FakeAttention(Asked& asked) : asked_(asked) {}
    std::vector<Image> locate(const edit::AttentionQuery& query) override {
        ++asked_.maps;
        std::vector<Image> maps;
        for (const auto& word : query.words)
            maps.emplace_back(query.image.width, query.image.height, 1,
                              asked_.broken ? std::numeric_limits<float>::quiet_NaN()
                                            : 1.0f / static_cast<float>(word.size()));
        return maps;
    }
    double threshold() const override { return 0.37; }
    int image_size() const override { return 64; }

private:
    Asked& asked_;
};

class FakeScore final : public edit::ImageTextEncoder {
public:
    explicit FakeScore(Asked& asked) : asked_(asked) {}
    std::vector<float> image(const Image& image) override {
        ++asked_.pictures;
        return {image.data[0], 0.25f};
    }
    std::vector<float> text(const std::string& sentence) override {
        ++asked_.sentences;
        return {static_cast<float>(sentence.size()), 0.5f};
    }
    std::vector<float> viewpoint(const Image& image) override {
        ++asked_.viewpoints;
        return {image.data[0], 1 - image.data[0]};
    }

private:
    Asked& asked_;
};

class FakeViews final : public edit::MultiViewEditor {
public:
    explicit FakeViews(Asked& asked) : asked_(asked) {}
    edit::EditedViews edit(const std::vector<edit::EditView>& views, const edit::EditViewsRequest&,
                           const JobControl&) override {
        ++asked_.drawn;
        edit::EditedViews targets;
        for (const auto& view : views) {
            targets.images.push_back(view.rendered);
            auto& maps = asked_.outlines ? targets.outlines : targets.changes;
            maps.emplace_back(view.rendered.width, view.rendered.height, 1, 0.125f);
        }
        return targets;
    }

private:
    Asked& asked_;
};

class FakeModel final : public neural::TextToImage {
public:
    explicit FakeModel(Asked& asked) : asked_(asked) {}
    std::unique_ptr<edit::AttentionSource> attention(const neural::AttentionParameters&) const override {
        return std::make_unique<FakeAttention>(asked_);
    }
    std::unique_ptr<edit::Guidance> guidance(const std::string&,
                                             const neural::SdsParameters&) const override {
        return nullptr;
    }
    std::unique_ptr<edit::MultiViewEditor> views(const std::string&,
                                                 const neural::SdsParameters&) const override {
        return std::make_unique<FakeViews>(asked_);
    }
    bool supports_scene_conditioning() const override { return true; }
    bool supports_appearance_editing() const override { return true; }
    std::vector<std::string> known_words() const override { return {"bear", "caf\xc3\xa9"}; }
    int image_size() const override { return 96; }
    std::string name() const override { return "fake"; }
    neural::BundleKind kind() const override { return neural::BundleKind::Tcd; }
    Image sample(const neural::SampleRequest&) const override { return {}; }
    Image img2img(const Image& image, const neural::SampleRequest&) const override { return image; }
    std::unique_ptr<edit::ImageTextEncoder> image_text_encoder() const override {
        return asked_.encoder_gone ? nullptr : std::make_unique<FakeScore>(asked_);
    }
    neural::TunedModel tune(const neural::DreamBoothParameters&, std::span<const Image>, const std::string&,
                            const std::string&, const JobControl&, AnswerCache*) const override {
        return {};
    }
    bool save_tuning(const fs::path&, std::uint64_t) const override { return false; }
    std::shared_ptr<TextToImage> load_tuning(const fs::path&) const override { return nullptr; }
    void save_lora(const fs::path&) const override {}
    std::shared_ptr<TextToImage> load_lora(const fs::path&, double) const override { return nullptr; }

private:
    Asked& asked_;
};

/// As after a restart: nothing is left but the folder.
std::shared_ptr<CachedModel> fake(const fs::path& folder, Asked& asked,
                                  const std::string& identity = "a model") {
    return std::make_shared<CachedModel>(std::make_shared<DiskCache>(folder, Room), identity, [&asked] {
        ++asked.loads;
        return std::make_shared<FakeModel>(asked);
    });
}

std::uint64_t passes(const neural::NetworkUse& use) { return use.unet + use.encoder + use.decoder; }

}  // namespace

DOCTEST_TEST_CASE(
    "cached model: what it is and what it answered is known after a restart without loading it") {
    const test::ScratchFolder folder;
    Asked asked;
    const Image picture(8, 6, 3, 0.5f);
    const edit::AttentionQuery query{picture, "a bear", {"bear", "a"}};
    std::vector<Image> maps;
    std::vector<float> seen, told, viewpoint;
    const auto ask = [&] {
        const auto model = fake(folder.path(), asked);
        maps = model->attention()->locate(query);
        const auto score = model->image_text_encoder();
        seen = score->image(picture);
        told = score->text("a bear");
        viewpoint = score->viewpoint(picture);
        DOCTEST_CHECK(model->attention()->threshold() == 0.37);
        DOCTEST_CHECK(model->attention()->image_size() == 64);
        DOCTEST_CHECK(model->image_size() == 96);
        DOCTEST_CHECK(model->name() == "fake");
        DOCTEST_CHECK(model->kind() == neural::BundleKind::Tcd);
        DOCTEST_CHECK((model->supports_scene_conditioning() && model->supports_appearance_editing()));
        DOCTEST_CHECK(model->known_words() == std::vector<std::string>{"bear", "caf\xc3\xa9"});
    };
    ask();
    DOCTEST_CHECK((asked.loads == 1 && asked.maps == 1 && asked.pictures == 1 && asked.sentences == 1 &&
                   asked.viewpoints == 1));
    const auto first = maps;
    const auto first_seen = seen, first_told = told, first_viewpoint = viewpoint;
    const auto before = network_use();
    ask();
    DOCTEST_CHECK((asked.loads == 1 && asked.maps == 1 && asked.pictures == 1 && asked.sentences == 1 &&
                   asked.viewpoints == 1));
    DOCTEST_CHECK((network_use() - before).cached == 3);
    DOCTEST_REQUIRE(maps.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        DOCTEST_CHECK((maps[i].width == 8 && maps[i].height == 6 && maps[i].channels == 1));
        DOCTEST_CHECK(maps[i].data == first[i].data);
    }
    DOCTEST_CHECK((seen == first_seen && told == first_told && viewpoint == first_viewpoint));
    clear_cache_folder(folder.path());
    ask();
    DOCTEST_CHECK((asked.loads == 2 && asked.maps == 2 && asked.pictures == 2 && asked.sentences == 2));
}

DOCTEST_TEST_CASE("cached model: an encoder that went since its facts were kept is an error that says so") {
    const test::ScratchFolder folder;
    Asked asked;
    DOCTEST_REQUIRE(fake(folder.path(), asked)->image_text_encoder());
    asked.encoder_gone = true;
    const auto score = fake(folder.path(), asked)->image_text_encoder();
    DOCTEST_REQUIRE(score);
    DOCTEST_CHECK_THROWS_WITH_AS(score->text("a bear"),
                                 doctest::Contains("picture encoder of the model \"fake\""), Error);
    DOCTEST_CHECK_THROWS_AS(score->image(Image(8, 6, 3, 0.5f)), Error);
    DOCTEST_CHECK_THROWS_AS(score->viewpoint(Image(8, 6, 3, 0.5f)), Error);
}

DOCTEST_TEST_CASE("cached model: everything that an attention map follows from is part of the question") {
    const test::ScratchFolder folder;
    Asked asked;
    Image picture(8, 8, 3, 0.5f), other = picture, wide(16, 4, 3, 0.5f);
    other.data[77] = std::nextafter(0.5f, 1.0f);
    const edit::AttentionQuery query{picture, "a bear", {"bear"}};
    const auto ask = [&](const edit::AttentionQuery& asked_for,
                         const neural::AttentionParameters& parameters = {},
                         const std::string& identity = "a model") {
        const int before = asked.maps;
        fake(folder.path(), asked, identity)->attention(parameters)->locate(asked_for);
        return asked.maps > before;
    };
    DOCTEST_CHECK(ask(query));
    DOCTEST_CHECK(!ask(query));
    const auto changed = [&](auto change) {
        auto next = query;
        change(next);
        return ask(next) && !ask(next);
    };
    DOCTEST_CHECK(changed([](auto& q) { q.prompt = "the bear"; }));
    DOCTEST_CHECK(changed([](auto& q) { q.words = {"a"}; }));
    DOCTEST_CHECK(changed([](auto& q) { q.words = {"bear", "a"}; }));
    DOCTEST_CHECK(changed([](auto& q) { q.view_words = "front view"; }));
    DOCTEST_CHECK(changed([](auto& q) { q.absent = true; }));
    DOCTEST_CHECK(changed([](auto& q) { q.repeats = 4; }));
    DOCTEST_CHECK(changed([](auto& q) { q.seed = 1; }));
    DOCTEST_CHECK(ask({other, "a bear", {"bear"}}));
    DOCTEST_CHECK(ask({wide, "a bear", {"bear"}}));
    DOCTEST_CHECK(ask(query, {}, "another model"));
    const neural::AttentionParameters usual;
    neural::AttentionParameters::visit_fields(
        usual, [&](const char* name, const auto&, const char*, const auto&...) {
            neural::AttentionParameters parameters;
            neural::AttentionParameters::visit_fields(
                parameters, [&](const char* own, auto& value, const char*, const auto&...) {
                    using Value = std::remove_cvref_t<decltype(value)>;
                    if (std::strcmp(own, name) != 0) return;
                    if constexpr (std::is_same_v<Value, bool>) value = !value;
                    else if constexpr (std::is_arithmetic_v<Value>) value += 1;
                    else if constexpr (std::is_same_v<Value, std::string>) value += "x";
                    else value.push_back("x");
                });
            DOCTEST_CHECK(ask(query, parameters));
        });
    const int threads = network_threads();
    set_network_threads(threads + 1);
    DOCTEST_CHECK(ask(query));
    set_network_threads(threads);
    DOCTEST_CHECK(!ask(query));
    asked.broken = true;
    DOCTEST_CHECK(ask({picture, "a sick bear", {"bear"}}));
    DOCTEST_CHECK(ask({picture, "a sick bear", {"bear"}}));  // what is not finite is not kept
}

DOCTEST_TEST_CASE("cached model: views drawn to find a place are kept, by all that they follow from") {
    const test::ScratchFolder folder;
    Asked asked;
    std::vector<edit::EditView> views(2);
    for (auto& view : views) {
        view.rendered = view.original = view.clean_plate.picture = Image(6, 6, 3, 0.25f);
        view.depth = view.clean_plate.depth = Image(6, 6, 1, 2.0f);
        view.mask = Mask(6, 6);
        view.view.camera.width = view.view.camera.height = 6;
    }
    edit::EditViewsRequest input;
    input.keep = true;
    edit::EditedViews targets;
    const auto draws = [&](const std::string& prompt = "a hat") {
        const int before = asked.drawn;
        const auto model = fake(folder.path(), asked);
        DOCTEST_CHECK(model->supports_scene_conditioning());
        targets = model->views(prompt, {})->edit(views, input, {});
        return asked.drawn > before;
    };
    DOCTEST_CHECK(draws());
    DOCTEST_CHECK(!draws());
    DOCTEST_CHECK(asked.loads == 1);
    DOCTEST_REQUIRE((targets.images.size() == 2 && targets.changes.size() == 2));
    DOCTEST_CHECK(targets.images[1].data == views[1].rendered.data);
    DOCTEST_CHECK(targets.changes[1].data == std::vector<float>(36, 0.125f));
    DOCTEST_CHECK(targets.outlines.empty());
    DOCTEST_CHECK((draws("a crown") && !draws("a crown")));
    asked.outlines = true;
    DOCTEST_CHECK((draws("a scarf") && !draws("a scarf")));
    DOCTEST_REQUIRE((targets.outlines.size() == 2 && targets.changes.empty()));
    DOCTEST_CHECK(targets.outlines[1].data == std::vector<float>(36, 0.125f));
    const auto changed = [&](auto change) {
        change();
        return draws() && !draws();
    };
    DOCTEST_CHECK(changed([&] { views[1].rendered.data[5] = 0.5f; }));
    DOCTEST_CHECK(changed([&] { views[1].mask.data[5] = 1; }));
    DOCTEST_CHECK(changed([&] { views[0].clean_plate.picture.data[5] = 0.5f; }));
    DOCTEST_CHECK(changed([&] { views[0].depth.data[5] = 1; }));
    DOCTEST_CHECK(changed([&] { views[0].azimuth = 0.5; }));
    DOCTEST_CHECK(changed([&] { views[0].elevation = 0.5; }));
    DOCTEST_CHECK(changed([&] { views[0].view_words = "front view"; }));
    DOCTEST_CHECK(changed([&] { views[1].view.camera.translation.x = 1; }));
    DOCTEST_CHECK(changed([&] { input.seed = 1; }));
    DOCTEST_CHECK(changed([&] { input.steps = 5; }));
    DOCTEST_CHECK(changed([&] { input.strength = 1; }));
    DOCTEST_CHECK(changed([&] { input.anew = true; }));
    DOCTEST_CHECK(changed([&] { input.guided_until = 0.5; }));
    DOCTEST_CHECK(changed([&] { input.noise = 0.5; }));
    input.keep = false;  // of the loop: asked every time
    DOCTEST_CHECK((draws() && draws()));
}

DOCTEST_TEST_CASE(
    "cached model: damaged entries are asked anew; a model that cannot be loaded says so every time") {
    const test::ScratchFolder folder;
    Asked asked;
    const Image picture(4, 4, 3, 0.5f);
    const edit::AttentionQuery query{picture, "a bear", {"bear"}};
    const auto maps = fake(folder.path(), asked)->attention()->locate(query);
    for (const auto& entry : fs::directory_iterator(folder.path())) {
        auto bytes = read_file(entry.path());
        bytes[bytes.size() / 2] ^= 1;
        write_file(entry.path(), bytes);
    }
    DOCTEST_CHECK(fake(folder.path(), asked)->attention()->locate(query)[0].data == maps[0].data);
    DOCTEST_CHECK((asked.loads == 2 && asked.maps == 2));
    int tries = 0;
    const auto broken =
        std::make_shared<CachedModel>(std::make_shared<DiskCache>(folder.path(), Room), "broken",
                                      [&]() -> std::shared_ptr<neural::TextToImage> {
                                          ++tries;
                                          throw Error(ErrorCode::Model, "it is broken", "");
                                      });
    DOCTEST_CHECK_THROWS_AS(broken->name(), Error);
    DOCTEST_CHECK_THROWS_AS(broken->sample({}), Error);
    DOCTEST_CHECK(tries == 2);
    DOCTEST_CHECK(!broken->load());
}

DOCTEST_TEST_CASE(
    "model identity: contents of every file, settings of loading and the version count; places and times do "
    "not") {
    const test::ScratchFolder folder;
    DiskCache memory(folder.path() / "cache", Room);
    const auto model = folder.path() / "one" / "model";
    fs::create_directories(model / "unet");
    write_file(model / "model_index.json", "{}");
    write_file(model / "unet" / "weights.safetensors", std::string(3000000, 'w'));
    write_file(folder.path() / "style.safetensors", "low rank");
    JobParameters job;
    job.model = model.string();
    const auto identity = [&](const JobParameters& of, int version = AnswersVersion) {
        return model_identity(of, memory, version);
    };
    const auto first = identity(job);
    DOCTEST_CHECK(identity(job) == first);
    fs::create_directories(folder.path() / "two");
    fs::copy(model, folder.path() / "two" / "model", fs::copy_options::recursive);
    JobParameters copied = job;
    copied.model = (folder.path() / "two" / "model").string();
    DOCTEST_CHECK(identity(copied) == first);
    std::set<std::string> seen{first};
    const auto is_new = [&](const std::string& text) { return seen.insert(text).second; };
    DOCTEST_CHECK(is_new(identity(job, AnswersVersion + 1)));
    const auto changed = [&](auto change) {
        JobParameters next = job;
        change(next);
        return is_new(identity(next));
    };
    DOCTEST_CHECK(changed([](auto& j) { j.device = "cuda"; }));
    DOCTEST_CHECK(changed([](auto& j) { j.precision = "bf16"; }));
    DOCTEST_CHECK(changed([](auto& j) { j.taesd = "none"; }));
    DOCTEST_CHECK(changed([&](auto& j) { j.lora = {(folder.path() / "style.safetensors").string()}; }));
    DOCTEST_CHECK(
        changed([&](auto& j) { j.lora = {(folder.path() / "style.safetensors").string() + ":0.5"}; }));
    write_file(folder.path() / "style.safetensors", "low RANK");
    DOCTEST_CHECK(changed([&](auto& j) { j.lora = {(folder.path() / "style.safetensors").string()}; }));
    const auto weights = model / "unet" / "weights.safetensors";
    const auto time = fs::last_write_time(weights);
    auto bytes = read_file(weights);
    bytes[2999999] = 'W';
    write_file(weights, bytes);
    fs::last_write_time(weights, time);  // as some tools copy: the size and the time of change stay
    DOCTEST_CHECK(is_new(identity(job)));
    write_file(model / "gseditpro.json", "{}");
    DOCTEST_CHECK(is_new(identity(job)));
    JobParameters single;
    single.model = weights.string();
    DOCTEST_CHECK(is_new(identity(single)));
    write_file(model / "unet" / "scheduler_config.json", "{}");
    DOCTEST_CHECK(is_new(identity(single)));
    for (const char* beside : {"weights.yaml", "weights.vae.safetensors", "tokenizer/tokenizer.json"}) {
        write_file(model / "unet" / beside, "{}");
        DOCTEST_CHECK_MESSAGE(is_new(identity(single)), beside);
    }
    write_file(folder.path() / "adapter_config.json", "{}");
    DOCTEST_CHECK(changed([&](auto& j) { j.lora = {(folder.path() / "style.safetensors").string()}; }));
    job.model = (folder.path() / "none").string();
    DOCTEST_CHECK_THROWS_AS(identity(job), Error);
}

#ifdef GSE_NEURAL
namespace {

EditRecipe bear(bool learns) {
    EditRecipe recipe;
    recipe.request.source = "bear";
    recipe.request.prompt = "a red bear";
    recipe.request.target = "red";
    recipe.request.views = 3;
    recipe.use_dreambooth = learns;
    recipe.dreambooth.steps = 2;
    recipe.dreambooth.batch = 1;
    recipe.dreambooth.class_images = 5;
    recipe.dreambooth.class_steps = 2;
    return recipe;
}

struct Found {
    std::vector<std::uint8_t> label;
    std::vector<float> weights, picture;
    double confidence = 0;
    neural::NetworkUse use;
    bool loaded = false;
};

/// One start of the program: opens the model, locates.
Found start(const EditRecipe& recipe, const fs::path& cache, bool samples = false) {
    static const Scene scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    const auto before = network_use();
    const auto model =
        open_recipe_model(recipe.job, cache.empty() ? nullptr : std::make_shared<DiskCache>(cache, Room));
    EditJob job(recipe, EditJobInput{scene, {}, model}, JobControl{});
    job.locate();
    Found found{*job.located().label.bits,  {}, {}, job.located().confidence.value, network_use() - before,
                load_of(*model).has_value()};
    for (const auto& view : job.located().views)
        found.weights.insert(found.weights.end(), view.map.data.begin(), view.map.data.end());
    if (samples) {
        neural::SampleRequest request;
        request.prompt = "a red bear";
        request.steps = 2;
        found.picture = job.model().sample(request).data;
    }
    return found;
}

}  // namespace

DOCTEST_TEST_CASE(
    "cache: the second search after a restart gives the same label bit by bit, with no pass and nothing "
    "loaded") {
    const test::ScratchFolder folder;
    const auto plain = start(bear(false), {});
    const auto first = start(bear(false), folder.path()), second = start(bear(false), folder.path());
    DOCTEST_CHECK(passes(first.use) == passes(plain.use));
    DOCTEST_CHECK(passes(first.use) > 0);
    DOCTEST_CHECK(first.loaded);
    DOCTEST_CHECK(passes(second.use) == 0);
    DOCTEST_CHECK(second.use.cached > 0);
    DOCTEST_CHECK(!second.loaded);
    for (const auto& found : {first, second}) {
        DOCTEST_CHECK(found.label == plain.label);
        DOCTEST_CHECK(found.weights == plain.weights);
        DOCTEST_CHECK(found.confidence == plain.confidence);
    }
    auto other = bear(false);
    other.request.prompt = "a blue bear";
    other.request.target = "blue";
    DOCTEST_CHECK(passes(start(other, folder.path()).use) > 0);
}

DOCTEST_TEST_CASE(
    "cache: a tuning is learned once; another one from the same class draws no picture of it again") {
    for (const int rank : {0, 2}) {
        const test::ScratchFolder folder;
        auto recipe = bear(true);
        recipe.dreambooth.rank = rank;
        const auto plain = start(recipe, {}, true);
        const auto first = start(recipe, folder.path(), true);
        const auto second = start(recipe, folder.path());
        DOCTEST_CHECK(first.picture == plain.picture);
        DOCTEST_CHECK(first.label == plain.label);
        DOCTEST_CHECK(passes(second.use) == 0);
        DOCTEST_CHECK(!second.loaded);
        DOCTEST_CHECK(second.label == plain.label);
        DOCTEST_CHECK(second.weights == plain.weights);
        // The tuned weights, read back.
        DOCTEST_CHECK(start(recipe, folder.path(), true).picture == plain.picture);
        recipe.dreambooth.steps = 3;
        const auto plainer = start(recipe, {}, true), again = start(recipe, folder.path(), true);
        DOCTEST_CHECK(again.use.cached >= 2);  // two batches of the class
        DOCTEST_CHECK(again.picture == plainer.picture);
        DOCTEST_CHECK(again.picture != plain.picture);
    }
}
#endif

}  // namespace cached_model_test
