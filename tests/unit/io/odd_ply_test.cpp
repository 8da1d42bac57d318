// PLY files of other programs: halves, bytes, prefixes, georeferenced doubles, 3D filters, anchors, bad rows.
#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/unit/io/io_helpers.h"
#include "tests/unit/io/ply_columns.h"

namespace odd_ply_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr double FloatRounding = 1e-6;  // of values below 8
constexpr double LogitRounding = 1e-4;  // of an opacity near 0 or 1, through the float logit
constexpr std::size_t Rows = 40;

std::filesystem::path odd_folder() { return data_folder() / "odd"; }

Scene read(const std::string& bytes) { return parse_scene(as_bytes(bytes), "x.ply"); }

std::string refusal(const std::string& bytes) {
    const auto error = error_of([&] { read(bytes); });
    return error ? std::string(error->what()) : std::string();
}

bool says(const std::vector<std::string>& warnings, const std::string& phrase) {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& warning) { return warning.find(phrase) != std::string::npos; });
}

/// The column of that name, to be given another type or other values.
Column& column(std::vector<Column>& columns, const std::string& name) {
    return *std::find_if(columns.begin(), columns.end(), [&](const Column& one) { return one.name == name; });
}

/// Bits of the nearest 16-bit float of a normal value.
std::uint16_t half_bits(double value) {
    if (value == 0) return 0;
    int exponent = 0;
    const double mantissa = std::frexp(std::abs(value), &exponent);
    const int bits = ((exponent + 14) << 10) + static_cast<int>(std::lround((mantissa * 2 - 1) * 1024));
    return static_cast<std::uint16_t>(bits | (value < 0 ? 0x8000 : 0));
}

/// Checks a file of the shared folder against the values that truth.json states for its rows, which are
/// columns of the file. `apart` is the largest difference allowed.
void check_truth(const Scene& scene, const std::filesystem::path& truth_file, double apart) {
    const auto truth = nlohmann::json::parse(read_file(truth_file));
    const GaussianSpans set = scene.gaussians.spans();
    DOCTEST_REQUIRE(set.size == truth.size());
    const std::size_t stride = set.sh.size() / set.size, rest = stride / 3 - 1;
    double worst = 0;
    for (std::size_t row = 0; row < set.size; ++row) {
        const auto compare = [&](const std::string& name, float value) {
            worst = std::max(worst, std::abs(static_cast<double>(value) - truth[row].at(name).get<double>()));
        };
        for (std::size_t i = 0; i < 3; ++i) {
            compare("f_dc_" + std::to_string(i), set.sh[row * stride + i]);
            compare("scale_" + std::to_string(i), set.log_scale[row * 3 + i]);
        }
        for (std::size_t i = 0; i < 4; ++i) compare("rot_" + std::to_string(i), set.rotation[row * 4 + i]);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < rest; ++k)
                compare("f_rest_" + std::to_string(c * rest + k), set.sh[row * stride + (k + 1) * 3 + c]);
        compare("opacity", set.opacity_logit[row]);
    }
    DOCTEST_CHECK(worst <= apart);
}

}  // namespace

// Halves

