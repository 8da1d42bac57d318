// The segmenter of a job: SAM where weights are named, with masks that are remembered.
#define DOCTEST_CONFIG_NO_SHORT_MACRO_NAMES
#include <doctest/doctest.h>

#include <filesystem>
#include <memory>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/random.h"
#include "engine/base/thread_pool.h"
#include "engine/pipeline/models/neural_loader.h"
#include "engine/pipeline/models/segmenters.h"
#include "engine/pipeline/recipe/recipe.h"
#include "tests/test_paths.h"

namespace segmenters_test {

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

/// A folder of the reference's small CLIPSeg with the starter's words.
struct TinyClipSeg {
    TinyClipSeg() {
        const auto golden = test::goldens_folder() / "clipseg";
        const auto words = test::source_folder() / "assets/models/starter/tokenizer";
        if (neural_library().empty() || !test::available(golden / "config.json") ||
            !test::available(words / "merges.txt"))
            return;
        for (const char* file : {"config.json", "model.safetensors"})
            std::filesystem::copy(golden / file, scratch.path() / file);
        for (const auto& entry : std::filesystem::directory_iterator(words))
            std::filesystem::copy(entry.path(), scratch.path() / entry.path().filename());
        job.text_segmenter = scratch.path().string();
    }
    bool ready() const { return !job.text_segmenter.empty(); }
    test::ScratchFolder scratch;
    JobParameters job;
};

/// Says the left half, as sure as it is told to be.
class LeftHalf final : public edit::TextSegmenter {
public:
    explicit LeftHalf(double score) : score_(score) {}
    std::pair<Mask, double> segment(const Image& image, const std::string&) override {
        Mask mask(image.width, image.height);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width / 2; ++x) mask.at(x, y) = 1;
        return {std::move(mask), score_};
    }

private:
    double score_;
};

/// Fills a share of the box from its top.
class PartOfBox final : public edit::Segmenter {
public:
    explicit PartOfBox(double share) : share_(share) {}
    Mask segment(const Image& image, const std::vector<edit::PointPrompt>& points,
                 const std::optional<edit::BoxPrompt>& box, const Image&) override {
        DOCTEST_CHECK(points.empty());
        DOCTEST_REQUIRE(box.has_value());
        Mask mask(image.width, image.height);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                mask.at(x, y) = x >= box->x0 && x < box->x1 && y < box->y0 + share_ * (box->y1 - box->y0);
        return mask;
    }
    std::string name() const override { return "part of a box"; }

private:
    double share_;
};

const std::vector<edit::PointPrompt> Clicks{{40.5, 30.5, true}, {5.5, 5.5, false}};

}  // namespace

DOCTEST_TEST_CASE("without weights a job has no segmenter of its own") {
    DOCTEST_CHECK(open_segmenters({}, nullptr).clicks == nullptr);
}

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
    DOCTEST_CHECK(mask.data == uncached(*first).segment(image, Clicks, std::nullopt, {}).data);
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
    EditRecipe plain;
    plain.request.source = "bear", plain.request.prompt = "a blue bear";
    auto other = plain;
    other.job.segmenter = job.segmenter;
    DOCTEST_CHECK(search_key(check(plain)) != search_key(check(other)));
    DOCTEST_CHECK(tuning_key(plain) == tuning_key(other));
}

DOCTEST_TEST_CASE("words are looked for by CLIPSeg, and what it said is remembered") {
    const TinyClipSeg tiny;
    if (!tiny.ready()) return;
    const test::ScratchFolder scratch;
    const auto cache = std::make_shared<DiskCache>(scratch.path() / "answers", Room);
    const auto image = noise(80, 60);
    const auto first = open_segmenters(tiny.job, cache);
    DOCTEST_REQUIRE(first.words != nullptr);
    DOCTEST_CHECK(first.clicks == nullptr);
    const auto [mask, score] = first.words->segment(image, "bear");
    DOCTEST_CHECK(mask.width == image.width);
    DOCTEST_CHECK(mask.count() > 0);
    DOCTEST_CHECK(score > 0);
    DOCTEST_CHECK(score <= 1);
    const auto before = network_use();
    const auto again = open_segmenters(tiny.job, cache).words->segment(image, "bear");
    DOCTEST_CHECK(again.first.data == mask.data);
    DOCTEST_CHECK(again.second == score);
    DOCTEST_CHECK((network_use() - before).flop == 0);
    DOCTEST_CHECK(open_segmenters(tiny.job, nullptr).words->segment(image, "bear").first.data == mask.data);
    first.words->segment(image, "hat");
    DOCTEST_CHECK((network_use() - before).flop > 0);
}

DOCTEST_TEST_CASE("a folder that is no CLIPSeg is refused") {
    TinyClipSeg tiny;
    if (!tiny.ready()) return;
    const auto refused = [&] {
        try {
            open_segmenters(tiny.job, nullptr);
            DOCTEST_FAIL("it was opened");
        } catch (const Error& error) {
            DOCTEST_CHECK(error.message().starts_with("the segmenter cannot be used"));
        }
    };
    std::filesystem::remove(tiny.scratch.path() / "model.safetensors");
    refused();
    std::filesystem::remove(tiny.scratch.path() / "config.json");  // a copy of what may not be written to
    write_file(tiny.scratch.path() / "config.json", "{\"model_type\": \"clip\"}");
    refused();
    tiny.job.text_segmenter = (tiny.scratch.path() / "merges.txt").string();
    refused();
}

DOCTEST_TEST_CASE("a word's mask is sharpened where both mean the same thing") {
    const auto image = noise(40, 20);
    const auto sure = std::make_shared<LeftHalf>(0.9);
    const auto own = sure->segment(image, "bear").first;
    const auto sharp = sharpened(sure, std::make_shared<PartOfBox>(0.8))->segment(image, "bear");
    DOCTEST_CHECK(sharp.second == 0.9);
    DOCTEST_CHECK(sharp.first.count() < own.count());
    DOCTEST_CHECK(sharp.first.at(0, 0) == 1);
    const auto other = sharpened(sure, std::make_shared<PartOfBox>(0.3))->segment(image, "bear");
    DOCTEST_CHECK(other.first.data == own.data);
    const auto unsure =
        sharpened(std::make_shared<LeftHalf>(0.1), std::make_shared<PartOfBox>(0.8))->segment(image, "bear");
    DOCTEST_CHECK(unsure.first.data == own.data);
    DOCTEST_CHECK(sharpened(sure, nullptr) == sure);
}

}  // namespace segmenters_test
