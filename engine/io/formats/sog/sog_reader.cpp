// SOG: quantised attributes in lossless WebP textures, described by meta.json. Version 2 and its predecessor.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/base/error.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/json_numbers.h"
#include "engine/io/formats/scene_formats.h"
#include "engine/io/formats/sog/codebook.h"
#include "engine/io/formats/sog/sog_files.h"
#include "engine/io/formats/sog/sog_format.h"
#include "engine/io/formats/sog/sog_json.h"

namespace gse::io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t PaletteColumns = 64;  // palette entries side by side in the centroid texture
constexpr std::uint64_t LargestDescription = std::uint64_t{4}
                                             << 20;  // bytes of a meta.json, which has a few thousand
// Bytes of its file, were nothing compressed.
constexpr std::uint64_t LargestTexture = LargestSogCount * 4 + (std::uint64_t{1} << 20);

constexpr const char *SceneDescription = "meta.json", *LevelList = "lod-meta.json";  // of a streamed scene

/// Scene being read: its description and the place of its textures.
struct Source {
    const Json& meta;
    const PartFiles& files;
    std::size_t count = 0;
    bool version1 = false;

    Texture texture(const char* part, std::size_t index) const {
        const std::string name = meta.at(part).at("files").at(index).get<std::string>();
        return decode_webp(files.read(name, LargestTexture), name, files.stored_bytes());
    }
    Texture splat_texture(const char* part, std::size_t index) const {
        Texture result = texture(part, index);
        if (result.texel_count() < count)
            throw_malformed_sog(fmt::format("has a \"{}\" texture of {} texels for {} splats", part,
                                            result.texel_count(), count));
        return result;
    }
};

template <std::size_t N> std::array<double, N> numbers(const Json& json) {
    std::array<double, N> result{};
    for (std::size_t i = 0; i < N; ++i) result[i] = json.at(i).get<double>();
    return result;
}

/// Byte -> value for one channel: a codebook (v2) or a straight line between two bounds (v1).
using Decoder = std::array<float, CodebookSize>;

/// True for a codebook whose first value is null.
bool lacks_first_code(const Json& part) {
    const auto values = part.find("codebook");
    return values != part.end() && values->is_array() && !values->empty() && values->front().is_null();
}

/// Codebook of a part. Earlier writers left its first value out (null), which is where the next one and the
/// mean step between the codes say.
Decoder codebook(const Json& part) {
    const Json& values = part.at("codebook");
    if (values.size() < CodebookSize) throw_malformed_sog("has a codebook of fewer than 256 values");
    Decoder result{};
    const bool gap = lacks_first_code(part);
    for (std::size_t i = gap ? 1 : 0; i < CodebookSize; ++i)
        result[i] = static_cast<float>(values.at(i).get<double>());
    if (gap) {
        const double next = values.at(1).get<double>(), last = values.at(CodebookSize - 1).get<double>();
        result[0] = static_cast<float>(next + (next - last) / 255);
    }
    return result;
}

Decoder line(double low, double high) {
    Decoder result{};
    for (std::size_t i = 0; i < CodebookSize; ++i)
        result[i] = static_cast<float>(low + (high - low) * static_cast<double>(i) / 255);
    return result;
}

/// Decoders of `channels` channels of a part.
std::vector<Decoder> decoders(const Source& source, const char* part, std::size_t channels) {
    const Json& json = source.meta.at(part);
    if (!source.version1) return std::vector<Decoder>(channels, codebook(json));
    std::vector<Decoder> result;
    for (std::size_t i = 0; i < channels; ++i) {
        const bool scalar = json.at("mins").is_number();
        result.push_back(line((scalar ? json.at("mins") : json.at("mins").at(i)).get<double>(),
                              (scalar ? json.at("maxs") : json.at("maxs").at(i)).get<double>()));
    }
    return result;
}

