// Line-by-line reading of a PLY header. Every complaint names the line.
#include "engine/io/formats/ply/ply_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "engine/base/error.h"
#include "engine/io/bytes/byte_reader.h"

namespace gse::io {
namespace {

constexpr std::size_t LongestShown = 40;  // characters of a bad line quoted in a message

struct TypeName {
    std::string_view name;
    PlyType type;
};
constexpr std::array<TypeName, 16> TypeNames = {{{"char", PlyType::Int8},
                                                 {"uchar", PlyType::Uint8},
                                                 {"short", PlyType::Int16},
                                                 {"ushort", PlyType::Uint16},
                                                 {"int", PlyType::Int32},
                                                 {"uint", PlyType::Uint32},
                                                 {"float", PlyType::Float32},
                                                 {"double", PlyType::Float64},
                                                 {"int8", PlyType::Int8},
                                                 {"uint8", PlyType::Uint8},
                                                 {"int16", PlyType::Int16},
                                                 {"uint16", PlyType::Uint16},
                                                 {"int32", PlyType::Int32},
                                                 {"uint32", PlyType::Uint32},
                                                 {"float32", PlyType::Float32},
                                                 {"float64", PlyType::Float64}}};

constexpr std::string_view ByteOrderMark = "\xEF\xBB\xBF";

bool is_blank(char letter) { return letter == ' ' || letter == '\t' || letter == '\r'; }

std::string printable(std::string_view text) {
    std::string result;
    for (const char letter : text.substr(0, LongestShown))
        result += letter >= ' ' && letter < 127 ? letter : '?';
    return result;
}

class HeaderParser {
public:
    explicit HeaderParser(std::string_view text)
        : text_(text), offset_(text.size() - without_mark(text).size()) {}

    PlyHeader parse() {
        detect_line_end();
        next_line();  // "ply"
        while (true) {
            if (!next_line())
                throw Error(ErrorCode::Malformed, "the PLY header ends without end_header",
                            "the file is cut off or damaged; get it again");
            const std::string_view word = next_word();
            if (word == "end_header") break;
            parse_line(word);
        }
        if (!format_seen_) throw Error(ErrorCode::Malformed, "the PLY header has no format line");
        header_.body_offset = offset_;
        return std::move(header_);
    }

private:
    void parse_line(std::string_view word) {
        if (word == "comment" || word == "obj_info") {
            while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
            header_.comments.emplace_back(rest_);
        } else if (word == "format") {
            parse_format();
        } else if (word == "element") {
            parse_element();
        } else if (word == "property") {
            parse_property();
        } else if (!word.empty()) {
            fail("is not a PLY header line");
        }
    }

    void parse_format() {
        const std::string_view name = next_word();
        if (name == "ascii") header_.encoding = PlyEncoding::Ascii;
        else if (name == "binary_little_endian") header_.encoding = PlyEncoding::LittleEndian;
        else if (name == "binary_big_endian") header_.encoding = PlyEncoding::BigEndian;
        else fail("names an unknown format");
        format_seen_ = true;
    }

    void parse_element() {
        PlyElement element;
        element.name = next_word();
        const std::string_view count = next_word();
        const auto [end, failure] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (element.name.empty() || failure != std::errc{} || end != count.data() + count.size())
            fail("has no valid count");
        header_.elements.push_back(std::move(element));
    }

    void parse_property() {
        if (header_.elements.empty()) fail("comes before any element");
        PlyProperty property;
        std::string_view type = next_word();
        if (type == "list") {
            property.is_list = true;
            property.count_type = parse_type(next_word());
            type = next_word();
            if (property.count_type == PlyType::Float32 || property.count_type == PlyType::Float64)
                fail("counts a list with a fraction");
        }
        property.type = parse_type(type);
        property.name = next_word();
        if (property.name.empty()) fail("has no property name");
        header_.elements.back().properties.push_back(std::move(property));
    }

    PlyType parse_type(std::string_view name) const {
        for (const TypeName& known : TypeNames)
            if (known.name == name) return known.type;
        fail("names an unknown type");
    }

    /// Finds the end of lines. Old Macintosh files end lines with CR alone, seen from the first line.
    void detect_line_end() {
        const std::size_t first = text_.find_first_of("\r\n");
        const bool lone_return = first != std::string_view::npos && text_[first] == '\r' &&
                                 !(first + 1 < text_.size() && text_[first + 1] == '\n');
        line_end_ = lone_return ? '\r' : '\n';
    }

    bool next_line() {
        const std::size_t end = text_.find(line_end_, offset_);
        if (end == std::string_view::npos) return false;
        line_ = rest_ = text_.substr(offset_, end - offset_);
        while (!rest_.empty() && is_blank(rest_.back())) rest_.remove_suffix(1);
        offset_ = end + 1;
        ++line_number_;
        return true;
    }

    std::string_view next_word() {
        while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
        const std::size_t size =
            static_cast<std::size_t>(std::find_if(rest_.begin(), rest_.end(), is_blank) - rest_.begin());
        const std::string_view word = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return word;
    }

    [[noreturn]] void fail(const char* what) const {
        throw Error(
            ErrorCode::Malformed,
            fmt::format("line {} of the PLY header (\"{}\") {}", line_number_, printable(line_), what),
            "the file is damaged or not a PLY file");
    }

    std::string_view text_, line_, rest_;
    std::size_t offset_ = 0;
    std::size_t line_number_ = 0;
    char line_end_ = '\n';
    bool format_seen_ = false;
    PlyHeader header_;
};

}  // namespace

const char* ply_type_name(PlyType type) { return TypeNames[static_cast<std::size_t>(type)].name.data(); }

std::string_view without_mark(std::string_view text) {
    return text.starts_with(ByteOrderMark) ? text.substr(ByteOrderMark.size()) : text;
}

bool PlyElement::has_list() const {
    return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::row_bytes() const {
    std::size_t bytes = 0;
    for (const PlyProperty& property : properties) bytes += ply_type_size(property.type);
    return bytes;
}

std::size_t PlyElement::least_row_bytes() const {
    std::size_t bytes = 0;
    for (const PlyProperty& property : properties)
        bytes += ply_type_size(property.is_list ? property.count_type : property.type);
    return bytes;
}

int PlyElement::find(std::string_view property) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].name == property) return static_cast<int>(i);
    return -1;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
    for (const PlyElement& candidate : elements)
        if (candidate.name == element) return &candidate;
    return nullptr;
}

bool is_ply(std::span<const std::byte> bytes) {
    const std::string_view text = without_mark({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return text.size() > 3 && text.substr(0, 3) == "ply" && (is_blank(text[3]) || text[3] == '\n');
}

PlyHeader parse_ply_header(std::span<const std::byte> bytes) {
    return HeaderParser({reinterpret_cast<const char*>(bytes.data()), bytes.size()}).parse();
}

}  // namespace gse::io
