// Scenes as downloads bring them: packed, in archives, with capitals, in several files.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/base/json.h"
#include "engine/base/log.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/bytes/zip_archive.h"
#include "engine/io/files/free_path.h"
#include "tests/unit/io/io_helpers.h"

namespace packed_test {

using namespace gse;
using namespace gse::test;
namespace fs = std::filesystem;
using Files = std::vector<std::pair<std::string, std::string>>;

namespace {

constexpr std::uint64_t Any = std::uint64_t{1} << 40;

std::string zipped(const Files& files, bool deflate = true) {
    std::vector<io::ZipMember> members;
    for (const auto& [name, bytes] : files) members.push_back({name, bytes, deflate});
    return io::write_zip(members);
}

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Files of a .sog by their names.
Files unpacked(const std::string& sog) {
    const io::ZipReader zip(as_bytes(sog), "the archive");
    Files files;
    for (const char* name : {"meta.json", "means_l.webp", "means_u.webp", "scales.webp", "quats.webp",
                             "sh0.webp", "shN_centroids.webp", "shN_labels.webp"})
        if (zip.has(name)) files.emplace_back(name, text_of(zip.read(name, Any)));
    return files;
}

Files below(const std::string& folder, Files files) {
    for (auto& [name, bytes] : files) name = folder + "/" + name;
    return files;
}

Files joined(Files a, const Files& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

void write_files(const fs::path& folder, const Files& files) {
    for (const auto& [name, bytes] : files) write_file(folder / name, bytes);
}

std::string capitals(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), ::toupper);
    return text;
}

bool warns(const Scene& scene, const std::string& words) {
    const auto& warnings = scene.info.warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
}

Scene read(const std::string& bytes, const std::string& name) { return parse_scene(as_bytes(bytes), name); }

std::string refusal(const std::string& bytes, const std::string& name) {
    const auto error = error_of([&] { read(bytes, name); });
    return error ? std::string(error->what()) : "";
}

/// lod-meta.json that names these parts at its finest level.
std::string level_list(const std::vector<std::string>& parts, const std::string& environment) {
    nlohmann::json json{
        {"lodLevels", 1}, {"filenames", parts}, {"tree", {{"children", nlohmann::json::array()}}}};
    if (!environment.empty()) json["environment"] = environment;
    for (std::size_t i = 0; i < parts.size(); ++i)
        json["tree"]["children"].push_back({{"lods", {{"0", {{"file", i}, {"offset", 0}, {"count", 1}}}}}});
    return json.dump();
}

std::string sog_of(std::size_t count, int degree, std::uint64_t seed) {
    return written_as("sog", random_scene(count, degree, seed));
}

}  // namespace

DOCTEST_TEST_CASE("SOG: a codebook that begins with null has the value that its other codes say") {
    const std::string sog = sog_of(300, 2, 5);
    const Scene whole = read(sog, "a.sog");
    for (const char* part : {"scales", "sh0", "shN"}) {
        DOCTEST_CAPTURE(part);
        Files files = unpacked(sog);
        auto meta = parse_json(files.front().second, "meta");
        auto& codes = meta.at(part).at("codebook");
        const auto first = codes.at(0).get<float>();
        const double next = codes.at(1).get<double>(), last = codes.at(255).get<double>();
        const auto expected = static_cast<float>(next + (next - last) / 255);
        codes.at(0) = nullptr;
        files.front().second = meta.dump();
        const Scene patched = read(zipped(files), "a.sog");
        DOCTEST_CHECK(warns(patched, "codebook"));
        const bool sizes = std::string(part) == "scales";
        const auto before = sizes ? whole.gaussians.log_scale() : whole.gaussians.sh(),
                   after = sizes ? patched.gaussians.log_scale() : patched.gaussians.sh();
        DOCTEST_REQUIRE(before.size() == after.size());
        const std::size_t stride = sizes ? 1 : 27;
        std::size_t patched_values = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const bool own = sizes || (std::string(part) == "sh0") == (i % stride < 3);
            const bool lacking = own && before[i] == first;
            patched_values += lacking ? 1 : 0;
            DOCTEST_REQUIRE(after[i] == (lacking ? expected : before[i]));
        }
        DOCTEST_CHECK(patched_values > 0);
        meta.at(part).at("codebook").at(7) = nullptr;  // any other place says nothing
        files.front().second = meta.dump();
        DOCTEST_CHECK(refusal(zipped(files), "a.sog").find("cannot be understood") != std::string::npos);
    }
    DOCTEST_CHECK_FALSE(warns(whole, "codebook"));
}