DOCTEST_TEST_CASE("ushort columns of splats are halves") {
    const auto folder = odd_folder() / "06_half_ushort_ply";
    if (available(folder)) {
        const Scene scene = load_scene(folder / "ply01_half_ushort.ply");
        check_truth(scene, folder / "ply01.truth.json", 0);  // every half is a float
        DOCTEST_CHECK(says(scene.info.warnings, "halves"));
        DOCTEST_CHECK(scene.gaussians.position()[0] == -0.00913238525390625f);
    }
    GaussianData data = random_gaussians(Rows, 1, 6);
    for (auto* values : {&data.position, &data.log_scale, &data.rotation, &data.opacity_logit, &data.sh})
        for (float& value : *values) value = std::round(value * 64) / 64 + 0.0f;  // no -0
    for (const Encoding encoding : {Encoding::Ascii, Encoding::Little, Encoding::Big})
        for (const char* type : {"ushort", "uint16", "short"})
            for (const bool float_positions : {false, true}) {
                std::vector<Column> columns = columns_of(data);
                for (Column& one : columns) {
                    if (float_positions && one.name.size() == 1) continue;
                    one.type = type;
                    one.value = [exact = one.value,
                                 is_signed = std::string(type) == "short"](std::size_t row) {
                        const std::uint16_t bits = half_bits(exact(row));
                        return is_signed ? static_cast<double>(static_cast<std::int16_t>(bits)) : bits;
                    };
                }
                FileShape shape;
                shape.encoding = encoding;
                const Scene scene = read(make_ply(columns, Rows, shape));
                DOCTEST_CHECK(same_bits(scene.gaussians, GaussianSet(data)));
            }
}

// Whole numbers

DOCTEST_TEST_CASE("opacities of whole numbers are shares of the largest") {
    const GaussianData data = random_gaussians(Rows, 0, 7);
    for (const auto& [type, full] : {std::pair{"uchar", 255.0}, std::pair{"int", 255.0},
                                     std::pair{"ushort", 65535.0}, std::pair{"uchar", 1.0}}) {
        std::vector<Column> columns = columns_of(data);
        Column& opacity = column(columns, "opacity");
        opacity.type = type;
        opacity.value = [most = full](std::size_t row) {
            return std::floor(most * static_cast<double>(row) / (Rows - 1));
        };
        const Scene scene = read(make_ply(columns, Rows, {}));
        DOCTEST_CAPTURE(type);
        DOCTEST_CAPTURE(full);
        double worst = 0;
        for (std::size_t row = 0; row < Rows; ++row)
            worst = std::max(
                worst, std::abs(sigmoid(scene.gaussians.opacity_logit()[row]) - opacity.value(row) / full));
        DOCTEST_CHECK(worst < LogitRounding);
        DOCTEST_CHECK(std::isfinite(scene.gaussians.opacity_logit()[Rows - 1]));
        DOCTEST_CHECK(says(scene.info.warnings, "opacities are whole numbers"));
    }
}

DOCTEST_TEST_CASE("colours of bytes are colours, in f_dc too; sizes of bytes are refused") {
    const GaussianData data = random_gaussians(Rows, 1, 8);
    std::vector<Column> columns = columns_of(data);
    for (int i = 0; i < 3; ++i) {
        Column& colour = column(columns, "f_dc_" + std::to_string(i));
        colour.type = "uchar";
        colour.value = [i](std::size_t row) {
            return static_cast<double>(row * 6 + static_cast<std::size_t>(i));
        };
    }
    const Scene scene = read(make_ply(columns, Rows, {}));
    DOCTEST_CHECK(static_cast<double>(scene.gaussians.sh()[12 * 5 + 2]) ==
                  doctest::Approx(sh_from_colour(32.0 / 255)));
    DOCTEST_CHECK(scene.gaussians.sh()[12 * 5 + 3] == data.sh[12 * 5 + 3]);
    DOCTEST_CHECK(says(scene.info.warnings, "f_dc"));
    for (Column& one : columns)
        if (one.name.starts_with("f_rest_")) {
            one.type = "uchar";
            one.value = [](std::size_t row) { return row == 0 ? 0.0 : row == 1 ? 255.0 : 128.0; };
        }
    const Scene bytes = read(make_ply(columns, Rows, {}));  // as compressed PLY files store them
    DOCTEST_CHECK(bytes.gaussians.sh()[3] == -4.0f);
    DOCTEST_CHECK(bytes.gaussians.sh()[12 + 3] == 4.0f);
    DOCTEST_CHECK(std::abs(bytes.gaussians.sh()[24 + 3]) < 0.02f);
    for (const char* name : {"scale_1", "rot_2"}) {
        std::vector<Column> odd = columns_of(data);
        column(odd, name).type = "uchar";
        column(odd, name).value = [](std::size_t) { return 7.0; };
        DOCTEST_CHECK(refusal(make_ply(odd, Rows, {})).find(name) != std::string::npos);
    }
}

