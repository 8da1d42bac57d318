// 3DGS PLY: columns found by name, any type, order and encoding. Raw values are kept bit for bit. Binary
// files are read a piece at a time.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <optional>

#include "engine/base/aligned.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/encoding.h"
#include "engine/io/bytes/label_weights.h"
#include "engine/io/formats/ply/compressed_ply.h"
#include "engine/io/formats/ply/gaussian_ply.h"
#include "engine/io/formats/ply/ply_body.h"
#include "engine/io/formats/ply/ply_colour_space.h"
#include "engine/io/formats/ply/ply_comments.h"

namespace gse::io {
namespace {

constexpr int Absent = -1;
constexpr std::size_t BlockRows = 128;  // rows gathered at a time: 128 x 248 bytes stay in the cache
constexpr std::size_t ReadBytes = std::size_t{1} << 20;       // asked of a file at a time
constexpr std::size_t LongestHeader = std::size_t{64} << 10;  // of a file that is not read as a whole
constexpr float SurfelLogScale = -13.8155f;                   // third axis of a 2DGS surfel: 1e-6 units
constexpr std::size_t RestOfDegree4 = 24;

/// Attributes of a row. Each is a list of property indices of the vertex element (Absent = fill with
/// `missing`).
struct Attribute {
    std::vector<int> columns;
    std::vector<float>* target = nullptr;
    float missing = 0;
};

struct Layout {
    int sh_degree = 0;
    bool byte_colours = false;  // red, green, blue instead of f_dc
    std::vector<int> position, log_scale, rotation, opacity, sh, label, label_weight;
};

/// Number at the end of a name: "f_rest_7" -> 7.
std::optional<std::size_t> rest_index(std::string_view name) {
    constexpr std::string_view prefix = "f_rest_";
    if (name.substr(0, prefix.size()) != prefix) return std::nullopt;
    std::size_t index = 0;
    const auto [end, failure] =
        std::from_chars(name.data() + prefix.size(), name.data() + name.size(), index);
    if (failure != std::errc{} || end != name.data() + name.size()) return std::nullopt;
    return index;
}

[[noreturn]] void throw_not_gaussian(const PlyHeader& header, const PlyElement& vertex,
                                     const std::string& lacking) {
    const bool mesh = header.find("face") != nullptr && header.find("face")->count > 0;
    const bool coloured = vertex.find("red") >= 0 || vertex.find("diffuse_red") >= 0;
    const char* kind = mesh ? "a mesh" : coloured ? "a coloured point cloud" : "a point cloud";
    throw Error(ErrorCode::Unsupported,
                fmt::format("this PLY file is {}, not a Gaussian splatting scene: its vertices have no {}",
                            kind, lacking),
                "train a 3DGS model from it first, or choose the point_cloud.ply of a trained one");
}

std::vector<int> find_columns(const PlyElement& vertex, std::initializer_list<const char*> names) {
    std::vector<int> columns;
    for (const char* name : names) {
        const int index = vertex.find(name);
        const bool usable = index >= 0 && !vertex.properties[static_cast<std::size_t>(index)].is_list;
        columns.push_back(usable ? index : Absent);
    }
    return columns;
}

bool complete(const std::vector<int>& columns) {
    return std::find(columns.begin(), columns.end(), Absent) == columns.end();
}

/// Columns of the SH coefficients beyond DC, coefficient-major. The file has all of red first, then green,
/// then blue.
std::vector<int> rest_columns(const PlyElement& vertex, Layout& layout, std::vector<std::string>& warnings) {
    std::vector<int> by_index;
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
        const auto index = rest_index(vertex.properties[i].name);
        if (!index) continue;
        if (*index >= vertex.properties.size() || vertex.properties[i].is_list)
            throw Error(ErrorCode::Malformed, "the PLY header numbers its f_rest properties with gaps");
        if (by_index.size() <= *index) by_index.resize(*index + 1, Absent);
        by_index[*index] = static_cast<int>(i);
    }
    const std::size_t per_channel = by_index.size() / 3;
    int degree = degree_of_rest(per_channel);
    if (per_channel == RestOfDegree4) {
        degree = MaxShDegree;
        warnings.push_back("spherical harmonics of degree 4 are cut to degree 3");
    }
    if (by_index.size() % 3 != 0 || degree < 0 || !complete(by_index))
        throw Error(ErrorCode::Malformed,
                    fmt::format("the PLY header has {} f_rest properties; a 3DGS file has 0, 9, 24, 45 or 72",
                                by_index.size()));
    layout.sh_degree = degree;
    std::vector<int> columns;
    for (std::size_t k = 0; k < rest_of_degree(degree); ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            columns.push_back(by_index[channel * per_channel + k]);
    return columns;
}

Layout find_layout(const PlyHeader& header, const PlyElement& vertex, std::vector<std::string>& warnings) {
    Layout layout;
    layout.position = find_columns(vertex, {"x", "y", "z"});
    layout.sh = find_columns(vertex, {"f_dc_0", "f_dc_1", "f_dc_2"});
    layout.opacity = find_columns(vertex, {"opacity"});
    layout.log_scale = find_columns(vertex, {"scale_0", "scale_1", "scale_2"});
    layout.rotation = find_columns(vertex, {"rot_0", "rot_1", "rot_2", "rot_3"});
    layout.label = find_columns(vertex, {"label"});
    layout.label_weight = find_columns(vertex, {"label_weight"});
    if (!complete(layout.position)) throw_not_gaussian(header, vertex, "x, y and z");
    if (!complete(layout.opacity)) throw_not_gaussian(header, vertex, "opacity");
    if (!complete(layout.rotation)) throw_not_gaussian(header, vertex, "rot_0 to rot_3");
    if (layout.log_scale[0] == Absent || layout.log_scale[1] == Absent)
        throw_not_gaussian(header, vertex, "scale_0 to scale_2");
    if (layout.log_scale[2] == Absent)
        warnings.push_back("scale_2 is missing: flat 2DGS surfels get a thickness of 1e-6");
    if (!complete(layout.sh)) {
        layout.sh = find_columns(vertex, {"red", "green", "blue"});
        layout.byte_colours = true;
        if (!complete(layout.sh)) throw_not_gaussian(header, vertex, "f_dc_0 to f_dc_2");
    }
    const std::vector<int> rest = rest_columns(vertex, layout, warnings);
    layout.sh.insert(layout.sh.end(), rest.begin(), rest.end());
    return layout;
}

/// Source of binary rows [begin, end). They stay in place until the next call.
using RowSource = std::function<std::span<const std::byte>(std::size_t begin, std::size_t end)>;

/// Gathers binary rows without lists, block by block, so that each destination is written once.
void read_fixed_rows(const RowSource& source, const PlyHeader& header, const PlyElement& vertex,
                     std::span<const Attribute> attributes) {
    struct Column {
        std::size_t offset = 0;
        PlyType type = PlyType::Float32;
        bool absent = false;
    };
    const bool big_endian = header.encoding == PlyEncoding::BigEndian;
    const std::size_t stride = vertex.row_bytes();
    std::vector<std::size_t> offsets;
    for (std::size_t offset = 0; const PlyProperty& property : vertex.properties) {
        offsets.push_back(offset);
        offset += ply_type_size(property.type);
    }
    std::vector<std::vector<Column>> plan;
    std::vector<bool> plain;
    for (const Attribute& attribute : attributes) {
        std::vector<Column> columns;
        for (const int index : attribute.columns) {
            const auto i = static_cast<std::size_t>(std::max(index, 0));
            columns.push_back({offsets[i], vertex.properties[i].type, index == Absent});
        }
        plain.push_back(!big_endian && std::all_of(columns.begin(), columns.end(), [](const Column& c) {
            return !c.absent && c.type == PlyType::Float32;
        }));
        plan.push_back(std::move(columns));
    }
    std::vector<float> block;
    const auto count = static_cast<std::size_t>(vertex.count);
    for (std::size_t begin = 0; begin < count; begin += BlockRows) {
        const std::size_t end = std::min(count, begin + BlockRows);
        const std::span<const std::byte> rows = source(begin, end);
        for (std::size_t a = 0; a < attributes.size(); ++a) {
            const std::vector<Column>& columns = plan[a];
            block.resize((end - begin) * columns.size());
            float* out = block.data();
            for (std::size_t row = 0; row < end - begin; ++row) {
                const std::byte* values = rows.data() + row * stride;
                if (plain[a])
                    for (const Column& column : columns) *out++ = load_scalar<float>(values + column.offset);
                else
                    for (const Column& column : columns)
                        *out++ = column.absent
                                     ? attributes[a].missing
                                     : load_ply_scalar(values + column.offset, column.type, big_endian);
            }
            attributes[a].target->insert(attributes[a].target->end(), block.begin(), block.end());
        }
    }
}

void read_walked_rows(PlyBody& body, const PlyElement& vertex, std::span<const Attribute> attributes) {
    std::vector<float> row(vertex.properties.size());
    for (std::uint64_t i = 0; i < vertex.count; ++i) {
        body.read_row(vertex, row);
        for (const Attribute& attribute : attributes)
            for (const int column : attribute.columns)
                attribute.target->push_back(column == Absent ? attribute.missing
                                                             : row[static_cast<std::size_t>(column)]);
    }
}

void colours_to_sh(GaussianData& data, bool integers) {
    const float scale = integers ? 1.0f / 255 : 1.0f;
    for (std::size_t row = 0; row < data.size(); ++row)
        for (std::size_t c = 0; c < 3; ++c) {
            float& value = data.sh[row * data.sh_stride() + c];
            value = static_cast<float>(sh_from_colour(static_cast<double>(value * scale)));
        }
}

void add_label(Scene& scene, std::vector<float> bits, std::vector<float> weights, const std::string& name) {
    if (bits.empty() && weights.empty()) return;
    if (const std::size_t odd = hold_weights(bits))
        scene.info.warnings.push_back(
            fmt::format("the column \"label\" has values other than 0 and 1 for {} splats: those above 0.5 "
                        "count as labelled, whatever they are",
                        odd));
    if (const std::size_t odd = hold_weights(weights))
        scene.info.warnings.push_back(held_weights_text(odd, "the column \"label_weight\""));
    if (bits.empty()) bits = weights;
    Label label = make_label(name, std::move(bits), 0.5f);
    if (!weights.empty()) label.weight = std::make_shared<const std::vector<float>>(std::move(weights));
    scene.labels.labels.push_back(std::move(label));
}

/// The scene that a header describes, without its rows.
struct Described {
    PlyHeader header;
    const PlyElement* vertex = nullptr;
    Layout layout;
    Scene scene;
    std::string label_name;

