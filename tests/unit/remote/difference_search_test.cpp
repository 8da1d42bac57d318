// A search by differences over generated scenes, with a stand-in that edits the thing truly, and noise,
// losses and leaks beside it.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/log.h"
#include "engine/edit/search/grabcut_segmenter.h"
#include "engine/edit/search/locate.h"
#include "engine/laboratory/synth/synth.h"
#include "engine/localize/clusters.h"
#include "engine/raster/rasterizer.h"
#include "engine/remote/views/difference_source.h"
#include "tests/unit/remote/fake_server.h"
#include "tests/unit/remote/test_pictures.h"

namespace difference_search_test {
namespace {

using namespace gse;
using namespace gse::remote;
using namespace remote_pictures;

constexpr int Side = 192, Views = 8;

struct Quiet {
    Quiet() { log::set_level(log::Level::Off); }
    ~Quiet() { log::set_level(log::Level::Info); }
};

/// A scene, the masks of its thing in the views, and a server that recolours it.
struct World {
    synth::SynthScene scene;
    std::vector<View> views;
    std::vector<Mask> truth;
    ThreadPool pool{1};
    std::unique_ptr<raster::Rasterizer> rasterizer = raster::make_fast_rasterizer(pool);
    test::FakeServer server;
    std::array<float, 3> colour{0.75f, 0.15f, 0.95f};

    World(const char* object, const char* material, const char* ground, std::uint64_t seed)
        : scene(synth::generate({.object = object, .material = material, .ground = ground, .seed = seed})) {
        if (scene.spec.material == "purple" || scene.spec.material == "blue") colour = {1.0f, 0.75f, 0.1f};
        std::vector<float> values;
        for (const auto part : scene.parts) values.push_back(part == synth::Part::Object ? 1.0f : 0.0f);
        for (int v = 0; v < Views; ++v) {
            View view;
            view.camera =
                synth::scene_camera(scene, v * 2 * 3.14159265 / Views, v % 2 == 0 ? 0.2 : 0.6, 1, Side, Side);
            Image seen;
            rasterizer->forward_values(scene.scene.gaussians.spans(), view.camera, {}, values, seen);
            truth.push_back(localize::threshold_map(seen, 0.5));
            views.push_back(view);
        }
        server.draws = [this](const RedrawOrder& order, std::size_t call) { return drawn(order, call); };
    }

    /// The thing in another colour, what an autoencoder loses, noise, a leak of chance in every picture, and
    /// one of every third view in both of its pictures.
    Image drawn(const RedrawOrder& order, std::size_t call) const {
        const std::size_t view = call / 2;
        Image picture = order.picture;
        const bool edits = order.prompt.find("purple") != std::string::npos;
        for (std::size_t i = 0; i < truth[view].data.size(); ++i) {
            if (truth[view].data[i] == 0 || !edits) continue;
            float* pixel = picture.data.data() + i * 3;
            const float light = 0.35f + 0.65f * (pixel[0] + pixel[1] + pixel[2]) / 3;
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = std::min(1.0f, 1.3f * light * colour[c]);
        }
        const Image lost =
            localize::resize_image(localize::resize_image(picture, Side / 8, Side / 8), Side, Side);
        for (std::size_t i = 0; i < picture.data.size(); ++i)
            picture.data[i] += 0.1f * (lost.data[i] - picture.data[i]);
        Random random(call + 1);
        const auto place = [&] { return Side * random.uniform(0.1, 0.9); };
        paint(picture, disc(Side, 12, place(), place()), {0.2f, 0.8f, 0.8f});
        if (view % 3 == 0) paint(picture, disc(Side, 16, Side * 0.15, Side * 0.85), {0.8f, 0.1f, 0.1f});
        add_noise(picture, 0.02, call);
        return picture;
    }

    edit::LocateResult search(const char* family) {
        edit::EditRequest request;
        request.source = scene.spec.object;
        request.prompt = "a purple " + scene.spec.object;
        request.target = "purple";
        request.image_size = Side;
        request.retry_passes = 0;
        const auto asked = edit::check(request);
        RemoteDrawing drawing;
        drawing.text = {request.prompt, "turn it purple", ""};
        drawing.family = family_named(family);
        drawing.side = Side;
        PictureSource source(server, server.facts, "", nullptr);
        DifferenceSource differences(source, {drawing, "a " + request.source, request.source}, {});
        const auto segmenter = edit::make_default_segmenter();
        const edit::LocateTools tools{*rasterizer, differences, segmenter.get(), nullptr, {}};
        const std::vector<std::string> words;
        return edit::locate({scene.scene.gaussians, views, words, asked, {}, {0, -1, 0}}, tools);
    }

    double iou_of(const std::vector<std::uint8_t>& bits) const {
        double both = 0, either = 0;
        for (std::size_t row = 0; row < bits.size(); ++row) {
            const bool thing = scene.parts[row] == synth::Part::Object;
            both += thing && bits[row] != 0 ? 1 : 0;
            either += thing || bits[row] != 0 ? 1 : 0;
        }
        return both / either;
    }
};

}  // namespace

DOCTEST_TEST_CASE("difference search: a label is found without attention, among noise and leaks") {
    const Quiet quiet;
    // Told what to do (two seeds), and told what the picture shows (two sentences).
    for (const char* family : {"kontext", "sdxl"}) {
        double sum = 0, least = 1;
        int scenes = 0;
        for (const auto& [object, material, ground, seed] :
             {std::tuple{"bear", "red", "grass", 1u}, std::tuple{"dog", "blue", "snow", 2u},
              std::tuple{"car", "yellow", "sand", 3u}, std::tuple{"tree", "green", "grass", 5u},
              std::tuple{"cat", "black", "snow", 14u}, std::tuple{"chair", "wooden", "sand", 12u}}) {
            World world(object, material, ground, seed);
            const auto result = world.search(family);
            const double iou = world.iou_of(*result.label.bits);
            DOCTEST_CHECK_MESSAGE((result.problem == edit::SearchProblem::None), result.message);
            DOCTEST_CHECK_MESSAGE(iou >= 0.9, object);
            DOCTEST_CHECK(world.server.orders.size() == 2 * Views);
            sum += iou, least = std::min(least, iou), ++scenes;
        }
        DOCTEST_MESSAGE(std::string(family), ": IoU ", sum / scenes, " in the mean of ", scenes, " scenes, ",
                        least, " at least");
    }
}

DOCTEST_TEST_CASE("difference search: a server that edits nothing labels nothing, and says so") {
    const Quiet quiet;
    World world("bear", "red", "grass", 1);
    world.server.draws = [](const RedrawOrder& order, std::size_t) { return order.picture; };
    const auto result = world.search("kontext");
    DOCTEST_CHECK((result.problem == edit::SearchProblem::FewViews));
    DOCTEST_CHECK(std::count(result.label.bits->begin(), result.label.bits->end(), std::uint8_t{1}) == 0);
}

}  // namespace difference_search_test