DOCTEST_TEST_CASE("red, green and blue of 16 bits reach to 65535") {
    const GaussianData data = random_gaussians(Rows, 0, 9);
    for (const double full : {255.0, 65535.0}) {
        std::vector<Column> columns = columns_of(data);
        std::erase_if(columns, [](const Column& one) { return one.name.starts_with("f_dc_"); });
        for (const char* name : {"red", "green", "blue"})
            columns.push_back({name, "ushort", [full](std::size_t row) { return row == 0 ? full : 0.0; }});
        const Scene scene = read(make_ply(columns, Rows, {}));
        DOCTEST_CHECK(static_cast<double>(scene.gaussians.sh()[0]) == doctest::Approx(sh_from_colour(1)));
        DOCTEST_CHECK(static_cast<double>(scene.gaussians.sh()[3]) == doctest::Approx(sh_from_colour(0)));
    }
}

// Prefixes

DOCTEST_TEST_CASE("columns with CloudCompare's prefixes are read") {
    const auto folder = odd_folder() / "08_cloudcompare_scalar_prefix";
    if (available(folder))
        for (const char* name :
             {"ply03_cloudcompare_scalar.ply", "ply03b_cloudcompare_scalar_scal.ply", "ply03c_scal.ply"}) {
            const Scene scene = load_scene(folder / name);
            check_truth(scene, folder / "ply03.truth.json", FloatRounding);
            DOCTEST_CHECK(says(scene.info.warnings, "CloudCompare"));
        }
    const GaussianData data = random_gaussians(Rows, 2, 8);
    for (const std::string prefix : {"scalar_", "scal_", "scalar_scal_", "scalar_scalar_"})
        for (const bool all : {false, true}) {
            std::vector<Column> columns = columns_of(data);
            columns.push_back({"label", "float", [](std::size_t row) { return row % 2 == 0 ? 1.0 : 0.0; }});
            for (Column& one : columns)
                if (all || one.name.size() > 1) one.name.insert(0, prefix);
            const Scene scene = read(make_ply(columns, Rows, {}));
            DOCTEST_CHECK(same_bits(scene.gaussians, GaussianSet(data)));
            DOCTEST_REQUIRE(scene.labels.labels.size() == 1);
        }
}

DOCTEST_TEST_CASE("a column without the prefix is taken before one with it") {
    const GaussianData data = random_gaussians(Rows, 1, 9);
    std::vector<Column> columns;
    for (const char* name : {"scalar_opacity", "scalar_f_rest_4", "scal_x"})
        columns.push_back({name, "float", [](std::size_t) { return 99.0; }});
    for (Column& one : columns_of(data)) columns.push_back(one);
    const Scene scene = read(make_ply(columns, Rows, {}));
    DOCTEST_CHECK(same_bits(scene.gaussians, GaussianSet(data)));
    DOCTEST_CHECK_FALSE(says(scene.info.warnings, "CloudCompare"));
}

// 3D filter