    Described(const Described&) = delete;  // `vertex` points into the header
    explicit Described(Bytes start) : header(parse_ply_header(start)), vertex(header.find("vertex")) {
        if (vertex == nullptr) throw Error(ErrorCode::Malformed, "the PLY header has no vertex element");
        scene.info.format = "ply";
        label_name = read_comments(header, scene.info);
        layout = find_layout(header, *vertex, scene.info.warnings);
        if (vertex->count == 0) throw Error(ErrorCode::Malformed, "the PLY file holds no splats");
    }
    bool has_fixed_rows() const { return header.encoding != PlyEncoding::Ascii && !vertex->has_list(); }
};

/// Fills the scene with the rows that `read` puts into the attributes. `rest` returns the number of bytes
/// behind them.
Scene fill_scene(Described& described, const std::function<void(std::span<const Attribute>)>& read,
                 const std::function<std::size_t()>& rest) {
    const auto& [header, vertex, layout, scene, label_name] = described;
    require_memory(splat_bytes(vertex->count, layout.sh_degree),
                   fmt::format("the scene of {} splats", vertex->count));
    GaussianData data;
    data.sh_degree = layout.sh_degree;
    std::vector<float> label, label_weight;
    std::vector<Attribute> attributes = {{layout.position, &data.position},
                                         {layout.log_scale, &data.log_scale, SurfelLogScale},
                                         {layout.rotation, &data.rotation},
                                         {layout.opacity, &data.opacity_logit},
                                         {layout.sh, &data.sh}};
    if (complete(layout.label)) attributes.push_back({layout.label, &label});
    if (complete(layout.label_weight)) attributes.push_back({layout.label_weight, &label_weight});
    for (const Attribute& attribute : attributes) {
        attribute.target->reserve(static_cast<std::size_t>(vertex->count) * attribute.columns.size());
        prefer_huge_pages(attribute.target->data(), attribute.target->capacity() * sizeof(float));
    }
    read(attributes);
    if (layout.byte_colours) {
        const PlyType type = vertex->properties[static_cast<std::size_t>(layout.sh[0])].type;
        colours_to_sh(data, type != PlyType::Float32 && type != PlyType::Float64);
    }
    Scene filled = std::move(described.scene);
    if (const std::size_t bytes = &header.elements.back() == vertex ? rest() : 0; bytes > 0)
        filled.info.warnings.push_back(
            fmt::format("{} bytes after the last of the {} splats are ignored", bytes, vertex->count));
    filled.gaussians = GaussianSet(std::move(data));
    add_label(filled, std::move(label), std::move(label_weight), label_name);
    return filled;
}

bool detect_gaussian_ply(Bytes bytes) { return is_ply(bytes) && !detect_compressed_ply(bytes); }

}  // namespace

bool may_be_gaussian_ply(std::string_view start) {
    const bool whole = start.starts_with("ply") && start.find("end_header") != std::string_view::npos;
    return !whole || start.find("scale_0") != std::string_view::npos ||
           start.find("packed_position") != std::string_view::npos;
}

MimeType ply_mime() {
    return {.type = "model/ply",
            .comment = "polygon or splat file",
            .acronym = "PLY",
            .expanded_acronym = "Polygon File Format",
            .alias = "application/x-ply",
            .magic = {"ply\\n", "ply\\r"},
            .own_icon = false};
}

SceneFormat gaussian_ply_format() {
    return {.name = "ply",
            .title = "PLY",
            .extensions = {".ply"},
            .mime = ply_mime(),
            .detect = detect_gaussian_ply,
            .may_be_scene = may_be_gaussian_ply,
            .read = parse_gaussian_ply,
            .read_pieces = load_gaussian_ply,
            .write = write_gaussian_ply,
            .exact = true,
            .keeps_labels = true,
            .keeps_antialiasing = true,
            .keeps_up = true};
}

Scene parse_gaussian_ply(Bytes bytes) {
    Described described(bytes);
    const PlyElement& vertex = *described.vertex;
    PlyBody body(bytes, described.header);
    body.seek(vertex);
    const auto read = [&](std::span<const Attribute> attributes) {
        if (!described.has_fixed_rows()) return read_walked_rows(body, vertex, attributes);
        const Bytes rows = body.take_rows(vertex);
        const std::size_t stride = vertex.row_bytes();
        read_fixed_rows([&](std::size_t begin,
                            std::size_t end) { return rows.subspan(begin * stride, (end - begin) * stride); },
                        described.header, vertex, attributes);
    };
    Scene scene =
        fill_scene(described, read, [&] { return body.has_rest() ? body.remaining() : std::size_t{0}; });
    show_as_srgb(scene, described.header, bytes);
    return scene;
}

std::optional<Scene> load_gaussian_ply(const InputFile& file) {
    std::vector<std::byte> start(
        static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), LongestHeader)));
    file.read(0, start);
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    if (!is_ply(start) || text.find("end_header") == std::string_view::npos || detect_compressed_ply(start))
        return std::nullopt;
    Described described(start);
    if (states_colour_space(described.header)) return std::nullopt;
    const PlyElement& vertex = *described.vertex;
    const std::uint64_t behind_header = file.size() - described.header.body_offset;
    const std::size_t stride = vertex.row_bytes();
    const bool cut = described.header.body_offset == start.size() &&
                     start.size() < file.size();  // within a line end, maybe
    if (cut || !described.has_fixed_rows() || &vertex != &described.header.elements.front() || stride == 0 ||
        saturating_product(vertex.count, stride) > behind_header)
        return std::nullopt;
    std::vector<std::byte> block(std::max(ReadBytes / stride, BlockRows) * stride);
    const auto count = static_cast<std::size_t>(vertex.count);
    std::size_t first = 0, behind = 0;  // rows in the block
    const RowSource source = [&](std::size_t begin, std::size_t end) {
        if (end > behind) {
            first = begin;
            behind = std::min(count, begin + block.size() / stride);
            file.read(described.header.body_offset + begin * stride,
                      std::span(block).first((behind - first) * stride));
        }
        return Bytes(block).subspan((begin - first) * stride, (end - begin) * stride);
    };
    return fill_scene(
        described,
        [&](std::span<const Attribute> attributes) {
            read_fixed_rows(source, described.header, vertex, attributes);
        },
        [&] { return static_cast<std::size_t>(behind_header) - count * stride; });
}

}  // namespace gse::io
