// Training pictures as files.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/laboratory/training/picture_shards.h"
#include "engine/laboratory/training/starter_source.h"
#include "tests/test_paths.h"

namespace picture_shards_test {

namespace {

constexpr int Size = 32, Cells = Size / gse::training::LatentCell;

/// Reads a shard's arrays one after the other.
struct Cursor {
    std::string_view bytes;
    template <class T> std::vector<T> take(std::size_t count) {
        std::vector<T> values(count);
        DOCTEST_REQUIRE(bytes.size() >= count * sizeof(T));
        std::memcpy(values.data(), bytes.data(), count * sizeof(T));
        bytes.remove_prefix(count * sizeof(T));
        return values;
    }
};

using Bytes = std::vector<std::uint8_t>;

Bytes part(const Bytes& all, std::size_t index, std::size_t count) {
    const auto size = static_cast<std::ptrdiff_t>(all.size() / count);
    return {all.begin() + static_cast<std::ptrdiff_t>(index) * size,
            all.begin() + static_cast<std::ptrdiff_t>(index + 1) * size};
}

}  // namespace

DOCTEST_TEST_CASE("a file of training pictures holds what the source draws, with its words and cameras") {
    const gse::test::ScratchFolder scratch;
    const auto path = scratch.path() / "shard.bin";
    const auto source = gse::training::make_shape_source(7, {.restyled = 0.5});
    gse::ThreadPool pool(2);
    gse::training::ShardRange range;
    range.first = 16;
    range.count = 8;
    range.size = Size;
    range.wordings = 2;
    gse::training::write_picture_shard(*source, range, path, pool);
    const std::string text = gse::read_file(path);
    Cursor cursor{text};
    DOCTEST_CHECK(cursor.take<std::int32_t>(6) ==
                  std::vector<std::int32_t>{0x32485347, 8, Size, Cells, 2, gse::training::ShardWords});
    const auto after = cursor.take<std::uint8_t>(8 * Size * Size * 3),
               before = cursor.take<std::uint8_t>(8 * Size * Size * 3);
    const auto coverage = cursor.take<std::uint8_t>(8 * 3 * Cells * Cells),
               room = cursor.take<std::uint8_t>(8 * Cells * Cells);
    const auto outline = cursor.take<std::uint8_t>(8 * Size * Size),
               words = cursor.take<std::uint8_t>(8 * 2 * 2 * gse::training::ShardWords),
               restyled = cursor.take<std::uint8_t>(8);
    const auto cameras = cursor.take<float>(16), shares = cursor.take<float>(16),
               fronts = cursor.take<float>(8);
    DOCTEST_CHECK(cursor.bytes.empty());
    auto known = source->vocabulary();
    known.emplace_back(",");
    for (std::size_t i = 0; i < 8; ++i) {
        const auto picture = source->picture(16 + i, Size), old = source->before()->picture(16 + i, Size);
        DOCTEST_CHECK(part(after, i, 8) == picture.rgb);
        DOCTEST_CHECK(part(before, i, 8) == old.rgb);
        DOCTEST_CHECK(part(coverage, i, 8) == picture.coverage);
        DOCTEST_CHECK(part(room, i, 8) == part(old.coverage, 1, 3));
        DOCTEST_CHECK(part(outline, i, 8) == picture.outline);
        const auto of = source->restyled(16 + i);
        DOCTEST_CHECK(restyled[i] == (of ? static_cast<int>(*of) : 255));
        DOCTEST_CHECK(cameras[2 * i] == static_cast<float>(source->camera(16 + i).azimuth));
        DOCTEST_CHECK(fronts[i] == static_cast<float>(source->camera(16 + i).front));
        const auto sentence = [&](std::size_t row) {
            std::string said;
            for (const auto place : part(words, row, 32)) {
                if (place == 255) break;
                said += (said.empty() || known.at(place) == "," ? "" : " ") + known.at(place);
            }
            return said;
        };
        for (std::size_t k = 0; k < 2; ++k) {
            const auto own = sentence((i * 2 + k) * 2), next = sentence((i * 2 + k) * 2 + 1);
            DOCTEST_CHECK(own.size() > 5);
            // Views of one scene are put in the same words but for the side; what does not tell a side has no
            // next one.
            if (own == next) DOCTEST_CHECK(shares[2 * i + k] == 0);
            else DOCTEST_CHECK(own.substr(0, own.rfind(',')) == next.substr(0, next.rfind(',')));
        }
    }
}

DOCTEST_TEST_CASE(
    "files of training pictures that are there stay, and a source without pictures of before is refused") {
    const gse::test::ScratchFolder scratch;
    const auto source = gse::training::make_shape_source(7);
    gse::write_file(scratch.path() / "shard-0.bin", "kept");
    gse::training::StarterTrainParameters parameters;
    parameters.seed = 7;
    parameters.pictures = 9;
    parameters.image_size = Size;
    parameters.threads = 2;
    gse::training::write_picture_shards(parameters, scratch.path(), {}, 8);
    DOCTEST_CHECK(gse::read_file(scratch.path() / "shard-0.bin") == "kept");
    DOCTEST_CHECK(std::filesystem::exists(scratch.path() / "shard-1.bin"));
    DOCTEST_CHECK(!std::filesystem::exists(scratch.path() / "shard-2.bin"));
    const auto words = nlohmann::json::parse(gse::read_file(scratch.path() / "vocabulary.json"));
    DOCTEST_CHECK((words.size() == source->vocabulary().size() + 1 && words.back() == ","));
    gse::ThreadPool pool(1);
    DOCTEST_CHECK_THROWS_AS(
        gse::training::write_picture_shard(*source->before(), {}, scratch.path() / "none.bin", pool),
        gse::Error);
}

}  // namespace picture_shards_test