DOCTEST_TEST_CASE("the 3D filter of Mip-Splatting becomes part of sizes and opacities") {
    const GaussianData data = random_gaussians(Rows, 0, 14);
    for (const std::string name : {"filter_3D", "scalar_filter_3D"}) {
        std::vector<Column> columns = columns_of(data);
        columns.push_back({name, "float", [](std::size_t row) { return 0.01 * static_cast<double>(row); }});
        const Scene scene = read(make_ply(columns, Rows, {}));
        double worst_size = 0, worst_opacity = 0;
        for (std::size_t row = 0; row < Rows; ++row) {
            const double filter = static_cast<double>(static_cast<float>(0.01 * static_cast<double>(row)));
            double before = 1, after = 1;
            for (std::size_t i = 0; i < 3; ++i) {
                const double size = std::exp(static_cast<double>(data.log_scale[row * 3 + i]));
                const double filtered = std::sqrt(size * size + filter * filter);
                before *= size * size;
                after *= filtered * filtered;
                worst_size = std::max(
                    worst_size,
                    std::abs(std::exp(static_cast<double>(scene.gaussians.log_scale()[row * 3 + i])) -
                             filtered));
            }
            const double opacity = sigmoid(data.opacity_logit[row]) * std::sqrt(before / after);
            worst_opacity =
                std::max(worst_opacity, std::abs(sigmoid(scene.gaussians.opacity_logit()[row]) - opacity));
        }
        DOCTEST_CHECK(worst_size < FloatRounding);
        DOCTEST_CHECK(worst_opacity < FloatRounding);
        DOCTEST_CHECK(scene.gaussians.log_scale()[0] == data.log_scale[0]);  // a filter of 0 changes nothing
        DOCTEST_CHECK(scene.gaussians.opacity_logit()[0] == data.opacity_logit[0]);
        DOCTEST_CHECK(says(scene.info.warnings, "filter_3D"));
    }
}

// Headers and rows

DOCTEST_TEST_CASE("a byte order mark before the header is passed over") {
    const auto file = odd_folder() / "27_bom_ply/ply15_bom_crlf_ascii.ply";
    if (available(file)) DOCTEST_CHECK(load_scene(file).gaussians.size() == 6);
    const GaussianData data = random_gaussians(Rows, 1, 27);
    ScratchFolder scratch;
    for (const Encoding encoding : {Encoding::Ascii, Encoding::Little, Encoding::Big})
        for (const char* line_end : {"\n", "\r\n"}) {
            FileShape shape;
            shape.encoding = encoding;
            shape.line_end = line_end;
            const std::string bytes = "\xEF\xBB\xBF" + make_ply(columns_of(data), Rows, shape);
            DOCTEST_CHECK(same_bits(read(bytes).gaussians, GaussianSet(data)));
            write_file(scratch.path() / "a.ply", bytes);
            DOCTEST_CHECK(same_bits(load_scene(scratch.path() / "a.ply").gaussians, GaussianSet(data)));
        }
    Scene scene;
    scene.gaussians = GaussianSet(data);
    const std::string packed = "\xEF\xBB\xBF" + written_as("compressed.ply", scene);
    DOCTEST_CHECK(read(packed).info.format == "compressed.ply");
    DOCTEST_CHECK(refusal("\xEF\xBB\xBFsomething else").find("PLY header") == std::string::npos);
}

namespace {

/// A file whose rows hold `more` bytes that its header does not name.
std::string with_longer_rows(const GaussianData& data, std::size_t count, std::size_t more,
                             const FileShape& shape) {
    std::vector<Column> columns = columns_of(data);
    for (std::size_t i = 0; i < more; ++i)
        columns.insert(columns.begin() + 6,
                       {"unnamed", "uchar", [](std::size_t row) { return static_cast<double>(row % 251); }});
    std::string bytes = make_ply(columns, count, shape);
    const std::string line = "property uchar unnamed" + shape.line_end;
    for (std::size_t at; (at = bytes.find(line)) != std::string::npos;) bytes.erase(at, line.size());
    return bytes;
}

}  // namespace

