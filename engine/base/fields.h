// One list of fields per parameter struct serves command line, project file, log and window.
//
// A struct P offers   template <class Self, class F> static void visit_fields(Self& self, F&& f)
// that calls          f("name", self.member, "What it does.", Range{low, high})   once per member;
// the range is left out where there is none. Members are bool, int, std::uint64_t, float, double or std::string.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/error.h"

namespace gse {

/// Inclusive limits of a number.
struct Range {
    double low = 0;
    double high = 0;
};

/// All fields as a JSON object, in the order of the list.
template <class P>
nlohmann::ordered_json fields_to_json(const P& parameters) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    P::visit_fields(parameters, [&](const char* name, const auto& value, const char*, auto...) { json[name] = value; });
    return json;
}

/// Sets the fields named in `json`; absent ones keep their value. Throws Error for an unknown name, a wrong type or a
/// number out of its range.
template <class P>
void fields_from_json(P& parameters, const nlohmann::ordered_json& json) {
    std::size_t known = 0;
    P::visit_fields(parameters, [&](const char* name, auto& value, const char*, auto... range) {
        if (!json.contains(name)) return;
        ++known;
        try {
            json.at(name).get_to(value);
        } catch (const nlohmann::json::exception&) {
            throw Error(ErrorCode::InvalidArgument, std::string("the setting \"") + name + "\" has the wrong type");
        }
        if constexpr (sizeof...(range) == 1 && std::is_arithmetic_v<std::remove_reference_t<decltype(value)>>) {
            const auto inside = [&](const Range& limits) {
                return static_cast<double>(value) >= limits.low && static_cast<double>(value) <= limits.high;
            };
            if (!(inside(range) && ...))
                throw Error(ErrorCode::InvalidArgument, std::string("the setting \"") + name + "\" is out of its range");
        }
    });
    if (known == json.size()) return;
    for (const auto& [key, ignored] : json.items()) {
        bool found = false;
        P::visit_fields(parameters, [&found, &wanted = key](const char* name, const auto&, const char*, auto...) {
            found |= wanted == name;  // renamed: clang 14 cannot capture a structured binding
        });
        if (!found) throw Error(ErrorCode::InvalidArgument, "there is no setting \"" + key + "\"");
    }
}

}  // namespace gse
