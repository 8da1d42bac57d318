// Names of columns, with the refusals of files that are something else than splats.
#include "engine/io/formats/ply/ply_layout.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <optional>
#include <set>

#include "engine/base/error.h"
#include "engine/io/bytes/encoding.h"

namespace gse::io {
namespace {

constexpr std::size_t RestOfDegree4 = 24;
constexpr std::string_view RestPrefix = "f_rest_";

/// Number at the end of a name: "f_rest_7" -> 7.
std::optional<std::size_t> rest_index(std::string_view name) {
    if (!name.starts_with(RestPrefix)) return std::nullopt;
    std::size_t index = 0;
    const auto [end, failure] =
        std::from_chars(name.data() + RestPrefix.size(), name.data() + name.size(), index);
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

/// Finder of columns by their plain names. Notes which ones were found, and whether by a prefix.
class ColumnFinder {
public:
    explicit ColumnFinder(const PlyElement& vertex) : vertex_(vertex) {}

    int find(std::string_view name) {
        int found = vertex_.find(name);
        for (std::size_t i = 0; found < 0 && i < vertex_.properties.size(); ++i)
            if (plain_name(vertex_.properties[i].name) == name) found = static_cast<int>(i);
        return found >= 0 && take(found) ? found : Absent;
    }
    std::vector<int> find(std::initializer_list<const char*> names) {
        std::vector<int> columns;
        for (const char* name : names) columns.push_back(find(name));
        return columns;
    }
    /// Notes a column as used. False for a list, which is no column of numbers.
    bool take(int column) {
        const PlyProperty& property = vertex_.properties[static_cast<std::size_t>(column)];
        if (property.is_list) return false;
        taken_.insert(column);
        prefixed_ = prefixed_ || plain_name(property.name) != property.name;
        return true;
    }
    bool is_taken(int column) const { return taken_.contains(column); }
    bool prefixed() const { return prefixed_; }

private:
    const PlyElement& vertex_;
    std::set<int> taken_;
    bool prefixed_ = false;
};

bool complete(const std::vector<int>& columns) {
    return std::find(columns.begin(), columns.end(), Absent) == columns.end();
}

/// Columns of coefficients by their numbers. A plain name goes before one with a prefix.
std::vector<int> rest_by_index(const PlyElement& vertex, ColumnFinder& finder) {
    std::vector<int> by_index;
    for (const bool prefixed : {false, true})
        for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
            const PlyProperty& property = vertex.properties[i];
            const std::string_view plain = plain_name(property.name);
            const auto index = rest_index(plain);
            if (!index || prefixed != (plain != property.name)) continue;
            if (*index >= vertex.properties.size() || property.is_list)
                throw Error(ErrorCode::Malformed, "the PLY header numbers its f_rest properties with gaps");
            if (by_index.size() <= *index) by_index.resize(*index + 1, Absent);
            if (by_index[*index] != Absent && prefixed) continue;
            by_index[*index] = static_cast<int>(i);
            finder.take(static_cast<int>(i));
        }
    return by_index;
}

/// Columns of the SH coefficients beyond DC, coefficient-major. The file has all of red first, then green,
/// then blue.
std::vector<int> rest_columns(const std::vector<int>& by_index, PlyLayout& layout,
                              std::vector<std::string>& warnings) {
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

/// Refuses the anchors of Scaffold-GS and its kin, which have opacities, sizes and rotations as splats do.
void refuse_anchors(const PlyElement& vertex) {
    for (const PlyProperty& property : vertex.properties) {
        const std::string_view name = plain_name(property.name);
        if (name.starts_with("f_anchor_feat") || name.starts_with("f_offset"))
            throw Error(ErrorCode::Unsupported,
                        "this PLY file holds the anchors of Scaffold-GS, from which its networks make the "
                        "splats of every view, not the splats themselves",
                        "let Scaffold-GS write its splats as a 3DGS PLY, or train the scene with 3DGS");
    }
}

/// Finds columns that are kept as they are. Names that the writer gives to attributes are not among them.
void find_extra(const PlyElement& vertex, const ColumnFinder& finder, PlyLayout& layout) {
    std::set<std::string_view> seen = {"x",       "y",      "z",     "opacity",     "scale_0", "scale_1",
                                       "scale_2", "rot_0",  "rot_1", "rot_2",       "rot_3",   "f_dc_0",
                                       "f_dc_1",  "f_dc_2", "label", "label_weight"};
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
        const PlyProperty& property = vertex.properties[i];
        if (finder.is_taken(static_cast<int>(i))) continue;
        if (property.is_list) layout.lists.push_back(property.name);
        else if (!rest_index(property.name) && seen.insert(property.name).second)
            layout.extra.push_back(static_cast<int>(i));
    }
}

bool is_byte(PlyType type) { return type == PlyType::Int8 || type == PlyType::Uint8; }
bool is_short(PlyType type) { return type == PlyType::Int16 || type == PlyType::Uint16; }
bool is_fraction(PlyType type) { return type == PlyType::Float32 || type == PlyType::Float64; }

bool contains(const std::vector<int>& columns, int column) {
    return std::find(columns.begin(), columns.end(), column) != columns.end();
}

}  // namespace

std::string_view plain_name(std::string_view name) {
    while (true) {
        const std::string_view before = name;
        for (const std::string_view prefix : {std::string_view("scalar_"), std::string_view("scal_")})
            if (name.size() > prefix.size() && name.starts_with(prefix)) name.remove_prefix(prefix.size());
        if (name == before) return name;
    }
}

PlyLayout find_ply_layout(const PlyHeader& header, const PlyElement& vertex,
                          std::vector<std::string>& warnings) {
    PlyLayout layout;
    ColumnFinder finder(vertex);
    layout.position = finder.find({"x", "y", "z"});
    layout.sh = finder.find({"f_dc_0", "f_dc_1", "f_dc_2"});
    if (!complete(layout.sh)) refuse_anchors(vertex);
    layout.opacity = finder.find({"opacity"});
    layout.log_scale = finder.find({"scale_0", "scale_1", "scale_2"});
    layout.rotation = finder.find({"rot_0", "rot_1", "rot_2", "rot_3"});
    layout.label = finder.find({"label"});
    layout.label_weight = finder.find({"label_weight"});
    layout.filter = finder.find({"filter_3D"});
    if (!complete(layout.position)) throw_not_gaussian(header, vertex, "x, y and z");
    if (!complete(layout.opacity)) throw_not_gaussian(header, vertex, "opacity");
    if (!complete(layout.rotation)) throw_not_gaussian(header, vertex, "rot_0 to rot_3");
    if (layout.log_scale[0] == Absent || layout.log_scale[1] == Absent)
        throw_not_gaussian(header, vertex, "scale_0 to scale_2");
    if (layout.log_scale[2] == Absent)
        warnings.push_back("scale_2 is missing: flat 2DGS surfels get a thickness of 1e-6");
    if (!complete(layout.sh)) {
        layout.sh = finder.find({"red", "green", "blue"});
        layout.colours = true;
        if (!complete(layout.sh)) throw_not_gaussian(header, vertex, "f_dc_0 to f_dc_2");
    }
    const std::vector<int> rest = rest_columns(rest_by_index(vertex, finder), layout, warnings);
    layout.sh.insert(layout.sh.end(), rest.begin(), rest.end());
    if (finder.prefixed())
        warnings.push_back("the columns have names with CloudCompare's prefix, which is left out");
    find_extra(vertex, finder, layout);
    return layout;
}

PlyCoding coding_of(const PlyElement& vertex, const PlyLayout& layout, int column) {
    const auto property_of = [&](int index) -> const PlyProperty& {
        return vertex.properties[static_cast<std::size_t>(index)];
    };
    const PlyProperty& property = property_of(column);
    // One such column may be of whole numbers; a whole scene is not.
    const bool halves =
        is_short(property_of(layout.log_scale[0]).type) && is_short(property_of(layout.rotation[0]).type);
    if (contains(layout.opacity, column) && !(halves && is_short(property.type)))
        return is_fraction(property.type) ? PlyCoding::Value : PlyCoding::Share;
    if (contains(layout.position, column)) {
        return halves && is_short(property.type) ? PlyCoding::Half : PlyCoding::Value;
    }
    const auto sh = std::find(layout.sh.begin(), layout.sh.end(), column) - layout.sh.begin();
    const bool is_sh = sh < static_cast<std::ptrdiff_t>(layout.sh.size());
    if (is_sh && sh < 3 && layout.colours)
        return is_fraction(property.type) ? PlyCoding::Value : PlyCoding::Share;
    if (is_short(property.type)) return PlyCoding::Half;
    if (is_sh && is_byte(property.type)) return PlyCoding::ByteColour;
    if (is_byte(property.type))
        throw Error(ErrorCode::Unsupported,
                    fmt::format("the column \"{}\" of this PLY file holds 8-bit numbers, which say neither a "
                                "size nor a rotation",
                                property.name),
                    "export the scene again with float columns");
    return PlyCoding::Value;
}

}  // namespace gse::io
