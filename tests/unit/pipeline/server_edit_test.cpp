// Whole edits whose views a server in this process draws.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "engine/base/error.h"
#include "engine/io/project/load_scene.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/math/sh.h"
#include "engine/pipeline/models/installed.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/run/edit_job.h"
#include "tests/test_paths.h"
#include "tests/unit/remote/fake_server.h"

namespace server_edit_test {

namespace {

using namespace gse;
using namespace gse::pipeline;

struct ServerEdit {
    std::shared_ptr<test::FakeServer> server = std::make_shared<test::FakeServer>();
    EditRecipe recipe;

    ServerEdit(const std::string& prompt, const std::string& target) {
        recipe.job.front = "0";
        recipe.request.source = "bear";
        recipe.request.prompt = prompt;
        recipe.request.target = target;
        recipe.request.quality = "draft";
        recipe.server.url = "http://server";
        recipe.server.side = 128;
    }
    std::unique_ptr<EditJob> located() {
        EditJobInput input;
        input.scene = load_scene(assets_path() / "scenes/bear/scene.ply");
        input.model = load_recipe_model({});
        input.server = std::make_shared<ViewServer>(server, recipe.server, nullptr, JobControl{});
        auto job = std::make_unique<EditJob>(recipe, std::move(input), JobControl{});
        job->locate();
        DOCTEST_REQUIRE(job->found());
        return job;
    }
    std::unique_ptr<EditJob> run() {
        auto job = located();
        job->run();
        return job;
    }
};

bool can_run() {
    return !neural_library().empty() && test::available(starter_model_path() / "model_index.json");
}

/// PSNR of the result against what the server's rule makes of the scene, over pixels that labelled splats
/// cover. All views of the edit count, of which a few were fitted to.
double psnr_to_truth(EditJob& job, const test::FakeServer& server) {
    const auto& bits = *job.located().label.bits;
    const std::vector<float> values(bits.begin(), bits.end());
    double squares = 0, count = 0;
    for (const auto& view : job.views()) {
        Image covered;
        job.painter().rasterizer().forward_values(job.drawn().spans(), view.camera, job.render_settings(),
                                                  values, covered);
        const Image before =
            job.painter().paint(job.drawn().spans(), view.camera, job.render_settings()).colour;
        const Image after =
            job.painter().paint(job.drawn_result().spans(), view.camera, job.render_settings()).colour;
        const Image truth = test::in_colour(before, server.colour);
        for (std::size_t i = 0; i < covered.data.size(); ++i) {
            if (covered.data[i] < 0.95f) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double difference = after.data[i * 3 + c] - truth.data[i * 3 + c];
                squares += difference * difference, count += 1;
            }
        }
    }
    return -10 * std::log10(squares / count);
}

}  // namespace

DOCTEST_TEST_CASE("server edit: the scene becomes what the server draws, inside the label alone") {
    if (!can_run()) return;
    ServerEdit edit("a golden bear", "golden");
    auto job = edit.run();
    DOCTEST_CHECK(job->result().changed_outside_label == 0);
    DOCTEST_CHECK(psnr_to_truth(*job, *edit.server) >= 25);
    DOCTEST_CHECK(edit.server->orders.size() == 4);  // half of the views in draft quality
    DOCTEST_CHECK(edit.server->orders[0].picture.width == 128);
    DOCTEST_CHECK(edit.server->orders[0].prompt.starts_with("a golden bear"));
    const auto json = job->server()->to_json();
    DOCTEST_CHECK(json["requests"] == 4);
    DOCTEST_CHECK(json.dump().find("http") == std::string::npos);
}

DOCTEST_TEST_CASE("server edit: a server that edits is told what to do, in words that the model here lacks") {
    if (!can_run()) return;
    ServerEdit edit("an iridescent chitinous bear", "iridescent");
    edit.server->facts.model = "flux1-kontext-dev";
    edit.recipe.server.agreement = "none";
    edit.server->colour = {0.3f, 0.9f, 1.0f};
    auto job = edit.run();
    DOCTEST_CHECK(edit.server->orders[0].prompt.find("iridescent") != std::string::npos);
    DOCTEST_CHECK(edit.server->orders[0].prompt.find("exactly the same") != std::string::npos);
    DOCTEST_CHECK(edit.server->orders[0].strength == 1);
    DOCTEST_CHECK(psnr_to_truth(*job, *edit.server) >= 25);
}

