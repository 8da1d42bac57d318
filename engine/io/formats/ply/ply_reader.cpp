// 3DGS PLY: columns found by name, any type, order and encoding. Raw values are kept bit for bit. Binary
// files are read a piece at a time.
#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include "engine/base/aligned.h"
#include "engine/base/error.h"
#include "engine/base/memory.h"
#include "engine/io/bytes/activation.h"
#include "engine/io/bytes/byte_reader.h"
#include "engine/io/bytes/claims.h"
#include "engine/io/bytes/label_weights.h"
#include "engine/io/formats/ply/compressed_ply.h"
#include "engine/io/formats/ply/gaussian_ply.h"
#include "engine/io/formats/ply/ply_body.h"
#include "engine/io/formats/ply/ply_colour_space.h"
#include "engine/io/formats/ply/ply_comments.h"
#include "engine/io/formats/ply/ply_row_fit.h"
#include "engine/io/formats/ply/ply_rows.h"
#include "engine/io/formats/ply/ply_values.h"
#include "engine/scene/origin/world_offset.h"

namespace gse::io {
namespace {

constexpr std::size_t ReadBytes = std::size_t{1} << 20;       // asked of a file at a time
constexpr std::size_t LongestHeader = std::size_t{64} << 10;  // of a file that is not read as a whole
constexpr float SurfelLogScale = -13.8155f;                   // third axis of a 2DGS surfel: 1e-6 units

/// Returns true when the numbers of the column "label" are more than those of a label.
bool add_label(Scene& scene, std::vector<float> bits, std::vector<float> weights, const std::string& name) {
    if (bits.empty() && weights.empty()) return false;
    const std::size_t odd_bits = hold_weights(bits);
    if (odd_bits > 0)
        scene.info.warnings.push_back(
            fmt::format("the column \"label\" has values other than 0 and 1 for {} splats: those above 0.5 "
                        "count as labelled, whatever they are",
                        odd_bits));
    if (const std::size_t odd = hold_weights(weights))
        scene.info.warnings.push_back(held_weights_text(odd, "the column \"label_weight\""));
    if (bits.empty()) bits = weights;
    Label label = make_label(name, std::move(bits), 0.5f);
    if (!weights.empty()) label.weight = std::make_shared<const std::vector<float>>(std::move(weights));
    scene.labels.labels.push_back(std::move(label));
    return odd_bits > 0;
}

/// The scene that a header describes, without its rows.
struct Described {
    PlyHeader header;
    const PlyElement* vertex = nullptr;
    PlyLayout layout;
    Scene scene;
    std::string label_name;
    std::uint64_t body_bytes = 0;  // behind the header
    RowFit fit = RowFit::Fits;

