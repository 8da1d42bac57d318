// View guidance on a tiny random model: properties that hold for any weights, and what it asks of the
// networks.
#include <cmath>

#include "engine/edit/request/edit_method.h"
#include "engine/neural/api/network_use.h"
#include "engine/neural/diffusion/scene_views.h"
#include "engine/neural/guidance/dreambooth.h"
#include "engine/neural/guidance/multi_view_editor.h"
#include "engine/neural/model.h"
#include "tests/unit/neural/quantized.h"
#include "tests/unit/neural/tiny_model.h"
#include "tests/unit/neural/wall_views.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

double mean_change(const edit::EditedViews& targets, const std::vector<edit::EditView>& views) {
    double sum = 0;
    for (std::size_t v = 0; v < views.size(); ++v)
        for (std::size_t i = 0; i < views[v].rendered.data.size(); ++i)
            sum += std::abs(targets.images[v].data[i] - views[v].rendered.data[i]);
    return sum / static_cast<double>(2 * views[0].rendered.data.size());
}

}  // namespace

DOCTEST_TEST_CASE("timesteps of a redrawn view go down from its strength, evenly, none twice") {
    DOCTEST_CHECK(redraw_timesteps(0.75, 3, 1000) == std::vector<std::int64_t>{749, 499, 249});
    DOCTEST_CHECK(redraw_timesteps(1, 4, 1000) == std::vector<std::int64_t>{999, 749, 499, 249});
    DOCTEST_CHECK(redraw_timesteps(0.02, 100, 10).size() <= 1);
    DOCTEST_CHECK(!redraw_timesteps(0.02, 100, 10).empty());
}

DOCTEST_TEST_CASE("redrawn views: repeatable, of the size that came in, and counted") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    const auto views = wall_views();
    SdsParameters parameters;
    parameters.before_prompt = "a bear";
    DiffusionViewEditor guidance(bundle, "a red bear", parameters);
    edit::EditViewsRequest input;
    input.steps = 3;
    input.seed = 5;
    const auto before = thread_use();
    const auto targets = guidance.edit(views, input, {});
    const auto use = thread_use() - before;
    // Views, steps, two halves; the sentence before the edit is not asked about.
    DOCTEST_CHECK(use.unet == 2 * 3 * 2);
    DOCTEST_CHECK(use.encoder == 2);  // the render is the original
    DOCTEST_CHECK(use.decoder == 2 * 2);
    DOCTEST_CHECK(use.flop > 0);
    DOCTEST_REQUIRE(targets.images.size() == 2);
    for (const auto& image : targets.images) {
        DOCTEST_CHECK(image.width == 40);
        DOCTEST_CHECK(std::all_of(image.data.begin(), image.data.end(),
                                  [](float value) { return value >= 0 && value <= 1; }));
    }
    DOCTEST_CHECK(guidance.edit(views, input, {}).images[0].data == targets.images[0].data);
    auto other = input;
    other.seed = 6;
    DOCTEST_CHECK(guidance.edit(views, other, {}).images[0].data != targets.images[0].data);
    // Less noise, less change; nothing changes where nothing may.
    auto weak = input;
    weak.strength = 0.05;
    DOCTEST_CHECK(mean_change(guidance.edit(views, weak, {}), views) < mean_change(targets, views));
    auto closed = views;
    for (auto& view : closed) view.mask = Mask(40, 40);
    constexpr double none = 1e-5;  // both pictures go through the decoder
    DOCTEST_CHECK(mean_change(guidance.edit(closed, input, {}), closed) < none);
}

