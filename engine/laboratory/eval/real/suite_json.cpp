// Types and presence of entries.
#include "engine/laboratory/eval/real/suite_json.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/error.h"

namespace gse::bench {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

void refuse_suite(const std::string& where, const std::string& problem) {
    throw Error(ErrorCode::Malformed, fmt::format("{}: {}", where, problem), "correct the suite's file");
}

bool has_entry(const Json& json, const std::string& name) {
    return json.is_object() && json.contains(name) && !json[name].is_null();
}

const Json& entry_of(const Json& json, const std::string& name, const std::string& where) {
    if (!json.is_object()) refuse_suite(where, "it is no object of names and values");
    if (!has_entry(json, name)) refuse_suite(where, fmt::format("\"{}\" is missing", name));
    return json[name];
}

std::string text_entry(const Json& json, const std::string& name, const std::string& where) {
    const auto& value = entry_of(json, name, where);
    if (!value.is_string()) refuse_suite(where, fmt::format("\"{}\" is no text", name));
    return value.get<std::string>();
}

bool bool_entry(const Json& json, const std::string& name, const std::string& where) {
    const auto& value = entry_of(json, name, where);
    if (!value.is_boolean()) refuse_suite(where, fmt::format("\"{}\" is neither true nor false", name));
    return value.get<bool>();
}

double number_of(const Json& json, const std::string& where) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) refuse_suite(where, "it is no number");
    return json.get<double>();
}

double number_entry(const Json& json, const std::string& name, const std::string& where) {
    return number_of(entry_of(json, name, where), fmt::format("{}, \"{}\"", where, name));
}

Vec3 vector_of(const Json& json, const std::string& where) {
    if (!json.is_array() || json.size() != 3) refuse_suite(where, "it is no list of three numbers");
    return {number_of(json[0], where), number_of(json[1], where), number_of(json[2], where)};
}

Vec3 vector_entry(const Json& json, const std::string& name, const std::string& where) {
    return vector_of(entry_of(json, name, where), fmt::format("{}, \"{}\"", where, name));
}

const Json& list_entry(const Json& json, const std::string& name, const std::string& where) {
    const auto& value = entry_of(json, name, where);
    if (!value.is_array()) refuse_suite(where, fmt::format("\"{}\" is no list", name));
    return value;
}

}  // namespace gse::bench