DOCTEST_TEST_CASE("rows that are longer than the header says are refused") {
    const auto folder = odd_folder() / "30_rows_longer_than_header";
    if (available(folder))
        for (const auto& [name, bytes] : {std::pair{"ply06_colors_column_misaligned.ply", "59"},
                                          std::pair{"ply06b_rows_longer_than_header.ply", "71"}}) {
            const auto error = error_of([&] { load_scene(folder / name); });
            DOCTEST_REQUIRE(error.has_value());
            DOCTEST_CHECK(error->code() == ErrorCode::Malformed);
            DOCTEST_CHECK(std::string(error->what()).find(bytes) != std::string::npos);
            DOCTEST_CHECK(std::string(error->what()).find("50 rows") != std::string::npos);
        }
    ScratchFolder scratch;
    for (const std::size_t count : {3u, 50u, 5000u})
        for (const std::size_t more : {1u, 2u, 3u, 4u, 12u})
            for (const Encoding encoding : {Encoding::Ascii, Encoding::Little, Encoding::Big}) {
                if (count < 8 && more % 4 == 0) continue;  // looks like three sound rows and a rest
                const GaussianData data = random_gaussians(count, 0, count + more);
                FileShape shape;
                shape.encoding = encoding;
                const std::string bytes = with_longer_rows(data, count, more, shape);
                DOCTEST_CAPTURE(count);
                DOCTEST_CAPTURE(more);
                DOCTEST_CHECK(refusal(bytes).find("longer than its header says") != std::string::npos);
                write_file(scratch.path() / "a.ply", bytes);
                DOCTEST_CHECK(error_of([&] { load_scene(scratch.path() / "a.ply"); }).has_value());
            }
}

DOCTEST_TEST_CASE("a rest behind sound rows is passed over as before") {
    const GaussianData data = random_gaussians(Rows, 0, 30);
    for (const Encoding encoding : {Encoding::Ascii, Encoding::Little, Encoding::Big}) {
        FileShape shape;
        shape.encoding = encoding;
        const std::string good = make_ply(columns_of(data), Rows, shape);
        const auto rows_only = [&](const std::string& bytes) {
            const Scene scene = read(bytes);
            DOCTEST_CHECK(same_bits(scene.gaussians, GaussianSet(data)));
            return scene.info.warnings.size();
        };
        DOCTEST_CHECK(rows_only(good) == 0);
        DOCTEST_CHECK(rows_only(good + "more than the rows\n") == 1);
        if (encoding == Encoding::Ascii) DOCTEST_CHECK(rows_only(good + "\n\r\n") == 0);
        std::string fewer = good;  // the file holds more rows than the header counts
        fewer.replace(fewer.find("vertex 40"), 9, "vertex 20");
        DOCTEST_CHECK(read(fewer).gaussians.size() == 20);
        std::string half = good;
        half.replace(half.find("vertex 40"), 9, "vertex 32");
        DOCTEST_CHECK(read(half).gaussians.size() == 32);
        shape.trailing_element = true;
        DOCTEST_CHECK(rows_only(make_ply(columns_of(data), Rows, shape)) == 0);
        DOCTEST_CHECK(refusal(good.substr(0, good.size() - 30)).find("longer") == std::string::npos);
    }
}

// Anchors

DOCTEST_TEST_CASE("anchors of Scaffold-GS are named") {
    const auto file = odd_folder() / "20_scaffold_anchors/ply09_scaffold_anchors.ply";
    if (available(file)) {
        const auto error = error_of([&] { load_scene(file); });
        DOCTEST_REQUIRE(error.has_value());
        DOCTEST_CHECK(error->code() == ErrorCode::Unsupported);
        DOCTEST_CHECK(std::string(error->what()).find("Scaffold-GS") != std::string::npos);
    }
    const GaussianData data = random_gaussians(4, 0, 20);
    std::vector<Column> columns = columns_of(data);
    for (const char* name : {"f_anchor_feat_0", "f_anchor_feat_1"})
        columns.push_back({name, "float", [](std::size_t) { return 0.5; }});
    DOCTEST_CHECK(refusal(make_ply(columns, 4, {})).empty());  // splats with features of their own
    std::erase_if(columns, [](const Column& one) { return one.name.starts_with("f_dc_"); });
    DOCTEST_CHECK(refusal(make_ply(columns, 4, {})).find("Scaffold-GS") != std::string::npos);
}

}  // namespace odd_ply_test