DOCTEST_TEST_CASE(
    "redrawn views: from less noise another seed draws less that is different; only what is drawn anew takes "
    "less") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    const auto views = wall_views();
    DiffusionViewEditor guidance(bundle, "a red bear", {});
    edit::EditViewsRequest input;
    input.steps = 2;
    input.strength = 1;
    const auto drawn = [&](double noise, std::uint64_t seed) {
        input.noise = noise;
        input.seed = seed;
        return guidance.edit(views, input, {}).images[0].data;
    };
    DOCTEST_CHECK(drawn(1, 1) == drawn(0.3, 1));
    input.anew = true;
    const auto differ = [&](double noise) {
        const auto one = drawn(noise, 1), other = drawn(noise, 2);
        double sum = 0;
        for (std::size_t i = 0; i < one.size(); ++i) sum += std::abs(one[i] - other[i]);
        return sum;
    };
    DOCTEST_CHECK(differ(0) == 0);
    DOCTEST_CHECK(differ(0.3) > 0);
    // A network that nobody trained has a known limit only: it is continuous.
    constexpr double hardly = 0.001;
    DOCTEST_CHECK(differ(hardly) < differ(1));
    DOCTEST_CHECK(differ(hardly) < differ(0.3));
}

DOCTEST_TEST_CASE(
    "redrawn views: settings of the guidance that are said to have no effect have none, the others do") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    const auto views = wall_views();
    edit::EditViewsRequest input;
    input.steps = 2;
    SdsParameters parameters;
    parameters.before_prompt = "a bear";
    const auto drawn = [&] {
        return DiffusionViewEditor(bundle, "a red bear", parameters).edit(views, input, {}).images[0].data;
    };
    SdsParameters::visit_fields(
        parameters, [&](const char* name, auto& value, const FieldHelp& help, auto...) {
            using Value = std::remove_reference_t<decltype(value)>;
            if (std::string_view(name) == "image_guidance_scale")
                return;  // counts with models that are told what to do
            if (std::string_view(name).starts_with("restyle")) return;  // with those that restyle
            if (std::string_view(name) == "plain_ground") return;       // with what the views are shown
            input.anew = std::string_view(name) == "shape_guidance_scale";
            const auto plain = drawn();
            const Value kept = value;
            if constexpr (std::is_same_v<Value, bool>) value = !value;
            else if constexpr (std::is_same_v<Value, double>) value = value / 2 + 0.1;
            else value = value.empty() ? "a red hat" : "";
            DOCTEST_INFO(std::string(name));
            DOCTEST_CHECK((drawn() == plain) == !edit::method_named("views")->counts(help.uses));
            value = kept;
        });
}

DOCTEST_TEST_CASE(
    "redrawn views: what was learned for new things draws only those, and is told the side exactly") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    LoraWeights learned;
    for (auto factors = new_lora(lora_targets(*bundle->unet), 2, 7); auto& factor : factors) {
        factor.up.fill_(0.05);
        learned.unet.push_back(factor);
    }
    const auto shapes = std::make_shared<const ModelBundle>(with_lora(*bundle, learned, 1));
    auto views = wall_views();
    edit::EditViewsRequest input;
    input.steps = 2;
    const auto drawn = [&](bool with) {
        return DiffusionViewEditor(bundle, "a bear", {}, with ? shapes : nullptr)
            .edit(views, input, {})
            .images[0]
            .data;
    };
    DOCTEST_CHECK(drawn(true) == drawn(false));
    input.anew = true;
    DOCTEST_CHECK(drawn(true) != drawn(false));
    // In the middle of a side it is the sentence with that side; between two it is neither.
    const auto at = [&](std::optional<double> azimuth, const std::string& prompt) {
        for (auto& view : views) view.azimuth = azimuth;
        return DiffusionViewEditor(bundle, prompt, {}, shapes).edit(views, input, {}).images[0].data;
    };
    const double sector = std::acos(-1.0) / 4;
    DOCTEST_CHECK(at(0.0, "a bear") == at(std::nullopt, "a bear, front view"));
    DOCTEST_CHECK(at(sector / 2, "a bear") != at(0.0, "a bear"));
    DOCTEST_CHECK(at(sector / 2, "a bear") != at(sector, "a bear"));
}

