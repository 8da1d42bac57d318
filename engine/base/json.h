// Parsing of JSON from files and from the user. All JSON passes here, so that depth and damage are handled
// once.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "engine/base/error.h"

namespace gse {

/// Most arrays and objects within each other. Code that walks or writes a parsed value may recurse.
constexpr int DeepestJson = 128;

/// True when no value lies deeper than DeepestJson. Counts brackets outside of strings only.
bool json_depth_fits(std::string_view text);

/// Place at which a parser stopped: "line 3, column 14".
std::string place_in_text(std::string_view text, std::size_t byte);

/// The value in `text`. A discarded one when it is not valid or nested too deep.
template <class Json = nlohmann::json> Json try_parse_json(std::string_view text) {
    if (!json_depth_fits(text)) return Json(Json::value_t::discarded);
    return Json::parse(text.begin(), text.end(), nullptr, false);
}

/// The value in `text`. Throws Error (Malformed) that begins with `what` ("the recipe") and names the broken
/// place.
template <class Json = nlohmann::json>
Json parse_json(std::string_view text, std::string_view what,
                const char* hint = "the file is damaged or of another kind") {
    if (!json_depth_fits(text))
        throw Error(
            ErrorCode::Malformed,
            std::string(what) + " is nested more than " + std::to_string(DeepestJson) + " levels deep", hint);
    try {
        return Json::parse(text.begin(), text.end());
    } catch (const typename Json::parse_error& failure) {
        throw Error(ErrorCode::Malformed,
                    std::string(what) + " is not valid JSON (" + place_in_text(text, failure.byte) + ")",
                    hint);
    } catch (const typename Json::exception&) {  // a number that no double holds
        throw Error(ErrorCode::Malformed, std::string(what) + " holds a number that is too large", hint);
    }
}

/// The value as text. Bytes that are not UTF-8 become U+FFFD. With `ascii`, all other characters are escaped
/// too.
template <class Json> std::string json_text(const Json& json, int indent = -1, bool ascii = false) {
    return json.dump(indent, ' ', ascii, Json::error_handler_t::replace);
}

}  // namespace gse
