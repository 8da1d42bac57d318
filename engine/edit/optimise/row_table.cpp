// Changes of rows, column by column.
#include "engine/edit/optimise/row_table.h"

#include <algorithm>

#include "engine/base/check.h"

namespace gse::edit {
namespace {

/// Makes room for one row of zeros. Momentum that has not begun stays empty.
template <class T> void append_entry(const Column& column, std::vector<T>& array) {
    if (column.kind != ColumnKind::Momentum || !array.empty()) array.resize(array.size() + column.stride);
}

}  // namespace

void RowTable::append_zero() {
    visit([](const Column& column, auto& array) { append_entry(column, array); }, *this);
}

void RowTable::append_carried(const RowTable& from, std::size_t index) {
    GSE_CHECK_EQ(rows.sh_degree, from.rows.sh_degree);
    visit(
        [&](const Column& column, auto& to, const auto& source) {
            append_entry(column, to);
            if (column.kind != ColumnKind::Splat && column.kind != ColumnKind::Fact) return;
            const auto at =
                source.begin() + static_cast<std::ptrdiff_t>((from.begin_of(column) + index) * column.stride);
            std::copy_n(at, column.stride, to.end() - static_cast<std::ptrdiff_t>(column.stride));
        },
        *this, from);
}

void RowTable::keep(const std::vector<std::uint8_t>& flags) {
    GSE_CHECK_EQ(flags.size(), labelled());
    visit(
        [&](const Column& column, auto& array) {
            if (array.empty()) return;
            auto to = array.begin() + static_cast<std::ptrdiff_t>(begin_of(column) * column.stride);
            auto from = to;
            for (const auto flag : flags) {
                const auto end = from + static_cast<std::ptrdiff_t>(column.stride);
                if (flag != 0) to = std::copy(from, end, to);
                from = end;
            }
            array.erase(to, array.end());
        },
        *this);
}

void RowTable::reserve(std::size_t more) {
    const std::size_t count = labelled() + more;
    visit(
        [&](const Column& column, auto& array) { array.reserve((begin_of(column) + count) * column.stride); },
        *this);
}

void RowTable::clear_working() {
    visit(
        [](const Column& column, auto& array) {
            if (column.kind == ColumnKind::Working) std::fill(array.begin(), array.end(), 0);
        },
        *this);
}

bool RowTable::complete() const {
    bool all = true;
    visit(
        [&](const Column& column, const auto& array) {
            const bool begun = column.kind != ColumnKind::Momentum || !array.empty();
            all &= !begun || array.size() == (begin_of(column) + labelled()) * column.stride;
        },
        *this);
    return all;
}

}  // namespace gse::edit