DOCTEST_TEST_CASE(
    "redrawn views: those in which a new thing comes to be see each other where the model says so") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    const auto second = [&](std::int64_t together, float seen_by_the_other, bool anew) {
        auto shapes = *bundle;
        shapes.facts.shape_views = together;
        auto views = wall_views();
        for (auto& value : views[0].rendered.data) value *= seen_by_the_other;
        edit::EditViewsRequest input;
        input.steps = 2;
        input.anew = anew;
        return DiffusionViewEditor(bundle, "a bear", {},
                                   std::make_shared<const ModelBundle>(std::move(shapes)))
            .edit(views, input, {})
            .images[1]
            .data;
    };
    DOCTEST_CHECK(second(2, 1.0f, true) != second(2, 0.3f, true));
    DOCTEST_CHECK(second(1, 1.0f, true) == second(1, 0.3f, true));
    // An object that was there is redrawn view by view.
    DOCTEST_CHECK(second(2, 1.0f, false) == second(2, 0.3f, false));
}

DOCTEST_TEST_CASE(
    "redrawn views: what draws new things is shown what lies behind them, where the model takes that") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    const auto drawn = [&](bool takes, float behind, bool anew) {
        auto shapes = *bundle;
        if (takes) shapes.unet = with_scene_inputs(shapes.unet);
        torch::manual_seed(3);
        const torch::NoGradGuard no_grad;
        for (auto& [name, weight] : scene_input_weights(shapes.unet))
            if (name.starts_with("conv_inpaint.")) weight.normal_(0, 0.1);
        auto views = wall_views();
        for (auto& view : views) view.clean_plate.picture = Image(40, 40, 3, behind);
        edit::EditViewsRequest input;
        input.steps = 2;
        input.anew = anew;
        return DiffusionViewEditor(bundle, "a bear", {},
                                   std::make_shared<const ModelBundle>(std::move(shapes)))
            .edit(views, input, {})
            .images[1]
            .data;
    };
    DOCTEST_CHECK(drawn(true, 0.2f, true) != drawn(true, 0.7f, true));
    DOCTEST_CHECK(drawn(false, 0.2f, true) == drawn(false, 0.7f, true));
    // An object that was there is redrawn as it is.
    DOCTEST_CHECK(drawn(true, 0.2f, false) == drawn(true, 0.7f, false));
}

DOCTEST_TEST_CASE(
    "redrawn views: what restyles is shown the unedited view, changes nothing beside the mask, and tells of "
    "nothing new") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    auto shapes = *bundle;
    shapes.unet = with_scene_inputs(shapes.unet);
    torch::manual_seed(3);
    {
        const torch::NoGradGuard no_grad;
        for (auto& [name, weight] : scene_input_weights(shapes.unet))
            if (name.starts_with("conv_inpaint.")) weight.normal_(0, 0.1);
    }
    const auto scene = std::make_shared<const ModelBundle>(std::move(shapes));
    edit::EditViewsRequest input;
    input.steps = 2;
    const auto drawn = [&](bool supports_appearance_editing, float original) {
        auto views = wall_views();
        for (auto& view : views) view.original = Image(40, 40, 3, original);
        return DiffusionViewEditor(bundle, "a bear", {}, scene, supports_appearance_editing)
            .edit(views, input, {});
    };
    DOCTEST_CHECK_FALSE(
        DiffusionViewEditor(bundle, "a bear", {}, nullptr, true).supports_appearance_editing());
    DOCTEST_CHECK(DiffusionViewEditor(bundle, "a bear", {}, scene, true).supports_appearance_editing());
    const auto plain = drawn(false, 0.2f), restyled = drawn(true, 0.2f), other = drawn(true, 0.7f);
    DOCTEST_CHECK(restyled.images[1].data != plain.images[1].data);
    DOCTEST_CHECK(restyled.images[1].data != other.images[1].data);
    DOCTEST_CHECK((restyled.outlines.empty() && restyled.changes.empty()));
    SdsParameters harder;
    harder.restyle_guidance_scale = 4;
    auto grey = wall_views();
    for (auto& view : grey) view.original = Image(40, 40, 3, 0.2f);
    DOCTEST_CHECK(
        DiffusionViewEditor(bundle, "a bear", harder, scene, true).edit(grey, input, {}).images[1].data !=
        restyled.images[1].data);
    auto views = wall_views();  // nothing may change: nothing does, whatever the autoencoder loses
    for (auto& view : views) std::fill(view.mask.data.begin(), view.mask.data.end(), std::uint8_t{0});
    const auto kept = DiffusionViewEditor(bundle, "a bear", {}, scene, true).edit(views, input, {});
    for (std::size_t i = 0; i < views[0].rendered.data.size(); ++i)
        DOCTEST_REQUIRE(std::abs(kept.images[0].data[i] - views[0].rendered.data[i]) < 1e-5f);
}

