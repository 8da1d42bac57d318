// 3DGS PLY: any header that says the same thing gives the same splats; what is written is read back bit for
// bit.
#include <algorithm>
#include <bit>
#include <functional>
#include <limits>

#include "engine/io/formats/ply/gaussian_ply.h"
#include "tests/unit/io/io_helpers.h"
#include "tests/unit/io/ply_columns.h"

namespace ply_test {

using namespace gse;
using namespace gse::test;

namespace {

void shuffle(std::vector<Column>& columns, Random& random) {
    for (std::size_t i = columns.size(); i > 1; --i) std::swap(columns[i - 1], columns[random.below(i)]);
}

void add_strange_columns(std::vector<Column>& columns, Random& random) {
    const char* types[] = {"uchar", "double", "short", "int", "float", "uint8", "float64", "int32"};
    const auto extra = random.below(4);
    for (std::uint64_t i = 0; i < extra; ++i)
        columns.push_back({"extra_" + std::to_string(i), types[random.below(8)],
                           [](std::size_t row) { return static_cast<double>(row % 100); }});
}

}  // namespace

DOCTEST_TEST_CASE("any order, encoding, line end and company of columns gives the same splats") {
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        Random random(seed);
        const int degree = static_cast<int>(random.below(4));
        const std::size_t count = 1 + random.below(300);
        const GaussianData data = random_gaussians(count, degree, seed);
        std::vector<Column> columns = columns_of(data);
        add_strange_columns(columns, random);
        shuffle(columns, random);
        for (Column& column : columns)
            if (column.type == "float" && random.below(8) == 0)
                column.type = random.below(2) == 0 ? "double" : "float32";
        FileShape shape;
        shape.encoding = static_cast<Encoding>(random.below(3));
        shape.line_end = random.below(3) == 0 ? "\r\n" : "\n";
        shape.face_first = random.below(3) == 0;
        shape.list_inside = random.below(4) == 0;
        shape.trailing_element = random.below(3) == 0;
        shape.padded = random.below(3) == 0;
        DOCTEST_CAPTURE(seed);
        const std::string file = make_ply(columns, count, shape);
        const Scene scene = parse_scene(as_bytes(file), "x.ply");
        DOCTEST_CHECK(same_bits(scene.gaussians, GaussianSet(data)));
        DOCTEST_CHECK(scene.info.warnings.empty());
    }
}

/// Checks that both readers say one thing about a file. `piecewise` tells whether the one that reads pieces
/// had to take it.
void check_both_readers(const ScratchFolder& scratch, const std::string& bytes, bool piecewise) {
    const auto path = scratch.path() / "pieces.ply";
    write_file(path, bytes);
    const auto whole = [&] { return io::parse_gaussian_ply(as_bytes(bytes)); };
    std::optional<Scene> pieces;
    const auto failure = error_of([&] { pieces = io::load_gaussian_ply(InputFile(path)); });
    DOCTEST_CHECK((pieces.has_value() || failure.has_value()) == piecewise);
    if (failure) {
        const auto same = error_of(whole);
        DOCTEST_REQUIRE(same.has_value());
        DOCTEST_CHECK(std::string(failure->what()) == same->what());
    } else if (pieces) {
        const Scene scene = whole();
        DOCTEST_CHECK(same_bits(pieces->gaussians, scene.gaussians));
        DOCTEST_CHECK(pieces->info.warnings == scene.info.warnings);
        DOCTEST_REQUIRE(pieces->labels.labels.size() == scene.labels.labels.size());
        for (std::size_t i = 0; i < scene.labels.labels.size(); ++i)
            DOCTEST_CHECK(*pieces->labels.labels[i].bits == *scene.labels.labels[i].bits);
    }
}