void read_positions(const Source& source, GaussianData& data) {
    const Texture low = source.splat_texture("means", 0);
    const Texture high = source.splat_texture("means", 1);
    const auto mins = numbers<3>(source.meta.at("means").at("mins"));
    const auto maxs = numbers<3>(source.meta.at("means").at("maxs"));
    for (std::size_t row = 0; row < source.count; ++row)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int code = low.texel(row)[axis] | (high.texel(row)[axis] << 8);
            const double value = mins[axis] + (maxs[axis] - mins[axis]) * code / 65535;
            data.position[row * 3 + axis] =
                static_cast<float>(std::copysign(std::expm1(std::abs(value)), value));
        }
}

void read_scales(const Source& source, GaussianData& data) {
    const Texture texture = source.splat_texture("scales", 0);
    const std::vector<Decoder> decode = decoders(source, "scales", 3);
    for (std::size_t row = 0; row < source.count; ++row)
        for (std::size_t axis = 0; axis < 3; ++axis)
            data.log_scale[row * 3 + axis] = decode[axis][texture.texel(row)[axis]];
}

/// Unpacks a rotation. Alpha 252 + i names the largest of (w,x,y,z); red, green, blue are the others in
/// order. Other alphas mean no rotation.
void read_rotations(const Source& source, GaussianData& data) {
    const Texture texture = source.splat_texture("quats", 0);
    for (std::size_t row = 0; row < source.count; ++row) {
        const std::uint8_t* texel = texture.texel(row);
        std::array<double, 4> q = {1, 0, 0, 0};
        if (texel[3] >= 252) {
            const std::size_t largest = texel[3] - 252u;
            double rest = 1;
            std::size_t next = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                if (i == largest) continue;
                q[i] = (texel[next++] / 255.0 * 2 - 1) / std::numbers::sqrt2;
                rest -= q[i] * q[i];
            }
            q[largest] = std::sqrt(std::max(0.0, rest));
        }
        for (std::size_t i = 0; i < 4; ++i) data.rotation[row * 4 + i] = static_cast<float>(q[i]);
    }
}

void read_base_colours(const Source& source, GaussianData& data) {
    const Texture texture = source.splat_texture("sh0", 0);
    const std::vector<Decoder> decode = decoders(source, "sh0", source.version1 ? 4 : 3);
    const std::size_t stride = data.sh_stride();
    for (std::size_t row = 0; row < source.count; ++row) {
        const std::uint8_t* texel = texture.texel(row);
        for (std::size_t c = 0; c < 3; ++c) data.sh[row * stride + c] = decode[c][texel[c]];
        data.opacity_logit[row] = source.version1 ? decode[3][texel[3]] : byte_logits()[texel[3]];
    }
}

int sh_degree_of(const Source& source, const Texture* centroids) {
    if (centroids == nullptr) return 0;
    const int degree = degree_of_rest(centroids->width / PaletteColumns);
    if (degree <= 0 || centroids->width % PaletteColumns != 0)
        throw_malformed_sog(
            fmt::format("has an SH palette {} texels wide; 192, 512 or 960 are known", centroids->width));
    return degree;
}

/// Coefficients from the palette. Each splat has a 16-bit number of an entry, whose K texels are its
/// coefficients.
void read_palette_sh(const Source& source, const Texture& centroids, GaussianData& data) {
    const Texture labels = source.splat_texture("shN", 1);
    const Decoder decode = decoders(source, "shN", 1)[0];
    const std::size_t rest = rest_of_degree(data.sh_degree);
    const std::size_t stride = data.sh_stride();
    for (std::size_t row = 0; row < source.count; ++row) {
        const std::size_t entry =
            labels.texel(row)[0] | (static_cast<std::size_t>(labels.texel(row)[1]) << 8);
        const std::size_t line_of = entry / PaletteColumns;
        if (line_of >= centroids.height) continue;  // an entry that is not there: base colour only
        const std::size_t first = line_of * centroids.width + entry % PaletteColumns * rest;
        float* sh = data.sh.data() + row * stride + 3;
        for (std::size_t k = 0; k < rest; ++k)
            for (std::size_t c = 0; c < 3; ++c) *sh++ = decode[centroids.texel(first + k)[c]];
    }
}

