// Broken input: every reader answers with Error, allocates no more than the file can justify, and never
// crashes.
#include <sys/resource.h>

#include <limits>

#include "engine/base/memory.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/bytes/zip_archive.h"
#include "engine/io/formats/scene_formats.h"
#include "tests/unit/io/io_helpers.h"

namespace robustness_test {

using namespace gse;
using namespace gse::test;

namespace {

struct Sample {
    std::string name;
    std::string bytes;
};

/// A small valid file of every format.
std::vector<Sample> samples() {
    std::vector<Sample> result;
    const Scene scene = random_scene(3, 1, 40);
    for (const std::string& format : writable_formats())
        result.push_back({"a." + format, written_as(format, scene)});
    result.push_back({"four.spz", written_as("spz", scene, {.choices = {{"spz_version", 4}}})});
    const auto fixtures = data_folder() / "fixtures";
    for (const char* name : {"splat-transform/minimal-raw.spz", "splat-transform/minimal-v2.spz",
                             "splat-transform/minimal-v4.spz", "gsplat-rs/minimal_ascii.ply"})
        if (std::filesystem::exists(fixtures / name)) result.push_back({name, read_file(fixtures / name)});
    return result;
}

/// Loads or throws Error; anything else fails the test.
bool survives(const std::string& bytes, const std::string& name) {
    try {
        parse_scene(as_bytes(bytes), name);
    } catch (const Error& error) { return !error.message().empty(); }
    return true;
}

long peak_kilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

}  // namespace

DOCTEST_TEST_CASE("a file cut at any length is an error, never a crash") {
    for (const Sample& sample : samples()) {
        DOCTEST_CAPTURE(sample.name);
        DOCTEST_REQUIRE(!error_of([&] { parse_scene(as_bytes(sample.bytes), sample.name); }).has_value());
        std::size_t accepted = 0;
        for (std::size_t size = 0; size < sample.bytes.size(); ++size)
            if (!error_of([&] { parse_scene(as_bytes(sample.bytes.substr(0, size)), sample.name); }))
                ++accepted;
        // .splat has no header: whole rows are a valid file. A text PLY may lose its last digits or the final
        // newline, a gzip stream its checksum.
        const std::size_t tolerated = sample.name.ends_with(".splat")      ? sample.bytes.size() / 32
                                      : sample.name.ends_with("ascii.ply") ? 24
                                      : sample.name.ends_with(".spz")      ? 10
                                                                           : 0;
        DOCTEST_CHECK(accepted <= tolerated);
    }
}

DOCTEST_TEST_CASE("changed bytes never crash a reader") {
    Random random(77);
    for (const Sample& sample : samples())
        for (int round = 0; round < 400; ++round) {
            std::string bytes = sample.bytes;
            for (std::uint64_t change = 0; change <= random.below(4); ++change)
                bytes[random.below(bytes.size())] = static_cast<char>(random.next());
            DOCTEST_REQUIRE(survives(bytes, sample.name));
        }
}

DOCTEST_TEST_CASE("huge counts are refused without allocating") {
    const std::string ply = written_as("ply", random_scene(2, 3, 1));
    const long before = peak_kilobytes();
    for (const char* count :
         {"4294967295", "18446744073709551615", "9999999999999999999999", "74382384379286256"}) {
        std::string text = ply;
        text.replace(text.find("element vertex 2"), 16, std::string("element vertex ") + count);
        DOCTEST_CHECK(error_of([&] { parse_scene(as_bytes(text), "x.ply"); }).has_value());
        std::string ascii = text;
        ascii.replace(ascii.find("binary_little_endian"), 20, "ascii");
        DOCTEST_CHECK(error_of([&] { parse_scene(as_bytes(ascii), "x.ply"); }).has_value());
    }
    std::string spz = "NGSP";
    for (const std::uint32_t value : {2u, 0xffffffffu, 3u | 12u << 8}) io::append_value(spz, value);
    DOCTEST_CHECK(error_of([&] { parse_scene(as_bytes(spz), "x.spz"); }).has_value());
    DOCTEST_CHECK(error_of([&] { parse_scene(as_bytes(io::deflate_gzip(spz)), "x.spz"); }).has_value());
    std::string streams = "NGSP";
    for (const std::uint32_t value : {4u, 0xffffffffu, 3u | 12u << 8 | 6u << 24, 32u, 0u, 0u, 0u})
        io::append_value(streams, value);
    for (int i = 0; i < 6; ++i) {
        io::append_value(streams, std::uint64_t{10});
        io::append_value(streams, std::uint64_t{0xffffffff} * 9);
    }
    streams += std::string(60, 'x');
    DOCTEST_CHECK(error_of([&] { parse_scene(as_bytes(streams), "x.spz"); }).has_value());
    std::string compressed = written_as("compressed.ply", random_scene(2, 0, 1));
    compressed.replace(compressed.find("element vertex 2"), 16, "element vertex 4000000000");
    DOCTEST_CHECK(error_of([&] { parse_scene(as_bytes(compressed), "x.ply"); }).has_value());
    constexpr long AllowedKilobytes = 64 * 1024;
    DOCTEST_CHECK(peak_kilobytes() - before < AllowedKilobytes);
}

DOCTEST_TEST_CASE("small files that ask for gigabytes are refused before anything is unpacked") {
    const long before = peak_kilobytes();
    // 400 million splats as zstd frames of zeros would be read in full, were it not for the file's size.
    io::check_claim({io::splat_bytes(1000000, 3), 1000}, "it");  // a little may come from nothing
    DOCTEST_CHECK(error_of([] { io::check_claim({std::uint64_t{60} << 30, 820}, "it"); }));
    DOCTEST_CHECK_THROWS_AS(io::check_claim({std::uint64_t{1} << 60, std::uint64_t{1} << 59}, "it"),
                            OutOfMemory);
    const auto folder = data_folder() / "hostile";
    if (!available(folder)) return;
    for (const char* name : {"sog_bomb268M.sog", "spz4_bomb400M.spz"}) {
        const auto error = error_of([&] { load_scene(folder / name); });
        DOCTEST_REQUIRE_MESSAGE(error.has_value(), name);
        DOCTEST_CHECK(error->code() == ErrorCode::Malformed);
        DOCTEST_CHECK(std::string(error->what()).find("cannot hold so much") != std::string::npos);
    }
    const auto deep = error_of([&] { load_scene(folder / "lod_deep"); });
    DOCTEST_REQUIRE(deep.has_value());
    DOCTEST_CHECK(std::string(deep->what()).find("levels deep") != std::string::npos);
    constexpr long AllowedKilobytes = 64 * 1024;
    DOCTEST_CHECK(peak_kilobytes() - before < AllowedKilobytes);
}

DOCTEST_TEST_CASE(
    "a SOG archive's entry is unpacked to the size that the archive states, and that must be honest") {
    const std::string meta = R"({"version": 2, "count": 1, "sh0": {"files": ["sh0.webp"]}})",
                      texture(5000, 'x');
    const std::string honest =
        io::write_zip(std::vector<io::ZipMember>{{"meta.json", meta, true}, {"sh0.webp", texture, true}});
    const auto stating = [&](std::uint32_t size) {
        std::string archive = honest;
        // In the directory, whose record has the size 22 bytes before.
        const std::size_t name = archive.rfind("sh0.webp");
        std::memcpy(archive.data() + name - 22, &size, sizeof size);
        const auto error = error_of([&] { parse_scene(as_bytes(archive), "x.sog"); });
        return error ? error->message() : std::string();
    };
    DOCTEST_CHECK(stating(5000).find("is not a WebP picture") != std::string::npos);
    DOCTEST_CHECK(stating(1000000000).find("cannot hold so much") != std::string::npos);
    DOCTEST_CHECK(stating(0xfffffff0u).find("more than its place allows") != std::string::npos);
    DOCTEST_CHECK(stating(10).find("cannot be unpacked") != std::string::npos);
    DOCTEST_CHECK(stating(6000).find("cannot be unpacked") != std::string::npos);
}

DOCTEST_TEST_CASE("a tree of levels names each part once, and none outside of its folder") {
    const auto source = data_folder() / "scenes/playbot_lod_sog/6_0";
    if (!available(source)) return;
    ScratchFolder scratch;
    std::filesystem::copy(source, scratch.path() / "part", std::filesystem::copy_options::recursive);
    const auto load = [&](const std::string& names) {
        std::filesystem::remove(scratch.path() / "lod-meta.json");
        write_file(scratch.path() / "lod-meta.json",
                   "{\"filenames\": [" + names +
                       "], \"tree\": {\"children\": [{\"lods\": {\"0\": {\"file\": 0}}}, "
                       "{\"lods\": {\"0\": {\"file\": 1}}}, {\"lods\": {\"0\": {\"file\": 0}}}]}}");
        return load_scene(scratch.path()).gaussians.size();
    };
    DOCTEST_CHECK(load("\"part/meta.json\", \"./part/meta.json\"") == 1873);
    DOCTEST_CHECK(error_of([&] { load("\"part/meta.json\", \"../x/meta.json\""); }));
    DOCTEST_CHECK(error_of([&] { load("\"part/meta.json\", \"/etc/meta.json\""); }));
}

DOCTEST_TEST_CASE("a list that claims billions of items ends with the file") {
    const std::string text =
        "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint double a\n"
        "element vertex 1\nproperty float x\nend_header\n\xff\xff\xff\xff";
    const auto error = error_of([&] { parse_scene(as_bytes(text), "x.ply"); });
    DOCTEST_CHECK(error.has_value());
}

DOCTEST_TEST_CASE("a file full of NaN loads, and the statistics say so") {
    GaussianData data = random_gaussians(50, 1, 2);
    for (auto* values : {&data.position, &data.log_scale, &data.rotation, &data.opacity_logit, &data.sh})
        std::fill(values->begin(), values->end(), std::numeric_limits<float>::quiet_NaN());
    Scene scene;
    scene.gaussians = GaussianSet(data);
    const Scene again = parse_scene(as_bytes(written_as("ply", scene)), "x.ply");
    DOCTEST_CHECK(compute_statistics(again.gaussians).nan_rows == 50);
    DOCTEST_CHECK(drop_unusable(again.gaussians).empty());
}

DOCTEST_TEST_CASE("wrong magic, wrong name, nothing at all") {
    const auto message = [](const std::string& bytes, const char* name) {
        const auto error = error_of([&] { parse_scene(as_bytes(bytes), name); });
        return error ? std::string(error->what()) : std::string();
    };
    DOCTEST_CHECK(message("", "a.ply").find("empty") != std::string::npos);
    DOCTEST_CHECK(message("plx\n", "a.ply").find("the name says ply") != std::string::npos);
    DOCTEST_CHECK(message("hello", "a.txt").find("no scene format") != std::string::npos);
    DOCTEST_CHECK(message(std::string(33, 'x'), "a.splat").find("32 bytes per splat") != std::string::npos);
    DOCTEST_CHECK(message("PK\x03\x04 no zip at all", "a.sog").find("zip") != std::string::npos);
    DOCTEST_CHECK(message("NGSP", "a.spz").find("header") != std::string::npos);
    const auto missing = error_of([] { load_scene("/nowhere/at/all.ply"); });
    DOCTEST_REQUIRE(missing.has_value());
    DOCTEST_CHECK(missing->code() == ErrorCode::NotFound);
    ScratchFolder scratch;
    const auto folder = error_of([&] { load_scene(scratch.path()); });
    DOCTEST_REQUIRE(folder.has_value());
    DOCTEST_CHECK(folder->code() == ErrorCode::NotFound);
}

DOCTEST_TEST_CASE("SOG: missing parts, wrong counts and bad descriptions are told") {
    const auto source = data_folder() / "scenes/playbot_lod_sog/6_0";
    if (!available(source)) return;
    ScratchFolder scratch;
    const auto folder = scratch.path() / "sog";
    std::filesystem::copy(source, folder, std::filesystem::copy_options::recursive);
    const std::string meta = read_file(folder / "meta.json");
    const auto with_meta = [&](std::string text) {
        std::filesystem::remove(folder / "meta.json");
        write_file(folder / "meta.json", text);
        const auto error = error_of([&] { load_scene(folder); });
        return error ? std::string(error->what()) : std::string();
    };
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = meta;
        text.replace(text.find(from), from.size(), to);
        return with_meta(text);
    };
    DOCTEST_CHECK(with_meta(meta).empty());
    DOCTEST_CHECK(changed("\"count\":1873", "\"count\":90000").find("texels") != std::string::npos);
    DOCTEST_CHECK(changed("\"count\":1873", "\"count\":1e30") != "");
    DOCTEST_CHECK(changed("\"count\":1873", "\"count\":0").find("no splats") != std::string::npos);
    DOCTEST_CHECK(changed("\"version\":2", "\"version\":7").find("version 7") != std::string::npos);
    DOCTEST_CHECK(changed("means_l.webp", "../../x.webp").find("outside") != std::string::npos);
    DOCTEST_CHECK(changed("means_l.webp", "gone.webp").find("does not exist") != std::string::npos);
    DOCTEST_CHECK(changed("\"codebook\"", "\"cookbook\"").find("cannot be understood") != std::string::npos);
    DOCTEST_CHECK(with_meta("{").find("not valid JSON") != std::string::npos);
    DOCTEST_CHECK(with_meta("[]") != "");
}

