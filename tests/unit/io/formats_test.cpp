// Quantised formats: what is written comes back within the format's own step; frames and envelopes of SPZ.
#include <algorithm>
#include <limits>

#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/inflate.h"
#include "engine/io/formats/ply/compressed_ply.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/formats/spz/spz_format.h"
#include "tests/unit/io/io_helpers.h"

namespace formats_test {

using namespace gse;
using namespace gse::test;

namespace {

constexpr double OpacityStep = 0.5 / 255 + 1e-6;

Scene reload(const Scene& scene, const char* name, const SaveOptions& options = {}) {
    ScratchFolder scratch;
    save_scene(scratch.path() / name, scene, options);
    return load_scene(scratch.path() / name);
}

double worst_rotation(const GaussianSet& a, const GaussianSet& b) {
    double worst = 1;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::min(worst, rotation_agreement(a.rotation().data() + 4 * i, b.rotation().data() + 4 * i));
    return worst;
}

/// Row of `b` nearest to each row of `a`.
std::vector<std::size_t> nearest_rows(const GaussianSet& a, const GaussianSet& b) {
    std::vector<std::size_t> rows(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        double best = HUGE_VAL;
        for (std::size_t j = 0; j < b.size(); ++j) {
            double distance = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double d = static_cast<double>(a.position()[i * 3 + axis]) - b.position()[j * 3 + axis];
                distance += d * d;
            }
            if (distance < best) {
                best = distance;
                rows[i] = j;
            }
        }
    }
    return rows;
}

GaussianSet reordered(const GaussianSet& set, const std::vector<std::size_t>& rows) {
    const GaussianData data = set.to_data();
    GaussianData result;
    result.sh_degree = data.sh_degree;
    for (const std::size_t row : rows) result.append_row(data, row);
    return GaussianSet(std::move(result));
}

std::string spz_header(std::uint32_t version, std::uint32_t count, int degree, int flags) {
    std::string out = "NGSP";
    io::append_value(out, version);
    io::append_value(out, count);
    for (const int value : {degree, 12, flags, 0}) out += static_cast<char>(value);
    return out;
}

}  // namespace

DOCTEST_TEST_CASE("SPZ round trip stays within its steps, in every version") {
    constexpr double PositionStep = 0.5 / 4096 + 1e-6;
    constexpr double ScaleStep = 0.5 / 16 + 1e-6;
    constexpr double BaseStep = 0.5 / 255 / 0.15 + 1e-5;
    constexpr double ShStep = 0.5 / 128 + 1e-6;
    constexpr double RotationFloor = 1 - 1e-5;  // nine bits per component
    // Seven bits, and w, which is small, from the rest: sqrt(3 / 127.5)
    constexpr double ByteRotationFloor = 0.99;
    for (int version = 2; version <= 4; ++version)
        for (int degree = 0; degree <= 3; ++degree) {
            DOCTEST_CAPTURE(version);
            DOCTEST_CAPTURE(degree);
            const Scene scene = random_scene(500, degree, 20 + static_cast<std::uint64_t>(degree));
            const SaveOptions options{.choices = {{"spz_version", version}}};
            const Scene again = reload(scene, "a.spz", options);
            DOCTEST_REQUIRE(again.gaussians.size() == 500);
            DOCTEST_REQUIRE(again.gaussians.sh_degree() == degree);
            DOCTEST_CHECK(largest_difference(scene.gaussians.position(), again.gaussians.position()) <=
                          PositionStep);
            DOCTEST_CHECK(largest_difference(scene.gaussians.log_scale(), again.gaussians.log_scale()) <=
                          ScaleStep);
            DOCTEST_CHECK(opacity_difference(scene.gaussians, again.gaussians) <= OpacityStep);
            DOCTEST_CHECK(worst_rotation(scene.gaussians, again.gaussians) >=
                          (version == 2 ? ByteRotationFloor : RotationFloor));
            const std::size_t stride = scene.gaussians.sh().size() / 500;
            double base = 0, rest = 0;
            for (std::size_t i = 0; i < scene.gaussians.sh().size(); ++i) {
                const double difference =
                    std::abs(static_cast<double>(scene.gaussians.sh()[i]) - again.gaussians.sh()[i]);
                (i % stride < 3 ? base : rest) = std::max(i % stride < 3 ? base : rest, difference);
            }
            DOCTEST_CHECK(base <= BaseStep);
            DOCTEST_CHECK(rest <= ShStep);
            // A second round changes nothing: the quantised values are fixed points.
            DOCTEST_CHECK(
                same_bits(reload(again, "b.spz", options).gaussians.position(), again.gaussians.position()));
        }
}