    Described(const Described&) = delete;  // `vertex` points into the header
    /// `start` holds the header of a file of that many bytes.
    Described(Bytes start, std::uint64_t file_bytes)
        : header(parse_ply_header(start)), vertex(header.find("vertex")),
          body_bytes(file_bytes - header.body_offset) {
        if (vertex == nullptr) throw Error(ErrorCode::Malformed, "the PLY header has no vertex element");
        fit = row_fit(header, *vertex, body_bytes);
        if (fit == RowFit::Longer && names_sizes()) throw_longer_rows(header, *vertex, body_bytes);
        scene.info.format = "ply";
        label_name = read_comments(header, scene.info);
        layout = find_ply_layout(header, *vertex, scene.info.warnings);
        scene.info.lists = layout.lists;
        if (vertex->count == 0) throw Error(ErrorCode::Malformed, "the PLY file holds no splats");
    }
    bool has_fixed_rows() const { return header.encoding != PlyEncoding::Ascii && !vertex->has_list(); }
    PlyType type_of(int column) const { return vertex->properties[static_cast<std::size_t>(column)].type; }

private:
    bool names_sizes() const {
        return std::any_of(vertex->properties.begin(), vertex->properties.end(),
                           [](const PlyProperty& p) { return plain_name(p.name) == "scale_0"; });
    }
};

/// Arrays that the rows of a file are read into.
struct RawScene {
    GaussianData data;
    std::vector<double> position;  // in place of data.position where the file has doubles
    std::vector<float> label, label_weight, filter;
    std::vector<std::vector<std::byte>> extra;  // of layout.extra
    std::vector<std::byte> label_numbers;       // as the file has them
};

bool has_doubles(const Described& described) {
    const std::vector<int>& columns = described.layout.position;
    return std::any_of(columns.begin(), columns.end(),
                       [&](int column) { return described.type_of(column) == PlyType::Float64; });
}

/// Gives up the further columns when the memory has no room for them beside the splats.
void require_memory_for(Described& described) {
    auto& [header, vertex, layout, scene, label_name, body_bytes, fit] = described;
    const std::uint64_t splats =
        splat_bytes(vertex->count, layout.sh_degree) + (has_doubles(described) ? vertex->count * 24 : 0);
    require_memory(splats, fmt::format("the scene of {} splats", vertex->count));
    std::uint64_t extra = 0;
    for (const int column : layout.extra) extra += vertex->count * ply_type_size(described.type_of(column));
    try {
        require_memory(splats + extra, "the columns of the scene");
    } catch (const OutOfMemory&) {
        scene.info.warnings.push_back(fmt::format(
            "{} further columns are left out, since the memory has no room for them", layout.extra.size()));
        layout.extra.clear();
    }
}

/// The arrays that take the columns of a file, with room for all rows.
std::vector<PlyTarget> targets_of(const Described& described, RawScene& raw) {
    const PlyLayout& layout = described.layout;
    const auto count = static_cast<std::size_t>(described.vertex->count);
    std::vector<PlyTarget> targets;
    const auto add = [&](const std::vector<int>& columns, std::vector<float>& floats, float missing = 0) {
        floats.reserve(count * columns.size());
        prefer_huge_pages(floats.data(), floats.capacity() * sizeof(float));
        targets.push_back({.columns = columns, .floats = &floats, .missing = missing});
    };
    if (!has_doubles(described)) add(layout.position, raw.data.position);
    add(layout.log_scale, raw.data.log_scale, SurfelLogScale);
    add(layout.rotation, raw.data.rotation);
    add(layout.opacity, raw.data.opacity_logit);
    add(layout.sh, raw.data.sh);
    if (layout.label[0] != Absent) add(layout.label, raw.label);
    if (layout.label_weight[0] != Absent) add(layout.label_weight, raw.label_weight);
    if (layout.filter[0] != Absent) add(layout.filter, raw.filter);
    if (has_doubles(described)) {
        raw.position.reserve(count * 3);
        targets.push_back({.columns = layout.position, .doubles = &raw.position});
    }
    const auto add_bytes = [&](int column, std::vector<std::byte>& bytes) {
        const PlyType type = described.type_of(column);
        bytes.reserve(count * ply_type_size(type));
        targets.push_back({.columns = {column}, .bytes = &bytes, .type = type});
    };
    if (layout.label[0] != Absent) add_bytes(layout.label[0], raw.label_numbers);
    raw.extra.resize(layout.extra.size());
    for (std::size_t i = 0; i < layout.extra.size(); ++i) add_bytes(layout.extra[i], raw.extra[i]);
    return targets;
}

/// A column of the file with the numbers that were read of it.
ExtraColumn column_of(const Described& described, int column, std::vector<std::byte> numbers) {
    return {described.vertex->properties[static_cast<std::size_t>(column)].name, described.type_of(column),
            std::make_shared<const std::vector<std::byte>>(std::move(numbers))};
}

/// The columns that are kept. Normals of zeros, which most writers put there, are not among them.
ExtraColumns take_extra(const Described& described, RawScene& raw) {
    ExtraColumns columns;
    for (std::size_t i = 0; i < raw.extra.size(); ++i) {
        const int column = described.layout.extra[i];
        const std::string& name = described.vertex->properties[static_cast<std::size_t>(column)].name;
        const bool normal = name == "nx" || name == "ny" || name == "nz";
        const auto is_zero = [](std::byte byte) { return byte == std::byte{0}; };
        if (normal && std::all_of(raw.extra[i].begin(), raw.extra[i].end(), is_zero)) continue;
        columns.push_back(column_of(described, column, std::move(raw.extra[i])));
    }
    return columns;
}

void take_positions(const PlyHeader& header, RawScene& raw, SceneInfo& info) {
    if (raw.position.empty()) return;
    auto [offset, values] = near_positions(raw.position, read_offset(header, OffsetComment));
    raw.data.position = std::move(values);
    info.offset = offset;
    if (has_offset(offset))
        info.warnings.push_back(
            fmt::format("the coordinates are large: {} is taken off them here and added again in files",
                        offset_text(offset)));
}

/// Fills the scene with the rows of a source. `rest` is the number of bytes behind them.
Scene fill_scene(Described& described, const PlyRowSource& source, const std::function<std::size_t()>& rest) {
    require_memory_for(described);
    const auto& [header, vertex, layout, scene, label_name, body_bytes, fit] = described;
    RawScene raw;
    raw.data.sh_degree = layout.sh_degree;
    read_ply_rows(source, row_shape(header, *vertex), static_cast<std::size_t>(vertex->count),
                  targets_of(described, raw));
    Scene filled = std::move(described.scene);
    std::vector<std::string>& warnings = filled.info.warnings;
    if (const std::size_t bytes = &header.elements.back() == vertex ? rest() : 0; bytes > 0)
        warnings.push_back(
            fmt::format("{} bytes after the last of the {} splats are ignored", bytes, vertex->count));
    take_positions(header, raw, filled.info);
    decode_values(raw.data, *vertex, layout, warnings);
    if (!raw.filter.empty()) {
        fuse_filter(raw.data, raw.filter);
        warnings.push_back("filter_3D, the 3D filter of Mip-Splatting, is part of sizes and opacities now");
    }
    filled.gaussians = GaussianSet(std::move(raw.data));
    if (fit == RowFit::MayBeLonger && !look_like_splats(filled.gaussians.spans()))
        throw_longer_rows(header, *vertex, body_bytes);
    if (const auto activated = looks_activated(filled.gaussians.spans()); activated.any()) {
        filled.info.looks_activated = true;
        warnings.push_back(activated_text(activated));
    }
    filled.extra = take_extra(described, raw);
    if (add_label(filled, std::move(raw.label), std::move(raw.label_weight), label_name) &&
        layout.label[0] != Absent)
        filled.extra.push_back(column_of(described, layout.label[0], std::move(raw.label_numbers)));
    return filled;
}

bool detect_gaussian_ply(Bytes bytes) { return is_ply(bytes) && !detect_compressed_ply(bytes); }

}  // namespace

bool may_be_gaussian_ply(std::string_view start) {
    const bool whole =
        without_mark(start).starts_with("ply") && start.find("end_header") != std::string_view::npos;
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
            .keeps_up = true,
            .keeps_columns = true,
            .keeps_offset = true};
}