DOCTEST_TEST_CASE("SOG: the reported file with a null in a codebook opens") {
    const auto path = data_folder() / "odd/04_sog_codebook_null/sog_codebook_null.sog";
    if (!available(path)) return;
    const Scene scene = load_scene(path);
    DOCTEST_CHECK(scene.gaussians.size() == 40);
    const auto sizes = scene.gaussians.log_scale();
    const double next = -4.95856237411499, last = -2.002793788909912;
    DOCTEST_CHECK(*std::min_element(sizes.begin(), sizes.end()) ==
                  static_cast<float>(next + (next - last) / 255));
    DOCTEST_CHECK(compute_statistics(scene.gaussians).nan_rows == 0);
    DOCTEST_CHECK(warns(scene, "codebook"));
}

DOCTEST_TEST_CASE(
    "streamed SOG: bundled and unpacked parts, and the environment, from folders and archives") {
    const std::string first = sog_of(20, 1, 1), second = sog_of(30, 2, 2), sky = sog_of(7, 0, 3);
    const Scene alone = read(sky, "a.sog");
    for (const bool bundled : {false, true}) {
        const std::string environment = bundled ? "env.sog" : "env/meta.json";
        Files files{{"lod-meta.json", level_list({"0_0.sog", "parts/0_1/meta.json"}, environment)},
                    {"0_0.sog", first}};
        files = joined(files, below("parts/0_1", unpacked(second)));
        files = joined(files, bundled ? Files{{"env.sog", sky}} : below("env", unpacked(sky)));
        ScratchFolder scratch;
        write_files(scratch.path() / "scene", files);
        const auto check = [&](const Scene& scene) {
            DOCTEST_CHECK(scene.gaussians.size() == 57);
            DOCTEST_CHECK(scene.gaussians.sh_degree() == 2);
            DOCTEST_CHECK(warns(scene, "the environment of 7 splats"));
            DOCTEST_CHECK(warns(scene, "only the finest"));
            DOCTEST_CHECK(same_bits(scene.gaussians.position().last(21), alone.gaussians.position()));
        };
        check(load_scene(scratch.path() / "scene"));
        check(load_scene(scratch.path() / "scene/lod-meta.json"));
        check(read(zipped(files), "scene.zip"));
        check(read(zipped(files), "scene.sog"));
        check(read(zipped(below("a folder", files)), "scene.zip"));
    }
}

DOCTEST_TEST_CASE(
    "streamed SOG: an environment that cannot be read is told, and the scene opens without it") {
    const Files part{{"0_0.sog", sog_of(20, 1, 1)}};
    const auto with = [&](const std::string& name, const Files& more = {}) {
        return zipped(joined(joined(part, {{"lod-meta.json", level_list({"0_0.sog"}, name)}}), more));
    };
    for (const auto& [name, more] :
         {std::pair{std::string("env/meta.json"), Files{}}, {"env.sog", {{"env.sog", "no zip"}}}}) {
        const Scene scene = read(with(name, more), "a.zip");
        DOCTEST_CHECK(scene.gaussians.size() == 20);
        DOCTEST_CHECK(warns(scene, "the environment of the scene is left out"));
    }
    DOCTEST_CHECK(refusal(with("../env.sog"), "a.zip").find("outside of its folder") != std::string::npos);
    DOCTEST_CHECK_FALSE(warns(read(with(""), "a.zip"), "environment"));
}