DOCTEST_TEST_CASE(
    "SPZ versions 3 and 4 hold the same splats; other versions are refused before anything is written") {
    Scene scene = random_scene(300, 3, 5);
    scene.info.antialiased = true;
    const Scene third = parse_scene(as_bytes(io::write_spz(scene, 3)), "x.spz");
    const std::string newest = io::write_spz(scene, 4);
    const Scene fourth = parse_scene(as_bytes(newest), "x.spz");
    DOCTEST_CHECK(newest.starts_with(std::string("NGSP\4\0\0\0", 8)));
    DOCTEST_CHECK(newest[15] == 6);  // streams; a scene without view-dependent colour has five
    DOCTEST_CHECK(io::write_spz(random_scene(3, 0, 5), 4)[15] == 5);
    DOCTEST_CHECK(same_bits(third.gaussians, fourth.gaussians));
    DOCTEST_CHECK(fourth.info.antialiased);
    DOCTEST_CHECK(fourth.info.warnings.empty());
    ScratchFolder scratch;
    for (const int version : {-1, 0, 1, 5}) {
        const auto refused = error_of([&] {
            save_scene(scratch.path() / "a.spz", scene, {.choices = {{"spz_version", version}}});
        });
        DOCTEST_REQUIRE(refused.has_value());
        DOCTEST_CHECK(refused->code() == ErrorCode::InvalidArgument);
    }
    DOCTEST_CHECK(std::filesystem::is_empty(scratch.path()));
}

DOCTEST_TEST_CASE("SPZ takes far positions with fewer fractional bits instead of wrapping") {
    const Scene scene = random_scene(50, 0, 3, 30000);
    const Scene again = reload(scene, "far.spz");
    DOCTEST_CHECK(largest_difference(scene.gaussians.position(), again.gaussians.position()) < 0.01);
}

DOCTEST_TEST_CASE("SPZ honours the coordinate system that the extension names") {
    const Scene scene = random_scene(5, 3, 4);
    const std::string raw = io::write_spz(scene);
    std::vector<std::byte> flat = io::inflate_gzip(as_bytes(raw), 1 << 20);
    const auto with_frame = [&](std::uint32_t frame) {
        std::string file(reinterpret_cast<const char*>(flat.data()), flat.size());
        file[14] = 2;
        io::append_value(file, std::uint32_t{0x12345678});  // unknown, to be skipped
        io::append_value(file, std::uint32_t{3});
        file += "abc";
        io::append_value(file, std::uint32_t{0xadbe0003});
        io::append_value(file, std::uint32_t{4});
        io::append_value(file, frame);
        return parse_scene(as_bytes(file), "x.spz");
    };
    const GaussianSet usual = parse_scene(as_bytes(raw), "x.spz").gaussians;
    DOCTEST_CHECK(same_bits(with_frame(4).gaussians, usual));  // right, up, back: the default
    const GaussianSet stored = with_frame(6).gaussians;        // right, down, forward: ours already
    DOCTEST_CHECK(stored.position()[0] == usual.position()[0]);
    DOCTEST_CHECK(stored.position()[1] == -usual.position()[1]);
    DOCTEST_CHECK(stored.position()[2] == -usual.position()[2]);
    const Scene strange = with_frame(12);
    DOCTEST_CHECK(strange.info.warnings.size() == 2);  // and the unknown extension
    DOCTEST_CHECK(same_bits(strange.gaussians, stored));
}

