// PLY files made up column by column, for the tests of their readers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "engine/scene/gaussian_set.h"

namespace gse::test {

enum class Encoding { Ascii, Little, Big };

/// One column of a made-up PLY: its name, its type and its value for a row.
struct Column {
    std::string name;
    std::string type = "float";
    std::function<double(std::size_t)> value;
};

template <class T> void append_scalar(std::string& out, T value, bool big_endian) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
}

inline void append_value(std::string& out, const std::string& type, double value, Encoding encoding) {
    const bool big = encoding == Encoding::Big;
    char text[64];
    if (encoding == Encoding::Ascii) {
        std::snprintf(text, sizeof text, type == "double" ? "%.17g " : "%.9g ", value);
        out += text;
    } else if (type == "float" || type == "float32") {
        append_scalar(out, static_cast<float>(value), big);
    } else if (type == "double" || type == "float64") {
        append_scalar(out, value, big);
    } else if (type == "uchar" || type == "uint8") {
        append_scalar(out, static_cast<std::uint8_t>(value), big);
    } else if (type == "short" || type == "int16") {
        append_scalar(out, static_cast<std::int16_t>(value), big);
    } else if (type == "ushort" || type == "uint16") {
        append_scalar(out, static_cast<std::uint16_t>(value), big);
    } else {
        append_scalar(out, static_cast<std::int32_t>(value), big);
    }
}

/// The columns of these splats in the Inria order.
inline std::vector<Column> columns_of(const GaussianData& data) {
    std::vector<Column> columns;
    const auto add = [&](const std::string& name, const std::vector<float>& values, std::size_t stride,
                         std::size_t offset) {
        columns.push_back({name, "float", [&values, stride, offset](std::size_t row) {
                               return static_cast<double>(values[row * stride + offset]);
                           }});
    };
    for (std::size_t i = 0; i < 3; ++i) add(std::string(1, "xyz"[i]), data.position, 3, i);
    for (std::size_t i = 0; i < 3; ++i) add("f_dc_" + std::to_string(i), data.sh, data.sh_stride(), i);
    const std::size_t rest = data.sh_stride() / 3 - 1;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < rest; ++k)
            add("f_rest_" + std::to_string(c * rest + k), data.sh, data.sh_stride(), (k + 1) * 3 + c);
    add("opacity", data.opacity_logit, 1, 0);
    for (std::size_t i = 0; i < 3; ++i) add("scale_" + std::to_string(i), data.log_scale, 3, i);
    for (std::size_t i = 0; i < 4; ++i) add("rot_" + std::to_string(i), data.rotation, 4, i);
    return columns;
}

struct FileShape {
    Encoding encoding = Encoding::Little;
    std::string line_end = "\n";
    bool face_first = false;   // a face element with lists before the vertices
    bool list_inside = false;  // a list property among the vertex's
    bool trailing_element = false;
    bool padded = false;
    std::string comments = {};  // whole lines, before the elements
};

inline std::string make_ply(const std::vector<Column>& columns, std::size_t count, const FileShape& shape) {
    const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    std::string out = "ply" + shape.line_end;
    const auto line = [&](const std::string& text) {
        out += text + (shape.padded ? " \t" : "") + shape.line_end;
    };
    line(std::string("format ") + names[static_cast<int>(shape.encoding)] + " 1.0");
    line("comment made for a test");
    line("obj_info nothing");
    out += shape.comments;
    if (shape.face_first) {
        line("element face 2");
        line("property list uchar int vertex_indices");
        line("property float area");
    }
    line("element vertex " + std::string(shape.padded ? "   " : "") + std::to_string(count));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (shape.list_inside && i == columns.size() / 2) line("property list uchar short extra_list");
        line("property " + columns[i].type + " " + columns[i].name);
    }
    if (shape.trailing_element) {
        line("element note 1");
        line("property uchar mark");
    }
    out += "end_header" + shape.line_end;
    const auto put = [&](const std::string& type, double value) {
        append_value(out, type, value, shape.encoding);
    };
    if (shape.face_first)
        for (int face = 0; face < 2; ++face) {
            put("uchar", 3 - face);
            for (int i = 0; i < 3 - face; ++i) put("int", i);
            put("float", 1.5);
            if (shape.encoding == Encoding::Ascii) out += "\n";
        }
    for (std::size_t row = 0; row < count; ++row) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (shape.list_inside && i == columns.size() / 2) {
                put("uchar", static_cast<double>(row % 3));
                for (std::size_t item = 0; item < row % 3; ++item) put("short", -7);
            }
            put(columns[i].type, columns[i].value(row));
        }
        if (shape.encoding == Encoding::Ascii) out += shape.line_end;
    }
    if (shape.trailing_element) put("uchar", 7);
    return out;
}

}  // namespace gse::test