DOCTEST_TEST_CASE("a scene in a zip archive opens, whatever lies around it") {
    const Scene scene = random_scene(25, 1, 9);
    for (const std::string& format : writable_formats())
        for (const bool deflate : {false, true}) {
            DOCTEST_CAPTURE(format);
            const std::string bytes = written_as(format, scene);
            const Files files{{"read me.txt", "hello"},
                              {"export/scene." + format, bytes},
                              {"export/cameras.json", "[]"},
                              {"export/thumb.webp", "RIFF"},
                              {"__MACOSX/export/._scene." + format, "AppleDouble"},
                              {"export/.hidden.ply", "ply"}};
            const Scene expected = read(bytes, "scene." + format);
            for (const char* name : {"download.zip", "DOWNLOAD.ZIP", "scene", "scene.ply"}) {
                const Scene again = read(zipped(files, deflate), name);
                DOCTEST_CHECK(same_bits(again.gaussians, expected.gaussians));
                DOCTEST_CHECK(again.info.format == format);
            }
        }
    const std::string meta = R"({"name": "no list of textures"})";
    const std::string ply = written_as("ply", scene);
    DOCTEST_CHECK(read(zipped({{"meta.json", meta}, {"a.ply", ply}}), "a.zip").gaussians.size() == 25);
    DOCTEST_CHECK(read(zipped({{"dir\\a.ply", ply}}), "a.zip").gaussians.size() == 25);
    const std::string sog = written_as("sog", scene);
    DOCTEST_CHECK(read(zipped(below("x/y", unpacked(sog))), "a.zip").gaussians.size() == 25);
    // A point cloud beside the scene is none.
    const std::string cloud = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n";
    DOCTEST_CHECK(read(zipped({{"input.ply", cloud}, {"a.ply", ply}}), "a.zip").gaussians.size() == 25);
}

DOCTEST_TEST_CASE("several scenes in an archive are named; none is named too; a training gives its last") {
    const std::string a = written_as("ply", random_scene(3, 0, 1)),
                      b = written_as("spz", random_scene(4, 0, 1));
    const std::string two = refusal(zipped({{"one/a.ply", a}, {"b.spz", b}}), "a.zip");
    DOCTEST_CHECK(two.find("the archive holds 2 scenes (one/a.ply, b.spz)") != std::string::npos);
    DOCTEST_CHECK(two.find("open the one you mean") != std::string::npos);
    const std::string none = refusal(zipped({{"a.txt", "hello"}, {"b/c.obj", "v"}}), "a.zip");
    DOCTEST_CHECK(none.find("the archive holds no scene that can be read (a.txt, b/c.obj)") !=
                  std::string::npos);
    DOCTEST_CHECK(refusal("PK\5\6" + std::string(18, '\0'), "a.zip").find("the archive is empty") !=
                  std::string::npos);
    const std::string cloud =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n0 0 0\n";
    DOCTEST_CHECK(refusal(zipped({{"points.ply", cloud}}), "a.zip").find("a point cloud") !=
                  std::string::npos);
    const std::string sogs =
        refusal(zipped(joined(below("a", unpacked(sog_of(3, 0, 1))), below("b", unpacked(sog_of(4, 0, 2))))),
                "a.zip");
    DOCTEST_CHECK(sogs.find("2 scenes (a/meta.json, b/meta.json)") != std::string::npos);
    Files training{{"out/input.ply", cloud}, {"out/cameras.json", "[]"}};
    for (const int iteration : {700, 30000, 7000})
        training.emplace_back(
            "out/point_cloud/iteration_" + std::to_string(iteration) + "/point_cloud.ply",
            written_as("ply", random_scene(static_cast<std::size_t>(iteration) / 100, 0, 1)));
    DOCTEST_CHECK(read(zipped(training), "out.zip").gaussians.size() == 300);
}

