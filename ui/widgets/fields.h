// Rows of controls generated from a parameter struct's list of fields.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/fields.h"
#include "ui/model/context.h"

namespace gse::ui {

/// Subject of one row. `prefix` + "." + name is its place in the widget map.
struct FieldRow {
    const char* prefix;
    const char* name;
    const char* help;
    std::optional<Range> range;
    bool stated = false;      // the default is what the model states, another than the program's
    std::string unused = {};  // why it has no effect now; empty = it has
};

/// Reason why fields with these bits of FieldHelp::uses have no effect now; empty = they have one.
using UnusedField = std::function<std::string(unsigned uses)>;

/// One row each: label with help, control, right click = back to `standard`. True when the value changed.
bool field_row(Context& context, const FieldRow& row, bool& value, bool standard);
bool field_row(Context& context, const FieldRow& row, int& value, int standard);
bool field_row(Context& context, const FieldRow& row, std::uint64_t& value, std::uint64_t standard);
bool field_row(Context& context, const FieldRow& row, float& value, float standard);
bool field_row(Context& context, const FieldRow& row, double& value, double standard);
bool field_row(Context& context, const FieldRow& row, Overridable& value, const Overridable& standard);
bool field_row(Context& context, const FieldRow& row, std::string& value, const std::string& standard);

/// "attention_threshold" -> "attention threshold"
std::string field_label(const char* name);

/// Values of the program without any choice.
template <class P> const P& program_defaults() {
    static const P defaults{};
    return defaults;
}

/// Value of a field of that name and type in another struct of the kind. Value{} when there is none.
template <class Value, class P> Value value_named(const P& parameters, const char* name) {
    Value found{};
    P::visit_fields(parameters, [&](const char* other, const auto& value, const char*, auto...) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Value>)
            if (std::string_view(other) == name) found = value;
    });
    return found;
}

/// Rows for the fields that `wanted(name, help)` accepts. `before(name)` may put a header first, and says
/// whether the rows that follow are shown (a folded group). `standard` has the values to go back to.
template <class P, class Wanted, class Before>
bool field_rows(Context& context, const char* prefix, P& parameters, Wanted&& wanted, Before&& before,
                const P& standard = program_defaults<P>(), const UnusedField& unused = {}) {
    bool changed = false, shown = true;
    P::visit_fields(parameters, [&](const char* name, auto& value, const FieldHelp& help, auto... range) {
        using Value = std::remove_reference_t<decltype(value)>;
        before(name, shown);
        if (!shown || !wanted(name, help)) return;
        const auto fallback = value_named<Value>(standard, name);
        FieldRow row{prefix, name, help, std::nullopt};
        row.stated = fallback != value_named<Value>(program_defaults<P>(), name);
        if (unused) row.unused = unused(help.uses);
        if constexpr (sizeof...(range) == 1) row.range = (range, ...);
        changed |= field_row(context, row, value, fallback);
    });
    return changed;
}

}  // namespace gse::ui