DOCTEST_TEST_CASE("SPZ: flags and extensions that are not known are told in one sentence") {
    const std::string raw = io::write_spz(random_scene(5, 1, 4));
    const std::vector<std::byte> flat = io::inflate_gzip(as_bytes(raw), 1 << 20);
    const auto warnings = [&](char flags, bool extension) {
        std::string file(reinterpret_cast<const char*>(flat.data()), flat.size());
        file[14] = flags;
        if (extension)
            for (const std::uint32_t word : {0x12345678u, 0u, 0x12345678u, 0u, 0xabcdu, 0u})
                io::append_value(file, word);
        return parse_scene(as_bytes(file), "x.spz").info.warnings;
    };
    const std::string begin = "the SPZ file has parts that are not known and passed over: ";
    const std::string levels = "flags 0x80 (levels of detail, all drawn at once)",
                      types = "extensions 0xabcd, 0x12345678";
    for (const char flags : {'\0', '\1', '\2', '\3'}) DOCTEST_CHECK(warnings(flags, false).empty());
    DOCTEST_CHECK(warnings('\x81', false) == std::vector<std::string>{begin + levels});
    DOCTEST_CHECK(warnings('\x04', false) == std::vector<std::string>{begin + "flags 0x4"});
    DOCTEST_CHECK(warnings('\2', true) == std::vector<std::string>{begin + types});
    DOCTEST_CHECK(warnings('\x82', true) == std::vector<std::string>{begin + levels + " and " + types});
}

DOCTEST_TEST_CASE("SPZ version 1 has half-float positions") {
    std::string file = spz_header(1, 1, 0, 1);
    for (const std::uint16_t half : {0x3c00, 0xc000, 0x3800}) io::append_value(file, half);  // 1, -2, 0.5
    file += '\x80';                                                                          // alpha
    file += std::string("\x80\x80\x80", 3);
    file += std::string("\xa0\xa0\xa0", 3);  // log-scale 0
    file += std::string("\x7f\x7f\xff", 3);  // rotation about z by 180 degrees
    const Scene scene = parse_scene(as_bytes(io::deflate_gzip(file)), "x.spz");
    DOCTEST_CHECK(scene.info.antialiased);
    DOCTEST_CHECK(scene.gaussians.position()[0] == 1.0f);
    DOCTEST_CHECK(scene.gaussians.position()[1] == 2.0f);
    DOCTEST_CHECK(scene.gaussians.position()[2] == -0.5f);
    DOCTEST_CHECK(scene.gaussians.log_scale()[1] == 0.0f);
    DOCTEST_CHECK(std::abs(scene.gaussians.rotation()[3]) > 0.99f);
}