DOCTEST_TEST_CASE("a scene in a gzip stream opens, under any name") {
    const Scene scene = random_scene(25, 2, 9);
    for (const std::string& format : writable_formats()) {
        DOCTEST_CAPTURE(format);
        const std::string bytes = written_as(format, scene), packed = io::deflate_gzip(bytes);
        const Scene expected = read(bytes, "a." + format);
        for (const std::string& name :
             {"a." + format + ".gz", "a." + format, "A." + capitals(format) + ".GZ"})
            DOCTEST_CHECK(same_bits(read(packed, name).gaussians, expected.gaussians));
        const std::string inner = zipped({{"a." + format + ".gz", packed}});
        DOCTEST_CHECK(same_bits(read(inner, "a.zip").gaussians, expected.gaussians));
        DOCTEST_CHECK(same_bits(read(io::deflate_gzip(inner), "a.zip").gaussians, expected.gaussians));
    }
    DOCTEST_CHECK(refusal(io::deflate_gzip("hello"), "a.ply").find("the name says ply") != std::string::npos);
    DOCTEST_CHECK(refusal(io::deflate_gzip("hello"), "a.txt.gz").find("no scene format") !=
                  std::string::npos);
    const std::string splat = io::deflate_gzip(written_as("splat", scene));
    DOCTEST_CHECK(refusal(splat.substr(0, splat.size() - 9), "a.splat").find("cut off") != std::string::npos);
}

DOCTEST_TEST_CASE("what is no scene is named") {
    std::string tar(512, '\0');
    tar.replace(257, 5, "ustar");
    for (const auto& [bytes, what] : {std::pair{std::string("7z\xbc\xaf\x27\x1c\0\4", 8), "7z archive"},
                                      {std::string("Rar!\x1a\7\1\0", 8), "RAR archive"},
                                      {std::string("\x28\xb5\x2f\xfd more", 9), "zstd"},
                                      {tar, "tar archive"},
                                      {io::deflate_gzip(tar), "tar archive"},
                                      {std::string("<!DOCTYPE html><html><body>Sign in"), "a web page"},
                                      {std::string("glTF\2\0\0\0", 8), "glTF"}})
        for (const char* name : {"scene.ply", "scene.splat", "download"}) {
            DOCTEST_CAPTURE(what);
            DOCTEST_CHECK(refusal(bytes, name).find(what) != std::string::npos);
        }
}

DOCTEST_TEST_CASE("gzip members one after the other are one stream") {
    const std::string spz = written_as("spz", random_scene(400, 1, 3));
    const std::vector<std::byte> flat = io::inflate_gzip(as_bytes(spz), Any);
    const std::string raw = text_of(flat);
    const GaussianSet expected = read(spz, "a.spz").gaussians;
    for (const std::size_t cut :
         {std::size_t{0}, std::size_t{3}, std::size_t{16}, raw.size() / 2, raw.size()}) {
        DOCTEST_CAPTURE(cut);
        const std::string members = io::deflate_gzip(raw.substr(0, cut)) + io::deflate_gzip(raw.substr(cut));
        DOCTEST_CHECK(same_bits(read(members, "a.spz").gaussians, expected));
        DOCTEST_CHECK(same_bits(read(members + std::string(9, '\0'), "a.spz").gaussians, expected));
    }
    const std::string ply = written_as("ply", random_scene(40, 1, 3));
    const std::string halves = io::deflate_gzip(ply.substr(0, 999)) + io::deflate_gzip(ply.substr(999));
    DOCTEST_CHECK(read(halves, "a.ply").gaussians.size() == 40);
}

DOCTEST_TEST_CASE("archives and streams that ask for gigabytes are refused before anything is kept") {
    std::string bomb;
    const std::string member = io::deflate_gzip(std::string(std::size_t{16} << 20, '\0'));
    for (int i = 0; i < 20; ++i) bomb += member;
    DOCTEST_CHECK(refusal(bomb, "a.ply.gz").find("cannot hold so much") != std::string::npos);
    DOCTEST_CHECK(refusal(zipped({{"a.ply.gz", bomb}}), "a.zip").find("cannot hold so much") !=
                  std::string::npos);
    std::string archive = zipped({{"a.splat", std::string(64000, '\0')}});
    const std::uint32_t size = 1000000000;
    std::memcpy(archive.data() + archive.rfind("a.splat") - 22, &size, sizeof size);  // in the directory
    DOCTEST_CHECK(refusal(archive, "a.zip").find("cannot hold so much") != std::string::npos);
    std::string matryoshka = written_as("ply", random_scene(2, 0, 1));
    for (int i = 0; i < 10; ++i) matryoshka = io::deflate_gzip(matryoshka);
    DOCTEST_CHECK(refusal(matryoshka, "a.ply").find("within each other") != std::string::npos);
    const std::string whole = zipped({{"a.ply", written_as("ply", random_scene(2, 0, 1))}});
    for (std::size_t cut = 4; cut < whole.size(); cut += 7)
        DOCTEST_CHECK(refusal(whole.substr(0, cut), "a.zip") != "");
}

