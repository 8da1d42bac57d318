// Linear colours of PLY files: stated by comments and by SHARP's element, shown as sRGB.
#include <algorithm>

#include "engine/math/spherical_harmonics.h"
#include "tests/unit/io/io_helpers.h"

namespace colour_space_test {

using namespace gse;
using namespace gse::test;

namespace {

double srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// The file with a line in its header and bytes behind its body.
std::string with_line(std::string ply, const std::string& line, const std::string& tail = {}) {
    ply.insert(ply.find("end_header"), line + "\n");
    return ply + tail;
}

Scene read(const std::string& bytes) { return parse_scene(as_bytes(bytes), "a.ply"); }

bool says_linear(const Scene& scene) {
    const auto& warnings = scene.info.warnings;
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
        return warning.find("linear light") != std::string::npos;
    });
}

/// Largest difference of the base colours of `shown` from the linear ones of `stored` in sRGB.
double base_difference(const GaussianSet& stored, const GaussianSet& shown) {
    double largest = 0;
    const std::size_t stride = stored.sh().size() / stored.size();
    for (std::size_t row = 0; row < stored.size(); ++row)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = row * stride + c;
            const double wanted = srgb(colour_from_sh(static_cast<double>(stored.sh()[at])));
            largest =
                std::max(largest, std::abs(wanted - colour_from_sh(static_cast<double>(shown.sh()[at]))));
        }
    return largest;
}

/// Colour of a channel seen along `direction`.
double seen(const GaussianSet& set, std::size_t row, std::size_t channel, const Vec3& direction) {
    const std::size_t count = set.sh().size() / set.size() / 3;
    double basis[MaxShCoefficients], colour = 0.5;
    sh_basis(direction, set.sh_degree(), basis);
    for (std::size_t k = 0; k < count; ++k)
        colour += basis[k] * static_cast<double>(set.sh()[(row * count + k) * 3 + channel]);
    return std::max(0.0, colour);
}

constexpr double Rounding = 1e-6;  // of a float

}  // namespace

DOCTEST_TEST_CASE("PLY: colours that the header states as linear are shown in sRGB, and it is said") {
    const Scene scene = random_scene(60, 0, 3);
    const std::string ply = written_as("ply", scene), compressed = written_as("compressed.ply", scene);
    const GaussianSet of_compressed = read(compressed).gaussians;
    for (const char* line :
         {"comment color_space linear", "comment colour space: Linear-sRGB", "comment ColorSpace=linearRGB",
          "obj_info color_space 1", "comment color_space: lin_rec709"}) {
        DOCTEST_CAPTURE(line);
        const Scene shown = read(with_line(ply, line));
        DOCTEST_CHECK(says_linear(shown));
        DOCTEST_CHECK(base_difference(scene.gaussians, shown.gaussians) < Rounding);
        DOCTEST_CHECK(same_bits(shown.gaussians.position(), scene.gaussians.position()));
        const Scene unpacked = read(with_line(compressed, line));
        DOCTEST_CHECK(says_linear(unpacked));
        DOCTEST_CHECK(base_difference(of_compressed, unpacked.gaussians) < Rounding);
    }
    for (const char* line : {"comment color_space sRGB", "comment color space: non-linear", "comment linear",
                             "obj_info color_space 0", "comment colorspace gamma", "comment color_space"}) {
        DOCTEST_CAPTURE(line);
        const Scene shown = read(with_line(ply, line));
        DOCTEST_CHECK(shown.info.warnings.empty());
        DOCTEST_CHECK(same_bits(shown.gaussians, scene.gaussians));
    }
    const Scene other = read(with_line(ply, "comment color_space ACEScg"));
    DOCTEST_REQUIRE(other.info.warnings.size() == 1);
    DOCTEST_CHECK(other.info.warnings[0].find("\"acescg\"") != std::string::npos);
    DOCTEST_CHECK(same_bits(other.gaussians, scene.gaussians));
    DOCTEST_CHECK(base_difference(scene.gaussians, read(with_line(with_line(ply, "comment color_space sRGB"),
                                                                  "comment color_space linear"))
                                                       .gaussians) < Rounding);
}

