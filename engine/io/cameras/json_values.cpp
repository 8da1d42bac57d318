// Numbers and texts of camera files.
#include "engine/io/cameras/json_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/io/bytes/letter_case.h"

namespace gse::io {
namespace {

using Json = nlohmann::json;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// End of the string literal that begins at `begin`.
std::size_t end_of_literal(std::string_view text, std::size_t begin) {
    std::size_t at = begin + 1;
    while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
    return std::min(at + 1, text.size());
}

/// The text with null for every word that stands for no finite number, and its sign.
std::string without_infinities(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t at = 0; at < text.size();) {
        std::size_t end = at + 1;
        if (text[at] == '"') end = end_of_literal(text, at);
        else if (is_letter(text[at]))
            while (end < text.size() && is_letter(text[end])) ++end;
        const std::string_view piece = text.substr(at, end - at);
        const std::string word = is_letter(piece.front()) ? lower_case(piece) : std::string();
        at = end;
        if (word != "nan" && word != "infinity" && word != "inf") {
            out += piece;
            continue;
        }
        if (!out.empty() && (out.back() == '-' || out.back() == '+')) out.pop_back();
        out += "null";
    }
    return out;
}

const Json* entry_at(const Json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

}  // namespace

Json parse_camera_json(std::string_view text, std::string_view what) {
    if (Json json = try_parse_json(text); !json.is_discarded()) return json;
    return parse_json(without_infinities(text), what);
}

std::optional<double> number_in(const Json& value) {
    double number = 0;
    if (value.is_number()) {
        number = value.get<double>();
    } else if (value.is_string()) {
        const auto& text = value.get_ref<const std::string&>();
        const std::size_t first = text.find_first_not_of(" \t");
        if (first == std::string::npos) return std::nullopt;
        const char* end = text.data() + text.find_last_not_of(" \t") + 1;
        const auto [stopped, failure] = std::from_chars(text.data() + first, end, number);
        if (failure != std::errc{} || stopped != end) return std::nullopt;
    } else {
        return std::nullopt;
    }
    return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::optional<double> number_at(const Json& object, const char* key) {
    const Json* entry = entry_at(object, key);
    return entry == nullptr ? std::nullopt : number_in(*entry);
}

double needed_number_at(const Json& object, const char* key) {
    const auto number = number_at(object, key);
    if (!number)
        throw Error(ErrorCode::Malformed,
                    "the entry " + std::string(key) +
                        (entry_at(object, key) == nullptr ? " is missing" : " is not a number"));
    return *number;
}

bool read_numbers(const Json& list, std::span<double> numbers) {
    if (!list.is_array() || list.size() < numbers.size()) return false;
    for (std::size_t at = 0; at < numbers.size(); ++at) {
        const auto number = number_in(list[at]);
        if (!number) return false;
        numbers[at] = *number;
    }
    return true;
}

std::optional<std::string> text_at(const Json& object, const char* key) {
    const Json* entry = entry_at(object, key);
    if (entry != nullptr && entry->is_string()) return entry->get<std::string>();
    if (entry != nullptr && entry->is_number()) return entry->dump();
    return std::nullopt;
}

bool flag_at(const Json& object, const char* key) {
    const Json* entry = entry_at(object, key);
    if (entry == nullptr) return false;
    if (entry->is_boolean()) return entry->get<bool>();
    if (entry->is_string()) return lower_case(entry->get<std::string>()) == "true";
    return number_in(*entry).value_or(0) != 0;
}

}  // namespace gse::io