DOCTEST_TEST_CASE("the reported downloads open as what they hold") {
    const auto folder = data_folder() / "odd/19_wrapped_downloads";
    if (!available(folder)) return;
    const GaussianSet ply = load_scene(folder / "gz02_gzipped_named.ply").gaussians;
    DOCTEST_CHECK(ply.size() == 8);
    for (const char* name : {"gz01_scene.ply.gz", "zip01_download.zip", "zip02_project.ssproj"})
        DOCTEST_CHECK(same_bits(load_scene(folder / name).gaussians, ply));
    const Scene splat = load_scene(folder / "spl01_gzip_transport.splat");
    DOCTEST_CHECK(splat.info.format == "splat");
    DOCTEST_CHECK(same_bits(splat.gaussians.position(), ply.position()));
}

DOCTEST_TEST_CASE("a folder of one packed scene is that scene; a plain one beside it goes first") {
    ScratchFolder scratch;
    write_file(scratch.path() / "Scene.PLY.GZ", io::deflate_gzip(written_as("ply", random_scene(5, 0, 1))));
    write_file(scratch.path() / "notes.txt.gz", io::deflate_gzip("hello"));
    write_file(scratch.path() / "images.zip", zipped({{"a.png", "no"}}));
    DOCTEST_CHECK(load_scene(scratch.path()).gaussians.size() == 5);
    save_scene(scratch.path() / "other.ply", random_scene(6, 0, 1));
    DOCTEST_CHECK(load_scene(scratch.path()).gaussians.size() == 6);
    DOCTEST_CHECK(scenes_in_folder(scratch.path()).size() == 1);
}

