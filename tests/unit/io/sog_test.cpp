// Writer of SOG: what is written comes back in Morton order within the steps that the format has.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/base/json.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/formats/sog/sog_files.h"
#include "engine/io/formats/sog/sog_format.h"
#include "engine/scene/morton.h"
#include "tests/unit/io/io_helpers.h"

namespace sog_test {

using namespace gse;
using namespace gse::test;

namespace {

/// Row order[i] of the written scene became row i.
GaussianSet in_file_order(const GaussianSet& set, const std::vector<std::uint32_t>& order) {
    const GaussianData data = set.to_data();
    GaussianData result;
    result.sh_degree = data.sh_degree;
    for (const std::uint32_t row : order) result.append_row(data, row);
    return GaussianSet(std::move(result));
}

struct Written {
    std::string bytes;
    GaussianSet before, after;  // in the same order
};

Written written(const Scene& scene) {
    std::vector<std::uint32_t> order;
    Written result;
    result.bytes = io::write_sog(scene, &order);
    result.before = in_file_order(drop_unusable(scene.gaussians), order);
    result.after = parse_scene(as_bytes(result.bytes), "x.sog").gaussians;
    return result;
}

double worst_turn(const GaussianSet& a, const GaussianSet& b) {
    double worst = 1;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::min(worst, rotation_agreement(a.rotation().data() + 4 * i, b.rotation().data() + 4 * i));
    return worst;
}

nlohmann::json meta_of(const std::string& bytes) {
    const auto content = io::open_sog_archive(as_bytes(bytes))->read("meta.json", 1 << 20);
    return parse_json({reinterpret_cast<const char*>(content.data()), content.size()}, "meta");
}

/// 1 where the positions of axis `axis` agree within half a step of the logarithmic grid.
bool within_grid(const Written& file, double extent) {
    const double step = 2 * std::log1p(extent) / 65535;  // of ln(1 + |x|)
    for (std::size_t i = 0; i < file.before.position().size(); ++i) {
        const double x = file.before.position()[i];
        if (std::abs(x - file.after.position()[i]) > (0.5 * step + 1e-6) * (1 + std::abs(x)) * 1.001)
            return false;
    }
    return true;
}

}  // namespace

DOCTEST_TEST_CASE("SOG round trip: the same splats in Morton order, within the steps of the format") {
    constexpr double OpacityStep = 0.5 / 255 + 1e-6;
    // The log-scales span 5; 256 codes fitted to them are as dense everywhere.
    constexpr double ScaleStep = 5.0 / 255;
    constexpr double RotationFloor = 1 - 1e-4;  // bytes over +-1/sqrt(2): half a step is 0.0028 per component
    for (int degree = 0; degree <= 3; ++degree) {
        DOCTEST_CAPTURE(degree);
        const Scene scene = random_scene(700, degree, 60 + static_cast<std::uint64_t>(degree));
        const Written file = written(scene);
        DOCTEST_REQUIRE(file.after.size() == 700);
        DOCTEST_REQUIRE(file.after.sh_degree() == degree);
        DOCTEST_CHECK(morton_order(file.before.position()) == [] {
            std::vector<std::uint32_t> rows(700);
            for (std::uint32_t i = 0; i < 700; ++i) rows[i] = i;
            return rows;
        }());
        DOCTEST_CHECK(within_grid(file, 3));
        DOCTEST_CHECK(largest_difference(file.before.log_scale(), file.after.log_scale()) <= ScaleStep);
        DOCTEST_CHECK(opacity_difference(file.before, file.after) <= OpacityStep);
        DOCTEST_CHECK(worst_turn(file.before, file.after) >= RotationFloor);
        // Fewer splats than the palette has entries: each keeps its own, up to the codebook.
        const auto [low, high] = std::minmax_element(file.before.sh().begin(), file.before.sh().end());
        DOCTEST_CHECK(largest_difference(file.before.sh(), file.after.sh()) <= (*high - *low) / 255);
    }
}

DOCTEST_TEST_CASE(
    "SOG: what was written, read and written again is the same; the bytes do not change either") {
    const Scene scene = random_scene(300, 2, 70);
    const std::string bytes = io::write_sog(scene);
    DOCTEST_CHECK(bytes == io::write_sog(scene));
    const Scene read = parse_scene(as_bytes(bytes), "x.sog");
    std::vector<std::uint32_t> order;
    const Scene again = parse_scene(as_bytes(io::write_sog(read, &order)), "x.sog");
    const GaussianSet expected = in_file_order(read.gaussians, order);
    DOCTEST_CHECK(same_bits(again.gaussians.log_scale(), expected.log_scale()));
    DOCTEST_CHECK(same_bits(again.gaussians.sh(), expected.sh()));
    DOCTEST_CHECK(same_bits(again.gaussians.opacity_logit(), expected.opacity_logit()));
    constexpr double Rounding = 1e-5;  // the ends of the grid are float positions again
    DOCTEST_CHECK(largest_difference(again.gaussians.position(), expected.position()) < Rounding);
}

DOCTEST_TEST_CASE(
    "SOG: meta.json names version, count, textures of the stated sizes, and the model of antialiased "
    "scenes") {
    Scene scene = random_scene(2500, 3, 71);
    scene.info.antialiased = true;
    const std::string bytes = io::write_sog(scene);
    const auto meta = meta_of(bytes);
    DOCTEST_CHECK(meta.at("version") == 2);
    DOCTEST_CHECK(meta.at("count") == 2500);
    DOCTEST_CHECK(meta.at("model") == "antialiased");
    DOCTEST_CHECK(meta.at("shN").at("bands") == 3);
    const auto entries = meta.at("shN").at("count").get<std::size_t>();
    DOCTEST_CHECK(entries <= 2048);  // the largest power of two within the splats
    DOCTEST_CHECK(entries > 1900);
    const auto files = io::open_sog_archive(as_bytes(bytes));
    const auto texture = [&](const char* part, std::size_t index) {
        const auto name = meta.at(part).at("files").at(index).get<std::string>();
        return io::decode_webp(files->read(name, 1 << 24), name, bytes.size());
    };
    for (const char* part : {"means", "scales", "quats", "sh0"}) {
        const io::Texture picture = texture(part, 0);
        DOCTEST_CHECK(picture.width == 52);  // 4 * ceil(sqrt(2500) / 4)
        DOCTEST_CHECK(picture.height == 52);
    }
    DOCTEST_CHECK(texture("shN", 0).width == 64 * 15);
    DOCTEST_CHECK(texture("shN", 0).height == (entries + 63) / 64);
    DOCTEST_CHECK(parse_scene(as_bytes(bytes), "x.sog").info.antialiased);
    DOCTEST_CHECK_FALSE(meta_of(io::write_sog(random_scene(3, 0, 1))).contains("shN"));
}

DOCTEST_TEST_CASE("SOG holds far, flat, opaque, single and equal splats") {
    GaussianData data = random_gaussians(40, 1, 72, 1e6);
    for (std::size_t i = 0; i < 6; ++i) data.log_scale[i] = -std::numeric_limits<float>::infinity();
    data.log_scale[7] = 80;
    data.opacity_logit[0] = std::numeric_limits<float>::infinity();
    data.opacity_logit[1] = -std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < 4; ++i) data.rotation[i] = 0;
    Scene scene;
    scene.gaussians = GaussianSet(data);
    const Written file = written(scene);
    DOCTEST_REQUIRE(file.after.size() == 40);
    DOCTEST_CHECK(within_grid(file, 1e6));
    for (const auto values :
         {file.after.position(), file.after.log_scale(), file.after.rotation(), file.after.opacity_logit()})
        DOCTEST_CHECK(
            std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }));
    for (const std::size_t count : {1u, 2u, 5u}) {
        GaussianData equal;
        equal.sh_degree = 1;
        for (std::size_t i = 0; i < count; ++i) equal.append_row(data, 20);
        scene.gaussians = GaussianSet(equal);
        const GaussianSet back = written(scene).after;
        DOCTEST_CHECK(back.size() == count);
        DOCTEST_CHECK(same_bits(back.sh(), scene.gaussians.sh()));
    }
    scene.gaussians = GaussianSet();
    DOCTEST_CHECK(error_of([&] { io::write_sog(scene); }).has_value());
}