/// Parts whose codebooks begin with null, in words.
std::string parts_that_lack_codes(const Json& meta) {
    std::vector<std::string> parts;
    for (const auto& [name, what] : {std::pair("scales", "sizes"), std::pair("sh0", "base colours"),
                                     std::pair("shN", "view-dependent colours")})
        if (const auto part = meta.find(name); part != meta.end() && lacks_first_code(*part))
            parts.emplace_back(what);
    return in_words(parts, "and");
}

std::size_t count_of(const Json& meta, bool version1) {
    const Json& stated = version1 ? meta.at("means").at("shape").at(0) : meta.at("count");
    const std::uint64_t count = whole_number(stated, LargestSogCount, "number of splats of the SOG scene");
    if (count == 0) throw_malformed_sog("holds no splats");
    return static_cast<std::size_t>(count);
}

Scene read_scene(const PartFiles& files, const Json& meta) {
    const bool version1 = !meta.contains("version");
    const std::uint64_t version =
        version1 ? 1 : whole_number(meta.at("version"), 1000, "version of the SOG scene");
    if (version > 2)
        throw Error(ErrorCode::Unsupported, fmt::format("SOG version {} is not known; 1 and 2 are", version));
    const Source source{meta, files, count_of(meta, version1), version1};
    check_claim({splat_bytes(source.count, meta.contains("shN") ? MaxShDegree : 0), files.stored_bytes()},
                fmt::format("the SOG scene's {} splats", source.count));
    source.splat_texture("sh0", 0);  // proves the count before anything of its size is made
    std::optional<Texture> centroids;
    if (meta.contains("shN") && !meta.at("shN").is_null()) centroids = source.texture("shN", 0);
    GaussianData data;
    data.sh_degree = sh_degree_of(source, centroids ? &*centroids : nullptr);
    data.resize(source.count);
    read_positions(source, data);
    read_scales(source, data);
    read_rotations(source, data);
    read_base_colours(source, data);
    if (centroids) read_palette_sh(source, *centroids, data);
    Scene scene;
    scene.info.format = "sog";
    scene.info.antialiased =
        meta.value("antialias", false) || meta.value("model", std::string()) == "antialiased";
    if (meta.value("model", std::string()) == "2dgs")
        scene.info.warnings.push_back("the file asks for 2DGS rendering; it is drawn as 3DGS");
    if (const std::string parts = parts_that_lack_codes(meta); !version1 && !parts.empty())
        scene.info.warnings.push_back(fmt::format(
            "the file lacks the first value of its codebook for {}: it is taken from the others", parts));
    scene.gaussians = GaussianSet(std::move(data));
    return scene;
}

bool detect_sog(Bytes bytes) { return is_zip(bytes); }

}  // namespace

Scene read_sog(const PartFiles& files, const std::string& meta) {
    return with_sog_errors(
        [&] { return read_scene(files, parse_sog_json(files.read(meta, LargestDescription))); });
}

Scene parse_sog(Bytes bytes) {
    const auto files = open_sog_archive(bytes);
    return read_sog(*files, SceneDescription);
}

namespace {

Scene read_unpacked_sog(const PartFiles& files, const std::string& description) {
    return lower_case(description) == LevelList ? read_sog_levels(files, description)
                                                : read_sog(files, description);
}

/// True when a description is one of these scenes': other programs have a meta.json too.
bool describes_sog(std::string_view description) {
    return description.find("\"means\"") != std::string_view::npos ||
           description.find("\"filenames\"") != std::string_view::npos;
}

std::vector<std::uint32_t> write_sog_archive(const Scene& scene, const SaveOptions&, const TakePiece& take) {
    std::vector<std::uint32_t> order;
    take(write_sog(scene, &order));
    return order;
}

}  // namespace

SceneFormat sog_format() {
    return {.name = "sog",
            .title = "SOG",
            .extensions = {".sog"},
            .file_names = {LevelList, SceneDescription},
            .mime = {.type = "model/x-sog",
                     .comment = "Gaussian splats (SOG)",
                     .parent = "application/zip",
                     .weight = 60},
            .detect = detect_sog,
            .read = parse_sog,
            .describes = describes_sog,
            .read_parts = read_unpacked_sog,
            .write = write_sog_archive,
            .keeps_antialiasing = true};
}

}  // namespace gse::io