namespace {

/// A red thing on snow, and a server that recolours what is red where no mask says what.
struct UnknownWord {
    synth::SynthScene world =
        synth::generate({.object = "dog", .material = "red", .ground = "snow", .seed = 5});
    ServerEdit edit{"a golden gizmo", "golden"};

    UnknownWord() {
        edit.recipe.request.source = "gizmo";
        edit.recipe.server.agreement = "none";
        edit.server->facts.model = "flux1-kontext-dev";
        edit.server->draws = [this](const remote::RedrawOrder& order, std::size_t) {
            Image mask = order.mask;
            if (mask.data.empty()) {
                mask = Image(order.picture.width, order.picture.height, 1);
                for (std::size_t i = 0; i < mask.data.size(); ++i) {
                    const float* pixel = order.picture.data.data() + i * 3;
                    mask.data[i] = pixel[0] - std::max(pixel[1], pixel[2]) > 0.12f ? 1.0f : 0.0f;
                }
            }
            return test::where(mask, drawn(order), order.picture);
        };
    }
    /// The picture in the server's colour, or all in the one that it is told to paint with.
    Image drawn(const remote::RedrawOrder& order) const {
        const auto at = order.prompt.find("(#");
        if (at == std::string::npos) return test::in_colour(order.picture, edit.server->colour);
        const auto rgb = std::stoul(order.prompt.substr(at + 2, 6), nullptr, 16);
        Image picture = order.picture;
        for (std::size_t i = 0; i < picture.data.size(); ++i)
            picture.data[i] = static_cast<float>(rgb >> (16 - 8 * (i % 3)) & 255) / 255;
        return picture;
    }
    std::unique_ptr<EditJob> job(bool server_searches) {
        EditJobInput input;
        input.scene = world.scene;
        input.model = load_recipe_model({});
        input.server = std::make_shared<ViewServer>(edit.server, edit.recipe.server, nullptr, JobControl{});
        input.server_searches = server_searches;
        return std::make_unique<EditJob>(edit.recipe, std::move(input), JobControl{});
    }
    double iou_of(const std::vector<std::uint8_t>& bits) const {
        double both = 0, either = 0;
        for (std::size_t row = 0; row < bits.size(); ++row) {
            const bool thing = world.parts[row] == synth::Part::Object;
            both += thing && bits[row] != 0 ? 1 : 0;
            either += thing || bits[row] != 0 ? 1 : 0;
        }
        return both / either;
    }
};

}  // namespace

DOCTEST_TEST_CASE("server edit: a word that the model lacks is found by what the server changes") {
    if (!can_run()) return;
    UnknownWord unknown;
    auto job = unknown.job(true);
    job->locate();
    DOCTEST_REQUIRE_MESSAGE(job->found(), job->located().message);
    DOCTEST_CHECK(job->found_by_differences());
    DOCTEST_CHECK(unknown.iou_of(*job->located().label.bits) >= 0.9);
    DOCTEST_CHECK(job->views().size() == 8);
    const auto asked = unknown.edit.server->orders.size();
    DOCTEST_CHECK((asked == 16 || asked == 32));  // from nearer, too, where it is small
    job->locate_again(0.4, "");                   // another threshold asks nobody
    DOCTEST_CHECK(unknown.edit.server->orders.size() == asked);
    DOCTEST_CHECK(unknown.iou_of(*job->located().label.bits) >= 0.9);
    job->run();
    DOCTEST_CHECK(job->result().changed_outside_label == 0);
    DOCTEST_CHECK(psnr_to_truth(*job, *unknown.edit.server) >= 23);
}

DOCTEST_TEST_CASE(
    "server edit: a thing that the server is told to paint is found for one picture of a view") {
    if (!can_run()) return;
    UnknownWord unknown;
    unknown.edit.recipe.server.search = "paint";
    auto job = unknown.job(true);
    job->locate();
    DOCTEST_REQUIRE_MESSAGE(job->found(), job->located().message);
    DOCTEST_CHECK(unknown.iou_of(*job->located().label.bits) >= 0.9);
    const auto asked = unknown.edit.server->orders.size();
    DOCTEST_CHECK((asked == 8 || asked == 16));
}