DOCTEST_TEST_CASE("opacities of exactly 0 and 1 become finite logits") {
    Scene scene = random_scene(2, 0, 1);
    GaussianData data = scene.gaussians.to_data();
    data.opacity_logit = {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
    scene.gaussians = GaussianSet(data);
    for (const char* name : {"a.spz", "a.splat", "a.compressed.ply", "a.sog"}) {
        const GaussianSet again = reload(scene, name).gaussians;
        DOCTEST_CAPTURE(name);
        const float low = std::min(again.opacity_logit()[0], again.opacity_logit()[1]);
        const float high = std::max(again.opacity_logit()[0], again.opacity_logit()[1]);
        DOCTEST_CHECK(low == doctest::Approx(-13.8155).epsilon(1e-4));
        DOCTEST_CHECK(high == doctest::Approx(13.8155).epsilon(1e-4));
    }
}

DOCTEST_TEST_CASE(".splat round trip keeps order and positions") {
    const Scene scene = random_scene(200, 1, 8);
    const GaussianSet again = reload(scene, "a.splat").gaussians;
    DOCTEST_CHECK(same_bits(again.position(), scene.gaussians.position()));
    DOCTEST_CHECK(largest_difference(again.log_scale(), scene.gaussians.log_scale()) < 1e-5);
    DOCTEST_CHECK(opacity_difference(again, scene.gaussians) <= OpacityStep);
    DOCTEST_CHECK(worst_rotation(again, scene.gaussians) > 0.9998);  // seven bits per component
    for (std::size_t i = 0; i < 600; ++i) {
        const double colour = colour_from_sh(static_cast<double>(scene.gaussians.sh()[i / 3 * 12 + i % 3]));
        DOCTEST_CHECK(colour_from_sh(static_cast<double>(again.sh()[i])) ==
                      doctest::Approx(std::clamp(colour, 0.0, 1.0)).epsilon(0.01));
    }
}

DOCTEST_TEST_CASE(
    "compressed PLY round trip: the same splats in Morton order, within the steps of their chunks") {
    constexpr double Extent = 6;
    constexpr double PositionStep = Extent / 1023;  // a chunk is no larger than the scene
    constexpr double ScaleStep = 5.0 / 1023;
    constexpr double ShStep = 8.0 / 256 / 2 + 1e-5;
    for (const int degree : {0, 2, 3}) {
        const Scene scene = random_scene(700, degree, 30 + static_cast<std::uint64_t>(degree));
        const GaussianSet read = reload(scene, "a.compressed.ply").gaussians;
        DOCTEST_REQUIRE(read.size() == 700);
        DOCTEST_REQUIRE(read.sh_degree() == degree);
        const GaussianSet again = reordered(read, nearest_rows(scene.gaussians, read));
        DOCTEST_CHECK(largest_difference(scene.gaussians.position(), again.position()) <= PositionStep);
        DOCTEST_CHECK(largest_difference(scene.gaussians.log_scale(), again.log_scale()) <= ScaleStep);
        DOCTEST_CHECK(opacity_difference(scene.gaussians, again) <= OpacityStep);
        DOCTEST_CHECK(worst_rotation(scene.gaussians, again) > 1 - 1e-5);
        DOCTEST_CHECK(largest_difference(scene.gaussians.sh(), again.sh()) <= ShStep);
    }
}

DOCTEST_TEST_CASE("old compressed PLY files have no colour bounds") {
    Scene scene = random_scene(3, 0, 11);
    GaussianData data = scene.gaussians.to_data();
    for (std::size_t i = 0; i < 9;
         ++i)  // the extremes fix the bounds to 0 and 1, so both layouts say the same
        data.sh[i] = static_cast<float>(sh_from_colour(i < 3 ? 0 : i < 6 ? 1 : 0.5));
    scene.gaussians = GaussianSet(data);
    std::string file = io::write_compressed_ply(scene);
    for (const char* name : {"min_r", "min_g", "min_b", "max_r", "max_g", "max_b"}) {
        const std::string line = std::string("property float ") + name + "\n";
        file.erase(file.find(line), line.size());
    }
    file.erase(file.find("end_header\n") + 11 + 48, 24);
    const GaussianSet old = parse_scene(as_bytes(file), "x.ply").gaussians;
    const GaussianSet current = parse_scene(as_bytes(io::write_compressed_ply(scene)), "x.ply").gaussians;
    DOCTEST_CHECK(largest_difference(old.sh(), current.sh()) < 1e-5);
}

DOCTEST_TEST_CASE("quantised formats leave unusable rows out") {
    GaussianData data = random_gaussians(10, 1, 12);
    data.position[4] = std::numeric_limits<float>::quiet_NaN();
    data.sh[50] = std::numeric_limits<float>::infinity();
    Scene scene;
    scene.gaussians = GaussianSet(data);
    for (const char* name : {"a.spz", "a.splat", "a.compressed.ply", "a.sog"})
        DOCTEST_CHECK(reload(scene, name).gaussians.size() == 8);
}

DOCTEST_TEST_CASE("flipping axes twice is nothing; a flip keeps the colour seen from the flipped side") {
    const GaussianData data = random_gaussians(20, 3, 13);
    for (const io::AxisSigns signs :
         {io::AxisSigns{1, -1, -1}, io::AxisSigns{-1, -1, 1}, io::AxisSigns{-1, 1, 1}}) {
        GaussianData flipped = data;
        io::flip_axes(flipped, signs);
        GaussianData back = flipped;
        io::flip_axes(back, signs);
        DOCTEST_CHECK(same_bits(GaussianSet(back), GaussianSet(data)));
        DOCTEST_CHECK(!same_bits(GaussianSet(flipped), GaussianSet(data)));
    }
}

DOCTEST_TEST_CASE("unknown formats and names are refused before anything is written") {
    ScratchFolder scratch;
    const Scene scene = random_scene(1, 0, 1);
    DOCTEST_CHECK(error_of([&] { save_scene(scratch.path() / "a.obj", scene); }).has_value());
    SaveOptions options;
    options.format = "obj";
    DOCTEST_CHECK(error_of([&] { save_scene(scratch.path() / "a.ply", scene, options); }).has_value());
    DOCTEST_CHECK(std::filesystem::is_empty(scratch.path()));
    const auto unwritable = error_of([&] { save_scene("/proc/none/a.ply", scene); });
    DOCTEST_REQUIRE(unwritable.has_value());
    DOCTEST_CHECK(unwritable->code() == ErrorCode::Unwritable);
}

}  // namespace formats_test