DOCTEST_TEST_CASE("PLY: SHARP's element tells linear colours from sRGB, wherever it lies") {
    const Scene scene = random_scene(9, 0, 3);
    const std::string ply = written_as("ply", scene);
    const auto with_element = [&](const char* type, const std::string& value, int count = 1) {
        const std::string before = "element intrinsic 2\nproperty float intrinsic\n";
        return with_line(ply,
                         before + "element color_space " + std::to_string(count) + "\nproperty " + type +
                             " color_space\nelement version 3\nproperty uchar version",
                         std::string(8, '\0') + value + "\1\5\0");
    };
    ScratchFolder scratch;
    const auto shown = [&](const std::string& bytes) {
        std::filesystem::remove(scratch.path() / "a.ply");
        write_file(scratch.path() / "a.ply", bytes);
        return load_scene(scratch.path() / "a.ply");
    };
    for (const auto& [type, value] : {std::pair{"uchar", std::string("\1")},
                                      {"int", std::string("\1\0\0\0", 4)},
                                      {"float", std::string("\0\0\x80\x3f", 4)}}) {
        const Scene linear = shown(with_element(type, value));
        DOCTEST_CHECK(says_linear(linear));
        DOCTEST_CHECK(base_difference(scene.gaussians, linear.gaussians) < Rounding);
        const Scene plain = shown(with_element(type, std::string(value.size(), '\0')));
        DOCTEST_CHECK(plain.info.warnings.empty());
        DOCTEST_CHECK(same_bits(plain.gaussians, scene.gaussians));
    }
    DOCTEST_CHECK(same_bits(shown(with_element("uchar", "", 0)).gaussians, scene.gaussians));
    const std::string cut = with_element("uchar", "\1");  // the splats are whole
    DOCTEST_CHECK(same_bits(shown(cut.substr(0, cut.size() - 6)).gaussians, scene.gaussians));
    std::string first = ply;  // in front of the splats
    first.insert(first.find("element vertex"), "element color_space 1\nproperty uchar color_space\n");
    first.insert(first.find("end_header\n") + 11, "\1");
    DOCTEST_CHECK(base_difference(scene.gaussians, shown(first).gaussians) < Rounding);
}

DOCTEST_TEST_CASE("PLY: linear colours with view-dependent ones are those of every side, as near as can be") {
    for (int degree = 1; degree <= 3; ++degree) {
        DOCTEST_CAPTURE(degree);
        GaussianData data = random_gaussians(40, degree, 8);
        for (std::size_t i = 0; i < data.sh.size(); ++i)
            data.sh[i] *= i % data.sh_stride() < 3 ? 1.0f : 0.15f;  // as in trained scenes
        Scene scene;
        scene.gaussians = GaussianSet(data);
        const Scene shown = read(with_line(written_as("ply", scene), "comment color_space linear"));
        DOCTEST_CHECK(says_linear(shown));
        DOCTEST_REQUIRE(shown.gaussians.sh_degree() == degree);
        double squares = 0, plain = 0;
        std::size_t count = 0;
        Random random(2);
        for (std::size_t row = 0; row < 40; ++row)
            for (int i = 0; i < 20; ++i, ++count) {
                const Vec3 side = normalized(Vec3{random.normal(), random.normal(), random.normal()});
                const double wanted = srgb(seen(scene.gaussians, row, 0, side));
                squares += std::pow(seen(shown.gaussians, row, 0, side) - wanted, 2);
                plain += std::pow(seen(scene.gaussians, row, 0, side) - wanted, 2);
            }
        constexpr double NearEnough = 0.02;  // of the range: what the degree has no room for
        DOCTEST_CHECK(std::sqrt(squares / static_cast<double>(count)) < NearEnough);
        DOCTEST_CHECK(squares < plain / 25);
    }
}

DOCTEST_TEST_CASE("PLY: the reported file of linear colours is shown in sRGB") {
    const auto path = data_folder() / "odd/16_sharp_linear_colours/ply04b_sharp_linear_space.ply";
    if (!available(path)) return;
    std::string stored = read_file(path);
    const Scene shown = load_scene(path);
    DOCTEST_CHECK(says_linear(shown));
    stored.back() = '\0';  // states sRGB
    DOCTEST_CHECK(base_difference(read(stored).gaussians, shown.gaussians) < Rounding);
}

}  // namespace colour_space_test
