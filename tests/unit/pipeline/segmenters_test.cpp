// The segmenter of a job: SAM where weights are named, with masks that are remembered.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <memory>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/random.h"
#include "engine/base/thread_pool.h"
#include "engine/pipeline/neural_loader.h"
#include "engine/pipeline/recipe.h"
#include "engine/pipeline/segmenters.h"
#include "tests/test_paths.h"

namespace {

using namespace gse;
using namespace gse::pipeline;

constexpr std::uint64_t Room = std::uint64_t{64} << 20;

Image noise(int width, int height) {
    Image image(width, height, 3);
    Random random(7);
    for (auto& value : image.data) value = static_cast<float>(random.uniform(0, 1));
    return image;
}

JobParameters tiny_sam() {
    JobParameters job;
    job.segmenter = (test::goldens_folder() / "sam/sam_original.pth").string();
    return job;
}

bool ready(const JobParameters& job) { return !neural_library().empty() && test::available(job.segmenter); }

const std::vector<edit::PointPrompt> Clicks{{40.5, 30.5, true}, {5.5, 5.5, false}};

}  // namespace

DOCTEST_TEST_CASE("without weights a job has no segmenter of its own") { DOCTEST_CHECK(open_segmenters({}, nullptr).clicks == nullptr); }

DOCTEST_TEST_CASE("masks are remembered: the same picture and clicks ask no network, other clicks do") {
    const auto job = tiny_sam();
    if (!ready(job)) return;
    const test::ScratchFolder scratch;
    const auto cache = std::make_shared<DiskCache>(scratch.path() / "answers", Room);
    const auto image = noise(96, 64);
    const auto first = open_segmenters(job, cache).clicks;
    DOCTEST_REQUIRE(first != nullptr);
    DOCTEST_CHECK(first->trusted());
    DOCTEST_CHECK(first->name() == "SAM");
    const auto mask = first->segment(image, Clicks, std::nullopt, {});
    DOCTEST_CHECK(mask.width == image.width);
    DOCTEST_CHECK(mask.data == without_memory(*first).segment(image, Clicks, std::nullopt, {}).data);
    const auto again = open_segmenters(job, cache).clicks;
    const auto before = network_use();
    DOCTEST_CHECK(again->segment(image, Clicks, std::nullopt, {}).data == mask.data);
    DOCTEST_CHECK((network_use() - before).flop == 0);
    DOCTEST_CHECK(again->name() == first->name());
    auto others = Clicks;
    others[0].positive = false;
    again->segment(image, others, std::nullopt, {});
    DOCTEST_CHECK((network_use() - before).flop > 0);
    const auto without = open_segmenters(job, nullptr).clicks;
    DOCTEST_CHECK(without->segment(image, Clicks, std::nullopt, {}).data == mask.data);
}

DOCTEST_TEST_CASE("threads that ask at once get what one gets") {
    const auto job = tiny_sam();
    if (!ready(job)) return;
    const auto segmenter = open_segmenters(job, nullptr).clicks;
    const auto image = noise(64, 64);
    const auto alone = segmenter->segment(image, Clicks, std::nullopt, {});
    ThreadPool pool(4);
    std::vector<Mask> masks(16);
    pool.parallel_for(masks.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (auto i = begin; i < end; ++i) masks[i] = segmenter->segment(image, Clicks, std::nullopt, {});
    });
    for (const auto& mask : masks) DOCTEST_CHECK(mask.data == alone.data);
}

DOCTEST_TEST_CASE("weights that cannot be used are refused with their name, and a search depends on them") {
    if (neural_library().empty()) return;
    const test::ScratchFolder scratch;
    JobParameters job;
    job.segmenter = (scratch.path() / "gone.pth").string();
    const auto refused = [&](ErrorCode code) {
        try {
            open_segmenters(job, std::make_shared<DiskCache>(scratch.path() / "answers", Room));
            DOCTEST_FAIL("it was opened");
        } catch (const Error& error) {
            DOCTEST_CHECK(error.code() == code);
            DOCTEST_CHECK(error.message().starts_with("the segmenter cannot be used"));
            DOCTEST_CHECK(error.path().string().starts_with(scratch.path().string()));
        }
    };
    refused(ErrorCode::NotFound);
    write_file(job.segmenter, "no weights at all");
    refused(ErrorCode::Malformed);
    EditRecipe plain, other;
    other.job.segmenter = job.segmenter;
    DOCTEST_CHECK(search_key(plain) != search_key(other));
    DOCTEST_CHECK(tuning_key(plain) == tuning_key(other));
}