DOCTEST_TEST_CASE("server edit: a server is asked for a place only where that is allowed, and makes sense") {
    if (!can_run()) return;
    UnknownWord unknown;
    DOCTEST_CHECK_THROWS_AS(unknown.job(false), Error);  // as in the window
    unknown.edit.recipe.server.search = "none";
    DOCTEST_CHECK_THROWS_AS(unknown.job(true), Error);
    unknown.edit.recipe.server.search = "differences";
    unknown.edit.recipe.request.prompt = "a gizmo with a hat";
    unknown.edit.recipe.request.target = "hat";
    DOCTEST_CHECK_THROWS_AS(unknown.job(true), Error);
    unknown.edit.recipe.server.search = "guess";
    DOCTEST_CHECK_THROWS_AS(unknown.job(true), Error);
    DOCTEST_CHECK(unknown.edit.server->orders.empty());
}

DOCTEST_TEST_CASE("server edit: a view that the server gets wrong is left out of the fit") {
    if (!can_run()) return;
    ServerEdit edit("a golden bear", "golden");
    edit.server->draws = [&](const remote::RedrawOrder& order, std::size_t call) {
        if (call == 1 || call == 2) return Image(128, 128, 3, 0.9f);
        return test::where(order.mask, test::in_colour(order.picture, edit.server->colour), order.picture);
    };
    auto job = edit.run();
    const auto& sheet = job->targets().front();
    DOCTEST_CHECK(std::count_if(sheet.views.begin(), sheet.views.end(),
                                [](const auto& view) { return view.dropped; }) == 1);
    DOCTEST_CHECK(psnr_to_truth(*job, *edit.server) >= 24);
}

DOCTEST_TEST_CASE("server edit: something new grows from what the server draws into the place found for it") {
    if (!can_run()) return;
    ServerEdit edit("a bear wearing a magenta hat", "hat");
    edit.server->draws = [](const remote::RedrawOrder& order, std::size_t) {
        double x = 0, y = 0, count = 0;
        for (int row = 0; row < order.mask.height; ++row)
            for (int column = 0; column < order.mask.width; ++column)
                if (order.mask.at(column, row, 0) > 0.5f) x += column, y += row, count += 1;
        Image picture = order.picture;
        const double radius = 0.25 * std::sqrt(count);
        for (int row = 0; row < picture.height; ++row)
            for (int column = 0; column < picture.width; ++column)
                if (std::hypot(column - x / count, row - y / count) < radius) {
                    picture.at(column, row, 0) = picture.at(column, row, 2) = 0.9f;
                    picture.at(column, row, 1) = 0.1f;
                }
        return picture;
    };
    auto job = edit.run();
    DOCTEST_CHECK(job->located().mode == edit::EditMode::Add);
    const auto& result = job->result();
    DOCTEST_CHECK(result.changed_outside_label == 0);
    const auto& set = result.set;
    const std::size_t before = job->scene().gaussians.size();
    DOCTEST_REQUIRE(set.size() > before);
    const std::size_t stride = set.sh().size() / set.size();
    double magenta = 0;
    for (std::size_t row = before; row < set.size(); ++row)
        magenta += colour_from_sh(set.sh()[row * stride]) > 0.5f + colour_from_sh(set.sh()[row * stride + 1])
                       ? 1
                       : 0;
    DOCTEST_CHECK(magenta > 0.5 * static_cast<double>(set.size() - before));
}

DOCTEST_TEST_CASE("server edit: a server that a recipe names is not asked by a job that was not given it") {
    if (!can_run()) return;
    ServerEdit edit("a golden bear", "golden");
    EditJobInput input;
    input.scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    input.model = load_recipe_model({});
    const EditJob job(edit.recipe, std::move(input), JobControl{});
    DOCTEST_CHECK(job.server() == nullptr);
    DOCTEST_CHECK(!job.recipe().server.used());
    edit.recipe.request.prompt = "an iridescent bear";
    edit.recipe.request.target = "iridescent";
    EditJobInput again;
    again.scene = load_scene(assets_path() / "scenes/bear/scene.ply");
    again.model = load_recipe_model({});
    DOCTEST_CHECK_THROWS_AS(EditJob(edit.recipe, std::move(again), JobControl{}), Error);
}

}  // namespace server_edit_test
