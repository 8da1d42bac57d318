// PlayCanvas compressed PLY: 256 splats share a chunk of bounds. Each splat is four packed 32-bit words.
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/formats/ply/compressed_ply.h"
#include "engine/io/formats/ply/gaussian_ply.h"
#include "engine/io/formats/ply/ply_body.h"
#include "engine/io/formats/ply/ply_colour_space.h"
#include "engine/io/formats/ply/ply_comments.h"

namespace gse::io {
namespace {

constexpr double ShRange = 8;  // coefficients lie in [-4, 4)

struct Chunk {
    std::array<float, 3> low{}, high{}, scale_low{}, scale_high{};
    std::array<float, 3> colour_low{0, 0, 0}, colour_high{1, 1, 1};  // older files have no colour bounds
};

constexpr std::array<const char*, 18> ChunkNames = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};
constexpr std::size_t NamesWithoutColour = 12;

[[noreturn]] void throw_malformed_compressed_ply(const std::string& what) {
    throw Error(ErrorCode::Malformed, "the compressed PLY file " + what, "the file is damaged; get it again");
}

/// Byte offset of each named property in a row. All must have this type.
std::vector<std::size_t> offsets_of(const PlyElement& element, std::span<const char* const> names,
                                    PlyType type) {
    std::vector<std::size_t> offsets;
    for (const char* name : names) {
        std::size_t offset = 0;
        bool found = false;
        for (const PlyProperty& property : element.properties) {
            if (property.name == name) {
                found = property.type == type && !property.is_list;
                break;
            }
            offset += ply_type_size(property.type);
        }
        if (!found)
            throw_malformed_compressed_ply(
                fmt::format("has no property \"{}\" of the right type in \"{}\"", name, element.name));
        offsets.push_back(offset);
    }
    return offsets;
}

std::vector<Chunk> read_chunks(const PlyElement& element, std::span<const std::byte> rows) {
    const bool has_colour = element.find("min_r") >= 0;
    const std::span<const char* const> names(ChunkNames.data(),
                                             has_colour ? ChunkNames.size() : NamesWithoutColour);
    const std::vector<std::size_t> offsets = offsets_of(element, names, PlyType::Float32);
    std::vector<Chunk> chunks(static_cast<std::size_t>(element.count));
    for (std::size_t row = 0; row < chunks.size(); ++row) {
        const std::byte* source = rows.data() + row * element.row_bytes();
        Chunk& chunk = chunks[row];
        const std::array<std::array<float, 3>*, 6> targets = {&chunk.low,        &chunk.high,
                                                              &chunk.scale_low,  &chunk.scale_high,
                                                              &chunk.colour_low, &chunk.colour_high};
        for (std::size_t i = 0; i < offsets.size(); ++i)
            (*targets[i / 3])[i % 3] = load_scalar<float>(source + offsets[i]);
    }
    return chunks;
}

float mix(float low, float high, double t) { return static_cast<float>(low * (1 - t) + high * t); }

/// Unpacks x from the top 11 bits, y from the next 10, z from the low 11, each 0..1.
std::array<double, 3> unpack_11_10_11(std::uint32_t word) {
    return {(word >> 21) / 2047.0, ((word >> 11) & 1023) / 1023.0, (word & 2047) / 2047.0};
}

/// Unpacks a rotation. Two bits name the largest component of (w,x,y,z). The other three follow in order, 10
/// bits each.
std::array<float, 4> unpack_rotation(std::uint32_t word) {
    std::array<float, 4> q{};
    const std::size_t largest = word >> 30;
    double rest = 1;
    int shift = 20;
    for (std::size_t i = 0; i < 4; ++i) {
        if (i == largest) continue;
        const double value = (((word >> shift) & 1023) / 1023.0 - 0.5) * std::numbers::sqrt2;
        q[i] = static_cast<float>(value);
        rest -= value * value;
        shift -= 10;
    }
    q[largest] = static_cast<float>(std::sqrt(std::max(0.0, rest)));
    return q;
}

struct VertexColumns {
    std::size_t position, rotation, scale, colour;
};

void unpack_row(const std::byte* source, const VertexColumns& columns, const Chunk& chunk, GaussianData& data,
                std::size_t row) {
    const auto position = unpack_11_10_11(load_scalar<std::uint32_t>(source + columns.position));
    const auto scale = unpack_11_10_11(load_scalar<std::uint32_t>(source + columns.scale));
    const auto rotation = unpack_rotation(load_scalar<std::uint32_t>(source + columns.rotation));
    const auto colour = load_scalar<std::uint32_t>(source + columns.colour);
    float* sh = data.sh.data() + row * data.sh_stride();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        data.position[row * 3 + axis] = mix(chunk.low[axis], chunk.high[axis], position[axis]);
        data.log_scale[row * 3 + axis] = mix(chunk.scale_low[axis], chunk.scale_high[axis], scale[axis]);
        const double unit = ((colour >> (24 - 8 * axis)) & 255) / 255.0;
        sh[axis] = static_cast<float>(
            sh_from_colour(static_cast<double>(mix(chunk.colour_low[axis], chunk.colour_high[axis], unit))));
    }
    for (std::size_t i = 0; i < 4; ++i) data.rotation[row * 4 + i] = rotation[i];
    data.opacity_logit[row] = byte_logits()[colour & 255];
}