DOCTEST_TEST_CASE(
    "redrawn views: where the model knows what lies behind a view, it tells what is new in it") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    auto shapes = *bundle;
    shapes.unet = with_scene_inputs(shapes.unet, false);
    auto views = wall_views();
    for (auto& view : views) view.clean_plate.picture = view.original;
    const auto change_of = [&](bool anew, bool may_change, bool tells = true) {
        for (auto& view : views)
            std::fill(view.mask.data.begin(), view.mask.data.end(), std::uint8_t{may_change});
        edit::EditViewsRequest input;
        input.steps = 2;
        input.strength = 1;
        input.anew = anew;
        input.tells_changes = tells;
        return DiffusionViewEditor(bundle, "a bear", {}, std::make_shared<const ModelBundle>(shapes))
            .edit(views, input, {})
            .changes;
    };
    DOCTEST_CHECK(change_of(false, true).empty());
    DOCTEST_CHECK(change_of(true, true, false).empty());
    const auto all = change_of(true, true), none = change_of(true, false);
    DOCTEST_REQUIRE((all.size() == views.size() && none.size() == views.size()));
    for (const auto& change :
         none)  // the surroundings stay as they are: nothing differs, whatever the autoencoder loses of them
        DOCTEST_CHECK(*std::max_element(change.data.begin(), change.data.end()) < 1e-5f);
    DOCTEST_CHECK((all[0].width == views[0].rendered.width && all[0].channels == 1));
    DOCTEST_CHECK(*std::max_element(all[0].data.begin(), all[0].data.end()) > 0.01f);
}

DOCTEST_TEST_CASE(
    "redrawn views: where the model knows outlines it tells them, and changes need not be decoded") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    auto shapes = *bundle;
    shapes.unet = with_scene_inputs(shapes.unet);
    auto views = wall_views();
    for (auto& view : views) view.clean_plate.picture = view.original;
    edit::EditViewsRequest input;
    input.steps = 2;
    input.tells_changes = true;
    const auto drawn = [&] {
        return DiffusionViewEditor(bundle, "a bear", {}, std::make_shared<const ModelBundle>(shapes))
            .edit(views, input, {});
    };
    DOCTEST_CHECK(drawn().outlines.empty());  // nothing is new
    input.anew = true;
    const auto targets = drawn();
    DOCTEST_CHECK(targets.changes.empty());
    DOCTEST_REQUIRE(targets.outlines.size() == views.size());
    for (const auto& outline : targets.outlines) {
        DOCTEST_CHECK((outline.width == views[0].rendered.width && outline.channels == 1));
        for (const float share : outline.data)
            DOCTEST_REQUIRE((share >= 0 && share < 0.5f));  // it has learned of none
    }
    shapes.unet = with_scene_inputs(bundle->unet, false);
    DOCTEST_CHECK((drawn().outlines.empty() && drawn().changes.size() == views.size()));
}

DOCTEST_TEST_CASE("a model that names a LoRA for new things and has none is refused at once") {
    const TinyModel model;
    for (const char* key : {"shape_lora", "shape_cameras", "shape_unet"}) {
        gse::write_file(model.path() / "gseditpro.json",
                        std::string("{\"") + key + "\": \"gone.safetensors\"}");
        DOCTEST_CHECK_THROWS_WITH_AS(load_bundle(model.path()), doctest::Contains("gone.safetensors"), Error);
    }
}