DOCTEST_TEST_CASE(
    "SOG: colours that no scene has spoil nothing: every value read is finite, and the colours of others "
    "keep their steps") {
    // Rows with more than 10,000 are left out by every format (scene/statistics.cpp)
    constexpr float Huge = 9000;
    GaussianData data = random_gaussians(3000, 1, 74);
    for (std::size_t row = 0; row < 40; ++row)
        for (std::size_t i = 0; i < 12; ++i) data.sh[row * 12 + i] = (row + i) % 2 == 0 ? Huge : -Huge;
    Scene scene;
    scene.gaussians = GaussianSet(data);
    const Written file = written(scene);
    DOCTEST_REQUIRE(file.after.size() == 3000);
    DOCTEST_CHECK(std::all_of(file.after.sh().begin(), file.after.sh().end(),
                              [](float value) { return std::isfinite(value); }));
    DOCTEST_CHECK(within_grid(file, 3));
    constexpr double BaseStep = 0.02;  // 256 codes, some of them for the ends, over a range of 1.8
    double worst = 0;
    for (std::size_t i = 0; i < file.before.sh().size(); ++i)
        if (i % 12 < 3 && std::abs(file.before.sh()[i]) < 1)
            worst = std::max(worst, std::abs(static_cast<double>(file.before.sh()[i]) - file.after.sh()[i]));
    DOCTEST_CHECK(worst <= BaseStep);
}

DOCTEST_TEST_CASE("a texture comes back byte for byte, under transparent texels too") {
    Random random(73);
    io::Texture texture{37, 11, std::vector<std::uint8_t>(37 * 11 * 4)};
    for (std::uint8_t& value : texture.rgba) value = static_cast<std::uint8_t>(random.next());
    for (std::size_t i = 0; i < 100; ++i) texture.rgba[i * 4 + 3] = 0;
    const std::string bytes = io::encode_webp(texture);
    const io::Texture again = io::decode_webp(as_bytes(bytes), "a", bytes.size());
    DOCTEST_CHECK(again.width == 37);
    DOCTEST_CHECK(again.height == 11);
    DOCTEST_CHECK(again.rgba == texture.rgba);
    DOCTEST_CHECK(io::encode_webp(texture) == bytes);
}

}  // namespace sog_test
