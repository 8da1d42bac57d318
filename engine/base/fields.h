// One list of fields per parameter struct serves command line, project file, log and window.
//
// A struct P offers this function, which calls f once per member:
//
//   template <class Self, class F> static void visit_fields(Self& self, F&& f) {
//       f("name", self.member, "Purpose of the member.", Range{low, high});
//   }
//
// A FieldHelp in place of the text also tags the member's use. The range may be left out. Members are bool,
// int, std::uint64_t, float, double, Overridable, std::string or a list of texts (std::vector<std::string>).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/overridable.h"

namespace gse {

/// Inclusive limits of a number.
struct Range {
    double low = 0;
    double high = 0;
};

/// A field that had another name before.
struct RenamedField {
    const char* before;
    const char* now;
};

/// The renamed fields of a struct, which it lists as `Renamed` if there are any.
template <class P> constexpr std::span<const RenamedField> renamed_fields() {
    if constexpr (requires { P::Renamed; }) return P::Renamed;
    else return {};
}

/// The object with the present names of fields; what has a present name in it already stays as it is.
nlohmann::ordered_json with_present_names(const nlohmann::ordered_json& json,
                                          std::span<const RenamedField> renamed);

/// Help text of a field, with bits that say what the field is used for, in the struct's own meaning; 0 = for
/// everything. Visitors that need no tag take it as `const char*`.
struct FieldHelp {
    const char* text;
    unsigned uses = 0;

    constexpr FieldHelp(const char* help, unsigned used_for = 0) : text(help), uses(used_for) {}
    constexpr operator const char*() const { return text; }
};

/// A setting that a struct once had: whoever names it is told that it is ignored. A struct P lists them in
/// `static constexpr std::array RetiredFields`.
struct RetiredField {
    std::string_view name;
    double unset = 0;  // its default, of which nothing has to be said
};

/// The retired field of that name; null = there is none.
template <class P> const RetiredField* retired_field(std::string_view name) {
    if constexpr (requires { P::RetiredFields; })
        for (const auto& field : P::RetiredFields)
            if (field.name == name) return &field;
    return nullptr;
}

/// Logs that the setting is ignored.
void note_retired_field(std::string_view name);

/// All fields as a JSON object, in the order of the list; an Overridable that nobody has set is null.
template <class P> nlohmann::ordered_json fields_to_json(const P& parameters) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    P::visit_fields(parameters, [&](const char* name, const auto& value, const char*, auto...) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Overridable>) {
            if (value.is_set()) json[name] = static_cast<double>(value);
            else json[name] = nullptr;
        } else {
            json[name] = value;
        }
    });
    return json;
}

/// Tells whether fields of the type hold one number, set or not.
template <class Value>
constexpr bool is_number_field = std::is_same_v<Value, Overridable> ||
                                 (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>);

/// Sets `value` from JSON. Throws Error that names the setting for a wrong type, a number that is not whole
/// or not finite, or one out of range.
void read_field(const char* name, bool& value, const nlohmann::ordered_json& json);
void read_field(const char* name, int& value, const nlohmann::ordered_json& json,
                const Range* range = nullptr);
void read_field(const char* name, std::uint64_t& value, const nlohmann::ordered_json& json,
                const Range* range = nullptr);
void read_field(const char* name, float& value, const nlohmann::ordered_json& json,
                const Range* range = nullptr);
void read_field(const char* name, double& value, const nlohmann::ordered_json& json,
                const Range* range = nullptr);
/// Null unsets the number.
void read_field(const char* name, Overridable& value, const nlohmann::ordered_json& json,
                const Range* range = nullptr);
void read_field(const char* name, std::string& value, const nlohmann::ordered_json& json);
void read_field(const char* name, std::vector<std::string>& value, const nlohmann::ordered_json& json);

/// Throws Error that names the setting when the number is not finite or not in its range (may be null).
void check_field(const char* name, double value, const Range* range);
void check_field(const char* name, float value, const Range* range);

/// Checks every number of the struct, whoever set it.
template <class P> void check_fields(const P& parameters) {
    P::visit_fields(parameters, [&](const char* name, const auto& value, const char*, const auto&... range) {
        if constexpr (is_number_field<std::remove_cvref_t<decltype(value)>>) {
            const Range* limits = nullptr;
            ((limits = &range), ...);
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, float>)
                check_field(name, value, limits);
            else check_field(name, static_cast<double>(value), limits);
        }
    });
}

/// Sets the fields that a JSON object names, by present names or those of before. Absent ones keep their
/// value, retired ones are ignored. Throws Error for an unknown name, a wrong type, or a number that is not
/// finite or out of range. Nothing is set then.
template <class P> void fields_from_json(P& parameters, const nlohmann::ordered_json& named) {
    if (!named.is_object())
        throw Error(ErrorCode::InvalidArgument, "the settings are not an object of names and values");
    const auto json = with_present_names(named, renamed_fields<P>());
    P read = parameters;
    std::size_t known = 0;
    P::visit_fields(read, [&](const char* name, auto& value, const char*, const auto&... range) {
        const auto found = json.find(name);
        if (found == json.end()) return;
        ++known;
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (is_number_field<Value>) {
            const Range* limits = nullptr;
            ((limits = &range), ...);
            read_field(name, value, *found, limits);
        } else {
            read_field(name, value, *found);
        }
    });
    for (const auto& [key, value] : json.items()) {
        if (known == json.size()) break;
        if (const auto* retired = retired_field<P>(key)) {
            if (value != retired->unset) note_retired_field(key);
            continue;
        }
        bool found = false;
        P::visit_fields(parameters,
                        [&found, &wanted = key](const char* name, const auto&, const char*, auto...) {
                            found |= wanted == name;  // renamed: clang 14 cannot capture a structured binding
                        });
        if (!found) throw Error(ErrorCode::InvalidArgument, "there is no setting \"" + key + "\"");
    }
    parameters = std::move(read);
}

}  // namespace gse