DOCTEST_TEST_CASE(
    "a model with a network of its own draws new things with it, and everything else as before") {
    const TinyModel model;
    const auto plain = load_model(model.path(), "cpu");
    DOCTEST_CHECK_FALSE(plain->supports_scene_conditioning());
    auto views = wall_views();
    for (auto& view : views) view.clean_plate.picture = view.original;
    const auto drawn = [&](const TextToImage& with, bool anew) {
        edit::EditViewsRequest input;
        input.steps = 2;
        input.anew = anew;
        return with.views("a bear", {})->edit(views, input, {});
    };
    const auto redrawn = drawn(*plain, false);
    auto unet = with_scene_inputs(load_bundle(model.path()).unet);
    {
        const torch::NoGradGuard no_grad;
        for (auto& parameter : unet->parameters()) parameter.mul_(1.5);
    }
    write_shape_unet(unet, model.path() / "own");
    gse::write_file(model.path() / "gseditpro.json", R"({"shape_unet": "own", "shape_views": 2})");
    const auto with = load_model(model.path(), "cpu");
    DOCTEST_CHECK(with->supports_scene_conditioning());
    const auto same = drawn(*with, false), shapes = drawn(*with, true);
    for (std::size_t v = 0; v < views.size(); ++v)
        DOCTEST_CHECK(same.images[v].data == redrawn.images[v].data);
    DOCTEST_CHECK((same.outlines.empty() && shapes.outlines.size() == views.size()));
    DOCTEST_CHECK(shapes.images[0].data != drawn(*plain, true).images[0].data);
    DOCTEST_CHECK_FALSE((with->supports_appearance_editing() || plain->supports_appearance_editing()));
    gse::write_file(model.path() / "gseditpro.json",
                    R"({"shape_unet": "own", "shape_views": 2, "shape_restyles": true})");
    const auto restyling = load_model(model.path(), "cpu");
    DOCTEST_CHECK(restyling->supports_appearance_editing());
    DOCTEST_CHECK(restyling->views("a bear", {})->supports_appearance_editing());
    DOCTEST_CHECK(drawn(*restyling, false).images[0].data != redrawn.images[0].data);
    // What was tuned, or merged with a LoRA, draws by itself.
    LoraWeights style;
    for (const auto& factor : new_lora(lora_targets(*load_bundle(model.path()).unet), 2, 7))
        style.unet.push_back(factor);
    write_lora(model.path() / "style.safetensors", style);
    DOCTEST_CHECK_FALSE(
        restyling->load_lora(model.path() / "style.safetensors")->supports_appearance_editing());
    ModelOptions merged;
    merged.loras = {{model.path() / "style.safetensors", 1.0}};
    DOCTEST_CHECK_FALSE(load_model(model.path(), merged)->supports_appearance_editing());
    merged.loras.front().strength = 0;
    DOCTEST_CHECK(load_model(model.path(), merged)->supports_appearance_editing());
}

DOCTEST_TEST_CASE("redrawing views can be stopped") {
    const TinyModel model;
    DiffusionViewEditor guidance(std::make_shared<const ModelBundle>(load_bundle(model.path())), "a red bear",
                                 {});
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    DOCTEST_CHECK_THROWS_AS(guidance.edit(wall_views(), {}, job), Error);
}

DOCTEST_TEST_CASE("the arithmetic of a UNet pass is counted as its layers do it") {
    const TinyModel model;
    const auto bundle = load_bundle(model.path());
    const auto x = torch::zeros({1, 4, 8, 8});
    const auto context = bundle.encode_prompts({"a bear"});
    const auto pass = [&](std::int64_t batch) {
        const auto before = thread_use();
        bundle.unet->forward(x.expand({batch, 4, 8, 8}).contiguous(), torch::full({1}, 10.0),
                             context.expand({batch, -1, -1}).contiguous());
        return thread_use() - before;
    };
    const auto one = pass(1), two = pass(2);
    DOCTEST_CHECK(one.unet == 1);
    DOCTEST_CHECK(two.unet == 2);
    // The time embedding may be shared.
    DOCTEST_CHECK(two.flop == doctest::Approx(2 * one.flop).epsilon(0.02));
    DOCTEST_CHECK(one.encoder + one.decoder == 0);
}
