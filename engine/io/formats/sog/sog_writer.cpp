// Writer of SOG version 2: rows in Morton order, one texel each in lossless WebP textures, tied up in a zip
// archive.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/base/thread_pool.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/zip_archive.h"
#include "engine/io/formats/sog/codebook.h"
#include "engine/io/formats/sog/sog_files.h"
#include "engine/io/formats/sog/sog_format.h"
#include "engine/scene/morton.h"

namespace gse::io {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::size_t WidestTexture = 16383;   // texels of a WebP picture's side
constexpr std::size_t LargestPalette = 65536;  // 16-bit numbers
constexpr std::size_t SmallestPalette = 1024;
constexpr std::size_t EntriesPerLine = 64;  // of the centroid texture
constexpr float LargestSogLogScale = 20;    // a size that no scene has would take a code of its own
// Nor a colour 28 times as bright as white: others would get coarser steps.
constexpr float LargestCoefficient = 100;
constexpr std::uint64_t BytesPerRow = 100;  // textures, codebooks and palette while they are made

/// A texture and the name of its file.
struct NamedTexture {
    const char* name;
    Texture texture;
};

Texture blank_texture(std::size_t width, std::size_t height) {
    Texture texture{width, height, std::vector<std::uint8_t>(width * height * 4, 0)};
    for (std::size_t i = 0; i < width * height; ++i) texture.rgba[i * 4 + 3] = 255;
    return texture;
}

/// Blank texture for `count` texels: nearly square, with sides that are multiples of four as in other
/// writers.
Texture splat_texture(std::size_t count) {
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    const std::size_t width = std::min((side + 3) / 4 * 4, WidestTexture);
    const std::size_t height = (count + width - 1) / width;
    return blank_texture(width, std::min((height + 3) / 4 * 4, WidestTexture));
}

/// Rows in the order of the file, and the parts made of them so far.
struct Sog {
    const GaussianSpans& set;
    const std::vector<std::uint32_t>& order;
    OrderedJson meta = OrderedJson::object();
    std::vector<NamedTexture> textures = {};

    std::size_t size() const { return order.size(); }
    std::size_t sh_stride() const { return (rest_of_degree(set.sh_degree) + 1) * 3; }
    Texture& add(const char* name, Texture texture) {
        textures.push_back({name, std::move(texture)});
        return textures.back().texture;
    }
};

/// Symmetric logarithm sign(x) ln(1 + |x|): fine steps near the origin, coarse ones far away.
double folded(float value) {
    return std::copysign(std::log1p(std::abs(static_cast<double>(value))), static_cast<double>(value));
}

void write_positions(Sog& sog) {
    std::array<double, 3> low, high;
    for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = high[axis] = folded(sog.set.position[axis]);
    for (std::size_t i = 0; i < sog.set.position.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], folded(sog.set.position[i]));
        high[i % 3] = std::max(high[i % 3], folded(sog.set.position[i]));
    }
    Texture fine = splat_texture(sog.size()), coarse = fine;
    for (std::size_t row = 0; row < sog.size(); ++row)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double extent = high[axis] - low[axis];
            const double unit =
                extent > 0 ? (folded(sog.set.position[sog.order[row] * 3 + axis]) - low[axis]) / extent : 0;
            const auto code = static_cast<unsigned>(std::clamp(unit, 0.0, 1.0) * 65535 + 0.5);
            fine.rgba[row * 4 + axis] = static_cast<std::uint8_t>(code & 255);
            coarse.rgba[row * 4 + axis] = static_cast<std::uint8_t>(code >> 8);
        }
    sog.add("means_l.webp", std::move(fine));
    sog.add("means_u.webp", std::move(coarse));
    sog.meta["means"] = {{"mins", low}, {"maxs", high}, {"files", {"means_l.webp", "means_u.webp"}}};
}

float kept_log_scale(float value) { return std::clamp(value, FlattestLogScale, LargestSogLogScale); }

void write_scales(Sog& sog) {
    std::vector<float> values(sog.set.log_scale.begin(), sog.set.log_scale.end());
    for (float& value : values) value = kept_log_scale(value);
    const Codebook codebook = fit_codebook(std::move(values));
    Texture& texture = sog.add("scales.webp", splat_texture(sog.size()));
    for (std::size_t row = 0; row < sog.size(); ++row)
        for (std::size_t axis = 0; axis < 3; ++axis)
            texture.rgba[row * 4 + axis] =
                codebook.nearest(kept_log_scale(sog.set.log_scale[sog.order[row] * 3 + axis]));
    sog.meta["scales"] = {{"codebook", codebook.values}, {"files", {"scales.webp"}}};
}

/// Packs a rotation. Alpha 252 + i names the largest of (w,x,y,z), which is made positive. The colours are
/// the others in order.
void write_rotations(Sog& sog) {
    Texture& texture = sog.add("quats.webp", splat_texture(sog.size()));
    for (std::size_t row = 0; row < sog.size(); ++row) {
        const std::array<double, 4> q = unit_quaternion(sog.set.rotation.data() + sog.order[row] * 4);
        const auto largest = static_cast<std::size_t>(
            std::max_element(q.begin(), q.end(),
                             [](double a, double b) { return std::abs(a) < std::abs(b); }) -
            q.begin());
        const double sign = q[largest] < 0 ? -1 : 1;
        std::uint8_t* texel = texture.rgba.data() + row * 4;
        for (std::size_t i = 0; i < 4; ++i)
            if (i != largest) *texel++ = to_byte((sign * q[i] * std::numbers::sqrt2 + 1) * 127.5);
        *texel = static_cast<std::uint8_t>(252 + largest);
    }
    sog.meta["quats"] = {{"files", {"quats.webp"}}};
}