DOCTEST_TEST_CASE("a SuperSplat project gives its parts in their places") {
    const Scene first = random_scene(12, 3, 1), second = random_scene(5, 3, 2);
    const auto project = [&](const nlohmann::json& a, const nlohmann::json& b) {
        return read(zipped({{"document.json", nlohmann::json{{"version", 0}, {"splats", {a, b}}}.dump()},
                            {"splat_0.ply", written_as("ply", first)},
                            {"splat_1.ply", written_as("ply", second)}}),
                    "work.ssproj");
    };
    const nlohmann::json usual{
        {"name", "a"},     {"position", {0, 0, 0}}, {"rotation", {0, 0, 1, 0}}, {"scale", {1, 1, 1}},
        {"visible", true}, {"saturation", 1},       {"tintClr", {1, 1, 1, 1}}};
    const Scene both = project(usual, nlohmann::json{{"name", "b"}});
    DOCTEST_CHECK(both.gaussians.size() == 17);
    DOCTEST_CHECK(same_bits(both.gaussians.position().first(36), first.gaussians.position()));
    DOCTEST_CHECK(same_bits(both.gaussians.sh().last(240), second.gaussians.sh()));
    DOCTEST_CHECK(both.info.warnings.empty());
    nlohmann::json hidden = usual, graded = usual, moved = usual;
    hidden["visible"] = false;
    graded["saturation"] = 0.5;
    DOCTEST_CHECK(project(usual, hidden).gaussians.size() == 12);
    DOCTEST_CHECK(warns(project(usual, hidden), "a hidden part"));
    DOCTEST_CHECK(warns(project(graded, usual), "colour settings"));
    // Half a turn about x and then about z is one about y; y points up there and down in the file.
    moved["rotation"] = {1, 0, 0, 0};
    moved["position"] = {1, 2, 3};
    moved["scale"] = {2, 2, 2};
    const Scene turned = project(moved, hidden);
    constexpr double Rounding = 1e-5;
    for (std::size_t i = 0; i < 36; i += 3) {
        const auto before = first.gaussians.position().subspan(i, 3),
                   after = turned.gaussians.position().subspan(i, 3);
        DOCTEST_CHECK(after[0] == doctest::Approx(-1 - 2 * before[0]).epsilon(Rounding));
        DOCTEST_CHECK(after[1] == doctest::Approx(-2 + 2 * before[1]).epsilon(Rounding));
        DOCTEST_CHECK(after[2] == doctest::Approx(3 - 2 * before[2]).epsilon(Rounding));
        DOCTEST_CHECK(turned.gaussians.log_scale()[i] ==
                      doctest::Approx(first.gaussians.log_scale()[i] + std::log(2.0)).epsilon(Rounding));
    }
    // What is seen from a side that is turned along is as before: signs of half a turn about y, band by band.
    const float signs[16] = {1, 1, -1, -1, -1, -1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1};
    GaussianData expected = first.gaussians.to_data();
    for (std::size_t i = 0; i < expected.sh.size(); ++i) expected.sh[i] *= signs[i / 3 % 16];
    DOCTEST_CHECK(largest_difference(turned.gaussians.sh(), expected.sh) < Rounding);
    for (const nlohmann::json& broken :
         {nlohmann::json{{"rotation", {0, 0, 0, 0}}}, nlohmann::json{{"scale", {1, -1, 1}}},
          nlohmann::json{{"scale", {1, 1e-300, 1}}}, nlohmann::json{{"scale", {1e200, 1e200, 1}}},
          nlohmann::json{{"position", "here"}}, nlohmann::json(3)})
        DOCTEST_CHECK(error_of([&] { project(usual, broken); }));
}

DOCTEST_TEST_CASE("names in capitals are those of scenes too") {
    ScratchFolder scratch;
    const Scene scene = random_scene(6, 1, 4);
    for (const std::string& format : writable_formats()) {
        const auto path = scratch.path() / ("SCENE." + capitals(format));
        save_scene(path, scene);
        DOCTEST_CHECK(load_scene(path).info.format == format);
        fs::create_directories(scratch.path() / format);
        fs::rename(path, scratch.path() / format / path.filename());
        DOCTEST_CHECK(load_scene(scratch.path() / format).gaussians.size() == 6);
        DOCTEST_CHECK(first_free(scratch.path() / format / path.filename()).filename() ==
                      "SCENE-2." + capitals(format));
    }
    const auto in_capitals = [](Files files) {
        for (auto& [name, bytes] : files) name = capitals(name);
        return files;
    };
    const Files sog = unpacked(written_as("sog", scene));
    write_files(scratch.path() / "sog", in_capitals(sog));
    DOCTEST_CHECK(load_scene(scratch.path() / "sog").gaussians.size() == 6);
    DOCTEST_CHECK(load_scene(scratch.path() / "sog/META.JSON").gaussians.size() == 6);
    const Files levels = joined(below("0_0", sog), {{"lod-meta.json", level_list({"0_0/meta.json"}, "")}});
    write_files(scratch.path() / "lod", in_capitals(levels));
    DOCTEST_CHECK(load_scene(scratch.path() / "lod").gaussians.size() == 6);
    DOCTEST_CHECK(load_scene(scratch.path() / "lod/LOD-META.JSON").gaussians.size() == 6);
    DOCTEST_CHECK(read(zipped(in_capitals(levels)), "A.ZIP").gaussians.size() == 6);
    DOCTEST_CHECK(read(zipped(in_capitals(sog)), "A.SOG").gaussians.size() == 6);
    write_files(scratch.path() / "out",
                {{"POINT_CLOUD/ITERATION_7/POINT_CLOUD.PLY", written_as("ply", scene)}});
    DOCTEST_CHECK(load_scene(scratch.path() / "out").gaussians.size() == 6);
}

}  // namespace packed_test
