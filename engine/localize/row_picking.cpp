// Cached values of a property, and the choices that are out of date.
#include "engine/localize/row_picking.h"

#include "engine/base/check.h"

namespace gse::localize {

bool RowPicking::wants_values(const GaussianSet& set) const {
    const bool other_colour = choice_.property == RowProperty::Colour && choice_.colour != measured_.colour;
    return values_ == nullptr || !of_.shares_all_with(set) || choice_.property != measured_.property ||
           other_colour;
}

void RowPicking::take(const GaussianSet& set, const RowChoice& choice, Values values) {
    GSE_CHECK_EQ(values->size(), set.size());
    of_ = set;
    measured_ = choice;
    values_ = std::move(values);
    rows_ = nullptr;
}

bool RowPicking::update(const Rows& label, std::span<const std::uint8_t> hidden) {
    const Rows within = choice_.within_label ? label : nullptr;
    if (rows_ != nullptr && done_ == choice_ && label_ == within) return false;
    auto rows = chosen_rows(choice_, *values_, within ? std::span(*within) : std::span<const std::uint8_t>());
    for (std::size_t row = 0; row < hidden.size(); ++row)
        if (hidden[row] != 0) rows[row] = 0;
    rows_ = std::make_shared<const std::vector<std::uint8_t>>(std::move(rows));
    done_ = choice_;
    label_ = within;
    return true;
}

}  // namespace gse::localize
