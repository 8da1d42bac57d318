// Work shared out by pictures: the same as one after the other, counted for the caller, and nothing is
// encoded twice.
#include <atomic>
#include <stdexcept>
#include <thread>

#include "engine/neural/api/network_use.h"
#include "engine/neural/guidance/attention_source.h"
#include "engine/neural/guidance/multi_view_editor.h"
#include "engine/neural/layers/parallel_for_batches.h"
#include "tests/unit/neural/tiny_model.h"
#include "tests/unit/neural/wall_views.h"

using namespace gse;
using namespace gse::neural;
using namespace gse::test;

namespace {

Image ramp(int width, int height) {
    Image image(width, height, 3);
    for (std::size_t i = 0; i < image.data.size(); ++i)
        image.data[i] = static_cast<float>(i) / static_cast<float>(image.data.size());
    return image;
}

}  // namespace

DOCTEST_TEST_CASE(
    "parts cover everything once; what their threads ask is the caller's; the first exception comes back") {
    for (const bool apart : {false, true}) {
        std::vector<std::atomic<int>> visits(37);
        const auto before = thread_use();
        parallel_for_batches(37, apart, [&](std::int64_t begin, std::int64_t end) {
            DOCTEST_CHECK(!torch::GradMode::is_enabled());
            for (auto i = begin; i < end; ++i) {
                ++visits[static_cast<std::size_t>(i)];
                thread_use().unet += 1;
            }
        });
        for (const auto& count : visits) DOCTEST_CHECK(count == 1);
        DOCTEST_CHECK((thread_use() - before).unet == 37);
        DOCTEST_CHECK_THROWS_AS(parallel_for_batches(8, apart,
                                                     [](std::int64_t, std::int64_t end) {
                                                         if (end == 8) throw std::runtime_error("last");
                                                     }),
                                std::runtime_error);
    }
    parallel_for_batches(0, true, [](std::int64_t, std::int64_t) { DOCTEST_CHECK(false); });
    const int threads = torch::get_num_threads();
    parallel_for_batches(4, true,
                         [](std::int64_t, std::int64_t) { DOCTEST_CHECK(torch::get_num_threads() == 1); });
    DOCTEST_CHECK(torch::get_num_threads() == threads);
}

DOCTEST_TEST_CASE(
    "attention that was prepared is that of one question after the other; a picture is encoded once") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    std::vector<Image> pictures;
    for (int i = 0; i < 5; ++i) pictures.push_back(ramp(40 + i, 40));
    std::vector<edit::AttentionQuery> queries;
    for (const auto& picture : pictures) queries.push_back({picture, "a red bear", {"bear"}});
    queries.push_back({pictures[0], "a red bear", {"red"}});
    queries.push_back({pictures[1], "a red bear", {"hat"}});  // not in the sentence
    BundleAttentionSource plain(bundle, {}), prepared(bundle, {});
    DOCTEST_CHECK(prepared.at_once() > 1);
    const auto one = thread_use();
    plain.locate(queries[0]);
    const auto passes = (thread_use() - one).unet;  // one per noise level that the model states
    const auto before = thread_use();
    prepared.prepare(std::vector(queries.begin(), queries.begin() + 5));
    const auto use = thread_use() - before;
    DOCTEST_CHECK(use.encoder == 5);
    DOCTEST_CHECK(use.unet == 5 * passes);
    for (std::size_t i = 0; i < 5; ++i)
        DOCTEST_CHECK(prepared.locate(queries[i])[0].data == plain.locate(queries[i])[0].data);
    prepared.prepare(std::vector(queries.begin() + 5, queries.end()));
    const auto asked = thread_use();
    DOCTEST_CHECK(prepared.locate(queries[5])[0].data == plain.locate(queries[5])[0].data);
    DOCTEST_CHECK((thread_use() - asked).encoder == 0);
    DOCTEST_CHECK((thread_use() - asked).unet == passes);  // of the plain one
    DOCTEST_CHECK(contains(message_of([&] { prepared.locate(queries[6]); }), "hat"));
}

DOCTEST_TEST_CASE("redrawn views: the unedited ones are encoded once for all rounds") {
    const TinyModel model;
    const auto bundle = std::make_shared<const ModelBundle>(load_bundle(model.path()));
    auto views = wall_views();
    DiffusionViewEditor guidance(bundle, "a red bear", {});
    edit::EditViewsRequest input;
    input.steps = 1;
    guidance.edit(views, input, {});
    views.back().original.data.front() += 0.25f;  // of another one
    for (auto& view : views)
        for (auto& value : view.rendered.data) value = 1 - value;
    const auto first = thread_use();
    const auto targets = guidance.edit(views, input, {});
    // They were the renders, and not asked about.
    DOCTEST_CHECK((thread_use() - first).encoder == 2 * views.size());
    const auto second = thread_use();
    DOCTEST_CHECK(guidance.edit(views, input, {}).images[0].data == targets.images[0].data);
    DOCTEST_CHECK((thread_use() - second).encoder == views.size());
}
