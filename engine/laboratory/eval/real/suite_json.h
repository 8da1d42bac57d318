// Values of a suite's file, read with a sentence for each that is wrong.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "engine/math/vec.h"

namespace gse::bench {

/// Throws Error (Malformed): "`where`: `problem`".
[[noreturn]] void refuse_suite(const std::string& where, const std::string& problem);

/// Entry of an object. Throws Error (Malformed) where there is none.
const nlohmann::ordered_json& entry_of(const nlohmann::ordered_json& json, const std::string& name,
                                       const std::string& where);

/// Values of entries. Throw Error (Malformed) where they are missing or of another type.
std::string text_entry(const nlohmann::ordered_json& json, const std::string& name, const std::string& where);
bool bool_entry(const nlohmann::ordered_json& json, const std::string& name, const std::string& where);
double number_entry(const nlohmann::ordered_json& json, const std::string& name, const std::string& where);
Vec3 vector_entry(const nlohmann::ordered_json& json, const std::string& name, const std::string& where);
/// Entry that is a list. Throws as the others do.
const nlohmann::ordered_json& list_entry(const nlohmann::ordered_json& json, const std::string& name,
                                         const std::string& where);

/// Values themselves; `where` names them.
double number_of(const nlohmann::ordered_json& json, const std::string& where);
Vec3 vector_of(const nlohmann::ordered_json& json, const std::string& where);

/// True for an entry that is there and not null.
bool has_entry(const nlohmann::ordered_json& json, const std::string& name);

}  // namespace gse::bench