DOCTEST_TEST_CASE("a file that is read in pieces is read as one that is read as a whole") {
    ScratchFolder scratch;
    for (const std::size_t count :
         {1u, 128u, 4227u, 4228u, 4229u, 10001u}) {  // 4228 rows of 248 bytes are a piece
        const GaussianData data = random_gaussians(count, 3, count);
        std::vector<Column> columns = columns_of(data);
        for (const char* name : {"nx", "ny", "label"})
            columns.push_back({name, "float", [](std::size_t row) { return row % 3 == 0 ? 1.0 : 0.0; }});
        check_both_readers(scratch, make_ply(columns, count, {}), true);
    }
    const GaussianData data = random_gaussians(700, 1, 3);
    std::vector<Column> columns = columns_of(data);
    columns.front().type = "double";
    FileShape shape;
    shape.encoding = Encoding::Big;
    shape.line_end = "\r\n";
    const std::string good = make_ply(columns, 700, shape);
    check_both_readers(scratch, good, true);
    check_both_readers(scratch, good + "more", true);
    check_both_readers(scratch, good.substr(0, good.size() - 1),
                       false);  // the whole file tells how many rows there are
    std::string nameless = good;
    nameless.replace(nameless.find("opacity"), 7, "opaque_");
    check_both_readers(scratch, nameless, true);
    check_both_readers(
        scratch,
        std::string(good).insert(good.find("obj_info"), "comment " + std::string(70000, 'x') + "\r\n"),
        false);
    shape.list_inside = true;
    check_both_readers(scratch, make_ply(columns, 700, shape), false);
    shape = {};
    shape.face_first = true;
    check_both_readers(scratch, make_ply(columns, 700, shape), false);
    shape = {};
    shape.encoding = Encoding::Ascii;
    check_both_readers(scratch, make_ply(columns, 700, shape), false);
    check_both_readers(scratch, "ply", false);
    check_both_readers(scratch, "", false);
}

DOCTEST_TEST_CASE("a scene written as PLY comes back bit for bit") {
    ScratchFolder scratch;
    for (int degree = 0; degree <= 3; ++degree) {
        GaussianData data = random_gaussians(321, degree, 7 + static_cast<std::uint64_t>(degree));
        data.position[3] = std::numeric_limits<float>::quiet_NaN();
        data.opacity_logit[5] = std::numeric_limits<float>::infinity();
        data.log_scale[6] = -std::numeric_limits<float>::infinity();
        data.sh[9] = std::bit_cast<float>(0x7fa12345u);  // a signalling NaN with a payload
        data.sh[10] = -0.0f;
        Scene scene;
        scene.gaussians = GaussianSet(data);
        const auto path = scratch.path() / "scene.ply";
        save_scene(path, scene);
        const Scene again = load_scene(path);
        DOCTEST_CHECK(same_bits(again.gaussians, scene.gaussians));
        DOCTEST_CHECK(again.labels.labels.empty());
        save_scene(scratch.path() / "again.ply", again);
        DOCTEST_CHECK(read_file(path) == read_file(scratch.path() / "again.ply"));
    }
}

DOCTEST_TEST_CASE("the plain layout is Inria's: 62 floats for degree 3, normals zero") {
    ScratchFolder scratch;
    const Scene scene = random_scene(2, 3, 5);
    save_scene(scratch.path() / "a.ply", scene);
    const std::string bytes = read_file(scratch.path() / "a.ply");
    const std::size_t body = bytes.find("end_header\n") + 11;
    DOCTEST_CHECK(bytes.size() - body == 2 * 62 * 4);
    float row[62];
    std::memcpy(row, bytes.data() + body, sizeof row);
    DOCTEST_CHECK(row[3] == 0.0f);
    DOCTEST_CHECK(row[9] == scene.gaussians.sh()[3]);       // f_rest_0: red of coefficient 1
    DOCTEST_CHECK(row[9 + 15] == scene.gaussians.sh()[4]);  // f_rest_15: green of coefficient 1
    DOCTEST_CHECK(row[54] == scene.gaussians.opacity_logit()[0]);
    DOCTEST_CHECK(row[58] == scene.gaussians.rotation()[0]);
}