/// Codebook of coefficients. Its last value stands for everything beyond its ends.
Codebook fit_coefficients(std::vector<float> values) {
    for (float& value : values) value = std::clamp(value, -LargestCoefficient, LargestCoefficient);
    return fit_codebook(std::move(values));
}

void write_base_colours(Sog& sog) {
    const std::size_t stride = sog.sh_stride();
    std::vector<float> values;
    values.reserve(sog.size() * 3);
    for (std::size_t row = 0; row < sog.size(); ++row)
        values.insert(values.end(), sog.set.sh.begin() + static_cast<std::ptrdiff_t>(row * stride),
                      sog.set.sh.begin() + static_cast<std::ptrdiff_t>(row * stride + 3));
    const Codebook codebook = fit_coefficients(std::move(values));
    Texture& texture = sog.add("sh0.webp", splat_texture(sog.size()));
    for (std::size_t row = 0; row < sog.size(); ++row) {
        const std::size_t source = sog.order[row];
        for (std::size_t c = 0; c < 3; ++c)
            texture.rgba[row * 4 + c] = codebook.nearest(sog.set.sh[source * stride + c]);
        texture.rgba[row * 4 + 3] =
            to_byte(255 * opacity_from_logit(static_cast<double>(sog.set.opacity_logit[source])));
    }
    sog.meta["sh0"] = {{"codebook", codebook.values}, {"files", {"sh0.webp"}}};
}

/// Size of the palette: the largest power of two up to the number of rows, within the format's limits. Few
/// rows are kept exactly.
std::size_t palette_size(std::size_t rows) {
    std::size_t size = SmallestPalette;
    while (size < LargestPalette && size * 2 <= rows) size *= 2;
    return size;
}

void write_palette(Sog& sog, ThreadPool& pool) {
    const std::size_t rest = rest_of_degree(sog.set.sh_degree);
    if (rest == 0) return;
    const Palette palette =
        fit_palette({sog.set.sh, sog.sh_stride(), 3, rest * 3, sog.size()}, palette_size(sog.size()), pool);
    const Codebook codebook = fit_coefficients(palette.entries);
    Texture centroids =
        blank_texture(EntriesPerLine * rest, (palette.size() + EntriesPerLine - 1) / EntriesPerLine);
    for (std::size_t entry = 0; entry < palette.size(); ++entry) {
        const std::size_t first = entry / EntriesPerLine * centroids.width + entry % EntriesPerLine * rest;
        for (std::size_t k = 0; k < rest * 3; ++k)
            centroids.rgba[(first + k / 3) * 4 + k % 3] =
                codebook.nearest(palette.entries[entry * rest * 3 + k]);
    }
    Texture labels = splat_texture(sog.size());
    for (std::size_t row = 0; row < sog.size(); ++row) {
        const std::uint32_t label = palette.labels[sog.order[row]];
        labels.rgba[row * 4] = static_cast<std::uint8_t>(label & 255);
        labels.rgba[row * 4 + 1] = static_cast<std::uint8_t>(label >> 8);
    }
    sog.add("shN_centroids.webp", std::move(centroids));
    sog.add("shN_labels.webp", std::move(labels));
    sog.meta["shN"] = {{"count", palette.size()},
                       {"bands", sog.set.sh_degree},
                       {"codebook", codebook.values},
                       {"files", {"shN_centroids.webp", "shN_labels.webp"}}};
}

std::string archive_of(const Sog& sog, ThreadPool& pool) {
    std::vector<std::string> pictures(sog.textures.size());
    pool.parallel_for(pictures.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) pictures[i] = encode_webp(sog.textures[i].texture);
    });
    const std::string meta = sog.meta.dump();
    std::vector<ZipMember> members = {{"meta.json", meta}};
    for (std::size_t i = 0; i < pictures.size(); ++i) members.push_back({sog.textures[i].name, pictures[i]});
    return write_zip(members);
}

}  // namespace

std::string write_sog(const Scene& scene, std::vector<std::uint32_t>* order_out) {
    const GaussianSet storable = storable_rows(scene.gaussians, ".sog");
    if (storable.empty())
        throw Error(ErrorCode::InvalidArgument, "a scene without splats cannot be written as .sog",
                    "save as .ply");
    if (storable.size() > WidestTexture * WidestTexture)
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("a .sog file has no room for {} splats", storable.size()),
                    "save as .ply or .spz");
    require_memory(storable.size() * BytesPerRow, fmt::format("writing {} splats as .sog", storable.size()));
    const GaussianSpans set = storable.spans();
    const std::vector<std::uint32_t> order = morton_order(set.position);
    ThreadPool pool;
    Sog sog{set, order};
    sog.meta["version"] = 2;
    sog.meta["asset"] = {{"generator", "GSEditPro"}};
    sog.meta["count"] = set.size;
    if (scene.info.antialiased) sog.meta["model"] = "antialiased";
    write_positions(sog);
    write_scales(sog);
    write_rotations(sog);
    write_base_colours(sog);
    write_palette(sog, pool);
    if (order_out != nullptr) *order_out = order;
    return archive_of(sog, pool);
}

}  // namespace gse::io
