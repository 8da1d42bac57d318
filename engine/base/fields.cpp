// Checks of settings. A value that does not fit is refused by the setting's name.
#include "engine/base/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/log.h"

namespace gse {
namespace {

using Json = nlohmann::ordered_json;

std::string range_text(const Range* range) {
    return range != nullptr ? fmt::format("a number from {} to {}", range->low, range->high)
                            : "a finite number";
}

[[noreturn]] void refuse(const char* name, const std::string& wanted, const std::string& found) {
    throw Error(ErrorCode::InvalidArgument,
                fmt::format("the setting \"{}\" must be {}, not {}", name, wanted, found));
}

/// A value as a message shows it, cut if it is long.
std::string shown(const Json& json) {
    constexpr std::size_t longest = 40;
    if (json.is_structured()) return json.is_array() ? "a list" : "an object";
    const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    return text.size() > longest ? text.substr(0, longest) + "..." : text;
}

double number(const char* name, const Json& json, const Range* range) {
    if (!json.is_number()) refuse(name, range_text(range), shown(json));
    const double value = json.get<double>();
    check_field(name, value, range);
    return value;
}

/// A whole number that T holds, written either way (12 or 12.0).
template <class T> T whole(const char* name, const Json& json, const Range* range) {
    const double value = number(name, json, range);
    using Limits = std::numeric_limits<T>;
    if (std::floor(value) != value) refuse(name, "a whole number", shown(json));
    if (!(value >= static_cast<double>(Limits::lowest()) && value < std::ldexp(1.0, Limits::digits)) &&
        !(json.is_number_unsigned() && std::is_unsigned_v<T>))
        refuse(name, fmt::format("a whole number from {} to {}", Limits::lowest(), Limits::max()),
               shown(json));
    if (json.is_number_float()) return static_cast<T>(value);
    return json.is_number_unsigned() ? static_cast<T>(json.get<std::uint64_t>())
                                     : static_cast<T>(json.get<std::int64_t>());
}

/// The limits as a float meets them: 0.1f lies above 0.1.
Range as_floats(const Range& range) {
    return {std::min(range.low, static_cast<double>(static_cast<float>(range.low))),
            std::max(range.high, static_cast<double>(static_cast<float>(range.high)))};
}

}  // namespace

Json with_present_names(const Json& json, std::span<const RenamedField> renamed) {
    Json present = Json::object();
    for (const auto& field : json.items()) {
        const auto found = std::find_if(renamed.begin(), renamed.end(), [&](const RenamedField& other) {
            return field.key() == other.before;
        });
        const bool moves = found != renamed.end() && !json.contains(found->now);
        present[moves ? std::string(found->now) : field.key()] = field.value();
    }
    return present;
}

void note_retired_field(std::string_view name) {
    log::info("the setting \"{}\" is no longer there and is ignored", name);
}

void check_field(const char* name, float value, const Range* range) {
    const Range rounded = range != nullptr ? as_floats(*range) : Range{};
    check_field(name, static_cast<double>(value), range != nullptr ? &rounded : nullptr);
}

void check_field(const char* name, double value, const Range* range) {
    const bool fits =
        std::isfinite(value) && (range == nullptr || (value >= range->low && value <= range->high));
    if (!fits) refuse(name, range_text(range), fmt::format("{:g}", value));
}

void read_field(const char* name, bool& value, const Json& json) {
    if (!json.is_boolean()) refuse(name, "true or false", shown(json));
    value = json.get<bool>();
}

void read_field(const char* name, int& value, const Json& json, const Range* range) {
    value = whole<int>(name, json, range);
}

void read_field(const char* name, std::uint64_t& value, const Json& json, const Range* range) {
    value = whole<std::uint64_t>(name, json, range);
}

void read_field(const char* name, float& value, const Json& json, const Range* range) {
    const Range rounded = range != nullptr ? as_floats(*range) : Range{};
    const double wide = number(name, json, range != nullptr ? &rounded : nullptr);
    if (std::abs(wide) > static_cast<double>(std::numeric_limits<float>::max()))
        refuse(name, range_text(range), shown(json));
    value = static_cast<float>(wide);
}

void read_field(const char* name, double& value, const Json& json, const Range* range) {
    value = number(name, json, range);
}

void read_field(const char* name, Overridable& value, const Json& json, const Range* range) {
    if (json.is_null()) value.unset();
    else value = number(name, json, range);
}

void read_field(const char* name, std::string& value, const Json& json) {
    if (!json.is_string()) refuse(name, "text", shown(json));
    value = json.get<std::string>();
}

void read_field(const char* name, std::vector<std::string>& value, const Json& json) {
    const auto is_text = [](const Json& entry) { return entry.is_string(); };
    if (!json.is_array() || !std::all_of(json.begin(), json.end(), is_text))
        refuse(name, "a list of texts", shown(json));
    value = json.get<std::vector<std::string>>();
}

}  // namespace gse