DOCTEST_TEST_CASE("labels travel in a PLY") {
    ScratchFolder scratch;
    Scene scene = random_scene(10, 1, 3);
    std::vector<float> weight(10);
    for (std::size_t i = 0; i < 10; ++i) weight[i] = static_cast<float>(i) / 10;
    const Label label = make_label("a red hat", weight, 0.45f);
    SaveOptions options;
    options.from_label = &label;
    save_scene(scratch.path() / "a.ply", scene, options);
    const Scene again = load_scene(scratch.path() / "a.ply");
    DOCTEST_CHECK(same_bits(again.gaussians, scene.gaussians));
    DOCTEST_REQUIRE(again.labels.labels.size() == 1);
    DOCTEST_CHECK(again.labels.labels[0].name == "a red hat");
    DOCTEST_CHECK(*again.labels.labels[0].weight == weight);
    DOCTEST_CHECK(*again.labels.labels[0].bits == *label.bits);

    SaveOptions bits_only;
    const std::vector<float> bits = {0, 1, 0, 1, 1, 0, 0, 0, 0, 1};
    bits_only.label = bits;
    save_scene(scratch.path() / "b.ply", scene, bits_only);
    const Scene plain = load_scene(scratch.path() / "b.ply");
    DOCTEST_REQUIRE(plain.labels.labels.size() == 1);
    DOCTEST_CHECK(*plain.labels.labels[0].weight == bits);
    DOCTEST_CHECK(plain.labels.labels[0].bits->at(3) == 1);

    const auto wrong_size = error_of([&] {
        SaveOptions short_options;
        short_options.label = std::span<const float>(bits).first(4);
        save_scene(scratch.path() / "c.ply", scene, short_options);
    });
    DOCTEST_CHECK(wrong_size.has_value());
    DOCTEST_CHECK(error_of([&] { save_scene(scratch.path() / "c.spz", scene, bits_only); }).has_value());
    DOCTEST_CHECK(!std::filesystem::exists(scratch.path() / "c.ply"));
    DOCTEST_CHECK(!std::filesystem::exists(scratch.path() / "c.spz"));
}

DOCTEST_TEST_CASE("label columns with other numbers than labels have are taken with a warning") {
    const GaussianData data = random_gaussians(6, 0, 1);
    const auto read = [&](const char* name, const std::vector<double>& values) {
        auto columns = columns_of(data);
        columns.push_back({name, "float", [&values](std::size_t row) { return values[row]; }});
        return parse_scene(as_bytes(make_ply(columns, 6, {})), "x.ply");
    };
    const Scene weights = read("label_weight", {0, 0.25, 1, 3, -2, std::nan("")});
    DOCTEST_CHECK(*weights.labels.labels.at(0).weight == std::vector<float>{0, 0.25f, 1, 1, 0, 0});
    DOCTEST_REQUIRE(weights.info.warnings.size() == 1);
    DOCTEST_CHECK(weights.info.warnings[0].find(
                      "\"label_weight\" has weights outside of 0 to 1 for 3 splats") != std::string::npos);
    const Scene ids = read("label", {0, 1, 2, 9, 0, 1});
    DOCTEST_CHECK(*ids.labels.labels.at(0).bits == std::vector<std::uint8_t>{0, 1, 1, 1, 0, 1});
    DOCTEST_CHECK(*ids.labels.labels.at(0).weight == std::vector<float>{0, 1, 1, 1, 0, 1});
    DOCTEST_REQUIRE(ids.info.warnings.size() == 1);
    DOCTEST_CHECK(ids.info.warnings[0].find("values other than 0 and 1 for 2 splats") != std::string::npos);
    DOCTEST_CHECK(read("label", {0, 1, 1, 0, 0, 1}).info.warnings.empty());
    DOCTEST_CHECK(read("label_weight", {0, 0.5, 1, 0.1, 0, 1}).info.warnings.empty());
}

DOCTEST_TEST_CASE("header comments are honoured, the last one wins") {
    const GaussianData data = random_gaussians(1, 0, 1);
    const std::string plain = make_ply(columns_of(data), 1, {});
    const auto with_comments = [&](const std::string& comments) {
        std::string text = plain;
        text.insert(text.find("element"), comments);
        return parse_scene(as_bytes(text), "x.ply").info;
    };
    DOCTEST_CHECK(with_comments("").up_known == false);
    DOCTEST_CHECK(with_comments("comment Vertical axis: y\n").up == Vec3{0, -1, 0});
    DOCTEST_CHECK(with_comments("comment VERTICAL axis: z\n").up == Vec3{0, 0, -1});
    DOCTEST_CHECK(with_comments("comment Vertical Axis: z\n").up == Vec3{0, 0, 1});  // nerfstudio's spelling
    DOCTEST_CHECK(with_comments("comment Vertical axis: y\ncomment Vertical axis: 0 0 2\n").up ==
                  Vec3{0, 0, 1});
    DOCTEST_CHECK(with_comments("comment Vertical axis: nonsense\n").up_known == false);
    DOCTEST_CHECK(with_comments("comment SplatRenderMode: mip\n").antialiased);
    DOCTEST_CHECK(with_comments("comment antialiased 1\n").antialiased);
    DOCTEST_CHECK(!with_comments("comment antialiased 1\ncomment splatrendermode: default\n").antialiased);
}

