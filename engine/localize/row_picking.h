// Rows chosen by a property while an artist moves a slider: the values are measured once, the rows follow at
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
    /// What the rows were chosen by.
    const RowChoice& chosen() const { return done_; }
    const RowChoice& wanted() const { return choice_; }
    /// Whether the values of this set's rows have to be measured before the choice means anything.
    bool wants_values(const GaussianSet& set) const;
    /// Values of `choice`'s property, measured of `set`.
    void take(const GaussianSet& set, const RowChoice& choice, Values values);
    /// Chooses anew where the choice or what limits it has changed: `label` (for choices within it) and
    /// `hidden` ([N] or empty), which is never chosen. True when rows() is another one. Values must have been
    /// taken.
    bool update(const Rows& label, std::span<const std::uint8_t> hidden);
    /// Update anew whatever is known.
    void forget_rows() { rows_ = nullptr; }
    /// Null until they are chosen.
    const Rows& rows() const { return rows_; }
    const Values& values() const { return values_; }

private:
    RowChoice choice_, done_, measured_;
    GaussianSet of_;
    Values values_;
    Rows rows_, label_;
};

}  // namespace gse::localize