/// Coefficients beyond DC. Property f_rest_(c * K + k) is coefficient k of channel c. Bytes 0 and 255 are the
/// ends of the range.
void unpack_sh(const PlyElement& element, std::span<const std::byte> rows, GaussianData& data) {
    const std::size_t rest = rest_of_degree(data.sh_degree);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < rest * 3; ++i) names.push_back(fmt::format("f_rest_{}", i));
    std::vector<const char*> pointers;
    for (const std::string& name : names) pointers.push_back(name.c_str());
    const std::vector<std::size_t> offsets = offsets_of(element, pointers, PlyType::Uint8);
    for (std::size_t row = 0; row < data.size(); ++row) {
        const std::byte* source = rows.data() + row * element.row_bytes();
        float* sh = data.sh.data() + row * data.sh_stride() + 3;
        for (std::size_t k = 0; k < rest; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const auto code = static_cast<unsigned>(source[offsets[channel * rest + k]]);
                const double unit = code == 0 ? 0 : code == 255 ? 1 : (code + 0.5) / 256;
                *sh++ = static_cast<float>((unit - 0.5) * ShRange);
            }
    }
}

struct Elements {
    const PlyElement* chunk;
    const PlyElement* vertex;
    const PlyElement* sh;  // may be null
};

Elements find_elements(const PlyHeader& header) {
    if (header.encoding != PlyEncoding::LittleEndian)
        throw Error(ErrorCode::Unsupported, "a compressed PLY file must be binary little-endian");
    const Elements elements = {header.find("chunk"), header.find("vertex"), header.find("sh")};
    if (elements.chunk == nullptr || elements.vertex == nullptr)
        throw_malformed_compressed_ply("lacks its chunk or vertex element");
    for (const PlyElement* element : {elements.chunk, elements.vertex, elements.sh})
        if (element != nullptr && element->has_list()) throw_malformed_compressed_ply("has a list property");
    const std::uint64_t count = elements.vertex->count;
    if (count == 0) throw_malformed_compressed_ply("holds no splats");
    if (elements.chunk->count < count / CompressedChunkRows + (count % CompressedChunkRows != 0 ? 1 : 0))
        throw_malformed_compressed_ply(
            fmt::format("has {} chunks, too few for {} splats", elements.chunk->count, count));
    if (elements.sh != nullptr && elements.sh->count < count)
        throw_malformed_compressed_ply("has fewer SH rows than splats");
    return elements;
}

/// Rows of every element, walked in file order.
struct Rows {
    std::span<const std::byte> chunk, vertex, sh;
};

Rows take_rows(Bytes bytes, const PlyHeader& header, const Elements& elements) {
    Rows rows;
    PlyBody body(bytes, header);
    for (const PlyElement& element : header.elements) {
        std::span<const std::byte>* target = &element == elements.chunk    ? &rows.chunk
                                             : &element == elements.vertex ? &rows.vertex
                                             : &element == elements.sh     ? &rows.sh
                                                                           : nullptr;
        if (target == nullptr) continue;
        body.seek(element);
        *target = body.take_rows(element);
    }
    return rows;
}

}  // namespace

bool detect_compressed_ply(Bytes bytes) {
    if (!is_ply(bytes)) return false;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view header = text.substr(0, text.find("end_header"));
    return header.find("packed_position") != std::string_view::npos &&
           header.find("element chunk") != std::string_view::npos;
}

namespace {

Scene parse_compressed_ply(Bytes bytes) {
    const PlyHeader header = parse_ply_header(bytes);
    const Elements elements = find_elements(header);
    const Rows rows = take_rows(bytes, header, elements);
    const std::vector<Chunk> chunks = read_chunks(*elements.chunk, rows.chunk);
    constexpr std::array<const char*, 4> names = {"packed_position", "packed_rotation", "packed_scale",
                                                  "packed_color"};
    const std::vector<std::size_t> offsets = offsets_of(*elements.vertex, names, PlyType::Uint32);
    const VertexColumns columns = {offsets[0], offsets[1], offsets[2], offsets[3]};

    GaussianData data;
    if (elements.sh != nullptr) {
        data.sh_degree = degree_of_rest(elements.sh->properties.size() / 3);
        if (data.sh_degree < 0 || elements.sh->properties.size() % 3 != 0)
            throw_malformed_compressed_ply(
                fmt::format("has {} SH properties; 9, 24 or 45 are known", elements.sh->properties.size()));
    }
    const auto count = static_cast<std::size_t>(elements.vertex->count);
    require_memory(splat_bytes(count, data.sh_degree), fmt::format("the scene of {} splats", count));
    data.resize(count);
    for (std::size_t row = 0; row < count; ++row)
        unpack_row(rows.vertex.data() + row * elements.vertex->row_bytes(), columns,
                   chunks[row / CompressedChunkRows], data, row);
    if (data.sh_degree > 0) unpack_sh(*elements.sh, rows.sh, data);
    Scene scene;
    scene.info.format = "compressed.ply";
    read_comments(header, scene.info);
    scene.info.offset = read_offset(header, LessOffsetComment).value_or(Vec3{});
    scene.gaussians = GaussianSet(std::move(data));
    show_as_srgb(scene, header, bytes);
    return scene;
}

std::vector<std::uint32_t> write_in_new_order(const Scene& scene, const SaveOptions&, const TakePiece& take) {
    std::vector<std::uint32_t> order;
    take(write_compressed_ply(scene, &order));
    return order;
}

}  // namespace

SceneFormat compressed_ply_format() {
    return {.name = "compressed.ply",
            .title = "compressed PLY",
            .extensions = {".compressed.ply"},
            .mime = ply_mime(),
            .detect = detect_compressed_ply,
            .may_be_scene = may_be_gaussian_ply,
            .read = parse_compressed_ply,
            .write = write_in_new_order,
            .keeps_antialiasing = true,
            .keeps_up = true,
            .keeps_offset = true};
}

}  // namespace gse::io
