// Comments of PLY headers: Brush's and nerfstudio's up axis, the way of drawing.
#include "engine/io/formats/ply/ply_comments.h"

#include <fmt/core.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "engine/scene/origin/world_offset.h"

namespace gse::io {
namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& letter : result) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return result;
}

/// Text after `key`, without blanks around it, when the comment begins with `key` in any case.
std::optional<std::string> comment_value(const std::string& comment, std::string_view key) {
    if (lower(comment).substr(0, key.size()) != lower(key)) return std::nullopt;
    std::string value = comment.substr(key.size());
    value.erase(0, value.find_first_not_of(" \t:"));
    return value;
}

std::optional<Vec3> three_numbers(const std::string& text) {
    Vec3 numbers;
    const char* cursor = text.c_str();
    for (int i = 0; i < 3; ++i) {
        char* end = nullptr;
        numbers[i] = std::strtod(cursor, &end);
        if (end == cursor || !std::isfinite(numbers[i])) return std::nullopt;
        cursor = end;
    }
    return numbers;
}

/// Up axis of a comment. Brush writes "Vertical axis" and means the negative axis by a bare letter.
/// nerfstudio writes "Vertical Axis: z" for its world with +z up. Three numbers are taken literally.
std::optional<Vec3> vertical_axis(const std::string& comment) {
    const auto value = comment_value(comment, "vertical axis");
    if (!value) return std::nullopt;
    const double sign = comment.find("Axis") != std::string::npos ? 1 : -1;
    const std::string axis = lower(*value);
    if (axis == "x") return Vec3{sign, 0, 0};
    if (axis == "y") return Vec3{0, sign, 0};
    if (axis == "z") return Vec3{0, 0, sign};
    const auto up = three_numbers(axis);
    if (!up || length(*up) == 0) return std::nullopt;
    return normalized(*up);
}

}  // namespace

std::string read_comments(const PlyHeader& header, SceneInfo& info) {
    std::string label_name = "label";
    for (const std::string& comment : header.comments) {
        if (const auto up = vertical_axis(comment)) {
            info.up = *up;
            info.up_known = true;
        }
        if (const auto mode = comment_value(comment, "splatrendermode")) {
            info.antialiased = lower(*mode) == "mip";
            if (lower(*mode) == "2dgs")
                info.warnings.push_back("the file asks for 2DGS rendering; it is drawn as 3DGS");
        }
        if (const auto flag = comment_value(comment, "antialiased")) info.antialiased = *flag == "1";
        if (const auto name = comment_value(comment, "label name")) label_name = *name;
    }
    return label_name;
}

std::string comment_lines(const SceneInfo& info) {
    std::string text;
    if (info.antialiased) text += "comment SplatRenderMode: mip\n";
    if (info.up_known)
        text += fmt::format("comment Vertical axis: {} {} {}\n", info.up.x, info.up.y, info.up.z);
    return text;
}

std::optional<Vec3> read_offset(const PlyHeader& header, std::string_view beginning) {
    std::optional<Vec3> offset;
    for (const std::string& comment : header.comments)
        if (const auto value = comment_value(comment, beginning))
            if (const auto numbers = three_numbers(*value)) offset = numbers;
    return offset;
}

std::string offset_line(std::string_view beginning, const Vec3& offset) {
    if (!has_offset(offset)) return {};
    return fmt::format("comment {}: {} {} {}\n", beginning, offset.x, offset.y, offset.z);
}

}  // namespace gse::io