Scene parse_gaussian_ply(Bytes bytes) {
    Described described(bytes, bytes.size());
    const PlyElement& vertex = *described.vertex;
    PlyBody body(bytes, described.header);
    body.seek(vertex);
    const PlyRowShape shape = row_shape(described.header, vertex);
    const Bytes fixed = described.has_fixed_rows() ? body.take_rows(vertex) : Bytes{};
    std::vector<std::byte> walked(described.has_fixed_rows() ? 0 : PlyBlockRows * shape.stride);
    const PlyRowSource source = [&](std::size_t begin, std::size_t end) {
        if (described.has_fixed_rows())
            return fixed.subspan(begin * shape.stride, (end - begin) * shape.stride);
        for (std::size_t row = begin; row < end; ++row)
            body.read_row(vertex, shape, walked.data() + (row - begin) * shape.stride);
        return Bytes(walked);
    };
    Scene scene = fill_scene(described, source, [&] {
        if (described.header.encoding == PlyEncoding::Ascii) check_line_values(body, vertex);
        return body.has_rest() ? body.remaining() : std::size_t{0};
    });
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
    Described described(start, file.size());
    if (states_colour_space(described.header)) return std::nullopt;
    const PlyElement& vertex = *described.vertex;
    const std::uint64_t behind_header = file.size() - described.header.body_offset;
    const std::size_t stride = vertex.row_bytes();
    const bool cut = described.header.body_offset == start.size() &&
                     start.size() < file.size();  // within a line end, maybe
    if (cut || !described.has_fixed_rows() || &vertex != &described.header.elements.front() || stride == 0 ||
        saturating_product(vertex.count, stride) > behind_header)
        return std::nullopt;
    std::vector<std::byte> block(std::max(ReadBytes / stride, PlyBlockRows) * stride);
    const auto count = static_cast<std::size_t>(vertex.count);
    std::size_t first = 0, behind = 0;  // rows in the block
    const PlyRowSource source = [&](std::size_t begin, std::size_t end) {
        if (end > behind) {
            first = begin;
            behind = std::min(count, begin + block.size() / stride);
            file.read(described.header.body_offset + begin * stride,
                      std::span(block).first((behind - first) * stride));
        }
        return Bytes(block).subspan((begin - first) * stride, (end - begin) * stride);
    };
    return fill_scene(described, source,
                      [&] { return static_cast<std::size_t>(behind_header) - count * stride; });
}

}  // namespace gse::io
