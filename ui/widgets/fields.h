// Rows of controls generated from a parameter struct's list of fields.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/fields.h"
#include "ui/context.h"

namespace gse::ui {

/// What one row is about; `prefix` + "." + name is its place in the widget map.
struct FieldRow {
    const char* prefix;
    const char* name;
    const char* help;
    std::optional<Range> range;
};

/// One row each: label with help, control, right click = back to `standard`. True when the value changed.
bool field_row(Context& context, const FieldRow& row, bool& value, bool standard);
bool field_row(Context& context, const FieldRow& row, int& value, int standard);
bool field_row(Context& context, const FieldRow& row, std::uint64_t& value, std::uint64_t standard);
bool field_row(Context& context, const FieldRow& row, float& value, float standard);
bool field_row(Context& context, const FieldRow& row, double& value, double standard);
bool field_row(Context& context, const FieldRow& row, std::string& value, const std::string& standard);

/// "attention_threshold" -> "attention threshold"
std::string field_label(const char* name);

/// Rows for the fields that `wanted(name)` lets through; `before(name)` may put a header first and say
/// whether the rows that follow are shown (a folded group).
template <class P, class Wanted, class Before>
bool field_rows(Context& context, const char* prefix, P& parameters, Wanted&& wanted, Before&& before) {
    [[maybe_unused]] static const P standard{};
    bool changed = false, shown = true;
    P::visit_fields(parameters, [&](const char* name, auto& value, const char* help, auto... range) {
        using Value = std::remove_reference_t<decltype(value)>;
        before(name, shown);
        if (!shown || !wanted(name)) return;
        Value fallback{};
        P::visit_fields(standard, [&](const char* other, const auto& value_there, const char*, auto...) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value_there)>, Value>)
                if (std::string_view(other) == name) fallback = value_there;
        });
        FieldRow row{prefix, name, help, std::nullopt};
        if constexpr (sizeof...(range) == 1) row.range = (range, ...);
        changed |= field_row(context, row, value, fallback);
    });
    return changed;
}

}  // namespace gse::ui
