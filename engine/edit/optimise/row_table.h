// Rows of an edit as one table. Every array with an entry per labelled row is declared in one place. Rows
// come, go and are carried over in all of them at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/edit/optimise/adam.h"
#include "engine/scene/gaussian_set.h"
#include "engine/scene/visit_attributes.h"

namespace gse::edit {

/// Content of a column for a new row, and for a row carried over from this or another table.
enum class ColumnKind {
    Splat,     // an attribute, behind those of the unlabelled rows. New: zero; carried over: as it was
    Fact,      // what is remembered of the row. New: zero; carried over: as it was
    Working,   // gathered since the last densification or change of label. Both: zero
    Momentum,  // Adam's; empty before the first step. Both: zero
};

struct Column {
    ColumnKind kind;
    std::size_t stride;
};

/// Plain arrays; whoever appends a row fills in what is not zero.
struct RowTable {
    explicit RowTable(int sh_degree) { rows.sh_degree = anchor.sh_degree = sh_degree; }

    std::size_t first_row = 0;  // unlabelled rows in front of the labelled ones in `rows`
    GaussianData rows;
    std::vector<std::int64_t> origin;    // [labelled] base row it is, -1 = born in the run
    std::vector<std::int64_t> ancestor;  // [labelled] base row it is or descends from, or OfSeed, OfHoleFill
    std::vector<int> generation;         // [labelled]
    std::vector<float> birth_sh;         // [labelled,K,3] colour when the row (or its ancestor) came to be
    std::vector<float> birth_scale;      // [labelled] largest log-scale when the row came to be
    GaussianData anchor;                 // [labelled] the rows at the last densification
    AdamMoments position, log_scale, rotation, opacity, sh;
    std::vector<double> gradient_sum;           // [labelled] of the screen-space gradients
    std::vector<std::uint32_t> gradient_count;  // [labelled] how many they were
    std::vector<float> row_factor;              // [labelled] share of the learning rates of geometry

    std::size_t labelled() const { return rows.size() - first_row; }

    /// The declaration: calls f(column, array) for each array with an entry per labelled row, or f(column,
    /// array, array of the next table, ...) for several tables of one SH degree. All else that is done to
    /// rows follows from it.
    template <class F, class Table, class... More> static void visit(F&& f, Table& table, More&... more) {
        const auto of_kind = [&f](ColumnKind kind) {
            return [&f, kind](std::size_t stride, auto&... arrays) { f(Column{kind, stride}, arrays...); };
        };
        const auto fact = of_kind(ColumnKind::Fact), working = of_kind(ColumnKind::Working);
        const auto moments = [momentum = of_kind(ColumnKind::Momentum)](std::size_t stride, auto&... adam) {
            momentum(stride, adam.first...);
            momentum(stride, adam.second...);
        };
        const std::size_t sh_stride = table.rows.sh_stride();
        visit_attributes(of_kind(ColumnKind::Splat), table.rows, more.rows...);
        fact(1, table.origin, more.origin...);
        fact(1, table.ancestor, more.ancestor...);
        fact(1, table.generation, more.generation...);
        fact(sh_stride, table.birth_sh, more.birth_sh...);
        fact(1, table.birth_scale, more.birth_scale...);
        visit_attributes(fact, table.anchor, more.anchor...);
        moments(3, table.position, more.position...);
        moments(3, table.log_scale, more.log_scale...);
        moments(4, table.rotation, more.rotation...);
        moments(1, table.opacity, more.opacity...);
        moments(sh_stride, table.sh, more.sh...);
        working(1, table.gradient_sum, more.gradient_sum...);
        working(1, table.gradient_count, more.gradient_count...);
        working(1, table.row_factor, more.row_factor...);
    }

    /// Appends a new row: zero in every column.
    void append_zero();
    /// Appends the labelled row `index` of `from`, which may be this table.
    void append_carried(const RowTable& from, std::size_t index);
    /// Drops the labelled rows whose flag is 0.
    void keep(const std::vector<std::uint8_t>& flags);
    /// Takes the memory for `more` labelled rows.
    void reserve(std::size_t more);
    /// Sets the columns of kind Working to zero.
    void clear_working();
    /// True when every column has one entry per labelled row (momentum: or none at all).
    bool complete() const;

private:
    std::size_t begin_of(const Column& column) const {
        return column.kind == ColumnKind::Splat ? first_row : 0;
    }
};

}  // namespace gse::edit