DOCTEST_TEST_CASE("an Inria output folder gives its highest iteration") {
    ScratchFolder scratch;
    for (const int iteration : {700, 30000, 7000})
        save_scene(
            scratch.path() / "point_cloud" / ("iteration_" + std::to_string(iteration)) / "point_cloud.ply",
            random_scene(static_cast<std::size_t>(iteration) / 100, 0, 1));
    DOCTEST_CHECK(load_scene(scratch.path()).gaussians.size() == 300);
    DOCTEST_CHECK(load_scene(scratch.path() / "point_cloud").gaussians.size() == 300);
    DOCTEST_CHECK(load_scene(scratch.path() / "point_cloud/iteration_700").gaussians.size() == 7);
}

DOCTEST_TEST_CASE("a folder with one scene file is that scene, with several it is asked which") {
    ScratchFolder scratch;
    const auto folder = scratch.path();
    DOCTEST_CHECK(error_of([&] { load_scene(folder); })->message().find("holds no scene") !=
                  std::string::npos);
    save_scene(folder / "scene.ply", random_scene(11, 0, 1));
    write_file(folder / "cameras.json", "[]");
    write_file(folder / "points3D.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n0 0 0\n");
    DOCTEST_CHECK(load_scene(folder).gaussians.size() == 11);
    DOCTEST_CHECK(scenes_in_folder(folder) == std::vector<std::filesystem::path>{folder / "scene.ply"});
    save_scene(folder / "edited.spz", random_scene(12, 0, 2));
    DOCTEST_CHECK(scenes_in_folder(folder).size() == 2);
    const auto several = error_of([&] { load_scene(folder); });
    DOCTEST_REQUIRE(several.has_value());
    DOCTEST_CHECK(several->message() == "the folder holds 2 scenes (edited.spz, scene.ply)");
    // A folder that is a scene by itself is not asked about.
    save_scene(folder / "point_cloud/iteration_7/point_cloud.ply", random_scene(13, 0, 3));
    DOCTEST_CHECK(load_scene(folder).gaussians.size() == 13);
    DOCTEST_CHECK(scenes_in_folder(folder).empty());
}

}  // namespace robustness_test
