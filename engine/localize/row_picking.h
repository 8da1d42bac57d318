// Rows chosen by a property while an artist moves a slider. The values are measured once; the rows follow at
// once.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/localize/row_property.h"

namespace gse::localize {

class RowPicking {
public:
    using Rows = std::shared_ptr<const std::vector<std::uint8_t>>;
    using Values = std::shared_ptr<const std::vector<float>>;

    void choose(const RowChoice& choice) { choice_ = choice; }
    /// Choice from which the rows follow.
    const RowChoice& chosen() const { return done_; }
    const RowChoice& wanted() const { return choice_; }
    /// True when the values of this set's rows must be measured before a choice.
    bool wants_values(const GaussianSet& set) const;
    /// Values of `choice`'s property, measured of `set`.
    void take(const GaussianSet& set, const RowChoice& choice, Values values);
    /// Chooses anew if the choice or its limits have changed. `label` limits choices within it. `hidden` ([N]
    /// or empty) is never chosen. Returns true when rows() has changed. Values must have been taken.
    bool update(const Rows& label, std::span<const std::uint8_t> hidden);
    /// Forces the next update() to choose anew.
    void forget_rows() { rows_ = nullptr; }
    /// Chosen rows; null before the first choice.
    const Rows& rows() const { return rows_; }
    const Values& values() const { return values_; }

private:
    RowChoice choice_, done_, measured_;
    GaussianSet of_;
    Values values_;
    Rows rows_, label_;
};

}  // namespace gse::localize
