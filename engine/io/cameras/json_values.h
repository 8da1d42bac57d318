// Values of camera files in JSON, as the tools of other people write them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gse::io {

/// The value in `text`. NaN and Infinity, which Python writes and JSON does not have, become null. Throws
/// Error (Malformed) that begins with `what`.
nlohmann::json parse_camera_json(std::string_view text, std::string_view what);

/// A finite number: of a number, or of text that is one from end to end ("64"). Nothing for other values.
std::optional<double> number_in(const nlohmann::json& value);
/// The number at a key. Nothing where `object` is no object or has no number there.
std::optional<double> number_at(const nlohmann::json& object, const char* key);
/// The number at a key. Throws Error (Malformed) where there is none.
double needed_number_at(const nlohmann::json& object, const char* key);
/// Fills `numbers` from the first entries of a list. False where it is shorter or holds anything else.
bool read_numbers(const nlohmann::json& list, std::span<double> numbers);

/// The text at a key; a number gives its digits. Nothing for other values.
std::optional<std::string> text_at(const nlohmann::json& object, const char* key);
/// True for true, "true" and numbers but 0.
bool flag_at(const nlohmann::json& object, const char* key);

}  // namespace gse::io