DOCTEST_TEST_CASE("comments are written back, compressed as well") {
    ScratchFolder scratch;
    for (const bool said : {true, false})
        for (const char* name : {"a.ply", "a.compressed.ply"}) {
            Scene scene = random_scene(1, 0, 2);
            scene.info.up = {0.6, 0, 0.8};
            scene.info.up_known = scene.info.antialiased = said;
            save_scene(scratch.path() / name, scene);
            const Scene again = load_scene(scratch.path() / name);
            DOCTEST_CAPTURE(name);
            DOCTEST_CHECK(again.info.up_known == said);
            DOCTEST_CHECK(again.info.antialiased == said);
            if (said) DOCTEST_CHECK(length(again.info.up - scene.info.up) < 1e-12);
        }
}

DOCTEST_TEST_CASE("surfels, byte colours and degree 4 are taken in") {
    const GaussianData data = random_gaussians(3, 0, 4);
    std::vector<Column> columns = columns_of(data);
    const auto drop = [&](const std::string& name) {
        std::erase_if(columns, [&](const Column& column) { return column.name == name; });
    };
    drop("scale_2");
    const Scene surfels = parse_scene(as_bytes(make_ply(columns, 3, {})), "x.ply");
    DOCTEST_CHECK(surfels.gaussians.log_scale()[2] < -13);
    DOCTEST_CHECK(surfels.info.warnings.size() == 1);

    for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2"}) drop(name);
    for (const char* name : {"red", "green", "blue"})
        columns.push_back({name, "uchar", [](std::size_t row) { return row == 0 ? 255.0 : 0.0; }});
    const Scene coloured = parse_scene(as_bytes(make_ply(columns, 3, {})), "x.ply");
    DOCTEST_CHECK(static_cast<double>(coloured.gaussians.sh()[0]) == doctest::Approx(sh_from_colour(1)));
    DOCTEST_CHECK(static_cast<double>(coloured.gaussians.sh()[3]) == doctest::Approx(sh_from_colour(0)));

    std::vector<Column> wide = columns_of(data);
    for (int i = 0; i < 72; ++i)
        wide.push_back(
            {"f_rest_" + std::to_string(i), "float", [i](std::size_t) { return static_cast<double>(i); }});
    const Scene cut = parse_scene(as_bytes(make_ply(wide, 3, {})), "x.ply");
    DOCTEST_CHECK(cut.gaussians.sh_degree() == 3);
    DOCTEST_CHECK(cut.gaussians.sh()[3] == 0.0f);   // red of the first coefficient
    DOCTEST_CHECK(cut.gaussians.sh()[4] == 24.0f);  // green: the file has 24 per channel
    DOCTEST_CHECK(cut.info.warnings.size() == 1);
}

DOCTEST_TEST_CASE("headers that cannot be right are refused") {
    const GaussianData data = random_gaussians(2, 0, 9);
    const std::string good = make_ply(columns_of(data), 2, {});
    const auto refused = [&](std::string text, const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
        const auto error = error_of([&] { parse_scene(as_bytes(text), "x.ply"); });
        return error ? std::string(error->what()) : std::string();
    };
    DOCTEST_CHECK(refused(good, "property float x", "property quux x").find("unknown type") !=
                  std::string::npos);
    DOCTEST_CHECK(refused(good, "element vertex 2", "element vertex two").find("count") != std::string::npos);
    DOCTEST_CHECK(refused(good, "element vertex 2", "element vertex 3").find("promises 3") !=
                  std::string::npos);
    DOCTEST_CHECK(refused(good, "element vertex 2", "element vertex 0").find("no splats") !=
                  std::string::npos);
    DOCTEST_CHECK(refused(good, "format binary_little_endian", "format morse").find("format") !=
                  std::string::npos);
    DOCTEST_CHECK(refused(good, "end_header", "end_headed").find("header") != std::string::npos);
    DOCTEST_CHECK(refused(good, "float opacity", "float opaque").find("opacity") != std::string::npos);
    DOCTEST_CHECK(
        refused(good, "element vertex 2\n", "element vertex 2\nproperty float f_rest_0\n").find("f_rest") !=
        std::string::npos);
    DOCTEST_CHECK(refused(good, "element vertex 2\n", "element vertex 2\nproperty float f_rest_4000000000\n")
                      .find("f_rest") != std::string::npos);
}

}  // namespace ply_test
